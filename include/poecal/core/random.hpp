// Random numbers that are the same on every machine, and streams that do not depend on the order of work.
#pragma once

#include <cstdint>
#include <random>

namespace poecal {

/// A seeded generator; (seed, stream) pairs are independent, so work item k may draw from stream k in any thread.
class Rng {
 public:
  explicit Rng(std::uint64_t seed, std::uint64_t stream = 0);
  /// Uniform in [0, 1).
  double uniform();
  double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }
  /// Standard normal (polar method, so that the sequence does not depend on the standard library).
  double normal();
  /// Uniform integer in [0, count). @throws InvalidArgument if count is 0.
  std::size_t below(std::size_t count);

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace poecal
