#include "poecal/registration/target_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/SVD>
#include <opencv2/calib3d.hpp>

#include "poecal/cell/adjustment.hpp"

namespace poecal {
namespace {

struct NormalisedCorners {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> rays;  ///< at z = 1
};

NormalisedCorners normalise(const Camera& camera, const Observation& observation) {
  NormalisedCorners corners;
  for (const CornerMeasurement& corner : observation.corners) {
    const std::optional<Eigen::Vector3d> ray = unproject(camera, corner.px);
    if (!ray || ray->z() < 0.05) continue;
    corners.points.emplace_back(corner.p_target.x(), corner.p_target.y(), corner.p_target.z());
    corners.rays.emplace_back(ray->x() / ray->z(), ray->y() / ray->z());
  }
  return corners;
}

/// Rank of the points' spread: 1 on a line, 2 in a plane, 3 in space.
int spreadRank(const Observation& observation) {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(observation.corners.size()));
  for (Eigen::Index k = 0; k < points.cols(); ++k) points.col(k) = observation.corners[static_cast<std::size_t>(k)].p_target;
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Vector3d spread = Eigen::JacobiSVD<Eigen::Matrix3Xd>(centred).singularValues();
  int rank = 0;
  for (int k = 0; k < 3; ++k) rank += spread(k) > 1e-6 * spread(0) && spread(0) > 0.0;
  return rank;
}

Eigen::Isometry3d toIsometry(const cv::Mat& rvec, const cv::Mat& tvec) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = expSo3({rvec.at<double>(0), rvec.at<double>(1), rvec.at<double>(2)});
  T.translation() << tvec.at<double>(0), tvec.at<double>(1), tvec.at<double>(2);
  return T;
}

}  // namespace

std::vector<TargetPose> targetPoses(const Camera& camera, const Observation& observation) {
  const int rank = observation.corners.size() < 4 ? 0 : spreadRank(observation);
  if (rank < 2) return {};
  const NormalisedCorners corners = normalise(camera, observation);
  if (corners.points.size() < 4) return {};
  std::vector<cv::Mat> rvecs, tvecs;
  const cv::Matx33d K = cv::Matx33d::eye();
  try {
    cv::solvePnPGeneric(corners.points, corners.rays, K, cv::noArray(), rvecs, tvecs, false,
                        rank == 2 ? cv::SOLVEPNP_IPPE : cv::SOLVEPNP_SQPNP);
  } catch (const cv::Exception&) {
    return {};  // OpenCV throws for corners that no pose explains, which is a normal outcome here
  }
  std::vector<TargetPose> candidates;
  for (std::size_t k = 0; k < rvecs.size(); ++k) {
    const Eigen::Isometry3d start = toIsometry(rvecs[k], tvecs[k]);
    if (!start.matrix().allFinite() || start.translation().z() <= 0.0) continue;
    const FreePose refined = refinePose(camera, observation, start);
    if (!std::isfinite(refined.rms_px)) continue;
    const bool known = std::any_of(candidates.begin(), candidates.end(), [&](const TargetPose& other) {
      return rotationAngle(other.T_camera_target.linear().transpose() * refined.T_camera_target.linear()) < 1e-3;
    });
    if (!known) candidates.push_back({refined.T_camera_target, refined.rms_px});
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const TargetPose& a, const TargetPose& b) { return a.rms_px < b.rms_px; });
  return candidates;
}

FreePose refinePose(const Camera& camera, const Observation& observation, const Eigen::Isometry3d& T_camera_target) {
  // A cell without an arm whose only unknown is the mount: T_camera_target = T_camera_near.
  Cell cell;
  cell.camera = camera;
  cell.registration.T_camera_near = T_camera_target;
  Observation alone = observation;
  alone.T_base_flange = Eigen::Isometry3d::Identity();
  AdjustmentOptions options;
  options.free.near = true;
  options.robust = false;
  options.scale = 1.0;
  options.max_iterations = 30;
  const Adjustment fit = adjust(cell, {alone}, options);
  FreePose pose;
  pose.T_camera_target = fit.cell.registration.T_camera_near;
  pose.chi_square = fit.chi_square;
  pose.covariance = fit.covariance;
  pose.corners = static_cast<int>(observation.corners.size());
  double sum = 0.0;
  for (const UnitResidual& unit : residuals(fit.cell, alone)) sum += unit.residual.squaredNorm();
  pose.rms_px = std::isnan(sum) ? std::numeric_limits<double>::infinity() : std::sqrt(sum / std::max(1, pose.corners));
  return pose;
}

}  // namespace poecal
