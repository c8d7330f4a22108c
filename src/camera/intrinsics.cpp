#include "poecal/camera/intrinsics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "camera/board_bundle.hpp"
#include "camera/intrinsics_judgement.hpp"
#include "camera/intrinsics_start.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

constexpr std::size_t kLeastPictures = 3;

using Views = std::vector<const BoardView*>;

/// Pictures that take part, with the fit to them.
struct Solution {
  Views views;
  BoardBundleFit fit;
};

void checkViews(const std::vector<BoardView>& views, int width, int height) {
  if (width <= 0 || height <= 0) throw InvalidArgument(fmt::format("picture size {} x {}, expected positive numbers", width, height));
  for (const BoardView& view : views) {
    if (view.points.cols() != view.pixels.cols()) {
      throw InvalidArgument(
          fmt::format("{}: {} points and {} pixels, expected as many", view.image, view.points.cols(), view.pixels.cols()));
    }
    if (!view.points.allFinite() || !view.pixels.allFinite()) throw InvalidArgument(view.image + ": points and pixels must be finite");
  }
}

Eigen::Index pointCount(const Views& views) {
  return std::accumulate(views.begin(), views.end(), Eigen::Index{0},
                         [](Eigen::Index sum, const BoardView* v) { return sum + v->points.cols(); });
}

/// Numbers that the residuals have beyond the unknowns.
Eigen::Index freedoms(const Views& views, int parameter_count) {
  return 2 * pointCount(views) - parameter_count - 6 * static_cast<Eigen::Index>(views.size());
}

void requireEnough(const Views& views, int parameter_count) {
  if (views.size() < kLeastPictures) {
    throw InsufficientData(
        fmt::format("{} usable pictures of the board, expected at least {} (4 points each, not on a line)", views.size(), kLeastPictures));
  }
  const Eigen::Index numbers = 2 * pointCount(views);
  if (freedoms(views, parameter_count) <= 0) {
    throw InsufficientData(fmt::format("{} points in {} pictures give {} numbers for {} unknowns, expected more numbers", pointCount(views),
                                       views.size(), numbers, numbers - freedoms(views, parameter_count)));
  }
}

std::vector<int> allParameters(const Camera& camera) {
  std::vector<int> indices(static_cast<std::size_t>(camera.parameterCount()));
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

BoardBundleFit refit(const Views& views, const BoardBundle& start, const std::vector<int>& free, int max_iterations) {
  auto fit = fitBoardBundle(views, start, free, max_iterations);
  // Every start has seen all its points: poses come from boardPose or an earlier fit with the same camera.
  if (!fit) throw InsufficientData("the pictures do not fit any camera of this model");
  return *fit;
}

double squaredError(const Camera& camera, const Eigen::Isometry3d& T_camera_target, const BoardView& view) {
  const auto residuals = boardResiduals(camera, T_camera_target, view);
  return residuals ? residuals->squaredNorm() : std::numeric_limits<double>::infinity();
}

/// A flat board seen with a wrong lens may have been put down in its mirrored pose, which least squares does not leave: ask again.
void askForPosesAgain(const Views& views, BoardBundle& bundle) {
  for (std::size_t v = 0; v < views.size(); ++v) {
    const std::optional<Eigen::Isometry3d> again = boardPose(bundle.camera, *views[v]);
    Eigen::Isometry3d& pose = bundle.T_camera_target[v];
    if (again && squaredError(bundle.camera, *again, *views[v]) < squaredError(bundle.camera, pose, *views[v])) pose = *again;
  }
}

/// From nothing: focal lengths and the first coefficient, then the centre and the second, then all.
Solution fitFromScratch(const Views& given, int width, int height, const IntrinsicsOptions& options) {
  const int parameter_count = 4 + distortionCount(options.model);
  requireEnough(given, parameter_count);
  Solution solution;
  BoardBundle bundle;
  bundle.camera = startCamera(given, width, height, options.model);
  for (const BoardView* view : given) {
    if (const auto pose = boardPose(bundle.camera, *view)) {
      solution.views.push_back(view);
      bundle.T_camera_target.push_back(*pose);
    }
  }
  requireEnough(solution.views, parameter_count);
  const std::vector<int> stages[] = {{0, 1, 4}, {0, 1, 2, 3, 4, 5}, allParameters(bundle.camera)};
  for (const std::vector<int>& free : stages) {
    solution.fit = refit(solution.views, bundle, free, options.max_iterations);
    bundle = solution.fit.estimate;
    if (&free == &stages[0]) askForPosesAgain(solution.views, bundle);
  }
  return solution;
}

/// Residuals of every given picture under `camera`, its pose fitted again.
std::vector<ViewResidual> residualsOf(const std::vector<BoardView>& given, const Camera& camera) {
  std::vector<ViewResidual> residuals;
  for (const BoardView& view : given) {
    ViewResidual& entry = residuals.emplace_back();
    entry.image = view.image;
    entry.points = static_cast<int>(view.points.cols());
    if (!usable(view)) continue;
    const std::optional<Eigen::Isometry3d> pose = boardPose(camera, view);
    const auto r = pose ? boardResiduals(camera, *pose, view) : std::nullopt;
    if (!r) continue;
    entry.used = true;
    entry.T_camera_target = *pose;
    entry.rms_px = std::sqrt(r->squaredNorm() / static_cast<double>(r->cols()));
    entry.max_px = r->colwise().norm().maxCoeff();
  }
  return residuals;
}

/// Marks the bad ones as IntrinsicsOptions says.
void markBad(std::vector<ViewResidual>& residuals, const IntrinsicsOptions& options) {
  constexpr double kHarmless_px = 0.02;  // better than any detector: a picture of that rms is bad only among exact ones
  std::vector<double> rms;
  std::vector<ViewResidual*> worst_first;
  for (ViewResidual& entry : residuals) {
    entry.bad = false;
    if (!entry.used) continue;
    rms.push_back(entry.rms_px);
    worst_first.push_back(&entry);
  }
  std::stable_sort(worst_first.begin(), worst_first.end(), [](const auto* a, const auto* b) { return a->rms_px > b->rms_px; });
  const double middle = median(rms);
  const double limit = std::max({middle + options.bad_view_sigmas * robustSigma(rms), options.bad_view_factor * middle, kHarmless_px});
  const std::size_t beyond_least = worst_first.size() - std::min(worst_first.size(), kLeastPictures);
  const std::size_t most = std::min(worst_first.size() / 4, beyond_least);
  for (std::size_t k = 0; k < most; ++k) worst_first[k]->bad = worst_first[k]->rms_px > limit;
}

IntrinsicsFit summarise(const Solution& solution) {
  IntrinsicsFit summary;
  summary.camera = solution.fit.estimate.camera;
  summary.pictures = static_cast<int>(solution.views.size());
  summary.points = static_cast<int>(pointCount(solution.views));
  summary.converged = solution.fit.converged;
  summary.rms_px = std::sqrt(solution.fit.squared_error / summary.points);
  summary.sigma_px = std::sqrt(solution.fit.squared_error / static_cast<double>(freedoms(solution.views, summary.camera.parameterCount())));
  summary.covariance = summary.sigma_px * summary.sigma_px * unitCovariance(solution.fit.information);
  summary.camera.standard_deviation = summary.covariance.diagonal().cwiseSqrt();
  return summary;
}

/// Fits to the pictures of `all` that are not marked bad; `residuals` runs along `given`.
Solution fitWithoutBad(const std::vector<BoardView>& given, const std::vector<ViewResidual>& residuals, const Solution& all,
                       int max_iterations) {
  Solution others;
  BoardBundle start;
  start.camera = all.fit.estimate.camera;
  for (std::size_t v = 0; v < all.views.size(); ++v) {
    if (residuals[static_cast<std::size_t>(all.views[v] - given.data())].bad) continue;
    others.views.push_back(all.views[v]);
    start.T_camera_target.push_back(all.fit.estimate.T_camera_target[v]);
  }
  others.fit = refit(others.views, start, allParameters(start.camera), max_iterations);
  return others;
}

bool isBad(const ViewResidual& entry) { return entry.bad; }

bool sameBad(const std::vector<ViewResidual>& a, const std::vector<ViewResidual>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const ViewResidual& x, const ViewResidual& y) { return x.bad == y.bad; });
}

/// Names the bad pictures in `result.views` and fits without them. A bad picture bends the camera that it is judged by, so the fit
/// without it judges again, until it agrees.
void setBadAside(const std::vector<BoardView>& given, const Solution& all, const IntrinsicsOptions& options, IntrinsicsResult& result) {
  constexpr int kMaxRounds = 5;
  for (int round = 0; round < kMaxRounds; ++round) {
    if (std::none_of(result.views.begin(), result.views.end(), isBad)) {
      result.without_bad.reset();
      return;
    }
    result.without_bad = summarise(fitWithoutBad(given, result.views, all, options.max_iterations));
    std::vector<ViewResidual> again = residualsOf(given, result.without_bad->camera);
    markBad(again, options);
    if (round + 1 == kMaxRounds || sameBad(again, result.views)) return;
    result.views = std::move(again);
  }
}

std::string figures(const IntrinsicsFit& fit) {
  return fmt::format("fx {:.2f}, fy {:.2f}, {:.3f} px rms", fit.camera.fx, fit.camera.fy, fit.rms_px);
}

std::vector<std::string> pictureWarnings(const IntrinsicsResult& result) {
  std::vector<std::string> warnings;
  std::string bad;
  std::vector<double> good_rms;
  for (const ViewResidual& entry : result.views) {
    if (entry.points == 0) continue;  // the detector has said why
    if (!entry.used) {
      warnings.push_back(
          fmt::format("{} is not used: {} points of the board, expected at least 4 that fix its pose", entry.image, entry.points));
    } else if (entry.bad) {
      bad += fmt::format("{}{} ({:.2f} px rms)", bad.empty() ? "" : ", ", entry.image, entry.rms_px);
    } else {
      good_rms.push_back(entry.rms_px);
    }
  }
  if (!bad.empty()) {
    warnings.push_back(fmt::format("bad pictures: {}, against {:.2f} px in the median of the others; without them {}, with them {}", bad,
                                   median(good_rms), figures(*result.without_bad), figures(result.all)));
  }
  return warnings;
}

}  // namespace

void IntrinsicsOptions::validate() const {
  if (max_iterations < 1) throw InvalidArgument(fmt::format("max_iterations is {}, expected at least 1", max_iterations));
  if (!(bad_view_sigmas > 0.0)) throw InvalidArgument(fmt::format("bad_view_sigmas is {}, expected a positive number", bad_view_sigmas));
  if (!(bad_view_factor >= 1.0)) throw InvalidArgument(fmt::format("bad_view_factor is {}, expected at least 1", bad_view_factor));
}

IntrinsicsResult calibrateIntrinsics(const std::vector<BoardView>& views, int width, int height, const IntrinsicsOptions& options) {
  options.validate();
  checkViews(views, width, height);
  Views candidates;
  for (const BoardView& view : views) {
    if (usable(view)) candidates.push_back(&view);
  }
  const Solution all = fitFromScratch(candidates, width, height, options);

  IntrinsicsResult result;
  result.drop_bad = options.drop_bad;
  result.all = summarise(all);
  requireDetermined(result.all.camera, all.fit.information, result.all.sigma_px);
  result.views = residualsOf(views, result.all.camera);
  markBad(result.views, options);
  setBadAside(views, all, options, result);

  const IntrinsicsFit& chosen = result.chosen();
  std::vector<ViewResidual> residuals = residualsOf(views, chosen.camera);
  for (std::size_t v = 0; v < views.size(); ++v) residuals[v].bad = result.views[v].bad;
  result.views = std::move(residuals);

  result.warnings = pictureWarnings(result);
  if (!chosen.converged) {
    result.warnings.push_back(
        fmt::format("the fit did not settle within {} iterations: a model with fewer coefficients may be enough", options.max_iterations));
  }
  for (const std::string& warning : coefficientWarnings(chosen)) result.warnings.push_back(warning);
  constexpr double kLittleTilt_rad = 15.0 * M_PI / 180.0;
  const double spread = tiltSpread(all.views, all.fit.estimate.T_camera_target);
  if (spread < kLittleTilt_rad) {
    result.warnings.push_back(fmt::format(
        "all boards are within {:.0f} degrees of parallel: tilt them by 20 to 50 degrees, in different directions", spread * 180.0 / M_PI));
  }
  return result;
}

}  // namespace poecal
