// Stages whose results are kept: a result is up to date while the bytes of its inputs and its options are the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace poecal::app {

/// FNV-1a over the inputs of a stage.
class InputKey {
 public:
  InputKey();  ///< starts from the program's version
  InputKey& add(const std::string& text);
  InputKey& addFile(const std::filesystem::path& file);  ///< its bytes; a missing file counts as one that is empty
  std::string text() const;

 private:
  std::uint64_t hash_;
};

/// One result file of OUT with the key of what it was made from, kept in OUT/.stages/NAME.
class Stage {
 public:
  Stage(const std::filesystem::path& out, const std::string& name, std::vector<std::filesystem::path> results, const InputKey& key);
  bool upToDate() const;
  void markDone() const;

 private:
  std::filesystem::path stamp_;
  std::vector<std::filesystem::path> results_;
  std::string key_;
};

}  // namespace poecal::app
