// What tags that never move tell of a camera that does.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "diagnosis/candidates.hpp"

namespace poecal {

/// The corners of `reference` in the pictures of a camera that stands beside the arm, linearised at a state of the model:
///
///   pixel = project(exp(mount) T_camera_reference p; intrinsics),     r = H mount + noise
///
/// with T_camera_reference, one for all pictures, fitted and taken out. Only what moves the camera enters. These rows stand beside those of
/// the target as further rows of the candidates that move the reference.
///
/// Their noise is that of the corners, or what pictures that follow each other differ by where that is more: what shakes the camera from
/// picture to picture is no drift.
class ReferenceSight {
 public:
  ReferenceSight() = default;
  /// Of the observations of `rows`. Without a camera beside the arm, or with fewer than four pictures that show the reference, it is
  /// empty().
  /// @param effects  those of the state that change what is seen of a reference: of the lens, and what moves the camera.
  ReferenceSight(const MeasuredCell& measured, const Cell& cell, const std::vector<AppliedEffect>& effects, const CaptureRows& rows);

  bool empty() const { return pictures_ == 0; }
  std::size_t pictures() const { return pictures_; }

  /// Motion of the mount by each column of a candidate, six rows for each observation of `rows`; without columns for candidates that do
  /// not move the reference.
  Eigen::MatrixXd motionsOf(const Candidate& candidate, const CaptureRows& rows) const;
  /// a' W b with the fitted place taken out. @param a, b  motions
  Eigen::MatrixXd information(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) const;
  /// a' W r.
  Eigen::VectorXd score(const Eigen::MatrixXd& a) const;
  /// Takes a motion out of the residual.
  void take(const Eigen::VectorXd& motion);
  /// r' W r of poses: what a camera that stands still leaves, in squares of its noise.
  double misfit() const;

 private:
  Eigen::VectorXd weighted(const Eigen::VectorXd& motion) const;

  std::size_t pictures_ = 0;
  std::vector<Matrix6d> weights_;  ///< H' H / sigma^2 of each observation; zero where it does not show the reference
  Eigen::VectorXd motions_;        ///< of the mount, by each picture alone
  Matrix6d total_inverse_ = Matrix6d::Zero();
};

}  // namespace poecal
