#include "poecal/simulation/renderer.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include <opencv2/core.hpp>

#include "poecal/core/random.hpp"
#include "simulation/background.hpp"
#include "simulation/face_view.hpp"
#include "simulation/pattern.hpp"
#include "simulation/pixel_kernel.hpp"

namespace poecal {
namespace {

/// Grey level of a tile under even light: white paper is not 255 and black ink not 0, so that noise is not cut off.
double greyOf(Tile tile, double background) {
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
  return background;
}

/// Tiles of one plane lie this much over each other [m]: where the plates of two tags in a plane overlap, ink and paper win.
constexpr double kLayer = 1e-6;
constexpr double kThickest = kLayer * static_cast<double>(Tile::kInk);

/// A pixel is drawn in kParts x kParts squares before it gathers what the lens makes of them.
constexpr int kParts = 4;
constexpr double kPart = 1.0 / kParts;
/// Where faces overlap and neither hides the other wholly, a square is sampled by kRays x kRays rays.
constexpr int kRays = 8;

/// What one pixel sees: the faces that it may meet, each as the quadrilateral that the pixel covers of its plane.
class PixelSight {
 public:
  PixelSight(const std::vector<FaceView>& views, int u, int v) {
    for (const FaceView& view : views) {
      if (!view.box().contains(cv::Point(u, v))) continue;
      const int column = u - view.box().x, row = v - view.box().y;
      const Bundle bundle{.face = &view.face(),
                          .corners = {view.corner(column, row), view.corner(column + 1, row), view.corner(column, row + 1),
                                      view.corner(column + 1, row + 1)}};
      if (bundle.meets()) bundles_.push_back(bundle);
    }
  }

  /// One grey all over, so that the pixel need not be divided.
  std::optional<double> uniformGrey(double background) const {
    if (bundles_.empty()) return background;
    for (const Bundle& bundle : bundles_) {
      if (!bundle.uniform()) return std::nullopt;
    }
    // Where planes cross within a pixel, its middle is good enough for a line that no corner depends on.
    return rayGrey(0.5, 0.5, background);
  }

  /// Mean grey of the square of width kPart whose top left corner is (x, y), both in [0, 1).
  double partGrey(double x, double y, double background) const {
    double sum = 0.0;
    if (const Bundle* bundle = bundles_.size() == 1 ? &bundles_.front() : nearest(x, y)) {
      const TileShares shares = bundle->shares(x, y);
      for (std::size_t k = 0; k < shares.size(); ++k) sum += shares[k] * greyOf(static_cast<Tile>(k), background);
      return sum;
    }
    // Sheared against the square's sides, so that no two rays share a row or a column: an edge along a side is then placed to 1/kRays^2 of
    // the square instead of 1/kRays.
    for (int i = 0; i < kRays; ++i) {
      for (int j = 0; j < kRays; ++j) {
        sum += rayGrey(x + kPart * (i + (j + 0.5) / kRays) / kRays, y + kPart * (j + (i + 0.5) / kRays) / kRays, background);
      }
    }
    return sum / (kRays * kRays);
  }

 private:
  /// The pixel's rays to one face.
  struct Bundle {
    const PrintedFace* face;
    PlaneHit corners[4];  ///< top left, top right, bottom left, bottom right

    /// Where the ray at (x, y) of the pixel, both in [0, 1], meets the face.
    PlaneHit hitAt(double x, double y) const {
      return (1.0 - y) * ((1.0 - x) * corners[0] + x * corners[1]) + y * ((1.0 - x) * corners[2] + x * corners[3]);
    }
    int cellOf(const PlaneHit& hit) const { return face->cellAt(hit.x(), hit.y()); }
    /// What the square at (x, y) of the pixel covers.
    TileShares shares(double x, double y) const {
      Eigen::Matrix<double, 2, 4> around;
      around << hitAt(x, y).head<2>(), hitAt(x + kPart, y).head<2>(), hitAt(x + kPart, y + kPart).head<2>(), hitAt(x, y + kPart).head<2>();
      return face->shares(around);
    }
    /// Whether any ray may meet what is painted.
    bool meets() const {
      Eigen::AlignedBox2d box;
      for (const PlaneHit& hit : corners) {
        if (hit.hasNaN()) return false;
        box.extend(Eigen::Vector2d(hit.head<2>()));
      }
      return box.intersects(face->bounds());
    }
    /// All rays meet one and the same cell: cells are convex, so its four outermost rays tell.
    bool uniform() const {
      const int cell = cellOf(corners[0]);
      return cell >= 0 && cell == cellOf(corners[1]) && cell == cellOf(corners[2]) && cell == cellOf(corners[3]);
    }
  };

  /// The face that lies before all others all over the square at (x, y) and leaves no gap there, if there is one.
  const Bundle* nearest(double x, double y) const {
    const auto before = [&](const Bundle& a, const Bundle& b) {
      for (const double dx : {0.0, kPart}) {
        for (const double dy : {0.0, kPart}) {
          if (!(a.hitAt(x + dx, y + dy).z() < b.hitAt(x + dx, y + dy).z() - kThickest)) return false;
        }
      }
      return true;
    };
    for (const Bundle& bundle : bundles_) {
      const bool first = std::all_of(bundles_.begin(), bundles_.end(), [&](const Bundle& b) { return &b == &bundle || before(bundle, b); });
      if (first) return bundle.shares(x, y)[static_cast<std::size_t>(Tile::kNone)] == 0.0 ? &bundle : nullptr;
    }
    return nullptr;
  }

  /// The grey of what the ray at (x, y) of the pixel meets first.
  double rayGrey(double x, double y, double background) const {
    Tile nearest = Tile::kNone;
    double nearest_distance = std::numeric_limits<double>::infinity();
    for (const Bundle& bundle : bundles_) {
      const PlaneHit hit = bundle.hitAt(x, y);
      const Tile tile = bundle.face->tile(bundle.cellOf(hit));
      const double distance = hit.z() - kLayer * static_cast<double>(tile);
      if (tile != Tile::kNone && distance < nearest_distance) {
        nearest = tile;
        nearest_distance = distance;
      }
    }
    return greyOf(nearest, background);
  }

  std::vector<Bundle> bundles_;
};

/// Row v of the pixels from `left` on, as kParts rows of parts; beyond the picture's border the pixels at it are repeated.
void drawParts(cv::Mat& parts, const std::vector<FaceView>& views, const cv::Mat& background, int left, int v) {
  const int row = std::clamp(v, 0, background.rows - 1);
  for (int column = 0; column < parts.cols / kParts; ++column) {
    const int u = std::clamp(left + column, 0, background.cols - 1);
    const double behind = static_cast<double>(background.at<float>(row, u));
    const PixelSight sight(views, u, row);
    const std::optional<double> uniform = sight.uniformGrey(behind);
    for (int y = 0; y < kParts; ++y) {
      float* part = parts.ptr<float>(y) + column * kParts;
      for (int x = 0; x < kParts; ++x) {
        part[x] = static_cast<float>(uniform ? *uniform : sight.partGrey(kPart * x, kPart * y, behind));
      }
    }
  }
}

/// The picture that the lens throws on the sensor, gathered by its pixels.
cv::Mat drawPicture(const std::vector<FaceView>& views, const cv::Mat& background, double blur) {
  const PixelKernel kernel(blur, kParts);
  cv::Mat picture = kernel.gather(background);
  cv::Rect covered;
  for (const FaceView& view : views) covered |= view.box();
  if (covered.empty()) return picture;
  const int reach = kernel.reach();
  const cv::Rect changed = cv::Rect(covered.x - reach, covered.y - reach, covered.width + 2 * reach, covered.height + 2 * reach) &
                           cv::Rect(0, 0, picture.cols, picture.rows);
  cv::Mat parts(kParts, kParts * (changed.width + 2 * reach), CV_32F);
  cv::Mat rows(kParts * (changed.height + 2 * reach), changed.width, CV_32F);
  for (int k = 0; k < changed.height + 2 * reach; ++k) {
    drawParts(parts, views, background, changed.x - reach, changed.y - reach + k);
    kernel.gatherRows(parts).copyTo(rows.rowRange(kParts * k, kParts * (k + 1)));
  }
  kernel.gatherColumns(rows).copyTo(picture(changed));
  return picture;
}

void addNoise(cv::Mat& picture, double sigma, Rng& rng) {
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) picture.at<float>(v, u) += static_cast<float>(sigma * rng.normal());
  }
}

}  // namespace

cv::Mat renderTarget(const Camera& camera, const Target& target, const Eigen::Isometry3d& T_camera_target, const ImageOptions& options,
                     std::uint64_t seed, std::uint64_t stream) {
  options.validate();
  Rng rng(seed, stream);
  const cv::Mat background = drawBackground(options.background, camera.width, camera.height, rng);
  const std::vector<PrintedFace> faces = printedFaces(target);
  std::vector<FaceView> views;
  for (const PrintedFace& face : faces) {
    if (std::optional<FaceView> view = FaceView::of(camera, face, T_camera_target)) views.push_back(std::move(*view));
  }
  cv::Mat picture = drawPicture(views, background, options.blur);
  if (options.noise > 0.0) addNoise(picture, options.noise, rng);
  cv::Mat rounded;
  picture.convertTo(rounded, CV_8U);
  return rounded;
}

}  // namespace poecal
