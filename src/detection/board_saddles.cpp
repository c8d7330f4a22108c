#include "detection/board_saddles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>

#include "detection/saddle_fit.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

constexpr int kTerms = 10;
constexpr double kWild = 0.5;                           // [px]; more than a lens makes of neighbours, less than a fit comes back from
constexpr double kWindowNoise = 0.1, kFitNoise = 0.02;  // [px]; of corners given, and of those fitted once
using Terms = Eigen::Matrix<double, kTerms, 1>;

Eigen::Vector2d squaresOf(const BoardSaddle& saddle) { return {static_cast<double>(saddle.col), static_cast<double>(saddle.row)}; }

/// A plane seen through a pinhole, to second order about a point of it.
SaddleView viewOf(const Eigen::Matrix3d& H, const Eigen::Vector2d& squares) {
  SaddleView view;
  const Eigen::Vector3d h = H * squares.homogeneous();
  view.px = h.hnormalized();
  view.J_px_squares = (H.topLeftCorner<2, 2>() - view.px * H.row(2).head<2>()) / h.z();
  const double by_u = H(2, 0) / h.z(), by_v = H(2, 1) / h.z();
  view.uu = -by_u * view.J_px_squares.col(0);
  view.vv = -by_v * view.J_px_squares.col(1);
  view.uv = -by_v * view.J_px_squares.col(0) - by_u * view.J_px_squares.col(1);
  return view;
}

std::optional<Eigen::Matrix3d> homographyOf(const std::vector<BoardSaddle>& saddles) {
  if (saddles.size() < 4) return std::nullopt;
  std::vector<cv::Point2d> board, picture;
  for (const BoardSaddle& saddle : saddles) {
    board.emplace_back(saddle.col, saddle.row);
    picture.emplace_back(saddle.px.x(), saddle.px.y());
  }
  const cv::Mat H = cv::findHomography(board, picture);
  if (H.empty()) return std::nullopt;
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(H.ptr<double>());
}

/// The board about each corner: the homography that suits all of them, and about each a third order of what that leaves, which is the
/// lens's. The third is for the corners at the board's rim, whose neighbours all lie on one side.
class Neighbourhood {
 public:
  /// @param noise  of the corners [px].
  Neighbourhood(const std::vector<BoardSaddle>& saddles, const Eigen::Matrix3d& H, double noise) : saddles_(saddles), H_(H), noise_(noise) {
    for (const BoardSaddle& saddle : saddles) left_.push_back(saddle.px - (H * squaresOf(saddle).homogeneous()).hnormalized());
  }

  SaddleView about(std::size_t k) const {
    SaddleView view = viewOf(H_, squaresOf(saddles_[k]));
    const Lens lens = lensAbout(k, true);
    view.px = saddles_[k].px;
    view.J_px_squares += lens.middleRows<2>(1).transpose();
    view.uu += lens.row(3).transpose();
    view.uv += lens.row(4).transpose();
    view.vv += lens.row(5).transpose();
    return view;
  }

  /// How far a corner is from where its neighbours alone expect it [px].
  Eigen::Vector2d strays(std::size_t k) const { return left_[k] - lensAbout(k, false).row(0).transpose(); }

 private:
  using Lens = Eigen::Matrix<double, kTerms, 2>;

  Lens lensAbout(std::size_t k, bool with_itself) const {
    constexpr int kNear = 3;                                     // [squares]
    constexpr double kTilt = 0.05, kBend = 0.02, kTurn = 0.005;  // deviations of what a lens does within a square, in sides of it
    constexpr double kShift = 1.0;                               // likewise, of what a homography leaves
    const double side = viewOf(H_, squaresOf(saddles_[k])).J_px_squares.colwise().norm().mean();
    const auto prior = [&](double deviation) { return std::pow(noise_ / (deviation * side), 2.0); };
    Eigen::Matrix<double, kTerms, kTerms> A = Eigen::Matrix<double, kTerms, kTerms>::Zero();
    A.diagonal() << prior(kShift), prior(kTilt), prior(kTilt), Eigen::Vector3d::Constant(prior(kBend)),
        Eigen::Vector4d::Constant(prior(kTurn));
    Lens b = Lens::Zero();
    for (std::size_t n = 0; n < saddles_.size(); ++n) {
      const double u = saddles_[n].col - saddles_[k].col, v = saddles_[n].row - saddles_[k].row;
      if (std::max(std::abs(u), std::abs(v)) > kNear || (n == k && !with_itself)) continue;
      Terms terms;
      terms << 1.0, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v;
      A += terms * terms.transpose();
      b += terms * left_[n].transpose();
    }
    return A.ldlt().solve(b);
  }

  const std::vector<BoardSaddle>& saddles_;
  Eigen::Matrix3d H_;
  double noise_;
  std::vector<Eigen::Vector2d> left_;
};

bool isPlausible(const SaddleFit& fit, const Eigen::Vector2d& start) {
  constexpr double kLargestMove = 2.0;     // [px]
  constexpr double kLeastContrast = 20.0;  // [grey levels]
  constexpr double kLargestNoise = 0.1;    // of the contrast
  constexpr double kMostOutliers = 0.3;
  return (fit.px - start).norm() <= kLargestMove && fit.look.contrast() >= kLeastContrast &&
         fit.look.noise <= kLargestNoise * fit.look.contrast() && fit.outliers <= kMostOutliers && std::isfinite(fit.sigma());
}

using Fits = std::vector<std::optional<SaddleFit>>;

/// A fit of each corner that can be fitted. @param before  where to start; as many as corners.
Fits fits(const cv::Mat& grey, const SaddleCells& cells, DarkPair first, const std::vector<BoardSaddle>& saddles, const Eigen::Matrix3d& H,
          const Fits& before, int stride) {
  SaddleLook usual;
  std::vector<double> blurs;
  for (const auto& fit : before) {
    if (fit) blurs.push_back(fit->look.spread.blur);
  }
  const Neighbourhood board(saddles, H, blurs.empty() ? kWindowNoise : kFitNoise);
  if (!blurs.empty()) usual.spread.blur = median(std::move(blurs));
  Fits found;
  for (std::size_t k = 0; k < saddles.size(); ++k) {
    SaddleView view = board.about(k);
    const bool same = (saddles[k].col + saddles[k].row) % 2 == 0;
    view.dark = same == (first == DarkPair::kMain) ? DarkPair::kMain : DarkPair::kOther;
    const Eigen::Vector2d strays = board.strays(k);
    const bool is_wild = strays.norm() > kWild;
    if (is_wild) view.px -= strays;
    found.push_back(fitSaddle(grey, cells, view, before[k] && !is_wild ? before[k]->look : usual, stride));
    if (found.back() && !isPlausible(*found.back(), view.px)) found.back().reset();
  }
  return found;
}

/// Of the first fits: some hundred pixels of a square of any size.
int roughStride(const Eigen::Matrix3d& H, const BoardSaddle& middle) {
  constexpr double kSidePerPixel = 17.0;  // [px]
  const double side = std::sqrt(std::abs(viewOf(H, squaresOf(middle)).J_px_squares.determinant()));
  return std::clamp(static_cast<int>(side / kSidePerPixel), 1, 4);
}

}  // namespace

void fitBoardSaddles(const cv::Mat& grey, const SaddleCells& cells, DarkPair first, std::vector<BoardSaddle>& saddles) {
  constexpr double kLeastUnfitted = 0.1, kUnfitted = 5.0;  // [px], [median sigmas]
  const std::vector<BoardSaddle> given = saddles;
  std::vector<double> sigmas;
  Fits found(saddles.size());
  for (BoardSaddle& saddle : saddles) saddle.sigma = kLeastUnfitted;
  // The board about a corner is known as well as its neighbours are: once more with these.
  for (const bool is_rough : {true, false}) {
    const std::optional<Eigen::Matrix3d> H = homographyOf(saddles);
    if (!H) return;
    found = fits(grey, cells, first, saddles, *H, found, is_rough ? roughStride(*H, saddles[saddles.size() / 2]) : 1);
    sigmas.clear();
    for (std::size_t k = 0; k < saddles.size(); ++k) {
      saddles[k] = given[k];
      saddles[k].sigma = std::numeric_limits<double>::quiet_NaN();
      if (!found[k]) continue;
      saddles[k].px = found[k]->px;
      saddles[k].sigma = found[k]->sigma();
      sigmas.push_back(found[k]->sigma());
    }
  }
  const double unfitted = sigmas.empty() ? kLeastUnfitted : std::max(kLeastUnfitted, kUnfitted * median(sigmas));
  const std::optional<Eigen::Matrix3d> H = homographyOf(saddles);
  if (!H) return;
  const Neighbourhood board(saddles, *H, kWindowNoise);
  for (std::size_t k = 0; k < saddles.size(); ++k) {
    const double strays = board.strays(k).norm();
    if (std::isnan(saddles[k].sigma)) saddles[k].sigma = std::max(unfitted, strays);
    // Beside glare a poor fit may be far off. A good one may be far from the others' board too, where the print is poor.
    const bool is_poor = !sigmas.empty() && saddles[k].sigma > kUnfitted * median(sigmas);
    if (strays > kWild && is_poor) saddles[k].sigma = std::max(saddles[k].sigma, strays);
  }
}

}  // namespace poecal
