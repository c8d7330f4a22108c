#include "poecal/registration/hand_eye.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

// Beyond 170 degrees noise may turn a rotation vector round; below half a degree it is all noise.
constexpr double kLargestTurn = 2.97;
constexpr double kSmallestTurn = 0.01;
// Direction cosines of a second axis below this are those of one axis: a SCARA's nominal axes are parallel to rounding.
constexpr double kOneDirection = 0.01;

struct Turns {
  std::vector<Eigen::Vector3d> near;    ///< rotation vectors of the arm's relative motions, in near
  std::vector<Eigen::Vector3d> camera;  ///< of the target's, in camera
};

// Strides over which motions are compared, in a long series of poses.
constexpr double kStrides = 9.0;

/// Relative motions i <- j for a few strides from neighbours up to the whole series, so that their number grows with the poses and not with
/// their square.
Turns relativeTurns(const std::vector<Eigen::Isometry3d>& T_near_far, const std::vector<Eigen::Isometry3d>* T_camera_target) {
  Turns turns;
  const std::size_t count = T_near_far.size();
  const double factor = std::max(2.0, std::pow(static_cast<double>(count), 1.0 / kStrides));
  const auto next = [&](std::size_t stride) {
    return 1 + (count <= 12 ? stride : static_cast<std::size_t>(factor * static_cast<double>(stride)));
  };
  for (std::size_t stride = 1; stride < count; stride = next(stride)) {
    for (std::size_t j = 0; j + stride < count; ++j) {
      const std::size_t i = j + stride;
      const Eigen::Vector3d a = logSo3(T_near_far[i].linear() * T_near_far[j].linear().transpose());
      if (a.norm() > kLargestTurn || a.norm() < kSmallestTurn) continue;
      turns.near.push_back(a);
      if (T_camera_target != nullptr) {
        turns.camera.push_back(logSo3((*T_camera_target)[i].linear() * (*T_camera_target)[j].linear().transpose()));
      }
    }
  }
  return turns;
}

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> scatterOf(const std::vector<Eigen::Vector3d>& vectors) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& a : vectors) scatter += a * a.transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter);
}

bool isOneDirection(const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>& scatter) {
  return scatter.eigenvalues()(1) < kOneDirection * kOneDirection * scatter.eigenvalues()(2);
}

/// With R_camera_near known up to a turn alpha about `axis` (in camera):
///   t_camera_target = R_camera_target s + Rot(axis, alpha) R t_near_far + t_camera_near,   linear in s, t_camera_near, cos alpha, sin
///   alpha.
double turnAboutAxis(const Eigen::Vector3d& axis, const Eigen::Matrix3d& R_camera_near, const std::vector<Eigen::Isometry3d>& T_near_far,
                     const std::vector<Eigen::Isometry3d>& T_camera_target) {
  const auto count = static_cast<Eigen::Index>(T_near_far.size());
  Eigen::MatrixXd A(3 * count, 8);
  Eigen::VectorXd b(3 * count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Eigen::Vector3d u = R_camera_near * T_near_far[i].translation();
    const Eigen::Vector3d along = axis * axis.dot(u);
    A.block<3, 3>(3 * k, 0) = T_camera_target[i].linear();
    A.block<3, 3>(3 * k, 3).setIdentity();
    A.block<3, 1>(3 * k, 6) = u - along;
    A.block<3, 1>(3 * k, 7) = axis.cross(u);
    b.segment<3>(3 * k) = T_camera_target[i].translation() - along;
  }
  const Eigen::VectorXd x = A.completeOrthogonalDecomposition().solve(b);
  return std::atan2(x(7), x(6));
}

}  // namespace

int rotationDirections(const std::vector<Eigen::Isometry3d>& T_near_far) {
  const Turns turns = relativeTurns(T_near_far, nullptr);
  if (turns.near.empty()) return 0;
  return isOneDirection(scatterOf(turns.near)) ? 1 : 2;
}

std::optional<Eigen::Vector3d> onlyAxis(const std::vector<Eigen::Isometry3d>& T_near_far) {
  const Turns turns = relativeTurns(T_near_far, nullptr);
  if (turns.near.empty()) return std::nullopt;
  const auto scatter = scatterOf(turns.near);
  if (!isOneDirection(scatter)) return std::nullopt;
  Eigen::Vector3d axis = scatter.eigenvectors().col(2);
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis(largest) < 0.0 ? Eigen::Vector3d(-axis) : axis;
}

std::optional<HandEye> solveHandEye(const std::vector<Eigen::Isometry3d>& T_near_far, const std::vector<Eigen::Isometry3d>& T_camera_target,
                                    Setup setup) {
  const Turns turns = relativeTurns(T_near_far, &T_camera_target);
  if (turns.near.empty()) return std::nullopt;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < turns.near.size(); ++k) covariance += turns.camera[k] * turns.near[k].transpose();
  Eigen::Matrix3d R_camera_near = nearestRotation(covariance);
  const auto scatter = scatterOf(turns.near);
  if (isOneDirection(scatter)) {
    const Eigen::Vector3d axis = R_camera_near * scatter.eigenvectors().col(2);
    R_camera_near = expSo3(turnAboutAxis(axis, R_camera_near, T_near_far, T_camera_target) * axis) * R_camera_near;
  }

  std::vector<Eigen::Matrix3d> rotations;
  const auto count = static_cast<Eigen::Index>(T_near_far.size());
  Eigen::MatrixXd A(3 * count, 6);
  Eigen::VectorXd b(3 * count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    rotations.push_back(T_near_far[i].linear().transpose() * R_camera_near.transpose() * T_camera_target[i].linear());
    A.block<3, 3>(3 * k, 0).setIdentity();
    A.block<3, 3>(3 * k, 3) = R_camera_near * T_near_far[i].linear();
    b.segment<3>(3 * k) = T_camera_target[i].translation() - R_camera_near * T_near_far[i].translation();
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  // Sliding along the axis of a SCARA is only determined by noise.
  solver.setThreshold(1e-6);
  // The shortest solution is sought in units in which a metre on the flange is far longer than one beside the arm.
  constexpr double kOnFlange = 0.01;
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(6);
  (setup == Setup::kEyeToHand ? unit.tail<3>() : unit.head<3>()).setConstant(kOnFlange);
  solver.compute(A * unit.asDiagonal());
  const Eigen::VectorXd t = unit.cwiseProduct(solver.solve(b));
  HandEye result;
  result.T_camera_near.linear() = R_camera_near;
  result.T_camera_near.translation() = t.head<3>();
  result.T_far_target.linear() = meanRotation(rotations);
  result.T_far_target.translation() = t.tail<3>();
  return result;
}

}  // namespace poecal
