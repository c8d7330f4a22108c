#include "withheld/harder_sets.hpp"

#include <cmath>

#include "withheld/drawing.hpp"
#include "withheld/observing.hpp"
#include "withheld/strange_flaws.hpp"

namespace withheld {
namespace {

constexpr std::size_t kUsualShots = 80;

/// S of what moves corners by so many times their noise, rms.
double sizeOf(const Case& made, double times_noise) {
  return times_noise * std::sqrt(8.0 * static_cast<double>(made.shots.size() * made.actual.tags.size()));
}

Wishes shotsOf(std::size_t shots) {
  Wishes wishes;
  wishes.shots = shots;
  wishes.stamp = true;
  return wishes;
}

/// A cell with one unlisted flaw. @param S  of a cell
template <typename DrawFlaw, typename S>
void drawUnlisted(Case& made, const Wishes& wishes, Chance& chance, const S& size, const DrawFlaw& draw) {
  drawUntil(made, [&] {
    return drawWith(made, wishes, chance, [&](Case& c) {
      const Leftover leftover(c.actual, c.shots, c.noise, false);
      const std::optional<Hidden> hidden = chooseStrange(c, leftover, size(c), [&] { return draw(c); });
      if (hidden) c.hidden = {*hidden};
      return hidden.has_value();
    });
  });
  observe(made, {}, chance);
}

/// One listed effect, and structure half its size that no listed one explains.
void half(Case& made, Chance& chance) {
  const double S = chance.scale(2.0 * kClearS, 2.0 * kMostS);
  drawUntil(made, [&] {
    const std::string effect = chance.oneOf(listedNames());
    return drawWith(made, wishesFor({effect}, shotsOf(kUsualShots)), chance, [&](Case& c) {
      const Leftover leftover(c.actual, c.shots, c.noise, false);
      std::optional<Hidden> listed = chooseListed(c, leftover, effect, S, chance);
      if (!listed) return false;
      const std::size_t kind = chance.index(3);
      const std::optional<Hidden> unlisted = chooseStrange(c, leftover, 0.5 * S, [&] {
        return kind == 0   ? waveOfThree(c.actual, c.family, chance)
               : kind == 1 ? fieldOfThree(c.actual, c.family, chance)
                           : strangeFlaw(c.actual, c.shots, c.family, chance);
      });
      if (!unlisted || unlisted->flaw.location == listed->flaw.location || !separable(leftover, {*listed, *unlisted})) return false;
      compareWithListed(c, leftover, *listed);
      c.hidden = {*listed, *unlisted};
      return true;
    });
  });
  observe(made, {}, chance);
}

void waves(Case& made, Chance& chance) {
  const double times = chance.scale(0.8, 2.5);
  drawUnlisted(
      made, shotsOf(kUsualShots), chance, [&](const Case& c) { return sizeOf(c, times); },
      [&](const Case& c) { return waveOfThree(c.actual, c.family, chance); });
}

void field(Case& made, Chance& chance, std::size_t shots) {
  const double times = chance.scale(1.2, 2.5);
  drawUnlisted(
      made, shotsOf(shots), chance, [&](const Case& c) { return sizeOf(c, times); },
      [&](const Case& c) { return fieldOfThree(c.actual, c.family, chance); });
}
void field80(Case& made, Chance& chance) { field(made, chance, kUsualShots); }
void field300(Case& made, Chance& chance) { field(made, chance, 300); }

void fast(Case& made, Chance& chance) {
  const double S = chance.scale(kClearS, kMostS);
  drawUnlisted(
      made, shotsOf(kUsualShots), chance, [&](const Case&) { return S; },
      [&](const Case& c) { return fastFlaw(c.actual, c.shots, c.family, chance); });
}

/// One listed effect that moves corners by 5 to 100 px, geometry not asked.
void large(Case& made, Chance& chance) {
  const double wanted = chance.scale(5.0, 100.0);
  drawUntil(made, [&] {
    const std::string effect = chance.oneOf(listedNames());
    return drawWith(made, wishesFor({effect}, shotsOf(kUsualShots)), chance, [&](Case& c) {
      const Leftover leftover(c.actual, c.shots, c.noise, false);
      std::optional<Hidden> hidden = chooseListed(c, leftover, effect, kClearS, chance);
      if (!hidden) return false;
      Flaw& flaw = hidden->flaw;
      const Eigen::VectorXd still = corners(c.actual, c.shots, {});
      for (int round = 0; round < 4; ++round) {
        const Eigen::VectorXd moved = corners(c.actual, c.shots, {flaw}) - still;
        flaw.scale(wanted / std::sqrt(2.0 * moved.squaredNorm() / static_cast<double>(moved.size())));
        if (!flaw.credible()) return false;
      }
      hidden->S = leftover.size(flaw);
      if (!(hidden->S > kClearS)) return false;
      compareWithListed(c, leftover, *hidden);
      c.hidden = {*hidden};
      return true;
    });
  });
  observe(made, {}, chance);
}

void small(Case& made, Chance& chance) {
  drawListed(made, shotsOf(30), listedNames(), chance.scale(kLeastS, kMostS), chance, [](Case&) {});
  observe(made, {}, chance);
}

void inHand(Case& made, Chance& chance) {
  Wishes wishes = shotsOf(kUsualShots);
  wishes.in_hand = true;
  drawListed(made, wishes, listedNames(), chance.scale(kLeastS, kMostS), chance, [](Case&) {});
  observe(made, {}, chance);
}

void triple(Case& made, Chance& chance) {
  drawUntil(made, [&] {
    std::vector<std::string> effects;
    for (int i = 0; i < 3; ++i) effects.push_back(chance.oneOf(listedNames()));
    if (effects[0] == effects[1] || effects[0] == effects[2] || effects[1] == effects[2]) return false;
    return drawWith(made, wishesFor(effects, shotsOf(kUsualShots)), chance, [&](Case& c) {
      const Leftover leftover(c.actual, c.shots, c.noise, false);
      for (const std::string& effect : effects) {
        const std::optional<Hidden> hidden = chooseListed(c, leftover, effect, chance.scale(kClearS, kMostS), chance);
        if (!hidden) return false;
        for (const Hidden& other : c.hidden) {
          if (other.flaw.location == hidden->flaw.location) return false;
        }
        c.hidden.push_back(*hidden);
      }
      if (!separable(leftover, c.hidden)) return false;
      for (Hidden& hidden : c.hidden) compareWithListed(c, leftover, hidden);
      return true;
    });
  });
  observe(made, {}, chance);
}

/// Joints and pictures alone. What needs a column that a guess cannot stand in for is left out: speeds and temperatures.
void bare(Case& made, Chance& chance) {
  std::vector<std::string> names = listedNames();
  std::erase_if(names, [](const std::string& name) { return needsOf(name).dq; });
  Wishes wishes = shotsOf(kUsualShots);
  wishes.bare = true;
  drawListed(made, wishes, names, chance.scale(kClearS, kMostS), chance, [](Case& c) { c.told_masses.reset(); });
  made.columns = {};
  made.columns.stamp = made.columns.dir = false;
  observe(made, {}, chance);
}

}  // namespace

const std::map<std::string, MakeSet>& harderSets() {
  static const std::map<std::string, MakeSet> all = {{"half", half},     {"waves", waves}, {"field-80", field80}, {"field-300", field300},
                                                     {"fast", fast},     {"large", large}, {"small", small},      {"in-hand", inHand},
                                                     {"triple", triple}, {"bare", bare}};
  return all;
}

}  // namespace withheld
