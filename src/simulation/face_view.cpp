#include "simulation/face_view.hpp"

#include <cmath>
#include <limits>

namespace poecal {
namespace {

/// Smallest rectangle of pixels around the outline of a face; the whole picture where a part of the outline has no pixel.
cv::Rect pixelBounds(const Camera& camera, const Eigen::AlignedBox2d& bounds, const Eigen::Isometry3d& T_camera_face) {
  // Distortion bends the sides: points along them, and a margin for the bend between these.
  constexpr int kPointsOfSide = 16;
  constexpr double kMargin = 2.0;  // [px]
  const cv::Rect picture(0, 0, camera.width, camera.height);
  Eigen::AlignedBox2d pixels;
  for (int k = 0; k <= kPointsOfSide; ++k) {
    const Eigen::Vector2d along = bounds.min() + bounds.sizes() * (static_cast<double>(k) / kPointsOfSide);
    const Eigen::Vector2d outline[] = {
        {along.x(), bounds.min().y()}, {along.x(), bounds.max().y()}, {bounds.min().x(), along.y()}, {bounds.max().x(), along.y()}};
    for (const Eigen::Vector2d& p : outline) {
      const std::optional<Eigen::Vector2d> px = project(camera, T_camera_face * Eigen::Vector3d(p.x(), p.y(), 0.0));
      if (!px) return picture;
      pixels.extend(*px);
    }
  }
  // Far outside, pixels would not fit into an int.
  pixels = pixels.intersection({Eigen::Vector2d(-kMargin, -kMargin), Eigen::Vector2d(camera.width + kMargin, camera.height + kMargin)});
  if (pixels.isEmpty()) return {};
  const cv::Point lower(static_cast<int>(std::floor(pixels.min().x() - kMargin)), static_cast<int>(std::floor(pixels.min().y() - kMargin)));
  const cv::Point upper(static_cast<int>(std::ceil(pixels.max().x() + kMargin)), static_cast<int>(std::ceil(pixels.max().y() + kMargin)));
  return cv::Rect(lower, upper + cv::Point(1, 1)) & picture;
}

/// @param T_face_camera  its translation is the camera's centre in the face.
PlaneHit meetPlane(const Camera& camera, const Eigen::Vector2d& px, const Eigen::Isometry3d& T_face_camera) {
  const PlaneHit none = PlaneHit::Constant(std::numeric_limits<double>::quiet_NaN());
  const std::optional<Eigen::Vector3d> ray = unproject(camera, px);
  if (!ray) return none;
  const Eigen::Vector3d direction = T_face_camera.linear() * *ray;
  const double distance = -T_face_camera.translation().z() / direction.z();
  if (!(distance > 0.0) || !std::isfinite(distance)) return none;
  const Eigen::Vector3d p_face = T_face_camera.translation() + distance * direction;
  return {p_face.x(), p_face.y(), distance};
}

}  // namespace

std::optional<FaceView> FaceView::of(const Camera& camera, const PrintedFace& face, const Eigen::Isometry3d& T_camera_target) {
  const Eigen::Isometry3d T_camera_face = T_camera_target * face.T_target_face();
  const Eigen::Isometry3d T_face_camera = T_camera_face.inverse();
  if (T_face_camera.translation().z() >= 0.0) return std::nullopt;  // z goes into the face, so the camera is behind it
  const cv::Rect box = pixelBounds(camera, face.bounds(), T_camera_face);
  if (box.empty()) return std::nullopt;
  FaceView view(face, box);
  view.corners_.reserve(static_cast<std::size_t>(box.width + 1) * static_cast<std::size_t>(box.height + 1));
  for (int row = 0; row <= box.height; ++row) {
    for (int column = 0; column <= box.width; ++column) {
      view.corners_.push_back(meetPlane(camera, {box.x + column - 0.5, box.y + row - 0.5}, T_face_camera));
    }
  }
  return view;
}

}  // namespace poecal
