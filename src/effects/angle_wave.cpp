#include "effects/angle_wave.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace poecal {
namespace {

/// "3q1+2q3-q4".
std::string phaseName(const AngleWave& wave) {
  std::string name;
  for (const auto& [joint, factor] : wave) {
    const double size = std::abs(factor);
    name += factor < 0.0 ? "-" : name.empty() ? "" : "+";
    if (size != 1.0) name += fmt::format("{}", size);
    name += fmt::format("q{}", joint + 1);
  }
  return name;
}

/// Takes one term off the front of a phase; nothing where there is none.
std::optional<std::pair<std::size_t, double>> takeTerm(const char*& at, const char* end) {
  double sign = 1.0, size = 1.0;
  if (at != end && (*at == '+' || *at == '-')) sign = *at++ == '-' ? -1.0 : 1.0;
  if (at != end && *at != 'q') {
    const auto [rest, status] = std::from_chars(at, end, size);
    if (status != std::errc()) return {};
    at = rest;
  }
  if (at == end || *at++ != 'q') return {};
  std::size_t joint = 0;
  const auto [rest, status] = std::from_chars(at, end, joint);
  if (status != std::errc() || joint == 0 || size == 0.0 || !std::isfinite(size)) return {};
  at = rest;
  return std::pair(joint - 1, sign * size);
}

}  // namespace

double phaseOf(const AngleWave& wave, const Eigen::VectorXd& q) {
  double phase = 0.0;
  for (const auto& [joint, factor] : wave) {
    const auto k = static_cast<Eigen::Index>(joint);
    phase += factor * (k < q.size() ? q(k) : std::numeric_limits<double>::quiet_NaN());
  }
  return phase;
}

std::string cosineName(const AngleWave& wave) { return fmt::format("cos({})", phaseName(wave)); }
std::string sineName(const AngleWave& wave) { return fmt::format("sin({})", phaseName(wave)); }

double NamedWave::at(const Eigen::VectorXd& q) const {
  const double phase = phaseOf(wave, q);
  return sine ? std::sin(phase) : std::cos(phase);
}

std::optional<NamedWave> namedWave(const std::string& name) {
  NamedWave named{.sine = name.starts_with("sin("), .wave = {}};
  if (!(named.sine || name.starts_with("cos(")) || !name.ends_with(")")) return {};
  constexpr std::size_t kPrefix = 4;
  const char* at = name.data() + kPrefix;
  const char* const end = name.data() + name.size() - 1;
  while (at != end) {
    const auto term = takeTerm(at, end);
    if (!term || !named.wave.insert(*term).second) return {};
  }
  return named.wave.empty() ? std::nullopt : std::optional(named);
}

std::string driversOf(const std::vector<AngleWave>& waves) {
  std::set<std::size_t> joints;
  for (const AngleWave& wave : waves) {
    for (const auto& [joint, factor] : wave) joints.insert(joint);
  }
  std::vector<std::string> words;
  for (const std::size_t joint : joints) words.push_back(fmt::format("q{}", joint + 1));
  return fmt::format("{}", fmt::join(words, ","));
}

}  // namespace poecal
