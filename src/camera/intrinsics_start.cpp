#include "camera/intrinsics_start.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/SVD>
#include <opencv2/calib3d.hpp>

#include "poecal/core/statistics.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

/// Extents of a board along its own principal directions, the largest first [m].
Eigen::Vector3d extents(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d scatter = centred * centred.transpose();
  return scatter.jacobiSvd().singularValues().cwiseSqrt();
}

/// Poses that solvePnP proposes, from the pixels whose rays are less than about 87 degrees from the axis.
std::vector<Eigen::Isometry3d> proposePoses(const Camera& camera, const BoardView& view) {
  constexpr double kLeastCosine = 0.05;
  constexpr std::size_t kLeastPoints = 4;
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> normalised;
  for (Eigen::Index i = 0; i < view.points.cols(); ++i) {
    const std::optional<Eigen::Vector3d> ray = unproject(camera, view.pixels.col(i));
    if (!ray || ray->z() < kLeastCosine) continue;
    points.emplace_back(view.points(0, i), view.points(1, i), view.points(2, i));
    normalised.emplace_back(ray->x() / ray->z(), ray->y() / ray->z());
  }
  if (points.size() < kLeastPoints) return {};
  std::vector<cv::Mat> rotations, translations;
  try {
    cv::solvePnPGeneric(points, normalised, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                        flat(view.points) ? cv::SOLVEPNP_IPPE : cv::SOLVEPNP_SQPNP);
  } catch (const cv::Exception&) {
    return {};  // OpenCV's way to say that the points left are degenerate
  }
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t k = 0; k < rotations.size(); ++k) {
    const cv::Vec3d w(rotations[k]), t(translations[k]);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = expSo3({w[0], w[1], w[2]});
    T.translation() << t[0], t[1], t[2];
    if (T.matrix().allFinite()) poses.push_back(T);
  }
  return poses;
}

double rmsOf(const Eigen::Matrix2Xd& residuals) { return std::sqrt(residuals.squaredNorm() / static_cast<double>(residuals.cols())); }

/// Reprojection error of the better proposal, not refined: enough to rank focal lengths. Without a pose the picture counts as wrong by
/// its whole width.
double proposedRms(const Camera& camera, const BoardView& view) {
  double least = camera.width;
  for (const Eigen::Isometry3d& proposed : proposePoses(camera, view)) {
    const auto residuals = boardResiduals(camera, proposed, view);
    if (residuals) least = std::min(least, rmsOf(*residuals));
  }
  return least;
}

Camera undistortedCamera(int width, int height, DistortionModel model, double focal_length) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.model = model;
  camera.fx = camera.fy = focal_length;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  camera.distortion = Eigen::VectorXd::Zero(distortionCount(model));
  return camera;
}

/// At most `count` of the views, evenly spread.
std::vector<const BoardView*> someOf(const std::vector<const BoardView*>& views, std::size_t count) {
  if (views.size() <= count) return views;
  std::vector<const BoardView*> some;
  for (std::size_t k = 0; k < count; ++k) some.push_back(views[k * views.size() / count]);
  return some;
}

}  // namespace

bool usable(const BoardView& view) {
  if (view.points.cols() < 4) return false;
  const Eigen::Vector3d size = extents(view.points);
  return size.y() > 1e-3 * size.x();
}

bool flat(const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d size = extents(points);
  return size.z() < 1e-3 * size.x();
}

std::optional<Eigen::Isometry3d> boardPose(const Camera& camera, const BoardView& view) {
  constexpr int kMaxIterations = 30;
  std::optional<BoardBundleFit> best;
  for (const Eigen::Isometry3d& proposed : proposePoses(camera, view)) {
    auto refined = fitBoardBundle({&view}, {camera, {proposed}}, {}, kMaxIterations);
    if (refined && (!best || refined->squared_error < best->squared_error)) best = std::move(refined);
  }
  if (!best) return std::nullopt;
  return best->estimate.T_camera_target[0];
}

Camera startCamera(const std::vector<const BoardView*>& views, int width, int height, DistortionModel model) {
  constexpr double kShortest = 0.2, kLongest = 8.0, kRatio = 1.4;  // of the picture's width; the fit converges from further off than 1.4
  constexpr std::size_t kViewsOfTheScan = 12;
  const std::vector<const BoardView*> scanned = someOf(views, kViewsOfTheScan);
  Camera best;
  double least = std::numeric_limits<double>::infinity();
  for (double ratio = kShortest; ratio < kLongest; ratio *= kRatio) {
    const Camera camera = undistortedCamera(width, height, model, ratio * width);
    std::vector<double> errors;
    for (const BoardView* view : scanned) errors.push_back(proposedRms(camera, *view));
    const double error = median(errors);
    if (error < least) {
      least = error;
      best = camera;
    }
  }
  return best;
}

}  // namespace poecal
