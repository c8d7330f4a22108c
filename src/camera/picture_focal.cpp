// Pictures of one camera whose focal lengths differ: zoom and autofocus.
#include "camera/picture_focal.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

constexpr int kSteps = 20;
constexpr Eigen::Index kUnknowns = 7;    // pose, and the logarithm of the factor
constexpr double kOther = 0.02;          // focusing from near to far changes a focal length by less than that
constexpr double kSigmas = 8.0;          // a lens that is beyond its model pulls pictures apart too
constexpr double kMostPictures = 0.25;   // of which the rest still are those of one lens
constexpr std::size_t kFewestViews = 4;  // a median of three may be that of the one that is other
constexpr std::size_t kListed = 6;

/// A factor of fx and fy as one picture has it, and its standard deviation by that picture's own residuals.
struct Factor {
  double value = 1.0, deviation = 0.0;
};

std::optional<Factor> factorOf(Camera camera, const BoardView& view, Eigen::Isometry3d T) {
  if (2 * view.points.cols() <= kUnknowns) return std::nullopt;
  const Camera whole = camera;
  double log_factor = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    camera.fx = whole.fx * std::exp(log_factor);
    camera.fy = whole.fy * std::exp(log_factor);
    Eigen::Matrix<double, kUnknowns, kUnknowns> A = Eigen::Matrix<double, kUnknowns, kUnknowns>::Zero();
    Eigen::Matrix<double, kUnknowns, 1> b = Eigen::Matrix<double, kUnknowns, 1>::Zero();
    double squares = 0.0;
    for (Eigen::Index j = 0; j < view.points.cols(); ++j) {
      const Eigen::Vector3d p = T * view.points.col(j);
      const auto seen = projectWithJacobians(camera, p);
      if (!seen) return std::nullopt;
      Eigen::Matrix<double, 2, kUnknowns> J;
      J << -seen->J_px_p * hat(p), seen->J_px_p, camera.fx * seen->J_px_parameters.col(0) + camera.fy * seen->J_px_parameters.col(1);
      const Eigen::Vector2d r = view.pixels.col(j) - seen->px;
      A += J.transpose() * J;
      b += J.transpose() * r;
      squares += r.squaredNorm();
    }
    const Eigen::LDLT<Eigen::Matrix<double, kUnknowns, kUnknowns>> factored(A);
    const Eigen::Matrix<double, kUnknowns, 1> change = factored.solve(b);
    if (!change.allFinite()) return std::nullopt;
    if (step + 1 == kSteps) {
      const double variance = squares / static_cast<double>(2 * view.points.cols() - kUnknowns);
      const Eigen::Matrix<double, kUnknowns, 1> last = Eigen::Matrix<double, kUnknowns, 1>::Unit(kUnknowns - 1);
      return Factor{std::exp(log_factor), std::sqrt(variance * factored.solve(last)(kUnknowns - 1))};
    }
    constexpr double kLongest = 0.3;
    T = expSe3(change.head<6>()) * T;
    log_factor += std::clamp(change(kUnknowns - 1), -kLongest, kLongest);
  }
  return std::nullopt;
}

}  // namespace

std::string otherFocalLengths(const Camera& camera, const std::vector<BoardView>& views, const std::vector<ViewResidual>& residuals) {
  std::vector<std::pair<std::string, Factor>> factors;
  std::vector<double> values;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!residuals[v].used) continue;
    const auto factor = factorOf(camera, views[v], residuals[v].T_camera_target);
    if (!factor || !std::isfinite(factor->deviation)) continue;
    factors.emplace_back(views[v].image, *factor);
    values.push_back(factor->value);
  }
  if (factors.size() < kFewestViews) return "";
  const double usual = median(values);
  std::vector<std::string> others;
  std::vector<double> by;
  for (const auto& [image, factor] : factors) {
    const double off = std::abs(factor.value / usual - 1.0);
    if (off <= kOther || off * usual <= kSigmas * factor.deviation) continue;
    others.push_back(image);
    by.push_back(factor.value / usual);
  }
  if (others.empty()) return "";
  const std::size_t all = others.size();
  if (all > kListed) {
    others.resize(kListed);
    others.push_back(fmt::format("and {} more", all - kListed));
  }
  const std::string text = fmt::format(
      "{} of {} pictures {} taken with another focal length ({:.3g} times that of the others in the median: {}): zoom and "
      "focus must stay as they are",
      all, factors.size(), all == 1 ? "looks" : "look", median(by), fmt::join(others, ", "));
  if (static_cast<double>(all) > kMostPictures * static_cast<double>(factors.size())) throw ImplausibleInput(text);
  return text;
}

}  // namespace poecal
