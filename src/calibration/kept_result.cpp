#include "calibration/kept_result.hpp"

#include <exception>
#include <optional>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"

namespace poecal {
namespace {

bool isFile(const std::filesystem::path& file) {
  std::error_code status;
  return std::filesystem::is_regular_file(file, status);
}

std::string checksumOf(const std::filesystem::path& file) { return checksum(readTextFile(file)); }

/// Puts a copy of a changed result beside it, under a name that holds nothing else.
std::filesystem::path keepCopy(const std::filesystem::path& file) {
  const std::string content = readTextFile(file);
  for (int k = 1;; ++k) {
    const std::string name = file.stem().string() + ".edited" + (k > 1 ? fmt::format("-{}", k) : "") + file.extension().string();
    const std::filesystem::path copy = file.parent_path() / name;
    if (isFile(copy) && readTextFile(copy) != content) continue;
    writeTextFile(copy, content);
    return copy;
  }
}

}  // namespace

KeptResult::KeptResult(const std::filesystem::path& out, const std::string& name, std::vector<std::filesystem::path> results,
                       const ContentKey& key)
    : stamp_(out / ".stages" / name), results_(std::move(results)), key_(key.text()) {}

std::string KeptResult::stampOfResults() const {
  std::string text = key_ + "\n";
  for (const std::filesystem::path& result : results_) text += checksumOf(result) + "\n";
  return text;
}

bool KeptResult::upToDate() const {
  for (const std::filesystem::path& result : results_) {
    if (!isFile(result)) return false;
  }
  return isFile(stamp_) && readTextFile(stamp_) == stampOfResults();
}

void KeptResult::markDone() const { writeTextFile(stamp_, stampOfResults()); }

ResultRecord::ResultRecord(const std::filesystem::path& out, const std::vector<std::filesystem::path>& results, Listener& listener)
    : file_(out / ".stages" / "results"), results_(results) {
  if (!isFile(file_)) return;
  std::istringstream lines(readTextFile(file_));
  for (std::string sum, name; lines >> sum >> name;) checksums_[name] = sum;
  for (const std::filesystem::path& result : results_) {
    const auto known = checksums_.find(result.filename().string());
    if (known == checksums_.end()) continue;
    const std::string now = isFile(result) ? checksumOf(result) : known->second;
    if (now == known->second) {
      checksums_.erase(known);
      continue;
    }
    edited_[known->first] = now;
    listener.warning(fmt::format("{} was changed since it was written: it counts for nothing here, a copy is kept in {}", result.string(),
                                 keepCopy(result).filename().string()));
  }
  // A command that is killed leaves results that nobody has noted down, and no result that is taken for a person's.
  std::error_code status;
  std::filesystem::remove(file_, status);
}

ResultRecord::~ResultRecord() {
  try {
    write();
  } catch (const std::exception&) {
    // The results are there; what is lost is whether a person changes them.
  }
}

void ResultRecord::write() const {
  std::map<std::string, std::string> checksums = checksums_;
  for (const std::filesystem::path& result : results_) {
    if (!isFile(result)) continue;
    const std::string name = result.filename().string(), now = checksumOf(result);
    const auto edited = edited_.find(name);
    // One that nobody wrote since stays a changed one.
    if (edited == edited_.end() || edited->second != now) checksums[name] = now;
  }
  std::string text;
  for (const auto& [name, sum] : checksums) text += fmt::format("{} {}\n", sum, name);
  if (!text.empty()) writeTextFile(file_, text);
}

}  // namespace poecal
