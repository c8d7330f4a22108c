#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>

#include "withheld/drawing.hpp"
#include "withheld/harder_sets.hpp"
#include "withheld/listed_flaws.hpp"
#include "withheld/observing.hpp"
#include "withheld/oracle.hpp"
#include "withheld/strange_flaws.hpp"

namespace withheld {
namespace {

constexpr double kFoundCorner = 0.01;  // what finding corners in pictures is taken to leave, for their S [px]

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
  drawUntil(made, [&] { return drawWith(made, {}, chance, [](Case&) { return true; }); });
  observe(made, {}, chance);
}

void untidy(Case& made, Chance& chance) {
  drawUntil(made, [&] {
    return drawWith(made, {}, chance, [&](Case& c) {
      makeUntidy(c, chance);
      return true;
    });
  });
  observe(made, {chance.between(0.01, 0.05), 0.0}, chance);
}

void single(Case& made, Chance& chance) {
  drawListed(made, {}, listedNames(), chance.scale(kLeastS, kMostS), chance, [](Case&) {});
  observe(made, {}, chance);
}

/// One effect, and pictures in which the corners have to be found first.
void rendered(Case& made, Chance& chance) {
  Wishes wishes;
  wishes.pictures = true;
  // A bent tag is not drawn; edges that are seen too far out are ink, which whoever fits a whole tag takes for ink.
  std::vector<std::string> names = listedNames();
  std::erase_if(names, [](const std::string& name) { return name == "target_bend" || name == "target_layout" || name == "corner_bias"; });
  drawListed(made, wishes, names, chance.scale(kClearS, kMostS), chance, [](Case& c) { c.noise = {kFoundCorner, 0.0, 0.0}; });
  observeByPictures(made, chance);
}

void outside(Case& made, Chance& chance) {
  const double S = chance.scale(kClearS, kMostS);
  Wishes wishes;
  wishes.stamp = wishes.masses = true;
  drawUntil(made, [&] {
    return drawWith(made, wishes, chance, [&](Case& c) {
      const Leftover leftover(c.actual, c.shots, c.noise, false);
      const std::optional<Hidden> hidden = chooseStrange(c, leftover, S, [&] { return strangeFlaw(c.actual, c.shots, c.family, chance); });
      if (hidden) c.hidden = {*hidden};
      return hidden.has_value();
    });
  });
  observe(made, {}, chance);
}

/// Masses as a data sheet has them, or none at all.
void spoilMasses(Case& made, Chance& chance) {
  constexpr double kOff = 0.15;
  made.told_masses.reset();
  if (chance.happens(0.5)) return;
  made.told_masses = made.told.arm.bodies;
  for (Body& body : *made.told_masses) body.mass *= 1.0 + kOff * chance.sign();
}

void untidySingle(Case& made, Chance& chance) {
  // What camera.yaml's deviation allows is no finding: errors of the lens are left to the tidy set.
  std::vector<std::string> names = listedNames();
  std::erase_if(names,
                [](const std::string& name) { return name == "focal_length" || name == "principal_point" || name == "lens_distortion"; });
  drawListed(made, {}, names, chance.scale(kClearS, kMostS), chance, [&](Case& c) {
    makeUntidy(c, chance);
    spoilMasses(c, chance);
  });
  observe(made, {chance.between(0.01, 0.05), 0.03}, chance);
}

void pairs(Case& made, Chance& chance) {
  drawUntil(made, [&] {
    const std::string first = chance.oneOf(listedNames()), second = chance.oneOf(listedNames());
    if (first == second) return false;
    const double S_first = chance.scale(kClearS, kMostS), S_second = chance.scale(kClearS, kMostS);
    return drawWith(made, wishesFor({first, second}), chance, [&](Case& c) {
      const Leftover leftover(c.actual, c.shots, c.noise, false);
      std::optional<Hidden> a = chooseListed(c, leftover, first, S_first, chance);
      std::optional<Hidden> b = a ? chooseListed(c, leftover, second, S_second, chance) : std::nullopt;
      if (!a || !b || a->flaw.location == b->flaw.location || !separable(leftover, {*a, *b})) return false;
      compareWithListed(c, leftover, *a);
      compareWithListed(c, leftover, *b);
      c.hidden = {*a, *b};
      return true;
    });
  });
  observe(made, {}, chance);
}

void scatter(Case& made, Chance& chance) {
  const double S = chance.scale(kClearS, kMostS);
  drawUntil(made, [&] {
    return drawWith(made, {}, chance, [&](Case& c) {
      const Leftover leftover(c.actual, c.shots, c.noise, false);
      Flaw flaw = jointScatter(c.actual, chance.index(c.actual.arm.size()), chance.index(1U << 30U));
      if (!scaleTo(S, leftover, flaw)) return false;
      c.hidden = {{flaw, leftover.size(flaw), true, {}, {}, "", 0.0}};
      return true;
    });
  });
  observe(made, {}, chance);
}

void scale(Case& made, Chance& chance) {
  drawUntil(made, [&] {
    return drawWith(made, {}, chance, [&](Case& c) {
      const Leftover leftover(c.actual, c.shots, c.noise, false);
      const Flaw flaw = targetScale(chance.sign() * chance.scale(0.01, 0.05));
      c.hidden = {{flaw, leftover.size(flaw), true, {}, {}, "", 0.0}};
      return true;
    });
  });
  observe(made, {}, chance);
}

/// Nothing hidden that could be found: a zero that is off, a gap that is always on the same side, a vertical joint that would yield.
void unobservable(Case& made, Chance& chance) {
  constexpr double kNothing = 1.0;  // S
  Wishes wishes;
  wishes.dir = true;
  drawUntil(made, [&] {
    return drawWith(made, wishes, chance, [&](Case& c) {
      const std::size_t kind = chance.index(3), joint = kind == 2 ? 0 : chance.index(c.actual.arm.size());
      if (kind == 1) {
        const double side = chance.sign();
        for (Shot& shot : c.shots) shot.dir[static_cast<Eigen::Index>(joint)] = side;
        if (c.columns.dq) return false;  // the speeds would not fit the side
      }
      Flaw flaw = zeroOffset(joint, chance.sign() * chance.scale(1e-3, 1e-2));
      if (kind > 0) {
        const std::string effect = kind == 1 ? "joint_backlash" : "joint_compliance";
        for (const Flaw& listed : listedFlaws(c.actual, c.columns, {})) {
          if (listed.effect == effect && listed.location == flaw.location) {
            flaw = listed;
            break;
          }
        }
        flaw.parameters[0].value = flaw.parameters[0].usual * chance.scale(1.0, 4.0);
        c.silent = {flaw.place()};
      }
      const Leftover leftover(c.actual, c.shots, c.noise, false);
      if (leftover.size(flaw) > kNothing) return false;
      c.unfindable = flaw;
      return true;
    });
  });
  observe(made, {}, chance);
}

const std::map<std::string, MakeSet>& sets() {
  static const std::map<std::string, MakeSet> all = [] {
    std::map<std::string, MakeSet> named = harderSets();
    named.insert({{"single", single},
                  {"rendered", rendered},
                  {"clean", clean},
                  {"untidy", untidy},
                  {"outside", outside},
                  {"untidy-single", untidySingle},
                  {"pairs", pairs},
                  {"scatter", scatter},
                  {"scale", scale},
                  {"unobservable", unobservable}});
    return named;
  }();
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

Case makeCase(const std::string& set, std::uint64_t seed, std::uint64_t number, Family family) {
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
  made.family = family;
  std::uint64_t mixed = seed * 1000003 + number * 7919;
  for (const char letter : set) mixed = mixed * 131 + static_cast<unsigned char>(letter);
  Chance chance(mixed);
  found->second(made, chance);
  if (!made.hidden.empty() && !made.look) made.oracle_px = oracleOnUnseen(made);
  return made;
}

}  // namespace withheld
