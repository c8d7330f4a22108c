// One seed of a scene, many independent random sequences: each purpose and item has a stream of its own.
#pragma once

#include <cstddef>
#include <cstdint>

namespace poecal {

enum class Purpose : std::uint64_t { kErrors = 1, kSamples, kPicture, kCornerNoise, kBoardPose, kBoardPicture, kDrivers };

/// Stream of item `index` (below 2^32) of a purpose, for Rng(seed, stream).
constexpr std::uint64_t streamOf(Purpose purpose, std::size_t index = 0) {
  return (static_cast<std::uint64_t>(purpose) << 32) | static_cast<std::uint64_t>(index);
}

}  // namespace poecal
