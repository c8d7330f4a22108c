#include "detection/family_hint.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "detection/picture.hpp"
#include "detection/tag_detector.hpp"

namespace poecal {
namespace {

constexpr std::size_t kPicturesTried = 3;
constexpr double kClearMargin = 30.0;  // grey values; printed tags have 50 and more, clutter that passes for a small code below 20

bool showsTags(const cv::Mat& grey, const std::string& family) {
  TagDetector detector(family, 0);
  const std::vector<TagDetection> tags = detector.detect(grey, 1.0, true);
  return std::any_of(tags.begin(), tags.end(), [](const TagDetection& tag) { return tag.decision_margin >= kClearMargin; });
}

}  // namespace

std::optional<PictureNote> hintAtFamily(const std::filesystem::path& folder, const std::vector<std::string>& images,
                                        const std::string& family) {
  for (std::size_t k = 0; k < std::min(images.size(), kPicturesTried); ++k) {
    const Picture picture = readPicture(folder / images[k]);
    if (picture.grey.empty()) continue;
    for (const std::string& other : knownFamilies()) {
      if (other == family) continue;
      if (!showsTags(picture.grey, other)) continue;
      return PictureNote{images[k], fmt::format("tags of family {} were seen; target.yaml says {}", other, family), true};
    }
  }
  return std::nullopt;
}

std::optional<std::string> findMirrored(const std::filesystem::path& folder, const std::vector<std::string>& images,
                                        const std::string& family) {
  for (std::size_t k = 0; k < std::min(images.size(), kPicturesTried); ++k) {
    const Picture picture = readPicture(folder / images[k]);
    if (picture.grey.empty()) continue;
    cv::Mat mirrored;
    cv::flip(picture.grey, mirrored, 1);
    if (showsTags(mirrored, family)) return images[k];
  }
  return std::nullopt;
}

}  // namespace poecal
