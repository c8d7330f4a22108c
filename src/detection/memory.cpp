#include "detection/memory.hpp"

#include <cerrno>
#include <cstdlib>
#include <new>

namespace poecal {

MemoryWatch::MemoryWatch() { errno = 0; }

void MemoryWatch::check() const {
  if (errno == ENOMEM) throw std::bad_alloc();
}

std::size_t searchMemory(std::int64_t pixels) {
  constexpr std::size_t kFixed = std::size_t{16} << 20, kPerPixel = 64;
  return kFixed + kPerPixel * static_cast<std::size_t>(pixels);
}

void requireMemory(std::size_t bytes) {
  void* const block = std::malloc(bytes);
  if (block == nullptr) throw std::bad_alloc();
  // An optimiser may take a block that nobody looks at for one that need not be.
  *static_cast<volatile char*>(block) = 0;
  std::free(block);
}

}  // namespace poecal
