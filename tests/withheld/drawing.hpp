// Drawing cells until their effects are as large, and as far apart, as a set wants them.
#pragma once

#include <string>
#include <vector>

#include "withheld/case.hpp"
#include "withheld/choice.hpp"
#include "withheld/setting.hpp"

namespace withheld {

constexpr double kLeastS = 5.0, kMostS = 40.0;  ///< of single effects
constexpr double kClearS = 12.0;

/// Calls draw() until it returns true. @throws std::runtime_error  after many times
template <typename Draw>
void drawUntil(const Case& made, const Draw& draw) {
  constexpr int kDraws = 50;  // of effects before a case is given up
  for (int attempt = 0; attempt < kDraws; ++attempt) {
    if (draw()) return;
  }
  throw std::runtime_error("no cell found for case " + std::to_string(made.number) + " of set " + made.set);
}

/// Draws cells until choose(cell) finds its effects in one. @return whether it did
template <typename Choose>
bool drawWith(Case& made, const Wishes& wishes, Chance& chance, const Choose& choose) {
  constexpr int kSettings = 40;  // tried before other effects are drawn
  for (int attempt = 0; attempt < kSettings; ++attempt) {
    Case fresh;
    fresh.set = made.set;
    fresh.seed = made.seed;
    fresh.number = made.number;
    fresh.family = made.family;
    drawSetting(fresh, wishes, chance);
    if (choose(fresh)) {
      made = std::move(fresh);
      return true;
    }
  }
  return false;
}

/// Wishes, and what these effects need.
Wishes wishesFor(const std::vector<std::string>& effects, Wishes wishes = {});

/// A cell with one listed effect that leaves S. @param prepare  is called with each cell before the effect is chosen
template <typename Prepare>
void drawListed(Case& made, const Wishes& wishes, const std::vector<std::string>& names, double S, Chance& chance, const Prepare& prepare) {
  drawUntil(made, [&] {
    const std::string effect = chance.oneOf(names);
    return drawWith(made, wishesFor({effect}, wishes), chance, [&](Case& c) {
      prepare(c);
      const Leftover leftover(c.actual, c.shots, c.noise, c.lens_deviation.has_value());
      std::optional<Hidden> hidden = chooseListed(c, leftover, effect, S, chance);
      if (!hidden) return false;
      compareWithListed(c, leftover, *hidden);
      c.hidden = {*hidden};
      return true;
    });
  });
}

/// Whether each effect is seen when all the others may explain what they can.
bool separable(const Leftover& leftover, const std::vector<Hidden>& effects);

}  // namespace withheld
