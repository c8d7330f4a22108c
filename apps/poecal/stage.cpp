#include "stage.hpp"

#include <fstream>

#include <fmt/format.h>

#include "poecal/core/text.hpp"

namespace poecal::app {
namespace {

constexpr std::uint64_t kPrime = 1099511628211ULL;

}  // namespace

InputKey::InputKey() : hash_(14695981039346656037ULL) { add(POECAL_VERSION); }

InputKey& InputKey::add(const std::string& text) {
  for (const char c : text) hash_ = (hash_ ^ static_cast<unsigned char>(c)) * kPrime;
  hash_ = (hash_ ^ 0xFFU) * kPrime;  // so that ("ab", "c") and ("a", "bc") differ
  return *this;
}

InputKey& InputKey::addFile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string block(1 << 16, '\0');
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0) {
    for (std::streamsize k = 0; k < stream.gcount(); ++k) hash_ = (hash_ ^ static_cast<unsigned char>(block[static_cast<std::size_t>(k)])) * kPrime;
  }
  return add(file.filename().string());
}

std::string InputKey::text() const { return fmt::format("{:016x}\n", hash_); }

Stage::Stage(const std::filesystem::path& out, const std::string& name, std::vector<std::filesystem::path> results, const InputKey& key)
    : stamp_(out / ".stages" / name), results_(std::move(results)), key_(key.text()) {}

bool Stage::upToDate() const {
  for (const std::filesystem::path& result : results_) {
    if (!std::filesystem::exists(result)) return false;
  }
  return std::filesystem::exists(stamp_) && readTextFile(stamp_) == key_;
}

void Stage::markDone() const { writeTextFile(stamp_, key_); }

}  // namespace poecal::app
