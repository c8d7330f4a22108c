#include "effects/curve.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/numbered.hpp"
#include "effects/shapes.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<const char*, 6> kAxes = {"rx", "ry", "rz", "tx", "ty", "tz"};

std::string driverUnit(DriverKind driver) {
  switch (driver) {
    case DriverKind::kReading:
      return "rad";
    case DriverKind::kTorque:
      return "N m";
    case DriverKind::kStamp:
    case DriverKind::kTemperature:
      return "t";
    default:
      return "";
  }
}

std::vector<EffectParameter> range(const Driver& driver) {
  const std::string unit = driverUnit(driver.kind());
  return {{"low", unit, 0.0, ParameterRole::kRange}, {"high", unit, 0.0, ParameterRole::kRange}};
}

/// How many of "c1", "c2", ... are given, up to the last.
int lastOf(const std::string& prefix, const std::map<std::string, double>& given) {
  int last = 0;
  for (const auto& [name, value] : given) last = std::max(last, numberAfter(name, prefix).value_or(0));
  return last;
}

/// Both factors of every wave of several angles that is named; none where none is.
std::vector<EffectParameter> waveParameters(const std::map<std::string, double>& given) {
  std::set<AngleWave> waves;
  for (const auto& [name, value] : given) {
    if (const auto named = namedWave(name)) waves.insert(named->wave);
  }
  std::vector<EffectParameter> parameters;
  for (const AngleWave& wave : waves) {
    parameters.push_back({cosineName(wave), "rad", 1e-4});
    parameters.push_back({sineName(wave), "rad", 1e-4});
  }
  return parameters;
}

std::vector<EffectParameter> jointParameters(const Driver& driver, const std::map<std::string, double>& given) {
  if (std::vector<EffectParameter> waves = waveParameters(given); !waves.empty()) return waves;
  std::vector<EffectParameter> parameters = range(driver);
  for (int j = 1; j <= lastOf("c", given); ++j) parameters.push_back({fmt::format("c{}", j), "rad", 1e-4});
  return parameters;
}

std::string swayName(const std::string& axis, const NamedSway& sway) {
  return fmt::format("{}_{}({})", axis, sway.sine ? "sin" : "cos", sway.cycles);
}

/// Nothing where a name is no such word.
std::optional<NamedSway> namedSway(const std::string& name) {
  constexpr std::size_t kAxis = 2, kPrefix = kAxis + 5;
  const std::string word = name.substr(std::min(kAxis, name.size()), kPrefix - kAxis);
  NamedSway sway{.sine = word == "_sin(", .cycles = 0.0};
  if (!(sway.sine || word == "_cos(") || !name.ends_with(")")) return {};
  const char* const end = name.data() + name.size() - 1;
  const auto [rest, status] = std::from_chars(name.data() + kPrefix, end, sway.cycles);
  if (status != std::errc() || rest != end || !(sway.cycles > 0.0) || !std::isfinite(sway.cycles)) return {};
  return sway;
}

/// Both factors of every sway that is named, of all axes; none where none is.
std::vector<EffectParameter> swayParameters(const std::map<std::string, double>& given) {
  std::set<double> all;
  for (const auto& [name, value] : given) {
    if (const auto sway = namedSway(name)) all.insert(sway->cycles);
  }
  std::vector<EffectParameter> parameters;
  for (const std::string axis : kAxes) {
    for (const double cycles : all) {
      for (const bool sine : {false, true}) {
        parameters.push_back({swayName(axis, {sine, cycles}), axis.starts_with("r") ? "rad" : "m", 1e-4});
      }
    }
  }
  return parameters;
}

std::vector<EffectParameter> mountParameters(const Driver& driver, const std::map<std::string, double>& given) {
  if (const std::vector<EffectParameter> sways = swayParameters(given); !sways.empty()) {
    std::vector<EffectParameter> parameters = range(driver);
    parameters.insert(parameters.end(), sways.begin(), sways.end());
    return parameters;
  }
  int count = 0;
  for (const char* axis : kAxes) count = std::max(count, lastOf(axis, given));
  std::vector<EffectParameter> parameters = range(driver);
  for (const std::string axis : kAxes) {
    for (int j = 1; j <= count; ++j) parameters.push_back({fmt::format("{}{}", axis, j), axis.starts_with("r") ? "rad" : "m", 1e-4});
  }
  return parameters;
}

/// "u_1_0" of the wave with i = 1, j = 0.
std::vector<EffectParameter> lensParameters(const Driver&, const std::map<std::string, double>& given) {
  const auto count = [&given](int orders) {
    const auto all = pixelOrders(orders);
    return std::any_of(all.begin(), all.end(), [&](const auto& order) {
      const std::string wave = fmt::format("_{}_{}", order.first, order.second);
      return order.first + order.second == orders && (given.contains("u" + wave) || given.contains("v" + wave));
    });
  };
  constexpr int kMostOrders = 20;
  int orders = kMostOrders;
  while (orders > 0 && !count(orders)) --orders;
  std::vector<EffectParameter> parameters;
  for (const auto& [i, j] : pixelOrders(orders)) {
    for (const char* along : {"u", "v"}) parameters.push_back({fmt::format("{}_{}_{}", along, i, j), "px", 0.1});
  }
  return parameters;
}

/// Orders of so many pixel waves.
int ordersOf(Eigen::Index waves) {
  int orders = 0;
  while (static_cast<Eigen::Index>(pixelOrders(orders).size()) < waves) ++orders;
  return orders;
}

constexpr Eigen::Index kRange = 2;  // low, high stand first

/// Wave `j` (from 0) of `count` at a sample.
double waveAt(const Effect& effect, const Eigen::VectorXd& parameters, const SampleContext& context, Eigen::Index j, Eigen::Index count) {
  return CurveRange{parameters(0), parameters(1)}.waves(driverValue(effect.driver(), context), count)(j);
}

void bendJoint(const Effect& effect, Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
               Disturbance& disturbance) {
  const std::vector<NamedWave>& waves = effect.curveTerms()->waves;
  if (!waves.empty()) {
    kinds::jointPort(effect, disturbance) += amount * waves[static_cast<std::size_t>(i)].at(context.sample.q);
    return;
  }
  kinds::jointPort(effect, disturbance) += amount * waveAt(effect, parameters, context, i - kRange, parameters.size() - kRange);
}

template <Vector6d Disturbance::*port>
void bendMount(const Effect& effect, Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
               Disturbance& disturbance) {
  const Eigen::Index count = (parameters.size() - kRange) / static_cast<Eigen::Index>(kAxes.size());
  const Eigen::Index axis = (i - kRange) / count, j = (i - kRange) % count;
  const std::vector<NamedSway>& sways = effect.curveTerms()->sways;
  if (!sways.empty()) {
    const NamedSway& sway = sways[static_cast<std::size_t>(i - kRange)];
    (disturbance.*port)(axis) += amount * sway.at({parameters(0), parameters(1)}, driverValue(effect.driver(), context));
    return;
  }
  (disturbance.*port)(axis) += amount * waveAt(effect, parameters, context, j, count);
}

double pixelWave(const Eigen::Vector2d& px, const Camera& camera, const std::pair<int, int>& order) {
  return std::cos(M_PI * order.first * px.x() / camera.width) * std::cos(M_PI * order.second * px.y() / camera.height);
}

void bendLens(const Effect& effect, Eigen::Index i, const Eigen::VectorXd&, const SampleContext& context, double amount,
              Disturbance& disturbance) {
  const std::pair<int, int>& order = effect.curveTerms()->pixels[static_cast<std::size_t>(i / 2)];
  for (std::size_t point = 0; point < context.points.size(); ++point) {
    const Eigen::Vector2d px = context.points[point].px;
    if (px.allFinite()) disturbance.pixels[point](i % 2) += amount * pixelWave(px, *context.capture->cell.camera, order);
  }
}

EffectKind unknown(PlaceKind place, EffectKind::AddDerivative add_derivative, EffectKind::ParametersOf parameters_of) {
  EffectKind kind;
  kind.name = kUnknownEffect;
  kind.place = place;
  kind.needs = {place == PlaceKind::kCameraLens ? Need::kCamera : Need::kJoints};
  kind.meaning = "structure that no listed effect explains";
  kind.formula =
      "sum over j of c_j cos(pi j x), x = (driver - low) / (high - low) held within 0 .. 1; of several joints: sum over n of a_n cos(n.q) "
      "+ b_n sin(n.q); of a mount that sways: sum over f of a_f cos(2 pi f x) + b_f sin(2 pi f x)";
  kind.add_derivative = add_derivative;
  kind.parameters_of = parameters_of;
  kind.moves_points = place == PlaceKind::kCameraLens;
  return kind;
}

}  // namespace

double driverValue(const Driver& driver, const SampleContext& context) {
  const Sample& sample = context.sample;
  const auto entry = [&driver](const Eigen::VectorXd& values) {
    const auto k = static_cast<Eigen::Index>(driver.joint());
    return k < values.size() ? values(k) : kNaN;
  };
  switch (driver.kind()) {
    case DriverKind::kReading:
      return entry(sample.q);
    case DriverKind::kTorque:
      return entry(context.torque);
    case DriverKind::kStamp:
      return sample.stamp.value_or(kNaN);
    case DriverKind::kTemperature:
      return sample.temperature.value_or(kNaN);
    default:
      break;
  }
  const std::vector<std::string>& others = context.capture->other_columns;
  const auto column = static_cast<std::size_t>(std::find(others.begin(), others.end(), driver.name()) - others.begin());
  return column < sample.other.size() ? sample.other[column] : kNaN;
}

bool hasDriver(const Driver& driver, const SampleContext& context) {
  if (driver.kind() != DriverKind::kReadings) return !std::isnan(driverValue(driver, context));
  const Eigen::VectorXd& q = context.sample.q;
  const auto has = [&q](std::size_t joint) {
    const auto k = static_cast<Eigen::Index>(joint);
    return k < q.size() && !std::isnan(q(k));
  };
  return std::all_of(driver.joints().begin(), driver.joints().end(), has);
}

Eigen::RowVectorXd CurveRange::waves(double value, Eigen::Index count) const {
  Eigen::RowVectorXd all = Eigen::RowVectorXd::Zero(count);
  if (std::isnan(value)) return all;
  const double first = std::cos(M_PI * std::clamp((value - low) / (high - low), 0.0, 1.0));
  // Chebyshev's recurrence: cos((j + 1) t) = 2 cos t cos(j t) - cos((j - 1) t).
  double before = 1.0, now = first;
  for (Eigen::Index j = 0; j < count; ++j) {
    all(j) = now;
    before = std::exchange(now, 2.0 * first * now - before);
  }
  return all;
}

Eigen::RowVectorXd CurveRange::sways(double value, const std::vector<double>& cycles) const {
  Eigen::RowVectorXd all(2 * static_cast<Eigen::Index>(cycles.size()));
  Eigen::Index next = 0;
  for (const double f : cycles) {
    for (const bool sine : {false, true}) all(next++) = NamedSway{sine, f}.at(*this, value);
  }
  return all;
}

double NamedSway::at(const CurveRange& range, double value) const {
  if (std::isnan(value)) return 0.0;
  const double phase = 2.0 * M_PI * cycles * std::clamp((value - range.low) / (range.high - range.low), 0.0, 1.0);
  return sine ? std::sin(phase) : std::cos(phase);
}

CurveTerms curveTermsOf(PlaceKind place, const std::vector<EffectParameter>& parameters) {
  CurveTerms terms;
  if (place == PlaceKind::kCameraLens) terms.pixels = pixelOrders(ordersOf(static_cast<Eigen::Index>(parameters.size() / 2)));
  for (const EffectParameter& parameter : parameters) {
    if (const auto wave = namedWave(parameter.name)) terms.waves.push_back(*wave);
    if (const auto sway = namedSway(parameter.name)) terms.sways.push_back(*sway);
  }
  return terms;
}

std::vector<std::pair<int, int>> pixelOrders(int orders) {
  std::vector<std::pair<int, int>> all;
  for (int i = 0; i <= orders; ++i) {
    for (int j = 0; i + j <= orders; ++j) {
      if (i + j > 0) all.emplace_back(i, j);
    }
  }
  return all;
}

Eigen::RowVectorXd pixelWaves(const Eigen::Vector2d& px, const Camera& camera, int orders) {
  const std::vector<std::pair<int, int>> all = pixelOrders(orders);
  Eigen::RowVectorXd waves(static_cast<Eigen::Index>(all.size()));
  for (std::size_t k = 0; k < all.size(); ++k) waves(static_cast<Eigen::Index>(k)) = pixelWave(px, camera, all[k]);
  return waves;
}

AppliedEffect makeCurve(const Place& place, const Driver& driver, const CurveRange& range, const Eigen::VectorXd& factors,
                        const Cell& cell) {
  EffectSpec spec{.effect = kUnknownEffect, .location = place.name(), .parameters = {}, .driver = driver.name()};
  const bool lens = place.kind == PlaceKind::kCameraLens;
  const auto name = [&](Eigen::Index k) {
    if (lens) {
      const auto [i, j] = pixelOrders(ordersOf(factors.size() / 2))[static_cast<std::size_t>(k / 2)];
      return fmt::format("{}_{}_{}", k % 2 == 0 ? "u" : "v", i, j);
    }
    if (place.kind == PlaceKind::kJoint) return fmt::format("c{}", k + 1);
    const Eigen::Index count = factors.size() / static_cast<Eigen::Index>(kAxes.size());
    return fmt::format("{}{}", kAxes[static_cast<std::size_t>(k / count)], k % count + 1);
  };
  for (Eigen::Index k = 0; k < factors.size(); ++k) spec.parameters[name(k)] = factors(k);
  if (!lens) {
    spec.parameters["low"] = range.low;
    spec.parameters["high"] = range.high;
  }
  return makeEffect(spec, cell);
}

AppliedEffect makeSway(const Place& place, const Driver& driver, const CurveRange& range, const std::vector<double>& cycles,
                       const Eigen::VectorXd& factors, const Cell& cell) {
  if (place.kind != PlaceKind::kCameraMount && place.kind != PlaceKind::kTargetMount) {
    throw InvalidArgument(fmt::format("nothing sways at {}, expected camera.mount or target.mount", place.name()));
  }
  EffectSpec spec{.effect = kUnknownEffect,
                  .location = place.name(),
                  .parameters = {{"low", range.low}, {"high", range.high}},
                  .driver = driver.name()};
  Eigen::Index next = 0;
  for (const std::string axis : kAxes) {
    for (const double f : cycles) {
      for (const bool sine : {false, true}) spec.parameters[swayName(axis, {sine, f})] = factors(next++);
    }
  }
  return makeEffect(spec, cell);
}

AppliedEffect makeAngleWaves(std::size_t joint, const std::vector<AngleWave>& waves, const Eigen::VectorXd& factors, const Cell& cell) {
  EffectSpec spec{
      .effect = kUnknownEffect, .location = Place{PlaceKind::kJoint, joint}.name(), .parameters = {}, .driver = driversOf(waves)};
  for (std::size_t k = 0; k < waves.size(); ++k) {
    spec.parameters[cosineName(waves[k])] = factors(2 * static_cast<Eigen::Index>(k));
    spec.parameters[sineName(waves[k])] = factors(2 * static_cast<Eigen::Index>(k) + 1);
  }
  return makeEffect(spec, cell);
}

namespace kinds {

const EffectKind* unknownAt(PlaceKind place) {
  static const std::array<EffectKind, 4> all = {unknown(PlaceKind::kJoint, bendJoint, jointParameters),
                                                unknown(PlaceKind::kCameraMount, bendMount<&Disturbance::mount>, mountParameters),
                                                unknown(PlaceKind::kTargetMount, bendMount<&Disturbance::grip>, mountParameters),
                                                unknown(PlaceKind::kCameraLens, bendLens, lensParameters)};
  const auto kind = std::find_if(all.begin(), all.end(), [place](const EffectKind& k) { return k.place == place; });
  return kind == all.end() ? nullptr : &*kind;
}

}  // namespace kinds
}  // namespace poecal
