#include "withheld/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <Eigen/Dense>
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace withheld {
namespace {

constexpr int kSamples = 8;     // a pixel and direction
constexpr double kReach = 4.0;  // of the spot, in sigma

/// A tag's cells, one pixel each, from the top left of its white border; the border between the black square and it is the tag's edge.
cv::Mat cellsOf(int id) {
  const std::unique_ptr<apriltag_family_t, decltype(&tag36h11_destroy)> family(tag36h11_create(), &tag36h11_destroy);
  if (id < 0 || static_cast<std::uint32_t>(id) >= family->ncodes) throw std::invalid_argument("tag36h11 has no tag " + std::to_string(id));
  const std::unique_ptr<image_u8_t, decltype(&image_u8_destroy)> image(apriltag_to_image(family.get(), id), &image_u8_destroy);
  return cv::Mat(image->height, image->width, CV_8U, image->buf, static_cast<std::size_t>(image->stride)).clone();
}
constexpr double kAcross = 8.0, kBorder = 1.0;  // cells of the black square; of the white border around it

/// From a ray (x, y at z = 1 in camera) to the tag's cells: where the plane through its corners is met.
Eigen::Matrix3d cellsFromRays(const Cell& cell, const State& state) {
  const Frame T_camera_target = targetInCamera(cell, state);
  const double low = kBorder, high = kBorder + kAcross;
  const double at[4][2] = {{low, high}, {high, high}, {high, low}, {low, low}};  // rows of cells count down the tag, as y does
  Eigen::Matrix<double, 8, 8> A = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> b;
  for (int i = 0; i < 4; ++i) {
    const Vector p = T_camera_target * state.points[static_cast<std::size_t>(i)];
    const double x = p.x() / p.z(), y = p.y() / p.z();
    for (int k = 0; k < 2; ++k) {
      A.row(2 * i + k).segment<3>(3 * k) << x, y, 1.0;
      A.row(2 * i + k).tail<2>() << -at[i][k] * x, -at[i][k] * y;
      b[2 * i + k] = at[i][k];
    }
  }
  const Eigen::Matrix<double, 8, 1> h = A.fullPivLu().solve(b);
  Eigen::Matrix3d H;
  H << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0;
  return H;
}

/// Part of the picture that the tag, its border and their blur can reach.
cv::Rect patchOf(const Cell& cell, const Eigen::VectorXd& pixels, double blur) {
  double left = pixels[0], right = left, top = pixels[1], bottom = top;
  for (Eigen::Index i = 0; i < pixels.size(); i += 2) {
    left = std::min(left, pixels[i]);
    right = std::max(right, pixels[i]);
    top = std::min(top, pixels[i + 1]);
    bottom = std::max(bottom, pixels[i + 1]);
  }
  // Perspective makes the near side's cells larger than the mean: twice a cell is enough.
  const double more = 2.0 / kAcross * std::max(right - left, bottom - top) + kReach * blur + 2.0;
  const cv::Point first(static_cast<int>(left - more), static_cast<int>(top - more));
  const cv::Point last(static_cast<int>(right + more) + 1, static_cast<int>(bottom + more) + 1);
  return cv::Rect(first, last) & cv::Rect(0, 0, cell.lens.width, cell.lens.height);
}

/// Rays through the corners of a patch's pixels, in rows.
std::vector<Eigen::Vector2d> raysOf(const Lens& lens, const cv::Rect& patch) {
  std::vector<Eigen::Vector2d> rays;
  for (int row = 0; row <= patch.height; ++row) {
    for (int column = 0; column <= patch.width; ++column) rays.push_back(lens.ray({patch.x + column - 0.5, patch.y + row - 0.5}));
  }
  return rays;
}

cv::Mat drawBackground(const Lens& lens, std::uint64_t seed) {
  cv::RNG chance(seed);
  cv::Mat coarse(13, 16, CV_32F), picture;
  chance.fill(coarse, cv::RNG::UNIFORM, 60.0, 170.0);
  cv::resize(coarse, picture, cv::Size(lens.width, lens.height), 0.0, 0.0, cv::INTER_CUBIC);
  return picture;
}

/// Grey values of one row of pixels, kSamples rows of kSamples a pixel; `rays` starts at the row's upper left corner. Each sample is taken
/// somewhere in its part of the pixel: on a regular grid, an edge along it would be off by up to 1/16 px over its whole length.
void drawRow(const Eigen::Matrix3d& H, const Eigen::Vector2d* rays, const cv::Mat& cells, const Look& look, const float* behind,
             cv::RNG& chance, cv::Mat&& samples) {
  const int width = samples.cols / kSamples;
  for (int column = 0; column < width; ++column) {
    const Eigen::Vector2d &a = rays[column], &b = rays[column + 1], &c = rays[column + width + 1], &d = rays[column + width + 2];
    for (int i = 0; i < kSamples; ++i) {
      float* out = samples.ptr<float>(i) + column * kSamples;
      for (int j = 0; j < kSamples; ++j) {
        const double down = (i + chance.uniform(0.0, 1.0)) / kSamples, along = (j + chance.uniform(0.0, 1.0)) / kSamples;
        const Eigen::Vector2d left = a + down * (c - a), right = b + down * (d - b);  // the lens is linear within a pixel
        const Eigen::Vector2d ray = left + along * (right - left);
        const Eigen::Vector2d at = (H * ray.homogeneous()).hnormalized();
        const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
        const bool on_tag = x >= 0 && y >= 0 && x < cells.cols && y < cells.rows;
        out[j] = !on_tag ? behind[column] : static_cast<float>(cells.at<std::uint8_t>(y, x) > 0 ? look.bright : look.dark);
      }
    }
  }
}

/// The patch before blur and noise, kSamples x kSamples a pixel.
cv::Mat drawSamples(const Cell& cell, const Shot& shot, const State& state, const Look& look, const cv::Rect& patch,
                    const cv::Mat& background, cv::RNG& chance) {
  const cv::Mat cells = cellsOf(cell.tags.front().id);
  const std::vector<Eigen::Vector2d> rays = raysOf(state.lens, patch);
  cv::Mat samples(patch.height * kSamples, patch.width * kSamples, CV_32F);
  Eigen::Matrix3d H = cellsFromRays(cell, state);
  for (int row = 0; row < patch.height; ++row) {
    if (state.line_time != 0.0) H = cellsFromRays(cell, stateAtRow(shot, state, patch.y + row));
    drawRow(H, rays.data() + row * (patch.width + 1), cells, look, background.ptr<float>(patch.y + row) + patch.x, chance,
            samples.rowRange(row * kSamples, (row + 1) * kSamples));
  }
  return samples;
}

}  // namespace

void drawPicture(const Cell& cell, const Shot& shot, const std::vector<Flaw>& flaws, const Look& look, const std::filesystem::path& file) {
  const State state = stateAt(cell, shot, flaws);
  if (cell.tags.size() != 1 || state.outward != 0.0 || state.warp) throw std::invalid_argument("no picture of several tags or moved edges");
  cv::Mat picture = drawBackground(cell.lens, look.seed);
  const cv::Rect patch = patchOf(cell, corners(cell, shot, flaws), look.blur);
  std::uint64_t seed = look.seed;
  for (const char letter : shot.image) seed = seed * 131 + static_cast<unsigned char>(letter);
  cv::RNG chance(seed);
  cv::Mat samples = drawSamples(cell, shot, state, look, patch, picture, chance), drawn;
  cv::GaussianBlur(samples, samples, cv::Size(), look.blur * kSamples);
  cv::resize(samples, drawn, patch.size(), 0.0, 0.0, cv::INTER_AREA);
  drawn.copyTo(picture(patch));

  cv::Mat noise(picture.size(), CV_32F), grey;
  chance.fill(noise, cv::RNG::NORMAL, 0.0, look.noise);
  cv::Mat(picture + noise).convertTo(grey, CV_8U);
  if (!cv::imwrite(file.string(), grey, {cv::IMWRITE_PNG_COMPRESSION, 1})) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace withheld
