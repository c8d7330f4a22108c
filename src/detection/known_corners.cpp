#include "poecal/detection/known_corners.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <map>
#include <mutex>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "poecal/core/content_key.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/detector.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFirstLine = "poecal-corners/1\n";
constexpr std::size_t kKeyLength = 32;

std::string checksumOf(std::string_view content) { return ContentKey().add(content).text(); }

/// KEY CHECKSUM {...}, where the checksum is of the key and what is in the braces. Numbers read back as the same bits.
std::string lineOf(const std::string& key, const PictureFinding& finding) {
  Json corners = Json::array();
  for (const Corner& corner : finding.corners) {
    corners.push_back({corner.id.tag, corner.id.corner, corner.px.x(), corner.px.y(), corner.sigma});  // NaN becomes null
  }
  Json look;
  if (finding.look) look = {finding.look->blur, finding.look->noise, finding.look->growth};
  const Json content{{"size", {finding.width, finding.height}}, {"corners", std::move(corners)}, {"notes", finding.notes}, {"look", look}};
  const std::string text = content.dump();
  return fmt::format("{} {} {}\n", key, checksumOf(key + text), text);
}

struct KnownLine {
  std::string key;
  PictureFinding finding;
};

/// What the checksum bears out. @throws Json::exception where somebody wrote it by hand.
std::optional<KnownLine> parseWholeLine(const std::string& key, const std::string& text) {
  const Json content = Json::parse(text);
  if (!content.contains("look")) return std::nullopt;

  PictureFinding finding;
  finding.width = content.at("size").at(0).get<int>();
  finding.height = content.at("size").at(1).get<int>();
  for (const Json& row : content.at("corners")) {
    Corner corner;
    corner.id = {row.at(0).get<int>(), row.at(1).get<int>()};
    corner.px = {row.at(2).get<double>(), row.at(3).get<double>()};
    if (!row.at(4).is_null()) corner.sigma = row.at(4).get<double>();
    finding.corners.push_back(corner);
  }
  for (const Json& note : content.at("notes")) finding.notes.push_back(note.get<std::string>());
  if (const Json& look = content.at("look"); !look.is_null()) {
    finding.look = PictureLook{look.at(0).get<double>(), look.at(1).get<double>(), look.at(2).get<double>()};
  }
  return KnownLine{key, std::move(finding)};
}

/// Nothing where the line is not whole, or of a version that did not look at pictures so closely.
std::optional<KnownLine> parseLine(std::string_view line) {
  constexpr std::size_t kBegin = 2 * kKeyLength + 2;
  if (line.size() <= kBegin || line[kKeyLength] != ' ' || line[kBegin - 1] != ' ') return std::nullopt;
  const std::string key(line.substr(0, kKeyLength));
  const std::string text(line.substr(kBegin));
  if (line.substr(kKeyLength + 1, kKeyLength) != checksumOf(key + text)) return std::nullopt;
  try {
    return parseWholeLine(key, text);
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

/// A file that is only appended to, one whole line a call.
class Journal {
 public:
  explicit Journal(std::filesystem::path file) : file_(std::move(file)) {}
  ~Journal() { close(); }
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  void append(const std::string& line) {
    if (descriptor_ < 0) open();
    for (std::string_view rest = line; !rest.empty();) {
      const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) throw FileError(file_, 0, "cannot be written: " + std::generic_category().message(errno));
      rest.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void close() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
  }

 private:
  void open() {
    requireReplaceable(file_);
    std::error_code status;
    if (file_.has_parent_path()) std::filesystem::create_directories(file_.parent_path(), status);
    const std::uintmax_t size = std::filesystem::file_size(file_, status);
    const bool fresh = status || size <= kFirstLine.size();
    descriptor_ = ::open(file_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | (fresh ? O_TRUNC : 0), 0666);
    if (descriptor_ < 0) throw FileError(file_, 0, "cannot be written");
    // What was cut short becomes a line of its own, which counts for nothing, and the next line is whole.
    append(fresh ? std::string(kFirstLine) : "\n");
  }

  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace

struct KnownCorners::Store {
  explicit Store(const std::filesystem::path& path) : file(path), journal(path) {}

  struct Entry {
    PictureFinding finding;
    bool used = false;
  };

  void read(const std::filesystem::path& from) {
    const std::string text = readTextFile(from);
    // A program that was killed at once may have left a part of the first line.
    if (!text.starts_with(kFirstLine) && !kFirstLine.starts_with(text)) {
      throw FileError(from, 1, fmt::format("is not a file of known corners, expected {}", kFirstLine.substr(0, kFirstLine.size() - 1)));
    }
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (auto known = parseLine(line)) entries.insert_or_assign(std::move(known->key), Entry{std::move(known->finding)});
    }
  }

  std::filesystem::path file;
  Journal journal;
  std::mutex mutex;
  std::map<std::string, Entry> entries;  ///< sorted, as finish() writes them
  std::size_t reused = 0;
};

KnownCorners::KnownCorners(const std::filesystem::path& file) : store_(std::make_unique<Store>(file)) {
  std::error_code status;
  if (std::filesystem::exists(file, status) || status) store_->read(file);
}

KnownCorners::~KnownCorners() = default;

void KnownCorners::read(const std::filesystem::path& file) {
  const std::lock_guard lock(store_->mutex);
  store_->read(file);
}

std::optional<PictureFinding> KnownCorners::find(const std::string& key) {
  const std::lock_guard lock(store_->mutex);
  const auto known = store_->entries.find(key);
  if (known == store_->entries.end()) return std::nullopt;
  if (!known->second.used) ++store_->reused;
  known->second.used = true;
  return known->second.finding;
}

void KnownCorners::add(const std::string& key, const PictureFinding& finding) {
  const std::string line = lineOf(key, finding);
  const std::lock_guard lock(store_->mutex);
  store_->journal.append(line);
  store_->entries.insert_or_assign(key, Store::Entry{finding, true});
}

void KnownCorners::finish() {
  const std::lock_guard lock(store_->mutex);
  store_->journal.close();
  std::string text(kFirstLine);
  for (const auto& [key, entry] : store_->entries) {
    if (entry.used) text += lineOf(key, entry.finding);
  }
  const bool same = std::filesystem::exists(store_->file) && readTextFile(store_->file) == text;
  if (!same) writeTextFile(store_->file, text);
}

std::size_t KnownCorners::reused() const {
  const std::lock_guard lock(store_->mutex);
  return store_->reused;
}

std::string detectionKey(const Target& target, const DetectOptions& options) {
  ContentKey key;
  key.add(cv::getVersionString()).add(targetYaml(target));
  key.add(formatNumber(options.quad_decimate)).add(options.refine ? "refine" : "");
  key.add(options.camera ? cameraYaml(*options.camera) : "");
  for (const int id : options.other_tags) key.add(std::to_string(id));
  return key.text();
}

std::string pictureKey(const std::string& detection_key, std::string_view bytes) {
  return ContentKey().add(detection_key).add(bytes).text();
}

}  // namespace poecal
