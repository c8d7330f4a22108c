// Random draws of the withheld world. Everything in a case comes from one generator, so a seed gives the same case again.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace withheld {

class Chance {
 public:
  explicit Chance(std::uint64_t seed) : engine_(seed) {}
  /// Between low and high.
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  /// Between low and high, every factor as likely as any other.
  double scale(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  /// Normal of mean 0.
  double normal(double sigma) { return sigma * std::normal_distribution<double>()(engine_); }
  bool happens(double probability) { return between(0.0, 1.0) < probability; }
  double sign() { return happens(0.5) ? 1.0 : -1.0; }
  /// 0 .. count - 1.
  std::size_t index(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(engine_); }
  template <typename T>
  const T& oneOf(const std::vector<T>& values) {
    return values[index(values.size())];
  }
  std::mt19937_64& engine() { return engine_; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace withheld
