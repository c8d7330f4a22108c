#include "poecal/core/content_key.hpp"

#include <cstdint>
#include <fstream>

#include <fmt/format.h>
// Compiled in: the library then needs nothing of xxHash when it is linked.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/build_key.hpp"

namespace poecal {

namespace {

std::string digits(const XXH128_hash_t& hash) { return fmt::format("{:016x}{:016x}", hash.high64, hash.low64); }

}  // namespace

std::string checksum(std::string_view bytes) { return digits(XXH3_128bits(bytes.data(), bytes.size())); }

struct ContentKey::State {
  XXH3_state_t hash;
  void update(const void* bytes, std::size_t size) { XXH3_128bits_update(&hash, bytes, size); }
  void endPiece(std::uint64_t size) { update(&size, sizeof size); }
};

ContentKey::ContentKey() : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(&state_->hash);
  add(POECAL_VERSION).add(buildKey());
}

ContentKey::~ContentKey() = default;

ContentKey& ContentKey::add(std::string_view bytes) {
  state_->update(bytes.data(), bytes.size());
  state_->endPiece(bytes.size());
  return *this;
}

ContentKey& ContentKey::addFile(const std::filesystem::path& file) {
  add(file.filename().string());
  std::ifstream stream(file, std::ios::binary);
  std::string block(1 << 16, '\0');
  std::uint64_t size = 0;
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0) {
    const auto count = static_cast<std::size_t>(stream.gcount());
    state_->update(block.data(), count);
    size += count;
  }
  state_->endPiece(size);
  return *this;
}

std::string ContentKey::text() const { return digits(XXH3_128bits_digest(&state_->hash)); }

}  // namespace poecal
