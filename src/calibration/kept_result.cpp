#include "calibration/kept_result.hpp"

#include "poecal/core/text.hpp"

namespace poecal {

KeptResult::KeptResult(const std::filesystem::path& out, const std::string& name, std::vector<std::filesystem::path> results,
                       const ContentKey& key)
    : stamp_(out / ".stages" / name), results_(std::move(results)), key_(key.text() + "\n") {}

bool KeptResult::upToDate() const {
  for (const std::filesystem::path& result : results_) {
    if (!std::filesystem::exists(result)) return false;
  }
  return std::filesystem::exists(stamp_) && readTextFile(stamp_) == key_;
}

void KeptResult::markDone() const { writeTextFile(stamp_, key_); }

}  // namespace poecal
