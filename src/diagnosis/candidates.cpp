#include "diagnosis/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "diagnosis/curve_candidates.hpp"
#include "diagnosis/mass_belief.hpp"
#include "diagnosis/thresholds.hpp"
#include "effects/mass_layout.hpp"

namespace poecal {
namespace {

constexpr int kHighestOrder = 200;           // teeth of a gear: strain waves and planets stay below
constexpr std::size_t kMostSlipTimes = 100;  // a large one shows only where all rows are on their side

/// Between two samples that follow each other.
struct Pause {
  double begin = 0.0, end = 0.0;
  double middle() const { return 0.5 * (begin + end); }
};

/// Those with as many samples on either side as the slip has numbers, and a few at least: with fewer it is not told from rows that are
/// wrong.
std::vector<Pause> slipTimes(const std::vector<Sample>& samples, std::size_t numbers) {
  std::vector<double> stamps;
  for (const Sample& sample : samples) {
    if (sample.stamp) stamps.push_back(*sample.stamp);
  }
  std::sort(stamps.begin(), stamps.end());
  std::vector<Pause> between;
  const std::size_t least = std::max<std::size_t>(3, numbers);
  for (std::size_t k = least; k + least <= stamps.size(); ++k) {
    if (stamps[k] > stamps[k - 1]) between.push_back({stamps[k - 1], stamps[k]});
  }
  return between;
}

/// Numbers of the pauses that are tried: all, or those in which kMostSlipTimes times lie that are evenly apart. A slip happens at any time,
/// so seldom between shots that follow each other at once.
std::vector<std::size_t> triedTimes(const std::vector<Pause>& pauses) {
  std::vector<std::size_t> tried;
  if (pauses.size() <= kMostSlipTimes) {
    tried.resize(pauses.size());
    std::iota(tried.begin(), tried.end(), 0);
    return tried;
  }
  const double begin = pauses.front().begin, apart = (pauses.back().end - begin) / static_cast<double>(kMostSlipTimes);
  for (std::size_t k = 0, i = 0; i < kMostSlipTimes; ++i) {
    const double mark = begin + (static_cast<double>(i) + 0.5) * apart;
    while (k + 1 < pauses.size() && pauses[k].end <= mark) ++k;
    if (tried.empty() || tried.back() != k) tried.push_back(k);
  }
  return tried;
}

/// The parameter that is scanned; nothing where none is.
std::optional<std::size_t> scannedParameter(const Effect& effect) {
  for (std::size_t i = 0; i < effect.parameters().size(); ++i) {
    if (isScanned(effect.parameters()[i].role)) return i;
  }
  return {};
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
/// @param numbers  linear parameters beside it.
std::vector<std::pair<double, double>> scanned(const EffectParameter& parameter, std::size_t numbers, const std::vector<Sample>& samples) {
  if (parameter.role == ParameterRole::kOrder) return harmonicOrders();
  std::vector<std::pair<double, double>> values;
  const std::vector<Pause> pauses = slipTimes(samples, numbers);
  const std::vector<std::size_t> tried = triedTimes(pauses);
  for (const std::size_t k : tried) values.emplace_back(pauses[k].middle(), 1.0 / static_cast<double>(tried.size()));
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
      makeEffect({.effect = effect.name(), .location = effect.location(), .driver = effect.driver().name()}, weightless).effect;
  const MassLayout layout(effect.index(), cell.arm->links.size());
  const Eigen::Index own = candidate.typical.size();
  candidate.typical.conservativeResize(own + static_cast<Eigen::Index>(candidate.mass_errors->parameters().size()));
  for (Eigen::Index i = 0; own + i < candidate.typical.size(); ++i) {
    const MassTerm term = layout[i];
    double missing = kMassError;  // of the payload
    if (!layout.isPayload(term)) {
      const LinkMass& link = cell.arm->links[term.body];
      missing = link.mass * (term.part == 0 ? kMassError : std::hypot(kMassError * link.com(term.part - 1), kPlaceError));
    }
    candidate.typical(own + i) = candidate.typical(0) * missing;
  }
}

bool isRandom(const Effect& effect) { return effect.kind().add_derivative == nullptr; }

void addNamed(const CaptureContext& capture, const Effect& effect, double share, const std::vector<Sample>& samples,
              std::vector<Candidate>& candidates) {
  Candidate candidate;
  candidate.effect = effect;
  candidate.name = effect.name();
  candidate.place = effect.place();
  candidate.driver = effect.driver();
  candidate.parameters = effect.start();
  std::vector<double> typical;
  for (std::size_t i = 0; i < effect.parameters().size(); ++i) {
    const EffectParameter& parameter = effect.parameters()[i];
    // Another capture begins elsewhere: what was found here keeps this one's reference.
    if (parameter.role == ParameterRole::kReference) {
      candidate.parameters(static_cast<Eigen::Index>(i)) =
          effect.driver().kind() == DriverKind::kTemperature ? capture.first_temperature : capture.first_stamp;
    }
    if (parameter.role != ParameterRole::kLinear) continue;
    candidate.linear.push_back(static_cast<Eigen::Index>(i));
    typical.push_back(parameter.typical);
  }
  candidate.typical = Eigen::Map<Eigen::VectorXd>(typical.data(), static_cast<Eigen::Index>(typical.size()));
  candidate.log_prior = std::log(share);
  addMassErrors(capture.cell, candidate);
  const std::optional<std::size_t> scan = scannedParameter(effect);
  if (effect.byMasses()) {
    // Masses as arms have them; or, since springs and counterweights carry some of them, any that gravity could have. Both are weighed, as
    // two ways to one answer.
    candidate.log_prior -= std::numbers::ln2;
    candidates.push_back(candidate);
    believeMasses(capture.cell, candidate);
  }
  if (!scan) {
    candidates.push_back(std::move(candidate));
    return;
  }
  for (const auto& [value, part] : scanned(effect.parameters()[*scan], candidate.linear.size(), samples)) {
    candidate.parameters(static_cast<Eigen::Index>(*scan)) = value;
    candidate.log_prior = std::log(share * part);
    candidates.push_back(candidate);
  }
}

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

/// Numbers of an action in one observation.
Eigen::Index actionSize(const Entry& entry, const ObservationRows& part) {
  constexpr Eigen::Index kPoseSize = 6;
  if (entry.reach == Reach::kJoint) return 1;
  return entry.reach == Reach::kPose ? kPoseSize : part.size;
}

/// Actions of an effect, one observation after the other.
class EffectActions {
 public:
  explicit EffectActions(const Candidate& candidate) : candidate_(candidate), entry_(candidate.entry()) {}

  void of(const ObservationRows& part, Eigen::Ref<Eigen::MatrixXd> action) {
    const std::size_t points = entry_.reach == Reach::kPicture ? part.context.points.size() : 0;
    if (direction_.joints.size() == 0 || direction_.points.size() != points) {
      direction_ = Disturbance::zero(part.context.capture->cell, points);
    }
    Eigen::Index column = 0;
    for (const Eigen::Index i : candidate_.linear) add(*candidate_.effect, i, candidate_.parameters, part, action.col(column++));
    if (candidate_.to_parameters.size() > 0) action = (action * candidate_.to_parameters).eval();
    if (!candidate_.mass_errors) return;
    const Eigen::VectorXd& none = candidate_.mass_errors->start();
    for (Eigen::Index i = 0; i < none.size(); ++i) add(*candidate_.mass_errors, i, none, part, action.col(column++));
  }

 private:
  void add(const Effect& effect, Eigen::Index i, const Eigen::VectorXd& parameters, const ObservationRows& part,
           Eigen::Ref<Eigen::VectorXd> action) {
    effect.addDerivative(i, parameters, part.context, 1.0, direction_);
    if (entry_.reach == Reach::kJoint) {
      action(0) = std::exchange(direction_.joints(static_cast<Eigen::Index>(entry_.joint)), 0.0);
      return;
    }
    action = entry_.reach == Reach::kPose ? Eigen::VectorXd(part.ports.along(direction_)) : part.along(direction_);
    clear(direction_);
  }

  const Candidate& candidate_;
  Entry entry_;
  Disturbance direction_;
};

void lensAction(const Curve& curve, const ObservationRows& part, Eigen::Ref<Eigen::MatrixXd> action) {
  const Camera& camera = *part.context.capture->cell.camera;
  action.setZero();
  for (std::size_t point = 0; point < part.context.points.size(); ++point) {
    const Eigen::Vector2d px = part.context.points[point].px;
    if (!px.allFinite()) continue;
    const Eigen::RowVectorXd waves = pixelWaves(px, camera, curve.orders) / part.unit_sigma[point];
    const auto row = 2 * static_cast<Eigen::Index>(point);
    for (Eigen::Index k = 0; k < waves.size(); ++k) action(row, 2 * k) = action(row + 1, 2 * k + 1) = waves(k);
  }
}

void curveAction(const Candidate& candidate, const ObservationRows& part, Eigen::Ref<Eigen::MatrixXd> action) {
  const Curve& curve = *candidate.curve;
  if (curve.place.kind == PlaceKind::kCameraLens) {
    lensAction(curve, part, action);
    return;
  }
  if (!curve.terms.empty()) {
    for (std::size_t i = 0; i < curve.terms.size(); ++i) {
      const double phase = phaseOf(curve.terms[i], part.context.sample.q);
      action.middleCols<2>(2 * static_cast<Eigen::Index>(i)) << std::cos(phase), std::sin(phase);
    }
    return;
  }
  const double driver = driverValue(candidate.driver, part.context);
  const Eigen::RowVectorXd waves = curve.cycles.empty() ? curve.range.waves(driver, curve.waves) : curve.range.sways(driver, curve.cycles);
  if (curve.place.kind == PlaceKind::kJoint) {
    action = waves;
    return;
  }
  const Matrix6d& port = curve.place.kind == PlaceKind::kCameraMount ? part.ports.mount : part.ports.grip;
  for (Eigen::Index axis = 0; axis < port.cols(); ++axis) action.middleCols(axis * waves.cols(), waves.cols()) = port.col(axis) * waves;
}

bool showsReference(const MeasuredCell& measured) {
  return measured.start.registration.setup == Setup::kEyeToHand &&
         std::any_of(measured.observations.begin(), measured.observations.end(),
                     [](const Observation& observation) { return !observation.reference.empty(); });
}

/// Beside each candidate at the camera's mount, which may be the base that moved, the same with the reference moving too.
void addCameraMoves(std::vector<Candidate>& candidates) {
  const std::size_t count = candidates.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (candidates[i].place.kind != PlaceKind::kCameraMount || candidates[i].entry().reach != Reach::kPose) continue;
    candidates[i].log_prior -= std::numbers::ln2;
    candidates.push_back(candidates[i]);
    candidates.back().moves_reference = true;
  }
}

}  // namespace

CandidateList allCandidates(const MeasuredCell& measured, const ModelState& state) {
  CandidateList list;
  const auto capture = makeCaptureContext(state.cell.cell, measured.target, measured.gravity, measured.samples, measured.other_columns);
  std::vector<SampleContext> contexts;
  for (std::size_t k = 0; k < measured.samples.size(); ++k) contexts.push_back(makeSampleContext(capture, measured.samples[k], k, {}));
  const Candidates named = candidateEffects(state.cell.cell, measured.target, measured.samples);
  list.not_testable = named.not_testable;
  list.ordered_by = orderingJoint(measured.samples);
  const auto is_left_out = [&](const Effect& effect) {
    return isRandom(effect) || (list.ordered_by && !measured.timed && effect.driver().kind() == DriverKind::kStamp);
  };
  std::set<std::string> kinds;
  std::map<std::string, int> instances;
  for (const Effect& effect : named.effects) {
    if (is_left_out(effect)) continue;
    kinds.insert(effect.name());
    ++instances[effect.name()];
  }
  for (const Effect& effect : named.effects) {
    if (is_left_out(effect)) {
      if (isRandom(effect)) continue;
      list.not_testable.push_back(
          {effect.name(), effect.location(),
           fmt::format("no stamp column to tell time from q{}, which the rows go through in order", *list.ordered_by + 1)});
      continue;
    }
    addNamed(*capture, effect, kSearch.named_share / static_cast<double>(kinds.size()) / instances[effect.name()], measured.samples,
             list.candidates);
  }
  for (Candidate& curve : curveCandidates(measured, contexts, list.ordered_by)) list.candidates.push_back(std::move(curve));
  if (showsReference(measured)) addCameraMoves(list.candidates);
  return list;
}

std::optional<Eigen::Index> Candidate::slipTime() const {
  const std::optional<std::size_t> scan = known() ? scannedParameter(*effect) : std::nullopt;
  if (!scan || effect->parameters()[*scan].role != ParameterRole::kTime) return {};
  return static_cast<Eigen::Index>(*scan);
}

Eigen::VectorXd Candidate::linearParameters(const Eigen::VectorXd& factors) const {
  if (to_parameters.size() > 0) return to_parameters * factors;
  return factors.head(static_cast<Eigen::Index>(linear.size()));
}

bool Candidate::isPositive() const { return known() && effect->kind().yields_to_gravity && !effect->byMasses(); }

std::vector<Candidate> untriedTimes(const Candidate& slip, const std::vector<Sample>& samples) {
  const std::optional<Eigen::Index> time = slip.slipTime();
  if (!time) return {};
  const std::vector<Pause> pauses = slipTimes(samples, slip.linear.size());
  const std::vector<std::size_t> tried = triedTimes(pauses);
  const auto at = std::find_if(tried.begin(), tried.end(), [&](std::size_t k) { return pauses[k].middle() == slip.parameters(*time); });
  if (at == tried.end()) return {};
  const std::size_t low = at == tried.begin() ? *at : *(at - 1) + 1, high = at + 1 == tried.end() ? *at + 1 : *(at + 1);
  std::vector<Candidate> all;
  for (std::size_t k = low; k < high; ++k) {
    if (k == *at) continue;
    all.push_back(slip);
    all.back().parameters(*time) = pauses[k].middle();
  }
  return all;
}

Eigen::VectorXd Candidate::spread(double scale, const Eigen::VectorXd& found) const {
  Eigen::VectorXd sigma = scale * typical;
  if (!mass_errors) return sigma;
  constexpr double kLeast = 0.01;
  const Eigen::Index of_each = (typical.size() - own()) / own();
  for (Eigen::Index way = 0; way < own(); ++way) {
    const double times = std::clamp(found(way) / typical(way), kLeast * scale, scale);
    sigma.segment(own() + way * of_each, of_each) = times * typical.segment(own() + way * of_each, of_each);
  }
  return sigma;
}

Entry Candidate::entry() const {
  if (known()) {
    const Reach reach = effect->kind().reach;
    return {reach, reach == Reach::kJoint ? effect->index() : 0};
  }
  if (curve->place.kind == PlaceKind::kJoint) return {Reach::kJoint, curve->place.index};
  return {curve->place.kind == PlaceKind::kCameraLens ? Reach::kPicture : Reach::kPose, 0};
}

Eigen::MatrixXd entryColumns(const Entry& entry, const ObservationRows& part) {
  if (entry.reach == Reach::kJoint) return part.rows.H * part.ports.joints.col(static_cast<Eigen::Index>(entry.joint));
  return part.rows.H;
}

Eigen::MatrixXd actionsOf(const Candidate& candidate, const CaptureRows& rows, std::size_t begin, std::size_t end) {
  const Entry entry = candidate.entry();
  Eigen::Index height = 0;
  for (std::size_t k = begin; k < end; ++k) height += actionSize(entry, rows.observations[k]);
  Eigen::MatrixXd actions(height, candidate.typical.size());
  EffectActions effect(candidate);
  Eigen::Index row = 0;
  for (std::size_t k = begin; k < end; ++k) {
    const ObservationRows& part = rows.observations[k];
    auto action = actions.middleRows(row, actionSize(entry, part));
    if (candidate.known()) {
      effect.of(part, action);
    } else {
      curveAction(candidate, part, action);
    }
    row += action.rows();
  }
  return actions;
}

Eigen::MatrixXd columnsOf(const Candidate& candidate, const CaptureRows& rows) {
  const Entry entry = candidate.entry();
  const Eigen::MatrixXd actions = actionsOf(candidate, rows, 0, rows.observations.size());
  if (entry.reach == Reach::kPicture) return actions;
  Eigen::MatrixXd columns(rows.size(), actions.cols());
  Eigen::Index row = 0;
  for (const ObservationRows& part : rows.observations) {
    const Eigen::Index size = actionSize(entry, part);
    columns.middleRows(part.begin, part.size).noalias() = entryColumns(entry, part) * actions.middleRows(row, size);
    row += size;
  }
  return columns;
}

}  // namespace poecal
