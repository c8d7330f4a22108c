#include "camera/intrinsics_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "camera/intrinsics_judgement.hpp"
#include "camera/intrinsics_start.hpp"
#include "camera/lens_model.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

Eigen::Index pointCount(const Views& views) {
  return std::accumulate(views.begin(), views.end(), Eigen::Index{0},
                         [](Eigen::Index sum, const BoardView* v) { return sum + v->points.cols(); });
}

void requireEnough(const Views& views, int parameter_count) {
  if (views.size() < kLeastPictures) {
    throw InsufficientData(
        fmt::format("{} usable pictures of the board, expected at least {} (4 points each, not on a line)", views.size(), kLeastPictures));
  }
  const Eigen::Index numbers = 2 * pointCount(views);
  const Eigen::Index unknowns = parameter_count + 6 * static_cast<Eigen::Index>(views.size());
  if (numbers <= unknowns) {
    throw InsufficientData(fmt::format("{} points in {} pictures give {} numbers for {} unknowns, expected more numbers", pointCount(views),
                                       views.size(), numbers, unknowns));
  }
}

BoardBundleFit refit(const Views& views, const BoardBundle& start, const std::vector<int>& free, int max_iterations,
                     const CornerWeights& weights = {}) {
  auto fit = fitBoardBundle(views, start, free, max_iterations, weights);
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

enum class Told { kAll, kSome, kOpen };

/// Whether the pictures tell the free coefficients: all to within what a lens may have; not all; or there are some that any value fits.
Told howFarTold(const Solution& solution) {
  const Eigen::MatrixXd covariance = unitCovariance(solution.fit.information);
  const std::span<const Coefficient> coefficients = lensModel(solution.fit.estimate.camera.model).coefficients;
  Told told = Told::kAll;
  for (std::size_t k = 0; k < solution.free.size(); ++k) {
    if (solution.free[k] < 4) continue;
    const auto i = static_cast<Eigen::Index>(k);
    const double deviation = solution.sigma() * std::sqrt(covariance(i, i));
    if (!std::isfinite(deviation)) return Told::kOpen;
    if (deviation > coefficients[static_cast<std::size_t>(solution.free[k] - 4)].plausible) told = Told::kSome;
  }
  return told;
}

/// Whether two coefficients are told apart so badly that one of them may as well be another's: a variance 500 times that alone.
bool areEntangled(const Solution& solution) {
  constexpr double kCorrelation = 0.999;
  const Eigen::MatrixXd covariance = unitCovariance(solution.fit.information);
  for (Eigen::Index i = 4; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 4; j < i; ++j) {
      if (!(std::abs(covariance(i, j)) <= kCorrelation * std::sqrt(covariance(i, i) * covariance(j, j)))) return true;
    }
  }
  return false;
}

/// The fit with as many of the free coefficients, in the model's order, as the pictures tell; nothing where the camera alone does not fit.
std::optional<Solution> withToldCoefficients(const Solution& full, int max_iterations, Progress& progress) {
  Solution best = full;
  best.free = {0, 1, 2, 3};
  BoardBundle start = full.start;
  start.camera.distortion.setZero();
  const auto bare = fitBoardBundle(best.views, start, best.free, max_iterations, best.weights);
  if (!bare) return std::nullopt;
  best.fit = *bare;
  for (const int parameter : full.free) {
    if (parameter < 4) continue;
    progress.show();
    Solution more = best;
    more.free.push_back(parameter);
    const auto fit = fitBoardBundle(more.views, best.fit.estimate, more.free, max_iterations, more.weights);
    if (fit) more.fit = *fit;
    if (fit && howFarTold(more) == Told::kAll && !areEntangled(more)) {
      best = std::move(more);
    } else {
      best.held.push_back(parameter);
    }
  }
  std::sort(best.held.begin(), best.held.end());
  return best;
}

/// Holds coefficients at 0 that the pictures do not tell, unless something of the picture would go with them.
/// @param progress  shown while it works.
void holdWhatIsOpen(Solution& solution, int max_iterations, Progress& progress) {
  constexpr double kLeastSigma_px = 0.01;  // below what detectors reach; exact corners tell zero from 1e-9
  const Told told = howFarTold(solution);
  if (told == Told::kAll) return;
  std::optional<Solution> without = withToldCoefficients(solution, max_iterations, progress);
  if (!without) return;
  // By Schwarz' criterion, each coefficient must be worth the logarithm of the number of data. What any value fits is worth nothing,
  // though values of hundreds may fit noise.
  const double variance = std::pow(std::max(solution.sigma(), kLeastSigma_px), 2.0);
  const double worth = (without->fit.squared_error - solution.fit.squared_error) / variance;
  const auto held = static_cast<double>(without->held.size() - solution.held.size());
  if (told == Told::kOpen || worth <= held * std::log(2.0 * solution.cornerCount())) solution = *std::move(without);
}

/// Hampel's three-part function of a distance in standard deviations.
double hampel(double distance) {
  constexpr double kInside = 3.0, kFalling = 4.0, kOutside = 6.0;
  if (distance <= kInside) return 1.0;
  if (distance <= kFalling) return kInside / distance;
  if (!(distance < kOutside)) return 0.0;
  return kInside / distance * (kOutside - distance) / (kOutside - kFalling);
}

Eigen::VectorXd hampelWeights(const Eigen::Matrix2Xd& residuals, double sigma_px) {
  return (residuals.colwise().norm() / sigma_px).transpose().unaryExpr([](double d) { return hampel(d); });
}

/// No detector is better than this; among exact corners rounding makes no outliers.
constexpr double kSmallestSigma_px = 1e-3;

struct Reweighting {
  CornerWeights weights, trust;
  double largest_change = 0.0;
};

bool stateSigmas(const Views& views) {
  return std::all_of(views.begin(), views.end(), [](const BoardView* view) { return view->sigmas.size() > 0; });
}

/// What corners have beside their sigmas [px]: the floor with which the median of |r|^2 / (sigma^2 + floor^2) is that of normal noise; 0
/// where corners are as near as they say. @param squares, variances  of all corners [px^2].
double squaredFloor(const std::vector<double>& squares, const std::vector<double>& variances) {
  constexpr int kHalvings = 60;
  const auto medianBeside = [&](double floor2) {
    std::vector<double> ratios;
    for (std::size_t k = 0; k < squares.size(); ++k) ratios.push_back(squares[k] / (variances[k] + floor2));
    return std::pow(sigmaOfMedian(std::sqrt(median(std::move(ratios)))), 2.0);
  };
  if (medianBeside(0.0) <= 1.0) return 0.0;
  double low = 0.0, high = *std::max_element(squares.begin(), squares.end());
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    (medianBeside(middle) > 1.0 ? low : high) = middle;
  }
  return high;
}

/// Standard deviations of the corners, relative to one of mean weight; all 1 where no sigmas are stated.
std::vector<Eigen::VectorXd> relativeSigmas(const Views& views, const std::vector<Eigen::Matrix2Xd>& residuals, double freedom_share) {
  std::vector<Eigen::VectorXd> relative;
  for (const Eigen::Matrix2Xd& of_view : residuals) relative.emplace_back(Eigen::VectorXd::Ones(of_view.cols()));
  if (!stateSigmas(views)) return relative;
  std::vector<double> squares, variances;
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (Eigen::Index i = 0; i < residuals[v].cols(); ++i) {
      squares.push_back(residuals[v].col(i).squaredNorm() / freedom_share);
      variances.push_back(views[v]->sigmas(i) * views[v]->sigmas(i));
    }
  }
  const double floor2 = squaredFloor(squares, variances);
  double precision = 0.0;
  for (const double variance : variances) precision += 1.0 / (variance + floor2);
  precision /= static_cast<double>(variances.size());
  for (std::size_t v = 0; v < views.size(); ++v) relative[v] = ((views[v]->sigmas.array().square() + floor2) * precision).sqrt();
  return relative;
}

Reweighting reweighted(const Solution& solution) {
  const BoardBundle& estimate = solution.fit.estimate;
  std::vector<Eigen::Matrix2Xd> residuals;
  for (std::size_t v = 0; v < solution.views.size(); ++v) {
    const BoardView& view = *solution.views[v];
    // The fit has just seen every point of it.
    residuals.push_back(
        boardResiduals(estimate.camera, estimate.T_camera_target[v], view).value_or(Eigen::Matrix2Xd::Zero(2, view.points.cols())));
  }
  const double numbers = 2.0 * static_cast<double>(pointCount(solution.views));
  const double unknowns = static_cast<double>(solution.free.size() + 6 * solution.views.size());
  const double freedom_share = std::max(1.0, numbers - unknowns) / numbers;
  const std::vector<Eigen::VectorXd> relative = relativeSigmas(solution.views, residuals, freedom_share);
  std::vector<double> distances;
  for (std::size_t v = 0; v < residuals.size(); ++v) {
    residuals[v] = residuals[v] * relative[v].cwiseInverse().asDiagonal();
    for (const double distance : residuals[v].colwise().norm()) distances.push_back(distance);
  }
  const double sigma = std::max(kSmallestSigma_px, sigmaOfMedian(median(distances)) / std::sqrt(freedom_share));
  Reweighting result;
  for (std::size_t v = 0; v < residuals.size(); ++v) {
    result.trust.push_back(hampelWeights(residuals[v], sigma));
    result.weights.push_back(result.trust.back().cwiseQuotient(relative[v].cwiseAbs2()));
    const Eigen::VectorXd before = solution.weights.empty() ? Eigen::VectorXd::Ones(residuals[v].cols()) : solution.weights[v];
    const Eigen::ArrayXd change = (result.weights.back() - before).cwiseAbs();
    result.largest_change = std::max(result.largest_change, (change / before.array().max(1.0)).maxCoeff());
  }
  return result;
}

}  // namespace

double Solution::cornerCount() const {
  if (weights.empty()) return static_cast<double>(pointCount(views));
  double sum = 0.0;
  for (const Eigen::VectorXd& of_view : weights) sum += of_view.sum();
  return sum;
}

double Solution::freedoms() const { return 2.0 * cornerCount() - static_cast<double>(free.size() + 6 * views.size()); }

double Solution::sigma() const { return std::sqrt(fit.squared_error / std::max(1.0, freedoms())); }

double sigmaOfMedian(double median_distance) { return median_distance / std::sqrt(2.0 * std::log(2.0)); }

Solution fitFromScratch(const Views& given, int width, int height, const IntrinsicsOptions& options) {
  const int parameter_count = 4 + distortionCount(options.model);
  requireEnough(given, parameter_count);
  // The start, poses, focal lengths, centre, all coefficients, those that are told.
  Progress progress(options.progress, "fitting the lens", 6);
  progress.show();
  Solution solution;
  BoardBundle bundle;
  bundle.camera = startCamera(given, width, height, options.model);
  progress.advance();
  for (const BoardView* view : given) {
    if (const auto pose = boardPose(bundle.camera, *view)) {
      solution.views.push_back(view);
      bundle.T_camera_target.push_back(*pose);
    }
  }
  requireEnough(solution.views, parameter_count);
  progress.advance();
  bundle = refit(solution.views, bundle, {0, 1, 4}, options.max_iterations).estimate;
  progress.advance();
  askForPosesAgain(solution.views, bundle);
  solution.start = refit(solution.views, bundle, {0, 1, 2, 3, 4, 5}, options.max_iterations).estimate;
  progress.advance();
  solution.free.resize(static_cast<std::size_t>(parameter_count));
  std::iota(solution.free.begin(), solution.free.end(), 0);
  solution.fit = refit(solution.views, solution.start, solution.free, options.max_iterations);
  progress.advance();
  holdWhatIsOpen(solution, options.max_iterations, progress);
  progress.advance();
  return solution;
}

Solution fitRobustly(const Solution& from, const Views& views, const IntrinsicsOptions& options) {
  constexpr int kMostRounds = 30;
  constexpr double kSettled = 1e-3;
  Progress progress(options.progress, "fitting the lens without outliers", kMostRounds);
  progress.show();
  Solution solution;
  solution.views = views;
  solution.free = from.free;
  solution.held = from.held;
  solution.start.camera = from.start.camera;
  BoardBundle at{from.fit.estimate.camera, {}};
  for (std::size_t v = 0; v < from.views.size(); ++v) {
    if (std::find(views.begin(), views.end(), from.views[v]) == views.end()) continue;
    at.T_camera_target.push_back(from.fit.estimate.T_camera_target[v]);
    solution.start.T_camera_target.push_back(from.start.T_camera_target[v]);
  }
  solution.fit = refit(solution.views, at, solution.free, options.max_iterations);
  for (int round = 0; round < kMostRounds; ++round) {
    Reweighting next = reweighted(solution);
    if (next.largest_change < kSettled) break;
    solution.weights = std::move(next.weights);
    solution.trust = std::move(next.trust);
    solution.fit = refit(solution.views, solution.fit.estimate, solution.free, options.max_iterations, solution.weights);
    if (round + 1 < kMostRounds) progress.advance();
  }
  holdWhatIsOpen(solution, options.max_iterations, progress);
  progress.finish();
  return solution;
}

std::optional<ViewFit> fitView(const Camera& camera, const BoardView& view, double sigma_px) {
  constexpr int kRounds = 10, kMaxIterations = 30;
  std::optional<Eigen::Isometry3d> pose = boardPose(camera, view);
  auto residuals = pose ? boardResiduals(camera, *pose, view) : std::nullopt;
  if (!residuals) return std::nullopt;
  ViewFit result{*pose, *residuals, Eigen::VectorXd::Ones(view.points.cols())};
  if (sigma_px == 0.0) return result;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::VectorXd distances = result.residuals.colwise().norm().transpose();
    const double own = sigmaOfMedian(median({distances.begin(), distances.end()}));
    // A wild corner draws the pose at first: by its own median a picture comes back from there.
    result.weights = hampelWeights(result.residuals, std::max({sigma_px, own, kSmallestSigma_px}));
    const auto again = fitBoardBundle({&view}, {camera, {result.T_camera_target}}, {}, kMaxIterations, {result.weights});
    residuals = again ? boardResiduals(camera, again->estimate.T_camera_target[0], view) : std::nullopt;
    if (!residuals) break;
    result.T_camera_target = again->estimate.T_camera_target[0];
    const double moved = (*residuals - result.residuals).cwiseAbs().maxCoeff();
    result.residuals = *residuals;
    constexpr double kSettled = 0.01;  // of the noise
    if (moved < kSettled * sigma_px) break;
  }
  result.weights = hampelWeights(result.residuals, std::max(sigma_px, kSmallestSigma_px));
  return result;
}

}  // namespace poecal
