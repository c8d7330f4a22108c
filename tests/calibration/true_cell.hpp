// A cell whose truth is known, and pictures of it.
#pragma once

#include <algorithm>
#include <vector>

#include "poecal/calibration/calibrate.hpp"
#include "poecal/core/statistics.hpp"
#include "support/cameras.hpp"
#include "support/random.hpp"

namespace poecal::test {

inline constexpr double kSigma = 0.1;  // [px]
inline constexpr int kPoses = 60, kUnseen = 40;

/// Columns: the camera's x, y and z in base, for a camera that looks along `z` with base's z up in the picture.
inline Eigen::Matrix3d lookingAlong(const Eigen::Vector3d& z) {
  Eigen::Matrix3d R;
  R.col(2) = z.normalized();
  R.col(0) = R.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

inline Eigen::Isometry3d pose(const Eigen::Matrix3d& R, const Eigen::Vector3d& p) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = p;
  return T;
}

/// Five joints; the third turns, or slides along the arm.
inline Arm fiveJoints(bool slides) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  Arm arm;
  arm.name = "test";
  arm.joints = {Joint::revolute("turn", z, {0.0, 0.0, 0.0}), Joint::revolute("shoulder", y, {0.05, 0.0, 0.4}),
                slides ? Joint::prismatic("slide", x, {0.3, 0.0, 0.6}) : Joint::revolute("elbow", y, {0.05, 0.0, 0.8}),
                Joint::revolute("roll", x, {0.4, 0.0, 0.8}), Joint::revolute("nod", y, {0.5, 0.0, 0.8})};
  arm.gamma << 0.0, 0.0, 0.0, 0.6, 0.0, 0.8;
  return arm;
}

/// A true cell, and poses in it.
struct TrueCell {
  Cell cell;
  Arm nominal;
  Target target = apriltagTarget("tag36h11", {{.id = 1, .size = 0.1}});
  std::vector<Eigen::VectorXd> q;

  TrueCell(std::uint64_t seed, Setup setup, bool slides) : nominal(fiveJoints(slides)), rng(seed) {
    Eigen::VectorXd beta(twistParameterCount(nominal));
    for (Eigen::Index k = 0; k < beta.size(); ++k) beta(k) = (k % 2 == 0 ? 1.5e-3 : 6e-4) * rng.normal();
    cell.arm = displaceTwists(nominal, beta);
    cell.camera = plumbBob(2448, 2048, {2400.0, 2400.0}, {1224.0, 1024.0});
    const Eigen::Matrix3d R = setup == Setup::kEyeToHand ? lookingAlong(-Eigen::Vector3d::UnitX()) : lookingAlong(Eigen::Vector3d::UnitX());
    cell.registration.setup = setup;
    if (setup == Setup::kEyeToHand) {
      cell.registration.T_camera_near = pose(R, {1.9, 0.0, 0.8}).inverse();
      cell.registration.T_far_target = pose(R, {0.03, 0.01, -0.02});
    } else {
      cell.registration.T_camera_near = pose(R, {0.04, -0.02, 0.06}).inverse();
      cell.registration.T_far_target = pose(R, {1.7, 0.05, 0.8});
    }
  }

  /// Draws poses in which the camera sees the whole target from its front, within the middle of the picture.
  void drawPoses(int count) {
    while (static_cast<int>(q.size()) < count) {
      Eigen::VectorXd reading(nominal.jointCount());
      for (double& angle : reading) angle = rng.uniform(-0.6, 0.6);
      for (Eigen::Index k = 0; k < reading.size(); ++k) {
        if (nominal.joints[static_cast<std::size_t>(k)].type == JointType::kPrismatic) reading(k) *= 0.25;
      }
      const Eigen::Isometry3d T = cell.registration.cameraTarget(forwardKinematics(*cell.arm, reading));
      const auto seen = [&](const TargetPoint& point) {
        const auto px = project(*cell.camera, T * point.p_target);
        return px && px->x() > 20.0 && px->x() < cell.camera->width - 20.0 && px->y() > 20.0 && px->y() < cell.camera->height - 20.0;
      };
      if (T.linear()(2, 2) > 0.7 && std::all_of(target.points.begin(), target.points.end(), seen)) q.push_back(reading);
    }
  }

  Measurements pictures() {
    drawPoses(kPoses + kUnseen);
    Measurements measurements;
    measurements.setup = cell.registration.setup;
    measurements.target = target;
    for (int k = 0; k < kPoses; ++k) {
      Sample sample;
      sample.q = q[static_cast<std::size_t>(k)];
      std::vector<Corner> corners = predictCorners(cell, target, forwardKinematics(*cell.arm, sample.q));
      for (Corner& corner : corners) {
        corner.px += kSigma * normalVector(rng, 2);
        corner.sigma = kSigma;
      }
      measurements.addPicture(sample, corners);
    }
    return measurements;
  }

  /// Root mean square by which a model misses the corners of poses that it did not see [px].
  double unseen(const Cell& model) const {
    std::vector<double> lengths;
    for (std::size_t k = kPoses; k < q.size(); ++k) {
      const std::vector<Corner> right = predictCorners(cell, target, forwardKinematics(*cell.arm, q[k]));
      const std::vector<Corner> told = predictCorners(model, target, forwardKinematics(*model.arm, q[k]));
      for (std::size_t j = 0; j < right.size(); ++j) lengths.push_back((right[j].px - told[j].px).norm());
    }
    return rms(lengths);
  }

  Cell stated() const { return {.arm = nominal, .camera = cell.camera, .registration = {}}; }

  Rng rng;
};

}  // namespace poecal::test
