#include "diagnosis/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <fmt/format.h>

namespace poecal {
namespace {

constexpr int kHighestOrder = 200;  // teeth of a gear: strain waves and planets stay below
constexpr std::size_t kMostSlipTimes = 60;
// Shares of the explanations: named ones against curves of unknown shape; see selection.
constexpr double kNamedShare = 0.75, kCurveShare = 0.25;

/// Times between samples that follow each other, at most kMostSlipTimes of them, with a few samples on either side.
std::vector<double> slipTimes(const std::vector<Sample>& samples) {
  std::vector<double> stamps;
  for (const Sample& sample : samples) {
    if (sample.stamp) stamps.push_back(*sample.stamp);
  }
  std::sort(stamps.begin(), stamps.end());
  std::vector<double> between;
  constexpr std::size_t kLeast = 3;
  for (std::size_t k = kLeast; k + kLeast <= stamps.size(); ++k) {
    if (stamps[k] > stamps[k - 1]) between.push_back(0.5 * (stamps[k] + stamps[k - 1]));
  }
  if (between.size() <= kMostSlipTimes) return between;
  std::vector<double> some;
  for (std::size_t k = 0; k < kMostSlipTimes; ++k) some.push_back(between[k * (between.size() - 1) / (kMostSlipTimes - 1)]);
  return some;
}

/// Low orders are strain and eccentricity of gears; high ones their teeth, each alone unlikely.
std::vector<std::pair<double, double>> harmonicOrders() {
  constexpr int kLow = 6;
  std::vector<std::pair<double, double>> orders;
  for (int order = 2; order <= kHighestOrder; ++order) {
    orders.emplace_back(order, order <= kLow ? 0.5 / (kLow - 1) : 0.5 / (kHighestOrder - kLow));
  }
  return orders;
}

/// Values to try of an effect's scanned parameter, with their shares.
std::vector<std::pair<double, double>> scanned(const EffectParameter& parameter, const std::vector<Sample>& samples) {
  if (parameter.name == "order") return harmonicOrders();
  std::vector<std::pair<double, double>> values;
  const std::vector<double> times = slipTimes(samples);
  for (const double time : times) values.emplace_back(time, 1.0 / static_cast<double>(times.size()));
  return values;
}

/// Columns of what wrong masses leave out: 15 % of each mass and its moment, and a centimetre of its place, times the compliance; for each
/// way that the effect yields.
void addMassErrors(const Cell& cell, Candidate& candidate) {
  const Effect& effect = *candidate.effect;
  if (!effect.kind().yields_to_gravity || effect.byMasses()) return;
  constexpr double kMassError = 0.15, kPlaceError = 0.01;
  Cell weightless = cell;
  weightless.arm->links.clear();
  candidate.mass_errors =
      makeEffect({.effect = effect.name(), .location = effect.location(), .driver = effect.driver()}, weightless).effect;
  std::vector<double> typical(candidate.typical.begin(), candidate.typical.end());
  const std::size_t of_all = typical.size() + candidate.mass_errors->parameters().size();
  while (typical.size() < of_all) {
    for (std::size_t body = effect.index(); body < cell.arm->links.size(); ++body) {
      const LinkMass& link = cell.arm->links[body];
      typical.push_back(candidate.typical(0) * kMassError * link.mass);
      for (int axis = 0; axis < 3; ++axis) {
        typical.push_back(candidate.typical(0) * link.mass * std::hypot(kMassError * link.com(axis), kPlaceError));
      }
    }
    typical.push_back(candidate.typical(0) * kMassError);  // of the payload
  }
  candidate.typical = Eigen::Map<Eigen::VectorXd>(typical.data(), static_cast<Eigen::Index>(typical.size()));
}

bool isRandom(const Effect& effect) { return effect.kind().add_derivative == nullptr; }

void addNamed(const CaptureContext& capture, const Effect& effect, double share, const std::vector<Sample>& samples,
              std::vector<Candidate>& candidates) {
  Candidate candidate;
  candidate.effect = effect;
  candidate.name = effect.name();
  candidate.location = effect.location();
  candidate.driver = effect.driver();
  candidate.parameters = effect.start();
  std::optional<Eigen::Index> scan;
  std::vector<double> typical;
  for (std::size_t i = 0; i < effect.parameters().size(); ++i) {
    const EffectParameter& parameter = effect.parameters()[i];
    if (parameter.role == ParameterRole::kScanned) scan = static_cast<Eigen::Index>(i);
    // Another capture begins elsewhere: what was found here keeps this one's reference.
    if (parameter.name == "reference") {
      candidate.parameters(static_cast<Eigen::Index>(i)) =
          effect.driver() == "temperature" ? capture.first_temperature : capture.first_stamp;
    }
    if (parameter.role != ParameterRole::kLinear) continue;
    candidate.linear.push_back(static_cast<Eigen::Index>(i));
    typical.push_back(parameter.typical);
  }
  candidate.typical = Eigen::Map<Eigen::VectorXd>(typical.data(), static_cast<Eigen::Index>(typical.size()));
  candidate.log_prior = std::log(share);
  addMassErrors(capture.cell, candidate);
  if (!scan) {
    candidates.push_back(std::move(candidate));
    return;
  }
  for (const auto& [value, part] : scanned(effect.parameters()[static_cast<std::size_t>(*scan)], samples)) {
    candidate.parameters(*scan) = value;
    candidate.log_prior = std::log(share * part);
    candidates.push_back(candidate);
  }
}

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

/// The drivers that a curve may follow, with the number of waves that the samples resolve.
struct Driver {
  std::string name;
  Eigen::VectorXd value;
  int waves = 0;
  double bend = 4.0;  ///< waves a range beyond which they are smaller
};

class Curves {
 public:
  Curves(const MeasuredCell& measured, const std::vector<SampleContext>& contexts) : measured_(measured), contexts_(contexts) {
    common_.push_back(driver("stamp", kStampWaves));
    common_.push_back(driver("temperature", kFewWaves));
    for (const std::string& column : measured.other_columns) common_.push_back(driver(column, kFewWaves));
  }

  std::vector<Candidate> all() {
    if (measured_.start.arm) addJoints();
    for (const Driver& driver : common_) {
      add(PlaceKind::kCameraMount, 0, driver);
      add(PlaceKind::kTargetMount, 0, driver);
    }
    if (measured_.start.camera) addLens();
    return std::move(candidates_);
  }

 private:
  static constexpr int kJointWaves = 14, kStampWaves = 14, kFewWaves = 5, kOtherJointWaves = 6, kTorqueWaves = 8, kLensOrders = 6,
                       kFineWaves = 40;

  Driver driver(const std::string& name, int count) const {
    Driver made{name, Eigen::VectorXd(static_cast<Eigen::Index>(contexts_.size())), count};
    for (std::size_t k = 0; k < contexts_.size(); ++k) made.value(static_cast<Eigen::Index>(k)) = driverValue(name, contexts_[k]);
    return made;
  }

  void addJoints() {
    const std::size_t joints = measured_.start.arm->joints.size();
    for (std::size_t k = 0; k < joints; ++k) {
      for (std::size_t j = 0; j < joints; ++j) {
        const std::string reading = fmt::format("q{}", j + 1);
        add(PlaceKind::kJoint, k, driver(reading, j == k ? kJointWaves : kOtherJointWaves));
        if (j != k) continue;
        // Teeth, steps and saws, which a few smooth waves do not follow.
        Driver fine = driver(reading, kFineWaves);
        fine.bend = kFineWaves;
        add(PlaceKind::kJoint, k, fine);
      }
      add(PlaceKind::kJoint, k, driver(fmt::format("tau{}", k + 1), kTorqueWaves));
      for (const Driver& each : common_) add(PlaceKind::kJoint, k, each);
    }
  }

  void addLens() {
    Candidate candidate;
    candidate.curve = Curve{.place = PlaceKind::kCameraLens, .index = 0, .range = {}, .waves = 0, .orders = kLensOrders};
    candidate.location = placeName(PlaceKind::kCameraLens);
    candidate.driver = "pixel";
    std::vector<double> typical;
    for (const auto& [i, j] : pixelOrders(kLensOrders)) typical.insert(typical.end(), 2, 0.3 / (1.0 + std::pow((i + j) / 3.0, 2)));
    candidate.typical = Eigen::Map<Eigen::VectorXd>(typical.data(), static_cast<Eigen::Index>(typical.size()));
    push(std::move(candidate));
  }

  void add(PlaceKind place, std::size_t index, const Driver& driver) {
    constexpr double kTypicalRadian = 2e-4, kTypicalMetre = 2e-4;
    const std::optional<CurveRange> range = rangeOf(driver.value);
    const int count = std::min(driver.waves, static_cast<int>(contexts_.size()) / 5);
    if (!range || count == 0) return;
    const bool joint = place == PlaceKind::kJoint;
    Candidate candidate;
    candidate.curve = Curve{.place = place, .index = index, .range = *range, .waves = count, .orders = 0};
    candidate.location = joint ? fmt::format("{}:{}", placeName(place), index + 1) : placeName(place);
    candidate.driver = driver.name;
    if (joint) {
      candidate.typical = smooth(count, kTypicalRadian, driver.bend);
    } else {
      candidate.typical.resize(6 * count);
      for (int axis = 0; axis < 6; ++axis)
        candidate.typical.segment(axis * count, count) = smooth(count, axis < 3 ? kTypicalRadian : kTypicalMetre, driver.bend);
    }
    push(std::move(candidate));
  }

  void push(Candidate candidate) {
    candidate.name = "unknown";
    candidates_.push_back(std::move(candidate));
  }

  const MeasuredCell& measured_;
  const std::vector<SampleContext>& contexts_;
  std::vector<Driver> common_;
  std::vector<Candidate> candidates_;
};

void clear(Disturbance& disturbance) {
  disturbance.joints.setZero();
  for (Vector6d& link : disturbance.links) link.setZero();
  disturbance.base.setZero();
  disturbance.mount.setZero();
  disturbance.grip.setZero();
  disturbance.intrinsics.setZero();
  for (Eigen::Vector3d& point : disturbance.points) point.setZero();
  for (Eigen::Vector2d& pixel : disturbance.pixels) pixel.setZero();
}

Eigen::MatrixXd effectColumns(const Candidate& candidate, const CaptureRows& rows) {
  Eigen::MatrixXd columns(rows.size(), candidate.typical.size());
  const Eigen::VectorXd no_masses = candidate.mass_errors ? candidate.mass_errors->start() : Eigen::VectorXd();
  for (const ObservationRows& part : rows.observations) {
    Disturbance direction = Disturbance::zero(part.context.capture->cell, part.context.points.size());
    Eigen::Index column = 0;
    const auto add = [&](const Effect& effect, Eigen::Index i, const Eigen::VectorXd& parameters) {
      effect.addDerivative(i, parameters, part.context, 1.0, direction);
      columns.block(part.begin, column++, part.size, 1) = part.along(direction);
      clear(direction);
    };
    for (const Eigen::Index i : candidate.linear) add(*candidate.effect, i, candidate.parameters);
    for (Eigen::Index i = 0; i < no_masses.size(); ++i) add(*candidate.mass_errors, i, no_masses);
  }
  return columns;
}

Eigen::MatrixXd lensColumns(const Curve& curve, Eigen::Index count, const CaptureRows& rows) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows.size(), count);
  for (const ObservationRows& part : rows.observations) {
    const Camera& camera = *part.context.capture->cell.camera;
    for (std::size_t point = 0; point < part.context.points.size(); ++point) {
      const Eigen::Vector2d px = part.context.points[point].px;
      if (!px.allFinite()) continue;
      const Eigen::RowVectorXd waves = pixelWaves(px, camera, curve.orders) / part.unit_sigma[point];
      const auto row = part.begin + 2 * static_cast<Eigen::Index>(point);
      for (Eigen::Index k = 0; k < waves.size(); ++k) columns(row, 2 * k) = columns(row + 1, 2 * k + 1) = waves(k);
    }
  }
  return columns;
}

Eigen::MatrixXd curveColumns(const Candidate& candidate, const CaptureRows& rows) {
  const Curve& curve = *candidate.curve;
  if (curve.place == PlaceKind::kCameraLens) return lensColumns(curve, candidate.typical.size(), rows);
  const Eigen::Index count = curve.waves;
  Eigen::MatrixXd columns(rows.size(), candidate.typical.size());
  for (const ObservationRows& part : rows.observations) {
    const Eigen::RowVectorXd waves = curve.range.waves(driverValue(candidate.driver, part.context), count);
    const auto block = [&](const Eigen::MatrixXd& ports) {
      const Eigen::MatrixXd moved = part.rows.H * ports;
      for (Eigen::Index axis = 0; axis < moved.cols(); ++axis) {
        columns.block(part.begin, axis * count, part.size, count) = moved.col(axis) * waves;
      }
    };
    if (curve.place == PlaceKind::kJoint) block(part.ports.joints.col(static_cast<Eigen::Index>(curve.index)));
    if (curve.place == PlaceKind::kCameraMount) block(part.ports.mount);
    if (curve.place == PlaceKind::kTargetMount) block(part.ports.grip);
  }
  return columns;
}

}  // namespace

CandidateList allCandidates(const MeasuredCell& measured, const ModelState& state) {
  CandidateList list;
  const auto capture = makeCaptureContext(state.cell.cell, measured.target, measured.gravity, measured.samples, measured.other_columns);
  std::vector<SampleContext> contexts;
  for (std::size_t k = 0; k < measured.samples.size(); ++k) contexts.push_back(makeSampleContext(capture, measured.samples[k], k, {}));
  const Candidates named = candidateEffects(state.cell.cell, measured.target, measured.samples);
  list.not_testable = named.not_testable;
  std::set<std::string> kinds;
  std::map<std::string, int> instances;
  for (const Effect& effect : named.effects) {
    if (isRandom(effect)) continue;
    kinds.insert(effect.name());
    ++instances[effect.name()];
  }
  for (const Effect& effect : named.effects) {
    if (isRandom(effect)) continue;
    addNamed(*capture, effect, kNamedShare / static_cast<double>(kinds.size()) / instances[effect.name()], measured.samples,
             list.candidates);
  }
  std::vector<Candidate> curves = Curves(measured, contexts).all();
  for (Candidate& curve : curves) {
    curve.log_prior = std::log(kCurveShare / static_cast<double>(curves.size()));
    list.candidates.push_back(std::move(curve));
  }
  return list;
}

Eigen::MatrixXd columnsOf(const Candidate& candidate, const CaptureRows& rows) {
  return candidate.known() ? effectColumns(candidate, rows) : curveColumns(candidate, rows);
}

}  // namespace poecal
