#include "compensation/commanded_arm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/SVD>
#include <fmt/format.h>

#include "poecal/cell/ports.hpp"
#include "poecal/core/error.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {
namespace {

constexpr double kLever = 0.1;          // [m]: a usual tool turns an error of the orientation into one of its tip
constexpr double kReachedError = 1e-9;  // [m], [rad]: far below any arm's repeatability, far above rounding
constexpr double kLargestStep = 0.5;    // [rad], [m]: further the arm is not nearly linear
constexpr int kLargestIterations = 300;

Vector6d errorTo(const Eigen::Isometry3d& wanted, const Eigen::Isometry3d& T) {
  Vector6d error;
  error << kLever * logSo3(wanted.linear() * T.linear().transpose()), wanted.translation() - T.translation();
  return error;
}

/// Derivative of -errorTo: the flange's origin moves with v + w x p.
Matrix6Xd errorJacobian(const CommandedArm::Reached& reached) {
  Matrix6Xd J = reached.J_flange_q;
  J.bottomRows<3>() -= hat(reached.T_base_flange.translation()) * reached.J_flange_q.topRows<3>();
  J.topRows<3>() *= kLever;
  return J;
}

Eigen::VectorXd dampedStep(const Matrix6Xd& J, const Vector6d& error) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& s = svd.singularValues();
  const double tiny = std::pow(1e-12 * std::max(s(0), 1e-6), 2);
  const double damping = 0.5 * error.squaredNorm() + tiny;
  const Eigen::VectorXd gains = (s.array() / (s.array().square() + damping)).matrix();
  return svd.matrixV() * gains.cwiseProduct(svd.matrixU().transpose() * error);
}

bool wouldLeave(const Joint& joint, double q, double step) {
  if (!joint.limits) return false;
  return (q <= joint.limits->lower && step < 0.0) || (q >= joint.limits->upper && step > 0.0);
}

/// The step of the joints that may move: one at its limit is held where it would leave it.
Eigen::VectorXd stepWithin(const Arm& arm, const Eigen::VectorXd& q, Matrix6Xd J, const Vector6d& error, bool limited) {
  for (;;) {
    Eigen::VectorXd step = dampedStep(J, error);
    bool held = false;
    for (Eigen::Index k = 0; limited && k < q.size(); ++k) {
      if (J.col(k).isZero(0.0) || !wouldLeave(arm.joints[static_cast<std::size_t>(k)], q(k), step(k))) continue;
      J.col(k).setZero();
      held = true;
    }
    if (!held) return step;
  }
}

double withinLimits(const Joint& joint, double q) { return joint.limits ? std::clamp(q, joint.limits->lower, joint.limits->upper) : q; }

Eigen::VectorXd withinLimits(const Arm& arm, Eigen::VectorXd q) {
  for (Eigen::Index k = 0; k < q.size(); ++k) q(k) = withinLimits(arm.joints[static_cast<std::size_t>(k)], q(k));
  return q;
}

}  // namespace

CommandedArm::CommandedArm(const RealArm& arm, const SampleTable& table) {
  cell_.arm = arm.arm;
  std::copy_if(arm.effects.begin(), arm.effects.end(), std::back_inserter(effects_),
               [](const AppliedEffect& applied) { return movesFlange(applied.effect); });
  context_ = makeCaptureContext(cell_, {}, arm.gravity, table.samples, table.other_columns);
  // It knows what each effect needs. Joints are always there: they are what is looked for.
  std::vector<Sample> samples = table.samples;
  for (Sample& sample : samples) sample.q = Eigen::VectorXd::Zero(arm.arm.jointCount());
  static_cast<void>(disturbancesOf(effects_, cell_, {}, arm.gravity, samples, false, table.other_columns));
}

CommandedArm::Reached CommandedArm::at(const Sample& sample, std::size_t number, const Eigen::VectorXd& q) const {
  Sample commanded = sample;
  commanded.q = q;
  Disturbance disturbance;
  if (!effects_.empty()) disturbance = disturbanceOf(effects_, makeSampleContext(context_, commanded, number, {}));
  const PosePortJacobian jacobian = posePortJacobian(cell_, commanded, disturbance);
  return {.T_base_flange = jacobian.T_camera_target, .J_flange_q = jacobian.joints};
}

JointCommand CommandedArm::solve(const Sample& sample, std::size_t number, const Eigen::VectorXd& start, bool limited) const {
  const Eigen::Isometry3d& wanted = *sample.T_base_flange;
  JointCommand best;
  best.start = start;
  best.q = start;
  double least = std::numeric_limits<double>::infinity();
  Eigen::VectorXd q = limited ? withinLimits(arm(), start) : start;
  for (int iteration = 0; iteration < kLargestIterations; ++iteration) {
    const Reached reached = at(sample, number, q);
    const Vector6d error = errorTo(wanted, reached.T_base_flange);
    if (error.norm() < least) {
      least = error.norm();
      best.q = q;
      best.T_base_flange = reached.T_base_flange;
    }
    Eigen::VectorXd step = stepWithin(arm(), q, errorJacobian(reached), error, limited);
    step *= std::min(1.0, kLargestStep / std::max(step.cwiseAbs().maxCoeff(), 1e-300));
    Eigen::VectorXd next = q + step;
    if (limited) next = withinLimits(arm(), next);
    // Below this the readings themselves are rounded.
    if ((next - q).cwiseAbs().maxCoeff() <= 1e-14) break;
    q = next;
  }
  best.position_error = (wanted.translation() - best.T_base_flange.translation()).norm();
  best.rotation_error = rotationAngle(wanted.linear() * best.T_base_flange.linear().transpose());
  return best;
}

bool isReached(const JointCommand& command) {
  return command.q.size() < 6 || (command.position_error <= kReachedError && command.rotation_error <= kReachedError);
}

}  // namespace poecal
