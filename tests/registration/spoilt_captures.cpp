#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "registration/captures.hpp"

namespace poecal::test {
namespace {

using Spoil = std::function<void(MadeCapture&)>;

Spoil ofReadings(std::function<void(Eigen::VectorXd&)> spoil) {
  return [spoil](MadeCapture& capture) {
    for (Observation& observation : capture.observations) spoil(observation.q);
  };
}

Spoil ofPoses(std::function<Eigen::Isometry3d(const Eigen::Isometry3d&)> spoil) {
  return [spoil](MadeCapture& capture) {
    for (Observation& observation : capture.observations) {
      if (observation.pose) {
        observation.pose->T_camera_target = spoil(observation.pose->T_camera_target);
      } else {
        observation.T_base_flange = spoil(*observation.T_base_flange);
      }
    }
  };
}

Spoil ofRotations(std::function<Eigen::Matrix3d(const Eigen::Matrix3d&)> spoil) {
  return ofPoses([spoil](Eigen::Isometry3d T) {
    T.linear() = spoil(T.linear());
    return T;
  });
}

Spoil ofCorners(std::function<void(CornerMeasurement&, const std::vector<CornerMeasurement>&)> spoil) {
  return [spoil](MadeCapture& capture) {
    for (Observation& observation : capture.observations) {
      const std::vector<CornerMeasurement> right = observation.corners;
      for (CornerMeasurement& corner : observation.corners) spoil(corner, right);
    }
  };
}

/// From row `begin` on each row has the reading of `by` rows before.
Spoil shiftedRows(std::size_t begin, std::size_t by) {
  return [begin, by](MadeCapture& capture) {
    const std::vector<Observation> right = capture.observations;
    for (std::size_t k = std::max(begin, by); k < right.size(); ++k) {
      capture.observations[k].q = right[k - by].q;
      capture.observations[k].T_base_flange = right[k - by].T_base_flange;
    }
    capture.observations.erase(capture.observations.begin(),
                               capture.observations.begin() + static_cast<std::ptrdiff_t>(begin == 0 ? by : 0));
  };
}

Spoil sizedTarget(double factor) {
  return [factor](MadeCapture& capture) {
    for (Observation& observation : capture.observations) {
      for (CornerMeasurement& corner : observation.corners) corner.p_target *= factor;
    }
  };
}

Spoil sizedArm(double factor) {
  return [factor](MadeCapture& capture) {
    Arm& arm = *capture.told.arm;
    for (Joint& joint : arm.joints) {
      joint.anchor *= factor;
      if (joint.type == JointType::kRevolute) joint.xi.tail<3>() *= factor;
    }
    Eigen::Isometry3d tip = expSe3(arm.gamma);
    tip.translation() *= factor;
    arm.gamma = logSe3(tip);
  };
}

Spoil ofLens(double factor) {
  return [factor](MadeCapture& capture) {
    Camera& camera = *capture.told.camera;
    camera.width = static_cast<int>(factor * camera.width);
    camera.height = static_cast<int>(factor * camera.height);
    camera.fx *= factor;
    camera.fy *= factor;
    camera.cx = factor * (camera.cx + 0.5) - 0.5;
    camera.cy = factor * (camera.cy + 0.5) - 0.5;
  };
}

void addOfJoints(const Arm& arm, std::vector<std::tuple<std::string, std::string, Spoil>>& list) {
  const auto revolute = [&arm](Eigen::Index k) { return arm.joints[static_cast<std::size_t>(k)].type == JointType::kRevolute; };
  list.emplace_back("degrees", "degrees", ofReadings([revolute](Eigen::VectorXd& q) {
                      for (Eigen::Index k = 0; k < q.size(); ++k) q(k) *= revolute(k) ? 180.0 / M_PI : 1.0;
                    }));
  list.emplace_back("sign", "q2 counts the other way", ofReadings([](Eigen::VectorXd& q) { q(1) = -q(1); }));
  list.emplace_back("two signs", "count the other way", ofReadings([](Eigen::VectorXd& q) {
                      q(0) = -q(0);
                      q(3) = -q(3);
                    }));
  if (revolute(2)) {
    list.emplace_back("alphabet", "q1 and q3 are exchanged", ofReadings([](Eigen::VectorXd& q) { std::swap(q(0), q(2)); }));
  }
  list.emplace_back("exchanged", "q2 and q4 are exchanged", ofReadings([](Eigen::VectorXd& q) { std::swap(q(1), q(3)); }));
  list.emplace_back("exchanged and reversed", "exchanged, and q", ofReadings([](Eigen::VectorXd& q) {
                      std::swap(q(1), q(3));
                      q(2) = -q(2);
                    }));
  list.emplace_back("zero", "the zero of q2 is off by 90 degrees", ofReadings([](Eigen::VectorXd& q) { q(1) += M_PI_2; }));
  if (revolute(1)) {
    list.emplace_back("one in degrees", "q2 looks like degrees", ofReadings([](Eigen::VectorXd& q) { q(1) *= 180.0 / M_PI; }));
  }
  if (revolute(1) && revolute(2)) {
    list.emplace_back("coupled", "q3 looks to hold q3 + q2", ofReadings([](Eigen::VectorXd& q) { q(2) += q(1); }));
  }
  list.emplace_back("copied", "q2 and q4 hold the same readings", ofReadings([](Eigen::VectorXd& q) { q(3) = q(1); }));
  list.emplace_back("stuck", "q2 stays at exactly", [](MadeCapture& capture) {
    const std::size_t from = capture.observations.size() * 3 / 5;
    for (std::size_t k = from; k < capture.observations.size(); ++k) capture.observations[k].q(1) = capture.observations[from].q(1);
  });
  list.emplace_back("frozen", "the readings stay", [](MadeCapture& capture) {
    const std::size_t from = capture.observations.size() * 3 / 4;
    for (std::size_t k = from; k < capture.observations.size(); ++k) capture.observations[k].q = capture.observations[from].q;
  });
  list.emplace_back("late", "q2 looks to hold the readings of the row before", [](MadeCapture& capture) {
    for (std::size_t k = capture.observations.size(); k-- > 1;) capture.observations[k].q(1) = capture.observations[k - 1].q(1);
  });
  list.emplace_back("reverse", "reverse order", ofReadings([](Eigen::VectorXd& q) { q.reverseInPlace(); }));
  if (arm.jointCount() > 4) {  // the last joint's zero is the tool's
    list.emplace_back("half a turn", "q4 is off by 180 degrees", ofReadings([revolute](Eigen::VectorXd& q) { q(3) += M_PI; }));
  }
  list.emplace_back("robot in mm", "millimetres", sizedArm(1e3));
}

void addOfPoses(std::vector<std::tuple<std::string, std::string, Spoil>>& list) {
  list.emplace_back("poses in mm", "millimetres", ofPoses([](Eigen::Isometry3d T) {
                      T.translation() *= 1e3;
                      return T;
                    }));
  list.emplace_back("poses in inches", "inches", ofPoses([](Eigen::Isometry3d T) {
                      T.translation() /= 0.0254;
                      return T;
                    }));
  list.emplace_back("wxyz", "another order of the quaternion", ofRotations([](const Eigen::Matrix3d& R) {
                      const Eigen::Quaterniond q(R);  // w, x, y, z stand where x, y, z, w are read
                      return Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
                    }));
  list.emplace_back("conjugate", "conjugate", ofRotations([](const Eigen::Matrix3d& R) { return Eigen::Matrix3d(R.transpose()); }));
  list.emplace_back("yaw first", "taken for yaw, pitch, roll", ofRotations([](const Eigen::Matrix3d& R) {
                      const Eigen::Vector3d a = R.eulerAngles(2, 1, 0);
                      return Eigen::Matrix3d(expSo3({0, 0, a.z()}) * expSo3({0, a.y(), 0}) * expSo3({a.x(), 0, 0}));
                    }));
  list.emplace_back("exchanged axes", "look to hold z, y, x in the axes of the rotations", ofPoses([](Eigen::Isometry3d T) {
                      std::swap(T.translation().x(), T.translation().z());
                      return T;
                    }));
  list.emplace_back("y up", "look to hold x, z, -y in the axes of the rotations", ofPoses([](Eigen::Isometry3d T) {
                      const Eigen::Vector3d p = T.translation();
                      T.translation() << p.x(), p.z(), -p.y();
                      return T;
                    }));
  list.emplace_back("inverted", "inverted", ofPoses([](const Eigen::Isometry3d& T) { return T.inverse(); }));
  list.emplace_back("rotation vectors", "rotation vectors that were taken for roll, pitch, yaw", ofRotations([](const Eigen::Matrix3d& R) {
                      const Eigen::Vector3d a = logSo3(R);
                      return Eigen::Matrix3d(expSo3({0, 0, a.z()}) * expSo3({0, a.y(), 0}) * expSo3({a.x(), 0, 0}));
                    }));
}

void addOfPictures(const MadeCapture& good, std::vector<std::tuple<std::string, std::string, Spoil>>& list) {
  const Setup setup = good.told.registration.setup;
  const Setup other = setup == Setup::kEyeToHand ? Setup::kEyeInHand : Setup::kEyeToHand;
  list.emplace_back("setup", std::string("looks like setup: ") + setupName(setup),
                    [other](MadeCapture& capture) { capture.told.registration.setup = other; });
  list.emplace_back("target in mm", "millimetres", sizedTarget(1e3));
  list.emplace_back("margin", "white margin", sizedTarget(1.25));
  list.emplace_back("small tag", "1.", sizedTarget(0.7));
  list.emplace_back("corners turned", "another order", ofCorners([](CornerMeasurement& c, const std::vector<CornerMeasurement>& all) {
                      for (const CornerMeasurement& one : all) {
                        if (one.id.tag == c.id.tag && one.id.corner == (c.id.corner + 1) % 4) c.px = one.px;
                      }
                    }));
  list.emplace_back("corners the other way round", "clockwise",
                    ofCorners([](CornerMeasurement& c, const std::vector<CornerMeasurement>& all) {
                      for (const CornerMeasurement& one : all) {
                        if (one.id.tag == c.id.tag && one.id.corner == 3 - c.id.corner) c.px = one.px;
                      }
                    }));
  list.emplace_back("other spacing", "times as far apart", ofCorners([](CornerMeasurement& c, const auto&) {
                      if (c.id.tag == 1) c.p_target.x() += 0.03;
                    }));
  list.emplace_back("right to left", "from right to left",
                    ofCorners([](CornerMeasurement& c, const auto&) { c.p_target.x() += c.id.tag == 1 ? -0.11 : 0.11; }));
  list.emplace_back("mirrored", "mirror", ofCorners([](CornerMeasurement& c, const auto&) { c.px.x() = 1279.0 - c.px.x(); }));
  list.emplace_back("cropped", "cut out", ofCorners([](CornerMeasurement& c, const auto&) { c.px -= Eigen::Vector2d(320, 240); }));
  list.emplace_back("u and v exchanged", "u and v", ofCorners([](CornerMeasurement& c, const auto&) { std::swap(c.px.x(), c.px.y()); }));
  list.emplace_back("half the resolution", "2 of the camera's resolution", ofLens(0.5));
}

}  // namespace

std::vector<Spoilt> spoiltCaptures(const CaptureKind& kind, const MadeCapture& good) {
  std::vector<std::tuple<std::string, std::string, Spoil>> list;
  if (good.told.arm) addOfJoints(*good.told.arm, list);
  if (kind.readings != Readings::kJoints) addOfPoses(list);
  if (kind.readings != Readings::kTracker) addOfPictures(good, list);
  list.emplace_back("shifted", "shifted by one", shiftedRows(0, 1));
  list.emplace_back("shifted from a row on", "from this row on the rows are shifted by 2",
                    shiftedRows(good.observations.size() * 3 / 5, 2));
  std::vector<Spoilt> spoilt;
  for (const auto& [name, said, spoil] : list) {
    spoilt.push_back({name, said, good});
    spoil(spoilt.back().capture);
  }
  return spoilt;
}

}  // namespace poecal::test
