#include "diagnosis/wild_poses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

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

/// The shots of one pose, each with what it shares with the others.
class Shots {
 public:
  Shots(const CaptureRows& rows, const Whitening& whitening, const Eigen::VectorXd& residual, std::size_t g)
      : rows_(rows), group_(rows.groups[g]) {
    const int size = whitening.size(g), begin = whitening.begin(g);
    const Eigen::MatrixXd L = whitening.undo(g, Eigen::MatrixXd::Identity(size, size));
    C_ = L * L.transpose();
    r_ = residual.segment(begin, size);
    begin_ = begin;
  }

  /// Those that have to go until the rest belongs to the model; all where none is left.
  std::vector<std::size_t> wild(double usual, const Wild& wild) const {
    std::vector<std::size_t> kept = group_, gone;
    while (!kept.empty() && isAnyWild(kept, usual, wild)) {
      std::size_t worst = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < kept.size() && kept.size() > 1; ++i) {
        std::vector<std::size_t> others = kept;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        const MeanSquare rest = squareOf(others);
        if (rest.square / rest.size >= least) continue;
        least = rest.square / rest.size;
        worst = i;
      }
      gone.push_back(kept[worst]);
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(worst));
    }
    return gone;
  }

 private:
  struct MeanSquare {
    double square = 0.0;
    int size = 0;
  };

  /// Of some of the shots, whatever the others are.
  MeanSquare squareOf(const std::vector<std::size_t>& shots) const {
    std::vector<Eigen::Index> numbers;
    for (const std::size_t k : shots) {
      const ObservationRows& part = rows_.observations[k];
      for (int row = 0; row < part.size; ++row) numbers.push_back(part.begin - begin_ + row);
    }
    Eigen::LLT<Eigen::MatrixXd> llt;
    factorNoise(C_(numbers, numbers), llt);
    return {llt.matrixL().solve(r_(numbers).eval()).squaredNorm(), static_cast<int>(numbers.size())};
  }

  /// One wild shot is thinned out among many, so each is looked at by itself too.
  bool isAnyWild(const std::vector<std::size_t>& shots, double usual, const Wild& wild) const {
    const auto is_wild = [&](const MeanSquare& mean) { return isWild(mean.square, mean.size, usual, wild); };
    if (is_wild(squareOf(shots))) return true;
    return shots.size() > 1 && std::any_of(shots.begin(), shots.end(), [&](std::size_t k) { return is_wild(squareOf({k})); });
  }

  const CaptureRows& rows_;
  const std::vector<std::size_t>& group_;
  Eigen::MatrixXd C_;
  Eigen::VectorXd r_;
  int begin_ = 0;
};

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

std::vector<std::size_t> wildRows(const MeasuredCell& measured, const Linearised& linear, const Wild& wild) {
  const WhiteResidual white = whiteResidual(linear);
  const std::vector<double> squares = squaresOf(white.whitening, white.e);
  const double usual = usualSquare(white.whitening, squares);
  const Eigen::VectorXd residual = linear.residual();
  std::vector<std::size_t> poses, rows;
  for (std::size_t g = 0; g < squares.size(); ++g) {
    const Shots shots(linear.rows, white.whitening, residual, g);
    const std::vector<std::size_t> bad = shots.wild(usual, wild);
    if (bad.empty()) continue;
    poses.push_back(g);
    for (const std::size_t k : bad) rows.push_back(linear.rows.observations[k].context.number);
  }
  if (isRunInTime(measured, poses) || poses.size() > squares.size() / 3) return {};
  std::sort(rows.begin(), rows.end());
  return rows;
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
    if (isSeen(others.rows, others.rows.groups[g]) && !isWild(squares[g], whitening.size(g), usual, kSearch.wild_at_last))
      explained.push_back(g);
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
