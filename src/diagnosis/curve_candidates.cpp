#include "diagnosis/curve_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "diagnosis/thresholds.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

/// The range of a driver in the samples; nothing where it does not vary, or is not known of all.
std::optional<CurveRange> rangeOf(const Eigen::VectorXd& driver) {
  if (!driver.allFinite() || driver.size() == 0) return {};
  const CurveRange range{driver.minCoeff(), driver.maxCoeff()};
  if (!(range.high - range.low > 1e-12 * (1.0 + std::abs(range.low)))) return {};
  return range;
}

/// Waves grow smaller beyond `bend` a range, as smooth curves have it.
Eigen::VectorXd smooth(int waves_count, double typical, double bend) {
  return Eigen::VectorXd::NullaryExpr(waves_count,
                                      [=](Eigen::Index j) { return typical / (1.0 + std::pow(static_cast<double>(j + 1) / bend, 2)); });
}

/// A driver that a curve may follow, with its values and the number of waves that the samples resolve.
struct FollowedDriver {
  Driver driver;
  Eigen::VectorXd value;
  int waves = 0;
  double bend = 4.0;  ///< waves a range beyond which they are smaller
};

class Curves {
 public:
  Curves(const MeasuredCell& measured, const std::vector<SampleContext>& contexts, const std::optional<std::size_t>& ordered_by)
      : measured_(measured), contexts_(contexts) {
    if (ordered_by) {
      ordered_by_ = driver(fmt::format("q{}", *ordered_by + 1), kStampWaves);
    } else {
      common_.push_back(driver("stamp", kStampWaves));
      // What comes and goes many times.
      common_.push_back(driver("stamp", kSwayWaves));
      common_.back().bend = kSwayWaves;
    }
    common_.push_back(driver("temperature", kFewWaves));
    for (const std::string& column : measured.other_columns) common_.push_back(driver(column, kFewWaves));
  }

  std::vector<Candidate> all() {
    if (measured_.start.arm) addJoints();
    for (const FollowedDriver& driver : common_) {
      add({PlaceKind::kCameraMount}, driver);
      add({PlaceKind::kTargetMount}, driver);
    }
    if (ordered_by_) {
      add({PlaceKind::kCameraMount}, *ordered_by_);
      add({PlaceKind::kTargetMount}, *ordered_by_);
    }
    // Rows come at no even pace: by their order alone, what comes and goes with time does not.
    if (measured_.timed && !ordered_by_) {
      addSways(PlaceKind::kCameraMount);
      addSways(PlaceKind::kTargetMount);
    }
    if (measured_.start.camera) addLens();
    return std::move(candidates_);
  }

 private:
  static constexpr int kJointWaves = 14, kStampWaves = 14, kSwayWaves = 32, kFewWaves = 5, kOtherJointWaves = 6, kTorqueWaves = 8,
                       kLensOrders = 6, kFineWaves = 40;
  static constexpr double kTypical = 2e-4;  // [rad, m]

  FollowedDriver driver(const std::string& name, int count) const {
    FollowedDriver made{Driver(name), Eigen::VectorXd(static_cast<Eigen::Index>(contexts_.size())), count};
    for (std::size_t k = 0; k < contexts_.size(); ++k) made.value(static_cast<Eigen::Index>(k)) = driverValue(made.driver, contexts_[k]);
    return made;
  }

  void addJoints() {
    const std::size_t joints = measured_.start.arm->joints.size();
    for (std::size_t k = 0; k < joints; ++k) {
      for (std::size_t j = 0; j < joints; ++j) {
        const std::string reading = fmt::format("q{}", j + 1);
        add({PlaceKind::kJoint, k}, driver(reading, j == k ? kJointWaves : kOtherJointWaves));
        if (j != k) continue;
        // Teeth, steps and saws, which a few smooth waves do not follow.
        FollowedDriver fine = driver(reading, kFineWaves);
        fine.bend = kFineWaves;
        add({PlaceKind::kJoint, k}, fine);
      }
      add({PlaceKind::kJoint, k}, driver(fmt::format("tau{}", k + 1), kTorqueWaves));
      for (const FollowedDriver& each : common_) add({PlaceKind::kJoint, k}, each);
    }
  }

  void addLens() {
    Candidate candidate;
    candidate.curve = Curve{.place = {PlaceKind::kCameraLens}, .range = {}, .waves = 0, .orders = kLensOrders};
    candidate.place = candidate.curve->place;
    candidate.driver = Driver("pixel");
    std::vector<double> typical;
    for (const auto& [i, j] : pixelOrders(kLensOrders)) typical.insert(typical.end(), 2, 0.3 / (1.0 + std::pow((i + j) / 3.0, 2)));
    candidate.typical = Eigen::Map<Eigen::VectorXd>(typical.data(), static_cast<Eigen::Index>(typical.size()));
    push(std::move(candidate));
  }

  void add(const Place& place, const FollowedDriver& driver) {
    const std::optional<CurveRange> range = rangeOf(driver.value);
    // A curve that is not smooth anyway may be as fine as poses carry it, were they evenly spread.
    const int carried = static_cast<int>(contexts_.size()) / (driver.bend < driver.waves ? 5 : 2);
    const int count = std::min(driver.waves, carried);
    if (!range || count == 0) return;
    const bool joint = place.kind == PlaceKind::kJoint;
    Candidate candidate;
    candidate.curve = Curve{.place = place, .range = *range, .waves = count, .orders = 0};
    candidate.place = place;
    candidate.driver = driver.driver;
    if (joint) {
      candidate.typical = smooth(count, kTypical, driver.bend);
    } else {
      candidate.typical.resize(6 * count);
      for (int axis = 0; axis < 6; ++axis) {
        candidate.typical.segment(axis * count, count) = smooth(count, kTypical, driver.bend);
      }
    }
    push(std::move(candidate));
  }

  /// A mount that sways with time at one frequency, which a curve of many waves would follow at a much higher price.
  void addSways(PlaceKind mount) {
    constexpr double kLeast = 1.5, kStep = 0.5, kMost = 40.0;  // times over the capture; less often is a smooth curve
    constexpr double kPoses = 4.0;                             // for each time, or it is noise
    const FollowedDriver& stamp = common_.front();
    const std::optional<CurveRange> range = rangeOf(stamp.value);
    if (!range) return;
    std::vector<double> all;
    for (double f = kLeast; f <= std::min(kMost, static_cast<double>(contexts_.size()) / kPoses); f += kStep) all.push_back(f);
    for (const double f : all) {
      Candidate candidate;
      candidate.curve = Curve{.place = {mount}, .range = *range, .waves = 0, .orders = 0, .cycles = {f}};
      candidate.place = candidate.curve->place;
      candidate.driver = stamp.driver;
      candidate.typical = Eigen::VectorXd::Constant(12, kTypical);
      candidate.log_prior = -std::log(static_cast<double>(all.size()));
      push(std::move(candidate));
    }
  }

  void push(Candidate candidate) {
    candidate.name = kUnknownEffect;
    candidates_.push_back(std::move(candidate));
  }

  const MeasuredCell& measured_;
  const std::vector<SampleContext>& contexts_;
  std::vector<FollowedDriver> common_;
  std::optional<FollowedDriver> ordered_by_;  ///< in place of time
  std::vector<Candidate> candidates_;
};

}  // namespace

std::optional<std::size_t> orderingJoint(const std::vector<Sample>& samples) {
  constexpr double kInOrder = 0.98;
  std::vector<double> times;
  for (const Sample& sample : samples) times.push_back(sample.stamp.value_or(std::numeric_limits<double>::quiet_NaN()));
  if (times.empty() || std::any_of(times.begin(), times.end(), [](double t) { return std::isnan(t); })) return {};
  for (Eigen::Index k = 0; k < samples.front().q.size(); ++k) {
    std::vector<double> readings;
    for (const Sample& sample : samples) readings.push_back(sample.q(k));
    if (std::abs(rankCorrelation(readings, times)) > kInOrder) return static_cast<std::size_t>(k);
  }
  return {};
}

std::vector<Candidate> curveCandidates(const MeasuredCell& measured, const std::vector<SampleContext>& contexts,
                                       const std::optional<std::size_t>& ordered_by) {
  std::vector<Candidate> curves = Curves(measured, contexts, ordered_by).all();
  // Sways of a mount are one curve of many shapes.
  const double shares = std::accumulate(curves.begin(), curves.end(), 0.0,
                                        [](double sum, const Candidate& curve) { return sum + std::exp(curve.log_prior); });
  for (Candidate& curve : curves) curve.log_prior += std::log(kSearch.curve_share / shares);
  return curves;
}

}  // namespace poecal
