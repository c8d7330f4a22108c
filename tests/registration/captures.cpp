#include "registration/captures.hpp"

#include <functional>
#include <map>
#include <ostream>

#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "poecal/registration/registration.hpp"
#include "support/cameras.hpp"

namespace poecal::test {
namespace {

constexpr double kTag = 0.08;
constexpr int kAttempts = 100000;

Eigen::Vector3d at(double x, double y, double z) { return {x, y, z}; }

void setTip(Arm& arm, const Eigen::Isometry3d& tip) { arm.gamma = logSe3(tip); }

Eigen::Isometry3d poseAt(const Eigen::Vector3d& place, const Eigen::Vector3d& rotation) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = expSo3(rotation);
  T.translation() = place;
  return T;
}

/// Shapes of arms that are sold, in round figures.
Arm armOf(const std::string& name) {
  const Eigen::Vector3d x = at(1, 0, 0), y = at(0, 1, 0), z = at(0, 0, 1);
  Arm arm;
  arm.name = name;
  const auto add = [&arm](const Eigen::Vector3d& axis, const Eigen::Vector3d& point) {
    arm.joints.push_back(Joint::revolute("joint_" + std::to_string(arm.jointCount() + 1), axis, point));
  };
  if (name == "elbow") {  // six joints, offset wrist
    add(z, at(0, 0, 0));
    add(y, at(0, 0.13, 0.16));
    add(y, at(0.45, 0.0, 0.16));
    add(y, at(0.85, 0.1, 0.16));
    add(-z, at(0.85, 0.11, 0.16));
    add(y, at(0.85, 0.11, 0.07));
    setTip(arm, poseAt(at(0.85, 0.2, 0.07), at(-1.5, 0.1, 0.0)));
  } else if (name == "seven") {
    add(z, at(0, 0, 0));
    add(y, at(0, 0, 0.33));
    add(z, at(0, 0, 0.4));
    add(-y, at(0.08, 0, 0.65));
    add(z, at(0, 0, 0.9));
    add(-y, at(0, 0, 1.03));
    add(-z, at(0.09, 0, 1.0));
    setTip(arm, poseAt(at(0.09, 0, 0.93), at(3.0, 0.2, 0.0)));
  } else if (name == "scara") {
    add(z, at(0, 0, 0.2));
    add(z, at(0.35, 0, 0.3));
    arm.joints.push_back(Joint::prismatic("joint_3", -z, at(0.6, 0, 0.3)));
    add(z, at(0.6, 0, 0.3));
    setTip(arm, poseAt(at(0.6, 0, 0.2), at(3.1, 0.0, 0.1)));
  } else {  // "shoulder": six joints, spherical wrist, a shoulder beside the column
    add(z, at(0, 0, 0));
    add(y, at(0.15, 0, 0.45));
    add(y, at(0.15, 0, 1.05));
    add(x, at(0.3, 0, 1.2));
    add(y, at(0.8, 0, 1.2));
    add(x, at(0.85, 0, 1.2));
    setTip(arm, poseAt(at(0.9, 0, 1.2), at(0.1, 1.5, 0.0)));
  }
  return arm;
}

/// A pose of the target before the camera: facing it from about a metre, off its axis.
Eigen::Isometry3d beforeCamera(Rng& rng) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = expSo3(uniformVector(rng, 3, 0.35));
  T.translation() = at(rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), rng.uniform(0.8, 1.0));
  return T;
}

/// Eight corners: two tags, so that their order and their size show.
std::vector<CornerMeasurement> pointsOfTarget() {
  std::vector<CornerMeasurement> points;
  for (int tag = 0; tag < 2; ++tag) {
    const Eigen::Matrix<double, 3, 4> corners = tagCorners(kTag);
    for (int k = 0; k < 4; ++k) {
      CornerMeasurement point;
      point.id = {tag, k};
      point.p_target = corners.col(k) + at(0.11 * tag, 0.0, 0.0);
      points.push_back(point);
    }
  }
  return points;
}

bool sees(const Camera& camera, const Eigen::Isometry3d& T_camera_target, const std::vector<CornerMeasurement>& points) {
  // Faces the camera at 60 degrees or better: z of the target points away from its front.
  if (T_camera_target.linear().col(2).dot(T_camera_target.translation().normalized()) < 0.5) return false;
  for (const CornerMeasurement& point : points) {
    const auto px = project(camera, T_camera_target * point.p_target);
    if (!px || px->x() < 0.0 || px->y() < 0.0 || px->x() > camera.width - 1 || px->y() > camera.height - 1) return false;
  }
  return true;
}

Eigen::VectorXd drawReading(const Arm& arm, const Eigen::VectorXd& middle, double spread, Rng& rng) {
  Eigen::VectorXd q = middle;
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const bool slides = arm.joints[static_cast<std::size_t>(k)].type == JointType::kPrismatic;
    q(k) += rng.uniform(-1.0, 1.0) * (slides ? 0.12 : spread);
  }
  return q;
}

/// A registration in which the target is before the camera at the middle reading.
void placeCamera(Cell& cell, const Eigen::Isometry3d& T_base_flange, Rng& rng) {
  Registration& registration = cell.registration;
  const bool to_hand = registration.setup == Setup::kEyeToHand;
  const Eigen::Isometry3d bracket = poseAt(uniformVector(rng, 3, 0.08), uniformVector(rng, 3, 0.3));
  const Eigen::Isometry3d T_camera_target = beforeCamera(rng);
  if (to_hand) {
    registration.T_far_target = bracket;
    registration.T_camera_near = T_camera_target * (T_base_flange * bracket).inverse();
  } else {
    registration.T_camera_near = bracket;
    registration.T_far_target = T_base_flange * bracket.inverse() * T_camera_target;
  }
}

Observation observe(const CaptureKind& kind, const Cell& told, const Cell& truth, const Eigen::VectorXd& q, Rng& rng) {
  Observation observation;
  const Eigen::Isometry3d T_base_flange = forwardKinematics(*truth.arm, q);
  const Eigen::Isometry3d T_camera_target = truth.registration.cameraTarget(T_base_flange);
  observation.q = q;
  if (kind.readings == Readings::kFlangePoses) {
    observation.T_base_flange = forwardKinematics(*told.arm, q);
    observation.q.resize(0);
  }
  if (kind.readings == Readings::kTracker) {
    PoseMeasurement pose;
    Vector6d noise;
    for (int k = 0; k < 6; ++k) noise(k) = rng.normal() * (k < 3 ? 1e-4 : 5e-5);
    pose.T_camera_target = expSe3(noise) * T_camera_target;
    Vector6d weight;
    weight << Eigen::Vector3d::Constant(1.0 / 3e-3), Eigen::Vector3d::Constant(1.0 / 1e-3);
    pose.whitening = weight.asDiagonal();
    observation.pose = pose;
    return observation;
  }
  observation.corners = pointsOfTarget();
  for (CornerMeasurement& corner : observation.corners) {
    corner.px = *project(*truth.camera, T_camera_target * corner.p_target) + kind.sigma_px * Eigen::Vector2d(rng.normal(), rng.normal());
  }
  return observation;
}

}  // namespace

std::string nameOf(const CaptureKind& kind) {
  constexpr const char* kReadings[] = {"joints", "poses", "tracker"};
  return fmt::format("{}_{}_{}_{}_{}", kind.arm, setupName(kind.setup), kReadings[static_cast<int>(kind.readings)],
                     kind.view == View::kWide ? "wide" : "lookat", kind.pictures);
}

void PrintTo(const CaptureKind& kind, std::ostream* stream) { *stream << nameOf(kind); }

MadeCapture makeCapture(const CaptureKind& kind, Rng& rng) {
  MadeCapture made;
  made.told.arm = armOf(kind.arm);
  made.told.camera = plumbBob(1280, 960, {1100.0, 1100.0}, {640.0, 480.0});
  made.told.registration.setup = kind.setup;
  made.truth = made.told;
  Eigen::VectorXd beta(twistParameterCount(*made.told.arm));
  const std::vector<std::string> names = twistParameterNames(*made.told.arm);
  for (Eigen::Index k = 0; k < beta.size(); ++k) {
    const bool tilts = names[static_cast<std::size_t>(k)].find("tilt") != std::string::npos;
    beta(k) = rng.normal() * (tilts ? kind.tilt : kind.shift);
  }
  made.truth.arm = displaceTwists(*made.told.arm, beta);
  const double spread = kind.view == View::kWide ? 0.7 : 0.3;
  const Eigen::VectorXd middle = drawReading(*made.told.arm, Eigen::VectorXd::Zero(made.told.arm->jointCount()), 0.6, rng);
  placeCamera(made.truth, forwardKinematics(*made.truth.arm, middle), rng);
  const std::vector<CornerMeasurement> points = pointsOfTarget();
  for (int attempt = 0; attempt < kAttempts && static_cast<int>(made.observations.size()) < kind.pictures; ++attempt) {
    const Eigen::VectorXd q = drawReading(*made.told.arm, middle, spread, rng);
    const Eigen::Isometry3d T_camera_target = made.truth.registration.cameraTarget(forwardKinematics(*made.truth.arm, q));
    if (!sees(*made.truth.camera, T_camera_target, points)) continue;
    made.observations.push_back(observe(kind, made.told, made.truth, q, rng));
    made.observations.back().sample = made.observations.size() - 1;
  }
  if (kind.readings == Readings::kFlangePoses) made.told.arm.reset();
  if (kind.readings == Readings::kTracker) {
    made.told.camera.reset();
    made.told.registration.setup = Setup::kEyeToHand;
  }
  return made;
}

MadeCapture movedFrom(const MadeCapture& capture, std::size_t row, const Eigen::Isometry3d& T_new_old) {
  MadeCapture moved = capture;
  for (std::size_t k = row; k < moved.observations.size(); ++k) {
    Observation& observation = moved.observations[k];
    if (observation.pose) {
      observation.pose->T_camera_target = T_new_old * observation.pose->T_camera_target;
      continue;
    }
    const Eigen::Isometry3d T_base_flange =
        observation.T_base_flange ? *observation.T_base_flange : forwardKinematics(*capture.truth.arm, observation.q);
    const Eigen::Isometry3d T_camera_target = capture.truth.registration.cameraTarget(T_base_flange);
    for (CornerMeasurement& corner : observation.corners) {
      const Eigen::Vector3d p_camera = T_camera_target * corner.p_target;
      const auto before = project(*capture.truth.camera, p_camera), after = project(*capture.truth.camera, T_new_old * p_camera);
      corner.px += *after - *before;
    }
  }
  return moved;
}

MadeCapture parkedFrom(const MadeCapture& capture, std::size_t row, Eigen::Index joint) {
  MadeCapture parked = capture;
  const double there = capture.observations[row].q(joint);
  for (std::size_t k = row; k < parked.observations.size(); ++k) {
    Observation& observation = parked.observations[k];
    const auto seen = [&] { return capture.truth.registration.cameraTarget(forwardKinematics(*capture.truth.arm, observation.q)); };
    const Eigen::Isometry3d before = seen();
    observation.q(joint) = there;
    const Eigen::Isometry3d after = seen();
    for (CornerMeasurement& corner : observation.corners) {
      corner.px += *project(*capture.truth.camera, after * corner.p_target) - *project(*capture.truth.camera, before * corner.p_target);
    }
  }
  return parked;
}

MadeCapture withGrid(const MadeCapture& capture, int columns, int rows, double cell) {
  MadeCapture board = capture;
  const Eigen::Matrix<double, 3, 4> corners = tagCorners(0.7 * cell);
  for (Observation& observation : board.observations) {
    const Eigen::Isometry3d T_camera_target = capture.truth.registration.cameraTarget(forwardKinematics(*capture.truth.arm, observation.q));
    observation.corners.clear();
    for (int tag = 0; tag < columns * rows; ++tag) {
      const Eigen::Vector3d centre((tag % columns - 0.5 * (columns - 1)) * cell, (tag / columns - 0.5 * (rows - 1)) * cell, 0.0);
      for (int k = 0; k < 4; ++k) {
        CornerMeasurement corner;
        corner.id = {tag, k};
        corner.p_target = centre + corners.col(k);
        corner.px = *project(*capture.truth.camera, T_camera_target * corner.p_target);
        corner.sigma_px = 0.1;
        observation.corners.push_back(corner);
      }
    }
  }
  return board;
}

Said said(const MadeCapture& capture) {
  try {
    if (capture.observations.front().pose) {
      std::string warnings;
      for (const std::string& warning : registerPoses(capture.told, capture.observations, true).warnings) warnings += warning + "\n";
      return {false, warnings};
    }
    std::string warnings;
    for (const std::string& warning : registerCell(capture.told, capture.observations, {}).warnings) warnings += warning + "\n";
    return {false, warnings};
  } catch (const Error& error) {
    return {true, error.what()};
  }
}

}  // namespace poecal::test
