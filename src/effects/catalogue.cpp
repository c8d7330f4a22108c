#include "poecal/effects/catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "effects/curve.hpp"
#include "effects/kinds.hpp"
#include "effects/mass_layout.hpp"
#include "poecal/core/choices.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"

namespace poecal {
namespace {

std::size_t jointCount(const Cell& cell) { return cell.arm ? cell.arm->joints.size() : 0; }

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

/// "qK" -> "q3", "qJ" -> "q5" for the joint that leaks.
std::string driverName(const std::string& pattern, std::size_t index, const std::map<std::string, double>& parameters) {
  const auto source = parameters.find("source");
  const std::string named = replaced(pattern, "K", std::to_string(index + 1));
  return source == parameters.end() ? named : replaced(named, "J", std::to_string(static_cast<long>(source->second)));
}

/// Index of the place that `location` names. @throws InvalidArgument.
std::size_t placeIndex(const EffectKind& kind, const std::string& location, const Cell& cell) {
  const std::optional<Place> place = Place::of(location);
  if (place && place->kind == kind.place && (!isNumbered(kind.place) || place->index < jointCount(cell))) return place->index;
  const std::string name = placeName(kind.place);
  if (!isNumbered(kind.place)) throw InvalidArgument(fmt::format("{} cannot be at '{}', expected {}", kind.name, location, name));
  throw InvalidArgument(fmt::format("{0} cannot be at '{1}', expected {2}:1 to {2}:{3}", kind.name, location, name, jointCount(cell)));
}

/// @throws InvalidArgument where the kind has no such driver.
Driver chosenDriver(const EffectKind& kind, const EffectSpec& spec, std::size_t index) {
  if (kind.drivers.empty()) {
    if (spec.driver.empty()) throw InvalidArgument(fmt::format("{} needs its driver", kind.name));
    return Driver(spec.driver);
  }
  std::vector<std::string> known;
  for (const std::string& pattern : kind.drivers) known.push_back(driverName(pattern, index, spec.parameters));
  if (spec.driver.empty()) return Driver(known.front());
  if (std::find(known.begin(), known.end(), spec.driver) == known.end()) {
    throw InvalidArgument(fmt::format("{} is not driven by '{}', expected {}", kind.name, spec.driver, fmt::join(known, " or ")));
  }
  return Driver(spec.driver);
}

/// @throws InvalidArgument: no such kind, or `unknown` where no curve can be.
const EffectKind& kindOf(const EffectSpec& spec) {
  if (spec.effect != kUnknownEffect) return effectKind(spec.effect);
  const std::optional<Place> place = Place::of(spec.location);
  const EffectKind* kind = place ? kinds::unknownAt(place->kind) : nullptr;
  if (kind != nullptr) return *kind;
  throw InvalidArgument(
      fmt::format("unknown cannot be at '{}', expected joint:K, camera.mount, target.mount or camera.lens", spec.location));
}

/// @throws InvalidArgument unless the fixed numbers name a joint, and not its own.
void checkSource(const EffectKind& kind, const EffectSpec& spec, std::size_t index, const Cell& cell) {
  const std::optional<std::size_t> number_of_joint = kind.parameterOf(ParameterRole::kSource);
  if (!number_of_joint) return;
  const auto source = spec.parameters.find(kind.parameters[*number_of_joint].name);
  if (source == spec.parameters.end()) return;
  const double number = source->second;
  if (number != std::floor(number) || number < 1.0 || number > static_cast<double>(jointCount(cell)) ||
      number == static_cast<double>(index + 1)) {
    throw InvalidArgument(fmt::format("{}: source is {}, expected the number of another joint", kind.name, formatNumber(number)));
  }
}

/// The kinds state units of a turning joint, and "/t" and "t" for whatever their driver measures.
std::string unitAt(const std::string& unit, const Driver& driver, bool slides) {
  const bool warms = driver.kind() == DriverKind::kTemperature;
  if (unit == "t") return warms ? "degC" : "s";
  const std::string timed = replaced(unit, "/t", warms ? "/K" : "/h");
  if (!slides) return timed;
  return timed.starts_with("rad/(N m)") ? replaced(timed, "rad/(N m)", "m/N") : replaced(timed, "rad", "m");
}

/// The kinds state sizes per hour: machines warm by some ten kelvin in it.
double typicalAt(const EffectParameter& parameter, const Driver& driver) {
  constexpr double kKelvinPerHour = 10.0;
  return parameter.unit.ends_with("/t") && driver.kind() == DriverKind::kTemperature ? parameter.typical / kKelvinPerHour
                                                                                     : parameter.typical;
}

/// Compliance times the masses of every body that the place carries, and the compliance as a payload shows it; see Effect::byMasses. Where
/// a kind yields in two ways (compliance and difference), all of them for each way.
std::vector<EffectParameter> massParameters(const EffectKind& kind, std::size_t index, const Arm& arm) {
  constexpr double kTypicalMass = 5.0;    // [kg]
  constexpr double kTypicalMoment = 1.5;  // [kg m]
  const EffectParameter& compliance = kind.parameters.front();
  const char* const ways[] = {kind.parameters.size() > 1 ? "_a" : "", "_b"};
  const MassLayout layout(index, arm.joints.size());
  std::vector<EffectParameter> parameters;
  for (Eigen::Index i = 0; i < layout.perWay() * static_cast<Eigen::Index>(kind.parameters.size()); ++i) {
    const MassTerm term = layout[i];
    const char* const way = ways[term.way];
    if (layout.isPayload(term)) {
      parameters.push_back({fmt::format("payload{}", way), compliance.unit, compliance.typical});
    } else if (term.part == 0) {
      parameters.push_back({fmt::format("m{}{}", term.body + 1, way), compliance.unit + " kg", kTypicalMass * compliance.typical});
    } else {
      parameters.push_back({fmt::format("m{}{}{}", "xyz"[term.part - 1], term.body + 1, way), compliance.unit + " kg m",
                            kTypicalMoment * compliance.typical});
    }
  }
  return parameters;
}

bool haveAll(const std::vector<Sample>& samples, bool (*has)(const Sample&)) { return std::all_of(samples.begin(), samples.end(), has); }

/// What is missing for a need, or empty.
std::string whatIsMissing(Need need, const Effect& effect, const Cell& cell, const Target& target, const std::vector<Sample>& samples) {
  switch (need) {
    case Need::kJoints:
      return cell.arm && haveAll(samples, [](const Sample& s) { return s.q.size() > 0; }) ? "" : "no q1.. columns";
    case Need::kDir:
      return haveAll(samples, [](const Sample& s) { return s.dir.size() > 0; }) ? "" : "no dir1.. columns";
    case Need::kDq:
      return haveAll(samples, [](const Sample& s) { return s.dq.size() > 0; }) ? "" : "no dq1.. columns";
    case Need::kStamp:
      return haveAll(samples, [](const Sample& s) { return s.stamp.has_value(); }) ? "" : "no stamp column";
    case Need::kTemperature:
      return haveAll(samples, [](const Sample& s) { return s.temperature.has_value(); }) ? "" : "no temperature column";
    case Need::kRevolute:
      return cell.arm && cell.arm->joints[effect.index()].type == JointType::kRevolute ? "" : "the joint does not turn";
    case Need::kMasses:
      return cell.arm && !cell.arm->links.empty() ? "" : "no masses of the links";
    case Need::kTags:
      return target.hasTags() ? "" : "no tags";
    case Need::kSeveralTags: {
      std::set<int> ids;
      for (const TargetPoint& point : target.points) ids.insert(point.id.tag);
      return ids.size() > 1 ? "" : "only one tag";
    }
    case Need::kTangential:
      return cell.camera && cell.camera->model == DistortionModel::kEquidistant ? "the lens model has no tangential terms" : "";
    case Need::kCamera:
      return cell.camera ? "" : "no pictures";
  }
  return "";
}

/// What else the driver asks for.
std::vector<Need> needsOf(const Effect& effect) {
  std::vector<Need> needs = effect.kind().needs;
  if (effect.driver().kind() == DriverKind::kStamp) needs.push_back(Need::kStamp);
  if (effect.driver().kind() == DriverKind::kTemperature) needs.push_back(Need::kTemperature);
  return needs;
}

/// @throws InsufficientData where a curve follows what the sample does not have.
void checkCurveDriver(const Effect& effect, const SampleContext& context) {
  const bool follows = effect.kind().parameters_of != nullptr && effect.driver().kind() != DriverKind::kPixel;
  if (!follows || hasDriver(effect.driver(), context)) return;
  throw InsufficientData(fmt::format("{} at {} cannot be computed: sample {} has no {}", effect.name(), effect.location(),
                                     context.number + 1, effect.driver().name()));
}

/// The fixed parameters of every instance of a kind at one place.
std::vector<std::map<std::string, double>> instancesOf(const EffectKind& kind, std::size_t index, const Cell& cell, const Target& target) {
  std::vector<std::map<std::string, double>> instances;
  if (const auto source_of = kind.parameterOf(ParameterRole::kSource)) {
    for (std::size_t source = 0; source < jointCount(cell); ++source) {
      if (source != index) instances.push_back({{kind.parameters[*source_of].name, static_cast<double>(source + 1)}});
    }
  } else if (const auto tag_of = kind.parameterOf(ParameterRole::kTag)) {
    std::set<int> ids;
    for (const TargetPoint& point : target.points) ids.insert(point.id.tag);
    for (const int id : ids) instances.push_back({{kind.parameters[*tag_of].name, static_cast<double>(id)}});
  } else {
    instances.emplace_back();
  }
  return instances;
}

}  // namespace

Effect instantiate(const EffectKind& kind, std::size_t index, const Driver& driver, const std::map<std::string, double>& parameters,
                   const Cell& cell) {
  Effect effect;
  effect.kind_ = &kind;
  effect.index_ = index;
  effect.driver_ = driver;
  const std::vector<EffectParameter> by_masses =
      kind.yields_to_gravity && cell.arm ? massParameters(kind, index, *cell.arm) : std::vector<EffectParameter>{};
  const bool asked =
      std::any_of(by_masses.begin(), by_masses.end(), [&parameters](const EffectParameter& p) { return parameters.contains(p.name); });
  effect.by_masses_ = !by_masses.empty() && (cell.arm->links.empty() || asked);
  effect.parameters_ = effect.by_masses_               ? by_masses
                       : kind.parameters_of == nullptr ? kind.parameters
                                                       : kind.parameters_of(driver, parameters);
  if (kind.parameters_of != nullptr) effect.curve_terms_ = std::make_shared<CurveTerms>(curveTermsOf(kind.place, effect.parameters_));
  const bool slides = kind.place == PlaceKind::kJoint && cell.arm->joints[index].type == JointType::kPrismatic;
  effect.start_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(effect.parameters_.size()));
  for (std::size_t i = 0; i < effect.parameters_.size(); ++i) {
    EffectParameter& parameter = effect.parameters_[i];
    parameter.typical = typicalAt(parameter, driver);
    parameter.unit = unitAt(parameter.unit, driver, slides);
    const auto given = parameters.find(parameter.name);
    if (parameter.role == ParameterRole::kReference) effect.start_(static_cast<Eigen::Index>(i)) = std::numeric_limits<double>::quiet_NaN();
    if (isFixed(parameter.role) && given != parameters.end()) effect.start_(static_cast<Eigen::Index>(i)) = given->second;
  }
  return effect;
}

bool EffectKind::takesLoad() const { return yields_to_gravity || std::find(needs.begin(), needs.end(), Need::kMasses) != needs.end(); }

std::string EffectKind::placePattern() const { return isNumbered(place) ? std::string(placeName(place)) + ":K" : placeName(place); }

std::optional<std::size_t> EffectKind::parameterOf(ParameterRole role) const {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].role == role) return i;
  }
  return {};
}

const std::vector<EffectKind>& effectKinds() {
  using namespace kinds;
  static const std::vector<EffectKind> all = {
      jointGain(),      jointEccentricity(), jointHarmonic(), jointCompliance(), jointBacklash(),    jointHysteresis(),
      jointCoupling(),  jointSlip(),         jointDrift(),    axisWobble(),      linkBending(),      linkExpansion(),
      baseCompliance(), cameraSlip(),        cameraDrift(),   lensDistortion(),  focalLength(),      focalDrift(),
      principalPoint(), rollingShutter(),    timeOffset(),    targetScale(),     targetAnisotropy(), targetBend(),
      targetLayout(),   targetSlip(),        cornerBias(),    jointScatter(),    badSamples()};
  return all;
}

const EffectKind* findEffectKind(const std::string& name) {
  for (const EffectKind& kind : effectKinds()) {
    if (kind.name == name) return &kind;
  }
  return nullptr;
}

const EffectKind& effectKind(const std::string& name) {
  if (const EffectKind* kind = findEffectKind(name)) return *kind;
  std::vector<std::string> names;
  for (const EffectKind& known : effectKinds()) names.push_back(known.name);
  throw InvalidArgument(fmt::format("effect '{}' is not known, expected {}", name, choices(name, std::move(names))));
}

AppliedEffect makeEffect(const EffectSpec& spec, const Cell& cell) {
  const EffectKind& kind = kindOf(spec);
  const std::size_t index = placeIndex(kind, spec.location, cell);
  checkSource(kind, spec, index, cell);
  Effect effect = instantiate(kind, index, chosenDriver(kind, spec, index), spec.parameters, cell);
  Eigen::VectorXd parameters = effect.start();
  for (const auto& [name, value] : spec.parameters) parameters(effect.parameterIndex(name)) = value;
  for (const EffectParameter& parameter : effect.parameters()) {
    const bool may_lack =
        parameter.role == ParameterRole::kLinear || parameter.role == ParameterRole::kSeed || parameter.role == ParameterRole::kReference;
    if (!may_lack && !spec.parameters.contains(parameter.name)) {
      throw InvalidArgument(fmt::format("{} needs its parameter '{}'", kind.name, parameter.name));
    }
  }
  return {std::move(effect), std::move(parameters)};
}

std::string whyNotTestable(const Effect& effect, const Cell& cell, const Target& target, const std::vector<Sample>& samples) {
  for (const Need need : needsOf(effect)) {
    const std::string missing = whatIsMissing(need, effect, cell, target, samples);
    if (!missing.empty()) return missing;
  }
  return "";
}

std::vector<Disturbance> disturbancesOf(const std::vector<AppliedEffect>& effects, const Cell& cell, const Target& target,
                                        const Eigen::Vector3d& gravity, const std::vector<Sample>& samples, bool at_random,
                                        const std::vector<std::string>& other_columns) {
  if (effects.empty()) return std::vector<Disturbance>(samples.size());
  for (const AppliedEffect& applied : effects) {
    const std::string missing = whyNotTestable(applied.effect, cell, target, samples);
    if (!missing.empty()) {
      throw InsufficientData(fmt::format("{} at {} cannot be computed: {}", applied.effect.name(), applied.effect.location(), missing));
    }
  }
  const auto capture = makeCaptureContext(cell, target, gravity, samples, other_columns);
  std::vector<Disturbance> disturbances;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const SampleContext context = makeSampleContext(capture, samples[k], k, target.points);
    for (const AppliedEffect& applied : effects) checkCurveDriver(applied.effect, context);
    disturbances.push_back(disturbanceOf(effects, context, at_random));
  }
  return disturbances;
}

Candidates candidateEffects(const Cell& cell, const Target& target, const std::vector<Sample>& samples) {
  Candidates candidates;
  for (const EffectKind& kind : effectKinds()) {
    const std::size_t places = isNumbered(kind.place) ? jointCount(cell) : 1;
    for (std::size_t index = 0; index < places; ++index) {
      std::string why;
      std::size_t testable = 0;
      for (const auto& fixed : instancesOf(kind, index, cell, target)) {
        for (const std::string& pattern : kind.drivers) {
          Effect effect = instantiate(kind, index, Driver(driverName(pattern, index, fixed)), fixed, cell);
          const std::string missing = whyNotTestable(effect, cell, target, samples);
          if (!missing.empty() && why.empty()) why = missing;
          if (missing.empty()) {
            candidates.effects.push_back(std::move(effect));
            ++testable;
          }
        }
      }
      if (testable == 0 && !why.empty()) {
        candidates.not_testable.push_back({kind.name, Place{kind.place, index}.name(), why});
      }
    }
  }
  return candidates;
}

}  // namespace poecal
