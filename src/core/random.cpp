#include "poecal/core/random.hpp"

#include <cmath>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

// SplitMix64 (Steele, Lea, Flood 2014): turns neighbouring (seed, stream) pairs into unrelated engine seeds.
std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

}  // namespace

Rng::Rng(std::uint64_t seed, std::uint64_t stream) : engine_(mix(mix(seed) ^ stream)) {}

double Rng::uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

double Rng::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  for (;;) {
    const double x = uniform(-1.0, 1.0);
    const double y = uniform(-1.0, 1.0);
    const double s = x * x + y * y;
    if (s >= 1.0 || s == 0.0) continue;
    const double factor = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = y * factor;
    has_spare_ = true;
    return x * factor;
  }
}

std::size_t Rng::below(std::size_t count) {
  if (count == 0) throw InvalidArgument("a random index below 0");
  return static_cast<std::size_t>(uniform() * static_cast<double>(count));
}

}  // namespace poecal
