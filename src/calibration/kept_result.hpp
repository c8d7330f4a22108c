// What is kept in an output folder from run to run: results that need not be made again, and what a person changed since.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "poecal/core/content_key.hpp"
#include "poecal/core/progress.hpp"

namespace poecal {

/// Result files of OUT with the key of what they were made from and their checksums, kept in OUT/.stages/NAME.
class KeptResult {
 public:
  KeptResult(const std::filesystem::path& out, const std::string& name, std::vector<std::filesystem::path> results, const ContentKey& key);
  /// Whether the results were made from the same and are as they were written.
  bool upToDate() const;
  void markDone() const;

 private:
  std::string stampOfResults() const;

  std::filesystem::path stamp_;
  std::vector<std::filesystem::path> results_;
  std::string key_;
};

/// The checksums of the results of OUT, kept in OUT/.stages/results while no command is at work there. A result that is not as it was
/// written was changed by a person: that is warned of, and a copy is kept beside it (model.yaml: model.edited.yaml).
class ResultRecord {
 public:
  /// @param results   that the command may write.
  /// @param listener  told of results that were changed.
  ResultRecord(const std::filesystem::path& out, const std::vector<std::filesystem::path>& results, Listener& listener);
  /// Notes down the results as they are now.
  ~ResultRecord();
  ResultRecord(const ResultRecord&) = delete;
  ResultRecord& operator=(const ResultRecord&) = delete;

 private:
  void write() const;

  std::filesystem::path file_;
  std::vector<std::filesystem::path> results_;
  std::map<std::string, std::string> checksums_;  ///< by file name: of results of other commands, and of those that were changed
  std::map<std::string, std::string> edited_;     ///< by file name: the checksums that changed results had when the command began
};

}  // namespace poecal
