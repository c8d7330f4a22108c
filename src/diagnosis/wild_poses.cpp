#include "diagnosis/wild_poses.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

/// Sum of squares of each pose's residuals in units of their noise.
std::vector<double> squaresOf(const Whitening& whitening, const Eigen::VectorXd& e) {
  std::vector<double> squares;
  for (std::size_t g = 0; g < whitening.poses(); ++g) squares.push_back(e.segment(whitening.begin(g), whitening.size(g)).squaredNorm());
  return squares;
}

/// What a number's square usually comes to in units of its noise, whatever wild poses there are.
double usualSquare(const Whitening& whitening, std::vector<double> squares) {
  for (std::size_t g = 0; g < squares.size(); ++g) squares[g] /= whitening.size(g);
  return std::max(1e-12, median(squares)) / 0.9;
}

bool isWild(double square, int size, double usual, const Wild& wild) {
  return square / size / usual > wild.mean_square && chiSquareTail(square / usual, size) < wild.probability;
}

/// Noise of poses that were not fitted, as that of those which were.
Eigen::VectorXd noiseAsOf(const Linearised& fitted, const std::vector<NoiseComponent>& components) {
  Eigen::VectorXd theta(static_cast<Eigen::Index>(components.size()));
  for (std::size_t i = 0; i < components.size(); ++i) {
    theta(static_cast<Eigen::Index>(i)) = varianceOf(components[i].name, fitted.components, fitted.noise).value_or(components[i].start);
  }
  return theta;
}

/// Whether the camera's model has a pixel for any corner of a pose: otherwise there is nothing that would speak against it.
bool isSeen(const CaptureRows& rows, const std::vector<std::size_t>& shots) {
  return std::any_of(shots.begin(), shots.end(), [&rows](std::size_t k) {
    const std::vector<bool>& valid = rows.observations[k].rows.valid;
    return std::find(valid.begin(), valid.end(), true) != valid.end();
  });
}

}  // namespace

std::vector<std::size_t> wildPoses(const MeasuredCell& measured, const Linearised& linear, const Wild& wild) {
  const WhiteResidual white = whiteResidual(linear);
  const std::vector<double> squares = squaresOf(white.whitening, white.e);
  const double usual = usualSquare(white.whitening, squares);
  std::vector<std::size_t> bad;
  for (std::size_t g = 0; g < squares.size(); ++g) {
    if (isWild(squares[g], white.whitening.size(g), usual, wild)) bad.push_back(g);
  }
  if (isRunInTime(measured, bad) || bad.size() > squares.size() / 3) return {};
  return bad;
}

bool isRunInTime(const MeasuredCell& measured, const std::vector<std::size_t>& poses) {
  constexpr std::size_t kFewest = 3;
  if (poses.size() < kFewest) return false;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t g = 0; g < measured.groups.size(); ++g) {
    const Sample& sample = measured.samples[measured.groups[g].front()];
    if (!sample.stamp) return false;
    order.emplace_back(*sample.stamp, g);
  }
  std::sort(order.begin(), order.end());
  const auto is_among = [&](std::size_t k) { return std::find(poses.begin(), poses.end(), order[k].second) != poses.end(); };
  std::size_t late = 0, early = 0;
  while (late < order.size() && is_among(order.size() - 1 - late)) ++late;
  while (early < order.size() && is_among(early)) ++early;
  return late >= kFewest || early >= kFewest;
}

std::vector<std::size_t> explainedPoses(const Linearised& fitted, const Linearised& others) {
  const Whitening whitening(others.rows, others.components, noiseAsOf(fitted, others.components));
  const std::vector<double> squares = squaresOf(whitening, whitening.apply(others.rows.r));
  const WhiteResidual white = whiteResidual(fitted);
  const double usual = usualSquare(white.whitening, squaresOf(white.whitening, white.e));
  std::vector<std::size_t> explained;
  for (std::size_t g = 0; g < squares.size(); ++g) {
    if (isSeen(others.rows, others.rows.groups[g]) && !isWild(squares[g], whitening.size(g), usual, kWildAtLast)) explained.push_back(g);
  }
  return explained;
}

std::vector<double> rmsOfEach(const CaptureRows& rows) {
  const Eigen::VectorXd squares = rows.r.cwiseAbs2().cwiseProduct(squareWeights(rows));
  std::vector<double> rms(rows.observations.size());
  for (const ObservationRows& each : rows.observations) {
    const auto points = std::count(each.rows.valid.begin(), each.rows.valid.end(), true);
    rms[each.context.number] = points > 0 ? std::sqrt(squares.segment(each.begin, each.size).sum() / static_cast<double>(points)) : 0.0;
  }
  return rms;
}

}  // namespace poecal
