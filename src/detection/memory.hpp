// Memory that runs out inside a library that does not say so.
#pragma once

#include <cstddef>
#include <cstdint>

namespace poecal {

/// Whether this thread was refused memory since begin: libraries written in C go on without it, and see less than there is.
class MemoryWatch {
 public:
  MemoryWatch();
  /// @throws std::bad_alloc where memory was refused.
  void check() const;
};

/// What AprilTag takes while it searches a picture of so many pixels, at most [bytes].
std::size_t searchMemory(std::int64_t pixels);

/// @throws std::bad_alloc where so much memory is not to be had at this moment.
void requireMemory(std::size_t bytes);

}  // namespace poecal
