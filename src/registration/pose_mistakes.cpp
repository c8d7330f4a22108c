#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/geometry/se3.hpp"
#include "registration/mistakes.hpp"

namespace poecal {
namespace {

using PoseChange = std::function<Eigen::Isometry3d(const Eigen::Isometry3d&)>;

Mistake mistakeOfPoses(std::string text, PoseChange right) {
  return {std::move(text), InputPart::kSamples, [right](Problem& problem) {
            for (Observation& observation : problem.observations) {
              if (observation.pose) {
                observation.pose->T_camera_target = right(observation.pose->T_camera_target);
              } else {
                observation.T_base_flange = right(*observation.T_base_flange);
              }
            }
            if (problem.observations.front().pose) {
              renewPictures(problem);
            } else {
              renewPoses(problem);
            }
          }};
}

PoseChange ofRotation(std::function<Eigen::Matrix3d(const Eigen::Matrix3d&)> right) {
  return [right = std::move(right)](const Eigen::Isometry3d& T) {
    Eigen::Isometry3d changed = T;
    changed.linear() = right(T.linear());
    return changed;
  };
}

/// Three numbers of a rotation, and back.
struct ThreeNumbers {
  const char* name;
  Eigen::Vector3d (*from)(const Eigen::Matrix3d&);
  Eigen::Matrix3d (*to)(const Eigen::Vector3d&);
};

Eigen::Matrix3d turn(int axis, double angle) { return expSo3(angle * Eigen::Vector3d::Unit(axis)); }

/// Rz(c) Ry(b) Rx(a): roll, pitch, yaw about fixed axes.
Eigen::Vector3d fixedAngles(const Eigen::Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)), std::atan2(R(1, 0), R(0, 0))};
}
Eigen::Matrix3d fromFixed(const Eigen::Vector3d& a) { return turn(2, a.z()) * turn(1, a.y()) * turn(0, a.x()); }
/// Rx(a) Ry(b) Rz(c): about moving axes.
Eigen::Vector3d movingAngles(const Eigen::Matrix3d& R) { return -fixedAngles(R.transpose()); }
Eigen::Matrix3d fromMoving(const Eigen::Vector3d& a) { return turn(0, a.x()) * turn(1, a.y()) * turn(2, a.z()); }

constexpr ThreeNumbers kThreeNumbers[] = {
    {"rotation vectors", [](const Eigen::Matrix3d& R) { return Eigen::Vector3d(logSo3(R)); },
     [](const Eigen::Vector3d& a) { return Eigen::Matrix3d(expSo3(a)); }},
    {"roll, pitch, yaw", fixedAngles, fromFixed},
    {"Euler angles about moving x, y, z", movingAngles, fromMoving},
    {"yaw, pitch, roll", [](const Eigen::Matrix3d& R) { return Eigen::Vector3d(fixedAngles(R).reverse()); },
     [](const Eigen::Vector3d& a) { return Eigen::Matrix3d(fromFixed(a.reverse())); }},
};

void addThreeNumbers(std::vector<Mistake>& mistakes) {
  for (const ThreeNumbers& are : kThreeNumbers) {
    for (const ThreeNumbers& taken : kThreeNumbers) {
      if (are.name == taken.name) continue;
      mistakes.push_back(mistakeOfPoses(fmt::format("the quaternions look made from {} that were taken for {}", are.name, taken.name),
                                        ofRotation([&are, &taken](const Eigen::Matrix3d& R) { return are.to(taken.from(R)); })));
    }
  }
}

/// Positions in other axes than the rotations: exchanged columns, other signs, y up in one program and z up in another.
void addAxes(std::vector<Mistake>& mistakes) {
  std::array<int, 3> axis{0, 1, 2};
  constexpr const char* kNames[] = {"x", "y", "z"};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      // What x, y and z hold, to be put back.
      Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
      std::vector<std::string> words;
      for (int row = 0; row < 3; ++row) {
        const bool negative = (signs >> row) & 1;
        const int of = axis[static_cast<std::size_t>(row)];
        held(row, of) = negative ? -1.0 : 1.0;
        words.push_back(fmt::format("{}{}", negative ? "-" : "", kNames[of]));
      }
      if (held.isIdentity()) continue;
      mistakes.push_back(mistakeOfPoses(fmt::format("x, y, z look to hold {} in the axes of the rotations", fmt::join(words, ", ")),
                                        [held](Eigen::Isometry3d T) {
                                          T.translation() = held.transpose() * T.translation();
                                          return T;
                                        }));
    }
  } while (std::next_permutation(axis.begin(), axis.end()));
}

}  // namespace

std::vector<Mistake> poseMistakes(const Problem& problem) {
  std::vector<Mistake> mistakes;
  const bool measured = problem.observations.front().pose.has_value();
  if (problem.cell.arm && !measured) return mistakes;
  constexpr std::pair<const char*, double> kUnits[] = {{"millimetres", 1e-3}, {"centimetres", 1e-2}, {"inches", 0.0254}};
  for (const auto& [unit, metres] : kUnits) {
    mistakes.push_back(mistakeOfPoses(fmt::format("x, y, z look like {}, expected metres", unit), [metres = metres](Eigen::Isometry3d T) {
      T.translation() *= metres;
      return T;
    }));
  }
  if (measured && problem.observations.front().pose->position_only) return mistakes;
  if (measured) {
    mistakes.push_back(mistakeOfPoses("the poses look inverted (instrument in tool), expected tool in instrument",
                                      [](const Eigen::Isometry3d& T) { return T.inverse(); }));
  }
  mistakes.push_back(
      mistakeOfPoses("qx, qy, qz, qw look like w, x, y, z: another order of the quaternion", ofRotation([](const Eigen::Matrix3d& R) {
                       const Eigen::Quaterniond q(R);
                       return Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
                     })));
  mistakes.push_back(mistakeOfPoses("the quaternions look conjugate (turned the other way)",
                                    ofRotation([](const Eigen::Matrix3d& R) { return Eigen::Matrix3d(R.transpose()); })));
  addThreeNumbers(mistakes);
  addAxes(mistakes);
  return mistakes;
}

std::vector<Mistake> inversions(const Problem& problem) {
  if (problem.cell.arm) return {};
  return {mistakeOfPoses("the poses look inverted (base in flange), expected flange in base",
                         [](const Eigen::Isometry3d& T) { return T.inverse(); })};
}

std::vector<Mistake> setupMistakes(const Problem& problem) {
  if (!problem.cell.camera) return {};
  const Setup stated = problem.cell.registration.setup;
  const Setup other = stated == Setup::kEyeToHand ? Setup::kEyeInHand : Setup::kEyeToHand;
  // Poses of the flange that are inverted and those of the other setup are one thing.
  return {{fmt::format("the capture looks like setup: {}, stated is {}{}", setupName(other), setupName(stated),
                       problem.cell.arm ? "" : "; or its poses are inverted (base in flange)"),
           InputPart::kManifest, [other](Problem& changed) {
             changed.cell.registration.setup = other;
             renewPoses(changed);
           }}};
}

}  // namespace poecal
