// Structure of three joints at one of them.
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "withheld/strange_flaws.hpp"
#include "withheld/strange_shapes.hpp"

namespace withheld {
namespace {

/// Three joints that turn, in order, and the joint that errs.
struct Cast {
  std::array<Eigen::Index, 3> drivers;
  std::size_t at = 0;
  std::string driver() const { return fmt::format("q{},q{},q{}", drivers[0] + 1, drivers[1] + 1, drivers[2] + 1); }
};

Cast drawCast(const Cell& cell, Chance& chance) {
  std::vector<std::size_t> turning = turningJoints(cell);
  Cast cast;
  cast.at = chance.oneOf(turning);
  while (turning.size() > 3) turning.erase(turning.begin() + static_cast<std::ptrdiff_t>(chance.index(turning.size())));
  for (std::size_t i = 0; i < 3; ++i) cast.drivers[i] = static_cast<Eigen::Index>(turning[i]);
  return cast;
}

using Shape = std::function<double(const std::array<double, 3>&)>;

Flaw flawOf(const char* name, const Cast& cast, const Shape& shape) {
  return jointFlaw(
      name, cast.at, cast.driver(),
      [=](const Shot& s, const Loads&) {
        return shape({s.q[cast.drivers[0]], s.q[cast.drivers[1]], s.q[cast.drivers[2]]});
      },
      false);
}

Shape wave(Chance& chance) {
  std::array<double, 3> n{};
  for (double& factor : n) factor = chance.sign() * static_cast<double>(1 + chance.index(4));
  const double phase = chance.between(0.0, 2.0 * KDL::PI);
  return [=](const std::array<double, 3>& q) { return std::sin(n[0] * q[0] + n[1] * q[1] + n[2] * q[2] + phase); };
}

}  // namespace

Flaw waveOfThree(const Cell& cell, Family family, Chance& chance) {
  const Cast cast = drawCast(cell, chance);
  const Shape first = wave(chance);
  if (family == Family::first) return flawOf("wave of three joints", cast, first);
  const Shape other = wave(chance);
  const double share = chance.between(0.3, 0.7);
  return flawOf("two waves of three joints", cast,
                [=](const std::array<double, 3>& q) { return (1.0 - share) * first(q) + share * other(q); });
}

Flaw fieldOfThree(const Cell& cell, Family family, Chance& chance) {
  const Cast cast = drawCast(cell, chance);
  struct Part {
    std::array<double, 3> at{};
    double weight = 0.0, phase = 0.0;
  };
  std::vector<Part> parts(family == Family::first ? 12 : 6);
  std::array<double, 3> width{};
  for (std::size_t j = 0; j < 3; ++j) {
    const Joint& joint = cell.arm.joints[static_cast<std::size_t>(cast.drivers[j])];
    width[j] = 0.35 * (joint.high - joint.low);
    for (Part& part : parts) part.at[j] = family == Family::first ? chance.between(joint.low, joint.high) : chance.normal(0.8);
  }
  for (Part& part : parts) {
    part.weight = chance.normal(1.0);
    part.phase = chance.between(0.0, 2.0 * KDL::PI);
  }
  if (family == Family::first) {
    return flawOf("bumps over three joints", cast, [=](const std::array<double, 3>& q) {
      double sum = 0.0;
      for (const Part& part : parts) {
        double away = 0.0;
        for (std::size_t j = 0; j < 3; ++j) away += std::pow((q[j] - part.at[j]) / width[j], 2);
        sum += part.weight * std::exp(-0.5 * away);
      }
      return sum;
    });
  }
  return flawOf("broken waves of three joints", cast, [=](const std::array<double, 3>& q) {
    double sum = 0.0;
    for (const Part& part : parts) sum += part.weight * std::sin(part.at[0] * q[0] + part.at[1] * q[1] + part.at[2] * q[2] + part.phase);
    return sum;
  });
}

}  // namespace withheld
