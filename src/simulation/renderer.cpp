#include "poecal/simulation/renderer.hpp"

#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "poecal/core/error.hpp"
#include "poecal/core/random.hpp"
#include "simulation/background.hpp"
#include "simulation/face_view.hpp"
#include "simulation/pattern.hpp"

namespace poecal {
namespace {

/// Grey level of a tile under even light: white paper is not 255 and black ink not 0, so that noise is not cut off.
double greyOf(Tile tile) {
  switch (tile) {
    case Tile::kInk:
      return 25.0;
    case Tile::kPaper:
      return 230.0;
    case Tile::kPlate:
      return 140.0;
    case Tile::kNone:
      break;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// Tiles of one plane lie this much over each other [m]: where the plates of two tags in a plane overlap, ink and paper win.
constexpr double kLayer = 1e-6;

/// The rays of one pixel towards the faces that may cover it.
class PixelRays {
 public:
  PixelRays(const std::vector<FaceView>& views, int u, int v) {
    for (const FaceView& view : views) {
      if (!view.box().contains(cv::Point(u, v))) continue;
      const int column = u - view.box().x, row = v - view.box().y;
      Bundle bundle{.face = &view.face(),
                    .corners = {view.corner(column, row), view.corner(column + 1, row), view.corner(column, row + 1),
                                view.corner(column + 1, row + 1)}};
      bool meets = true;
      for (const PlaneHit& hit : bundle.corners) meets = meets && !hit.hasNaN();
      if (meets) bundles_.push_back(bundle);
    }
  }

  bool empty() const { return bundles_.empty(); }

  /// All rays meet one and the same cell: cells are convex, so its four outermost rays tell.
  bool uniform() const {
    if (bundles_.size() != 1) return false;
    const Bundle& bundle = bundles_.front();
    const int cell = bundle.cellOf(bundle.corners[0]);
    return cell >= 0 && cell == bundle.cellOf(bundle.corners[1]) && cell == bundle.cellOf(bundle.corners[2]) &&
           cell == bundle.cellOf(bundle.corners[3]);
  }

  /// The tile that the ray at (x, y) of the pixel, both in [0, 1], meets first.
  Tile tileAt(double x, double y) const {
    Tile nearest = Tile::kNone;
    double nearest_distance = std::numeric_limits<double>::infinity();
    for (const Bundle& bundle : bundles_) {
      const PlaneHit hit =
          (1.0 - y) * ((1.0 - x) * bundle.corners[0] + x * bundle.corners[1]) + y * ((1.0 - x) * bundle.corners[2] + x * bundle.corners[3]);
      const Tile tile = bundle.face->tile(bundle.cellOf(hit));
      const double distance = hit.z() - kLayer * static_cast<double>(tile);
      if (tile != Tile::kNone && distance < nearest_distance) {
        nearest = tile;
        nearest_distance = distance;
      }
    }
    return nearest;
  }

 private:
  struct Bundle {
    const PrintedFace* face;
    PlaneHit corners[4];  ///< top left, top right, bottom left, bottom right
    int cellOf(const PlaneHit& hit) const { return face->cellAt(hit.x(), hit.y()); }
  };
  std::vector<Bundle> bundles_;
};

/// Mean grey level over a pixel.
///
/// The n x n rays are sheared against the pixel's sides, so that no two share a row or a column: an edge along a side is then placed to
/// 1/n^2 px instead of 1/n.
double meanGrey(const PixelRays& rays, double background, int n) {
  const auto grey = [&](double x, double y) {
    const Tile tile = rays.tileAt(x, y);
    return tile == Tile::kNone ? background : greyOf(tile);
  };
  if (rays.uniform()) return grey(0.5, 0.5);
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) sum += grey((i + (j + 0.5) / n) / n, (j + (i + 0.5) / n) / n);
  }
  return sum / (n * n);
}

void drawFaces(cv::Mat& picture, const std::vector<FaceView>& views, int supersample) {
  cv::Rect covered;
  for (const FaceView& view : views) covered |= view.box();
  for (int v = covered.y; v < covered.y + covered.height; ++v) {
    for (int u = covered.x; u < covered.x + covered.width; ++u) {
      const PixelRays rays(views, u, v);
      float& grey = picture.at<float>(v, u);
      if (!rays.empty()) grey = static_cast<float>(meanGrey(rays, grey, supersample));
    }
  }
}

void addNoise(cv::Mat& picture, double sigma, Rng& rng) {
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) picture.at<float>(v, u) += static_cast<float>(sigma * rng.normal());
  }
}

}  // namespace

cv::Mat renderTarget(const Camera& camera, const Target& target, const Eigen::Isometry3d& T_camera_target, const ImageOptions& options,
                     std::uint64_t seed, std::uint64_t stream, int supersample) {
  options.validate();
  if (supersample < 1) throw InvalidArgument("supersample is " + std::to_string(supersample) + ", expected 1 or more");
  Rng rng(seed, stream);
  cv::Mat picture = drawBackground(options.background, camera.width, camera.height, rng);
  const std::vector<PrintedFace> faces = printedFaces(target);
  std::vector<FaceView> views;
  for (const PrintedFace& face : faces) {
    if (std::optional<FaceView> view = FaceView::of(camera, face, T_camera_target)) views.push_back(std::move(*view));
  }
  drawFaces(picture, views, supersample);
  if (options.blur > 0.0) cv::GaussianBlur(picture, picture, cv::Size(), options.blur);
  if (options.noise > 0.0) addNoise(picture, options.noise, rng);
  cv::Mat rounded;
  picture.convertTo(rounded, CV_8U);
  return rounded;
}

}  // namespace poecal
