// The pose that a command reaches, its derivative, and the joints that reach a pose.
#pragma once

#include <memory>

#include "poecal/cell/cell.hpp"
#include "poecal/compensation/compensate.hpp"

namespace poecal {

/// The real arm with what the effects need to know of all rows.
class CommandedArm {
 public:
  /// @throws InsufficientData: an effect follows a column that some sample does not have.
  CommandedArm(const RealArm& arm, const SampleTable& table);

  struct Reached {
    Eigen::Isometry3d T_base_flange = Eigen::Isometry3d::Identity();
    Matrix6Xd J_flange_q;  ///< left derivative in base, the effects held
  };
  /// @param sample  its columns; q takes the place of its joints. @param number  of the row.
  Reached at(const Sample& sample, std::size_t number, const Eigen::VectorXd& q) const;

  /// Joints that reach a pose from `start`, within the limits or not. @returns the nearest that was found; its errors say whether it is
  /// near enough.
  JointCommand solve(const Sample& sample, std::size_t number, const Eigen::VectorXd& start, bool limited) const;

  const Arm& arm() const { return *cell_.arm; }

 private:
  Cell cell_;  ///< the arm alone: camera is base, target is flange
  std::vector<AppliedEffect> effects_;
  std::shared_ptr<const CaptureContext> context_;
};

/// To 1e-9 m and rad; always where the arm has fewer than six joints.
bool isReached(const JointCommand& command);

}  // namespace poecal
