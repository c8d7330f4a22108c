// How a camera sees one printed face: where the rays through the corners of the pixels meet its plane.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>

#include "poecal/camera/camera.hpp"
#include "simulation/printed_face.hpp"

namespace poecal {

/// Meeting of a ray with the plane of a face: (x, y) in the face and distance along the ray from the camera [m]. NaN where they do not
/// meet.
using PlaneHit = Eigen::Vector3d;

/// Rays are unprojected at the corners of the pixels only; between them hits are interpolated bilinearly. Over one pixel the plane
/// coordinate bends by about 2 tan(tilt) / f of a pixel, so the interpolation is off by less than 5e-4 px at 60 degrees and f = 1000 px.
class FaceView {
 public:
  /// Nothing where the face shows its back or lies outside the picture.
  static std::optional<FaceView> of(const Camera& camera, const PrintedFace& face, const Eigen::Isometry3d& T_camera_target);

  const PrintedFace& face() const { return *face_; }
  /// The pixels that the face may cover.
  const cv::Rect& box() const { return box_; }
  /// Hit of the ray through a corner of a pixel of the box: column 0 is half a pixel to the left of box().x.
  const PlaneHit& corner(int column, int row) const { return corners_[static_cast<std::size_t>(row * (box_.width + 1) + column)]; }

 private:
  FaceView(const PrintedFace& face, const cv::Rect& box) : face_(&face), box_(box) {}

  const PrintedFace* face_;
  cv::Rect box_;
  std::vector<PlaneHit> corners_;  ///< (box.width + 1) x (box.height + 1), row by row
};

}  // namespace poecal
