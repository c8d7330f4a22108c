#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>

#include "withheld/case.hpp"
#include "withheld/choice.hpp"
#include "withheld/listed_flaws.hpp"
#include "withheld/observing.hpp"
#include "withheld/setting.hpp"

namespace withheld {
namespace {

constexpr double kLeastS = 5.0, kMostS = 40.0;  // of single effects
constexpr double kClearS = 12.0;
constexpr int kSettings = 60;  // tried before a case is given up

/// Draws cells until `choose` finds its effects in one.
template <typename Choose>
void drawWith(Case& made, const Wishes& wishes, Chance& chance, const Choose& choose) {
  for (int attempt = 0; attempt < kSettings; ++attempt) {
    Case fresh;
    fresh.set = made.set;
    fresh.seed = made.seed;
    fresh.number = made.number;
    drawSetting(fresh, wishes, chance);
    if (choose(fresh)) {
      made = std::move(fresh);
      return;
    }
  }
  throw std::runtime_error("no cell found for case " + std::to_string(made.number) + " of set " + made.set);
}

Wishes wishesFor(const std::vector<std::string>& effects) {
  Wishes wishes;
  for (const std::string& effect : effects) {
    const KindNeeds needs = needsOf(effect);
    wishes.stamp = wishes.stamp || needs.stamp;
    wishes.dir = wishes.dir || needs.dir;
    wishes.dq = wishes.dq || needs.dq;
    wishes.several_tags = wishes.several_tags || needs.several_tags;
  }
  return wishes;
}

/// Noise common to a tag, joints that do not repeat, and intrinsics that are off within the deviation that is stated.
void makeUntidy(Case& made, Chance& chance) {
  made.noise.common = chance.between(0.0, 0.1);
  made.noise.repeatability = chance.between(2e-5, 5e-5);
  made.lens_deviation = LensDeviation{1e-3 * made.told.lens.fx, 2.0, 2e-3, 4e-3};
  const auto within = [&](double deviation) { return deviation * chance.between(-1.5, 1.5); };
  Lens& lens = made.actual.lens;
  const double f = within(made.lens_deviation->f);
  lens.fx += f;
  lens.fy += f;
  lens.cx += within(made.lens_deviation->c);
  lens.cy += within(made.lens_deviation->c);
  lens.k1 += within(made.lens_deviation->k1);
  lens.k2 += within(made.lens_deviation->k2);
}

void clean(Case& made, Chance& chance) {
  drawWith(made, {}, chance, [](Case&) { return true; });
  observe(made, {}, chance);
}

void untidy(Case& made, Chance& chance) {
  drawWith(made, {}, chance, [&](Case& c) {
    makeUntidy(c, chance);
    return true;
  });
  observe(made, {chance.between(0.01, 0.05), 0.0}, chance);
}

void single(Case& made, Chance& chance) {
  const std::string effect = chance.oneOf(listedNames());
  const double S = chance.scale(kLeastS, kMostS);
  drawWith(made, wishesFor({effect}), chance, [&](Case& c) {
    const Leftover leftover(c.actual, c.shots, c.noise, false);
    const std::optional<Hidden> hidden = chooseListed(c, leftover, effect, S, chance);
    if (hidden) c.hidden = {*hidden};
    return hidden.has_value();
  });
  observe(made, {}, chance);
}

void outside(Case& made, Chance& chance) {
  const double S = chance.scale(kClearS, kMostS);
  Wishes wishes;
  wishes.stamp = wishes.masses = true;
  drawWith(made, wishes, chance, [&](Case& c) {
    const Leftover leftover(c.actual, c.shots, c.noise, false);
    const std::optional<Hidden> hidden = chooseStrange(c, leftover, S, chance);
    if (hidden) c.hidden = {*hidden};
    return hidden.has_value();
  });
  observe(made, {}, chance);
}

using MakeSet = void (*)(Case&, Chance&);
const std::map<std::string, MakeSet>& sets() {
  static const std::map<std::string, MakeSet> all = {{"single", single}, {"clean", clean}, {"untidy", untidy}, {"outside", outside}};
  return all;
}

}  // namespace

const std::vector<std::string>& setNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, make] : sets()) all.push_back(name);
    return all;
  }();
  return names;
}

Case makeCase(const std::string& set, std::uint64_t seed, std::uint64_t number) {
  const auto found = sets().find(set);
  if (found == sets().end()) {
    std::string names;
    for (const std::string& name : setNames()) names += " " + name;
    throw std::invalid_argument("no set '" + set + "', expected one of" + names);
  }
  Case made;
  made.set = set;
  made.seed = seed;
  made.number = number;
  std::uint64_t mixed = seed * 1000003 + number * 7919;
  for (const char letter : set) mixed = mixed * 131 + static_cast<unsigned char>(letter);
  Chance chance(mixed);
  found->second(made, chance);
  return made;
}

}  // namespace withheld
