#include "detection/family_hint.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <opencv2/aruco.hpp>
#include <opencv2/core.hpp>

#include "detection/corner_finder.hpp"
#include "detection/picture.hpp"
#include "detection/tag_detector.hpp"
#include "detection/tag_family.hpp"
#include "detection/wide_tag_detector.hpp"
#include "target/names.hpp"

namespace poecal {
namespace {

constexpr std::size_t kPicturesTried = 3;
constexpr double kClearMargin = 30.0;  // grey values; printed tags have 50 and more, clutter that passes for a small code below 20

bool showsTags(const cv::Mat& grey, const std::string& family) {
  TagDetector detector(family, 0);
  const std::vector<TagDetection> tags = detector.detect(grey, 1.0, true);
  return std::any_of(tags.begin(), tags.end(), [](const TagDetection& tag) { return tag.decision_margin >= kClearMargin; });
}

/// Whether the target's tags or board can be seen.
bool shows(const cv::Mat& grey, const Target& target) {
  if (target.type == TargetType::kCharuco) return !makeCharucoFinder(target)->find(grey).corners.empty();
  if (target.type == TargetType::kAprilGrid && target.border_bits != 1 && mayHaveWideBorder(target.family)) {
    constexpr std::size_t kNotByChance = 2;
    if (WideTagDetector(target.family).detect(grey).size() >= kNotByChance) return true;
  }
  return showsTags(grey, target.family);
}

/// The largest dictionary of each kind of marker: it holds the smaller ones.
constexpr const char* kLargest[] = {"DICT_4X4_1000",      "DICT_5X5_1000",       "DICT_6X6_1000",
                                    "DICT_7X7_1000",      "DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_16h5",
                                    "DICT_APRILTAG_25h9", "DICT_APRILTAG_36h10", "DICT_APRILTAG_36h11"};

/// Markers with the ids that a board of so many markers has.
std::size_t countMarkers(const cv::Mat& grey, const std::string& dictionary, int board_markers) {
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, makeMarkerDictionary(dictionary), markers, ids, cv::aruco::DetectorParameters::create());
  std::set<int> of_the_board;
  for (const int id : ids) {
    if (id < board_markers) of_the_board.insert(id);
  }
  return of_the_board.size();
}

/// "DICT_4X4_1000": the size of the dictionary cannot be told from markers that all of them have.
std::string kindOf(const std::string& dictionary) {
  const bool sized = dictionary.ends_with("_1000");
  return sized ? dictionary.substr(0, dictionary.size() - 4) + "*" : dictionary;
}

std::optional<std::string> hintAtDictionary(const cv::Mat& grey, const Target& board) {
  constexpr std::size_t kNotByChance = 4;
  const int board_markers = board.cols * board.rows / 2;
  std::size_t most = kNotByChance - 1;
  std::optional<std::string> seen;
  for (const char* dictionary : kLargest) {
    const std::string kind = kindOf(dictionary);
    const bool same_kind = kind.back() == '*' ? board.dictionary.starts_with(kind.substr(0, kind.size() - 1)) : kind == board.dictionary;
    if (same_kind) continue;
    const std::size_t count = countMarkers(grey, dictionary, board_markers);
    if (count <= most) continue;
    most = count;
    seen = fmt::format("{} markers of {} were seen; target.yaml says {}", count, kind, board.dictionary);
  }
  return seen;
}

std::optional<std::string> hintAtOtherFamily(const cv::Mat& grey, const Target& target) {
  for (const std::string& other : knownFamilies()) {
    if (other == target.family || !showsTags(grey, other)) continue;
    return fmt::format("tags of family {} were seen; target.yaml says {}", other, target.family);
  }
  return std::nullopt;
}

}  // namespace

std::optional<PictureNote> hintAtFamily(const std::filesystem::path& folder, const std::vector<std::string>& images, const Target& target) {
  for (std::size_t k = 0; k < std::min(images.size(), kPicturesTried); ++k) {
    const Picture picture = readPicture(folder / images[k]);
    if (picture.grey.empty()) continue;
    const std::optional<std::string> hint =
        target.type == TargetType::kCharuco ? hintAtDictionary(picture.grey, target) : hintAtOtherFamily(picture.grey, target);
    if (hint) return PictureNote{images[k], *hint, true};
  }
  return std::nullopt;
}

std::optional<std::string> findMirrored(const std::filesystem::path& folder, const std::vector<std::string>& images, const Target& target) {
  for (std::size_t k = 0; k < std::min(images.size(), kPicturesTried); ++k) {
    const Picture picture = readPicture(folder / images[k]);
    if (picture.grey.empty()) continue;
    cv::Mat mirrored;
    cv::flip(picture.grey, mirrored, 1);
    if (shows(mirrored, target)) return images[k];
  }
  return std::nullopt;
}

}  // namespace poecal
