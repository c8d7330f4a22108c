#include "poecal/camera/intrinsics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "camera/intrinsics_fit.hpp"
#include "camera/intrinsics_judgement.hpp"
#include "camera/intrinsics_start.hpp"
#include "camera/picture_focal.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

void checkViews(const std::vector<BoardView>& views, int width, int height) {
  if (width <= 0 || height <= 0) throw InvalidArgument(fmt::format("picture size {} x {}, expected positive numbers", width, height));
  for (const BoardView& view : views) {
    if (view.points.cols() != view.pixels.cols()) {
      throw InvalidArgument(
          fmt::format("{}: {} points and {} pixels, expected as many", view.image, view.points.cols(), view.pixels.cols()));
    }
    if (view.sigmas.size() != 0 &&
        (view.sigmas.size() != view.points.cols() || !(view.sigmas.array() > 0.0).all() || !view.sigmas.allFinite())) {
      throw InvalidArgument(fmt::format("{}: {} sigmas of {} points, expected none or a positive one for each", view.image,
                                        view.sigmas.size(), view.points.cols()));
    }
    if (!view.points.allFinite() || !view.pixels.allFinite()) throw InvalidArgument(view.image + ": points and pixels must be finite");
  }
}

/// Root mean square of the 95 % smallest.
double trimmedRms(const Eigen::VectorXd& distances) {
  constexpr double kTrimmed = 0.05;
  std::vector<double> sorted(distances.begin(), distances.end());
  std::sort(sorted.begin(), sorted.end());
  sorted.resize(sorted.size() - static_cast<std::size_t>(std::ceil(kTrimmed * static_cast<double>(sorted.size()))));
  return rms(sorted);
}

/// Residuals of every given picture under a camera, its pose fitted again. @param sigma_px  as fitView().
std::vector<ViewResidual> residualsOf(const std::vector<BoardView>& given, const Camera& camera, double sigma_px,
                                      const ProgressFunction& progress) {
  std::vector<ViewResidual> residuals;
  Progress told(progress, "judging each picture of the board", given.size());
  told.show();
  for (const BoardView& view : given) {
    if (!residuals.empty()) told.advance();
    ViewResidual& entry = residuals.emplace_back();
    entry.image = view.image;
    entry.points = static_cast<int>(view.points.cols());
    if (!usable(view)) continue;
    const std::optional<ViewFit> fit = fitView(camera, view, sigma_px);
    if (!fit) continue;
    const Eigen::VectorXd distances = fit->residuals.colwise().norm().transpose();
    entry.used = true;
    entry.outliers = static_cast<int>((fit->weights.array() < 0.5).count());
    entry.T_camera_target = fit->T_camera_target;
    entry.rms_px = std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size()));
    entry.level_px = trimmedRms(distances);
    entry.typical_px = std::sqrt(2.0) * sigmaOfMedian(median({distances.begin(), distances.end()}));
    entry.max_px = distances.maxCoeff();
  }
  told.finish();
  return residuals;
}

/// What a figure of the pictures may be before it is far beyond the others'.
double limitOf(const std::vector<double>& values, const IntrinsicsOptions& options) {
  constexpr double kHarmless_px = 0.02;  // better than any detector: a picture of that level is bad only among exact ones
  const double middle = median(values);
  return std::max({middle + options.bad_view_sigmas * robustSigma(values), options.bad_view_factor * middle, kHarmless_px});
}

/// Marks the bad ones as IntrinsicsOptions says.
void markBad(std::vector<ViewResidual>& residuals, const IntrinsicsOptions& options) {
  std::vector<double> levels, typical;
  std::vector<ViewResidual*> worst_first;
  for (ViewResidual& entry : residuals) {
    entry.bad = entry.left_out = false;
    if (!entry.used) continue;
    levels.push_back(entry.level_px);
    typical.push_back(entry.typical_px);
    worst_first.push_back(&entry);
  }
  std::stable_sort(worst_first.begin(), worst_first.end(), [](const auto* a, const auto* b) { return a->level_px > b->level_px; });
  const double limit = limitOf(levels, options), typical_limit = limitOf(typical, options);
  const std::size_t beyond_least = worst_first.size() - std::min(worst_first.size(), kLeastPictures);
  const std::size_t most = std::min(worst_first.size() / 4, beyond_least);
  for (std::size_t k = 0; k < most; ++k) {
    worst_first[k]->bad = worst_first[k]->level_px > limit;
    worst_first[k]->left_out = worst_first[k]->bad && worst_first[k]->typical_px > typical_limit;
  }
}

/// The covariance of the free parameters among all of them; zeros for the others.
Eigen::MatrixXd amongAll(const Eigen::MatrixXd& covariance, const std::vector<int>& free, Eigen::Index count) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (std::size_t j = 0; j < free.size(); ++j)
      all(free[i], free[j]) = covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  }
  return all;
}

/// What corners may be off by in the same way in all pictures, as the tests of the detectors bound it [px]. No residual shows it, and the
/// lens takes it up.
constexpr double kCommonBias_px = 0.005;

/// @param variance_px2  of a coordinate; with kCommonBias_px it scales the covariance.
IntrinsicsFit summarise(const Solution& solution, double variance_px2) {
  IntrinsicsFit summary;
  Camera& camera = summary.camera;
  camera = solution.fit.estimate.camera;
  summary.pictures = static_cast<int>(solution.views.size());
  for (const BoardView* view : solution.views) summary.points += static_cast<int>(view->points.cols());
  for (const Eigen::VectorXd& trust : solution.trust) summary.outliers += static_cast<int>((trust.array() < 0.5).count());
  summary.converged = solution.fit.converged;
  summary.rms_px = std::sqrt(solution.fit.squared_error / solution.cornerCount());
  summary.sigma_px = solution.sigma();
  const double variance = variance_px2 + kCommonBias_px * kCommonBias_px;
  summary.covariance = amongAll(variance * unitCovariance(solution.fit.information), solution.free, camera.parameterCount());
  camera.standard_deviation = summary.covariance.diagonal().cwiseSqrt();
  const std::vector<std::string> names = camera.parameterNames();
  for (const int parameter : solution.held) {
    camera.standard_deviation(parameter) = std::numeric_limits<double>::quiet_NaN();
    summary.held.push_back(names[static_cast<std::size_t>(parameter)]);
  }
  summary.uncertainty = projectionUncertainty(camera, summary.covariance);
  return summary;
}

IntrinsicsFit summarise(const Solution& solution) { return summarise(solution, solution.sigma() * solution.sigma()); }

Solution withoutBad(const std::vector<BoardView>& given, const std::vector<ViewResidual>& residuals, const Solution& all,
                    const IntrinsicsOptions& options) {
  Views good;
  for (const BoardView* view : all.views) {
    if (!residuals[static_cast<std::size_t>(view - given.data())].left_out) good.push_back(view);
  }
  return fitRobustly(all, good, options);
}

bool sameLeftOut(const std::vector<ViewResidual>& a, const std::vector<ViewResidual>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const ViewResidual& x, const ViewResidual& y) { return x.left_out == y.left_out; });
}

/// Marks the bad pictures in `views` and fits without those left out. A bad picture bends the camera that it is judged by, so the fit
/// without it judges again, until it agrees.
Solution setBadAside(const std::vector<BoardView>& given, const Solution& all, const IntrinsicsOptions& options,
                     std::vector<ViewResidual>& views) {
  constexpr int kMaxRounds = 5;
  views = residualsOf(given, all.fit.estimate.camera, all.sigma(), options.progress);
  markBad(views, options);
  for (int round = 0;; ++round) {
    Solution robust = withoutBad(given, views, all, options);
    if (round + 1 == kMaxRounds) return robust;
    std::vector<ViewResidual> again = residualsOf(given, robust.fit.estimate.camera, robust.sigma(), options.progress);
    markBad(again, options);
    const bool agrees = sameLeftOut(again, views);
    views = std::move(again);
    if (agrees) return robust;
  }
}

std::string figures(const IntrinsicsFit& fit) {
  return fmt::format("fx {:.2f}, fy {:.2f}, {:.3f} px rms", fit.camera.fx, fit.camera.fy, fit.rms_px);
}

std::vector<std::string> pictureWarnings(const IntrinsicsResult& result) {
  std::vector<std::string> warnings;
  std::string bad;
  std::vector<double> good_rms;
  int wild = 0;
  constexpr double kHarmless_px = 0.1;  // what usual detectors reach; rendered pictures have outliers below that nobody need look for
  for (const ViewResidual& entry : result.views) {
    if (entry.points == 0) continue;  // the detector has said why
    if (!entry.left_out && entry.max_px > kHarmless_px) wild += entry.outliers;
    if (!entry.used) {
      warnings.push_back(
          fmt::format("{} is not used: {} points of the board, expected at least 4 that fix its pose", entry.image, entry.points));
    } else if (entry.bad) {
      bad += fmt::format("{}{} ({:.2f} px rms, {})", bad.empty() ? "" : ", ", entry.image, entry.rms_px,
                         entry.left_out ? "left out" : fmt::format("{} of {} corners", entry.outliers, entry.points));
    } else {
      good_rms.push_back(entry.rms_px);
    }
  }
  if (!bad.empty()) {
    warnings.push_back(
        fmt::format("bad pictures: {}, against {:.2f} px in the median of the others; without what does not belong {}, with it {}", bad,
                    median(good_rms), figures(result.robust), figures(result.all)));
  }
  if (result.is_robust && wild > 0) {
    warnings.push_back(fmt::format("{} of {} corners count for little or nothing: they are far from where the others put them", wild,
                                   result.robust.points));
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
  result.is_robust = options.robust;
  result.all = summarise(all);
  const Solution robust = setBadAside(views, all, options, result.views);
  // Pictures that pull more than noise would let them are what the camera is uncertain by.
  result.robust = summarise(robust, std::max(robust.sigma() * robust.sigma(), robust.fit.pull));
  const Solution& used = options.robust ? robust : all;
  requireDetermined(used.fit.estimate.camera, used.fit.information, used.sigma());

  const IntrinsicsFit& chosen = result.chosen();
  std::vector<ViewResidual> residuals = residualsOf(views, chosen.camera, options.robust ? chosen.sigma_px : 0.0, options.progress);
  for (std::size_t v = 0; v < views.size(); ++v) {
    residuals[v].bad = result.views[v].bad;
    residuals[v].left_out = result.views[v].left_out;
  }
  result.views = std::move(residuals);

  result.warnings = pictureWarnings(result);
  if (!chosen.converged) {
    result.warnings.push_back(
        fmt::format("the fit did not settle within {} iterations: a model with fewer coefficients may be enough", options.max_iterations));
  }
  const std::string zoomed = otherFocalLengths(chosen.camera, views, result.views);
  if (!zoomed.empty()) result.warnings.push_back(zoomed);
  for (const std::string& warning : coefficientWarnings(chosen)) result.warnings.push_back(warning);
  if (const std::string stretched = stretchWarning(chosen); !stretched.empty()) result.warnings.push_back(stretched);
  constexpr double kLittleTilt_rad = 15.0 * M_PI / 180.0;
  const double spread = tiltSpread(used.views, used.fit.estimate.T_camera_target);
  if (spread < kLittleTilt_rad) {
    result.warnings.push_back(fmt::format(
        "all boards are within {:.0f} degrees of parallel: tilt them by 20 to 50 degrees, in different directions", spread * 180.0 / M_PI));
  }
  return result;
}

}  // namespace poecal
