// Stages whose results are kept: a result is up to date while the bytes of its inputs and its options are the same.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "poecal/core/content_key.hpp"

namespace poecal {

/// One result file of OUT with the key of what it was made from, kept in OUT/.stages/NAME.
class KeptResult {
 public:
  KeptResult(const std::filesystem::path& out, const std::string& name, std::vector<std::filesystem::path> results, const ContentKey& key);
  bool upToDate() const;
  void markDone() const;

 private:
  std::filesystem::path stamp_;
  std::vector<std::filesystem::path> results_;
  std::string key_;
};

}  // namespace poecal
