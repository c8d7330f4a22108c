#include "withheld/choice.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "withheld/listed_flaws.hpp"

namespace withheld {
namespace {

constexpr int kTries = 12;
/// Share of an effect that another one may leave and still be the same thing.
constexpr double kSame = 0.05;
constexpr double kSameAtMost = 1.0;  // sigma
/// A strange effect of which the nearest listed one leaves less may rightly be called by that one's name.
constexpr double kStrangeShare = 0.4, kStrangeLeast = 6.0;

double timeOfRun(const Case& made, double share) {
  return made.shots.front().stamp + share * (made.shots.back().stamp - made.shots.front().stamp);
}

/// Whether some parameter could leave a fifth of S without being beyond its most: a joint that is all but upright carries no moment worth
/// the name, whatever masses it would need.
bool couldLeave(const Flaw& flaw, const Leftover& leftover, double S) {
  constexpr double kShare = 0.2;
  const Eigen::MatrixXd columns = leftover.columns(flaw);
  Eigen::Index column = 0;
  for (const Parameter& parameter : flaw.parameters) {
    if (parameter.usual == 0.0) continue;
    if (columns.col(column++).norm() * parameter.most / parameter.usual > kShare * S) return true;
  }
  return false;
}

void addOnce(const std::string& place, std::vector<std::string>& places) {
  if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
}

/// Fills aliases, close and nearest of a hidden effect from instances of all kinds.
void compare(Hidden& hidden, const std::vector<Flaw>& others, const Leftover& leftover) {
  const Eigen::VectorXd left = leftover.left({hidden.flaw});
  for (const Flaw& other : others) {
    if (other.place() == hidden.flaw.place()) continue;
    const double rest = Leftover::besides(left, leftover.columns(other)).norm();
    if (rest < kSame * hidden.S && rest < kSameAtMost) {
      addOnce(other.place(), hidden.aliases);
      continue;
    }
    if (rest < kTellable) addOnce(other.place(), hidden.close);
    if (hidden.nearest.empty() || rest < hidden.left_by_nearest) {
      hidden.nearest = other.place();
      hidden.left_by_nearest = rest;
    }
  }
}

}  // namespace

bool scaleTo(double S, const Leftover& leftover, Flaw& flaw) {
  for (int round = 0; round < 4; ++round) {
    const double now = leftover.size(flaw);
    if (!(now > 1e-6)) return false;
    flaw.scale(S / now);
    if (!flaw.credible()) return false;
  }
  return std::abs(leftover.size(flaw) / S - 1.0) < 0.02;
}

const std::vector<std::string>& listedNames() {
  static const std::vector<std::string> names = {
      "joint_gain",        "joint_eccentricity", "joint_harmonic",  "joint_compliance", "joint_backlash",
      "joint_coupling",    "joint_slip",         "joint_drift",     "axis_wobble",      "link_bending",
      "link_expansion",    "base_compliance",    "camera_slip",     "camera_drift",     "lens_distortion",
      "focal_length",      "focal_drift",        "principal_point", "rolling_shutter",  "time_offset",
      "target_anisotropy", "target_bend",        "target_layout",   "target_slip",      "corner_bias"};
  return names;
}

KindNeeds needsOf(const std::string& effect) {
  KindNeeds needs;
  needs.stamp = effect.ends_with("_slip") || effect.ends_with("_drift") || effect == "link_expansion";
  needs.dir = effect == "joint_backlash";
  needs.dq = effect == "rolling_shutter" || effect == "time_offset";
  needs.several_tags = effect == "target_layout";
  return needs;
}

std::optional<Hidden> chooseListed(const Case& made, const Leftover& leftover, const std::string& effect, double S, Chance& chance) {
  const double slip_time = timeOfRun(made, chance.between(0.25, 0.75));
  const int order = 2 + static_cast<int>(chance.index(7));
  const std::vector<Flaw> all = listedFlaws(made.actual, made.columns, Instances{slip_time, {order}});
  std::vector<Flaw> places;
  std::copy_if(all.begin(), all.end(), std::back_inserter(places), [&](const Flaw& flaw) { return flaw.effect == effect; });
  if (places.empty()) return std::nullopt;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    Flaw flaw = chance.oneOf(places);
    for (Parameter& parameter : flaw.parameters) {
      if (parameter.usual > 0.0) parameter.value = chance.normal(parameter.usual);
    }
    if (flaw.yields) {  // nothing stiffens under a load
      for (Parameter& parameter : flaw.parameters) parameter.value = std::abs(parameter.value);
    }
    if (!scaleTo(S, leftover, flaw)) continue;
    return Hidden{flaw, leftover.size(flaw), true, {}, {}, "", 0.0};
  }
  return std::nullopt;
}

void compareWithListed(const Case& made, const Leftover& leftover, Hidden& hidden) {
  Instances instances{timeOfRun(made, 0.5), {2}};
  for (const Parameter& parameter : hidden.flaw.parameters) {
    if (parameter.name == "time") instances.slip_time = parameter.value;
  }
  std::vector<Flaw> others = listedFlaws(made.actual, made.columns, instances);
  if (!made.told_masses) {
    for (Flaw& flaw : others) {
      if (flaw.yields) flaw = withUnknownMasses(made.actual, flaw);
    }
    std::erase_if(others, [&](const Flaw& flaw) { return !couldLeave(flaw, leftover, hidden.S); });
  }
  compare(hidden, others, leftover);
}

std::optional<Hidden> chooseStrange(const Case& made, const Leftover& leftover, double S, const std::function<Flaw()>& draw) {
  std::vector<Flaw> all;
  for (const double share : {0.15, 0.3, 0.5, 0.7, 0.85}) {
    Instances instances;
    instances.slip_time = timeOfRun(made, share);
    std::vector<Flaw> flaws = listedFlaws(made.actual, made.columns, instances);
    if (!all.empty()) std::erase_if(flaws, [](const Flaw& flaw) { return !flaw.effect.ends_with("_slip"); });
    all.insert(all.end(), flaws.begin(), flaws.end());
  }
  for (int attempt = 0; attempt < kTries; ++attempt) {
    Flaw flaw = draw();
    if (!scaleTo(S, leftover, flaw)) continue;
    Hidden hidden{flaw, leftover.size(flaw), false, {}, {}, "", 0.0};
    compare(hidden, all, leftover);
    if (hidden.aliases.empty() && hidden.left_by_nearest > std::max(kStrangeLeast, kStrangeShare * hidden.S)) return hidden;
  }
  return std::nullopt;
}

}  // namespace withheld
