#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "detection/corner_finder.hpp"
#include "detection/grid_corners.hpp"
#include "detection/tag_detector.hpp"
#include "detection/tag_refiner.hpp"
#include "detection/wide_tag_detector.hpp"
#include "target/names.hpp"

namespace poecal {
namespace {

class AprilTagFinder : public CornerFinder {
 public:
  AprilTagFinder(const Target& target, const DetectOptions& options)
      : family_(target.family),
        quad_decimate_(options.quad_decimate),
        others_(options.other_tags.begin(), options.other_tags.end()),
        border_bits_(target.type == TargetType::kAprilGrid ? target.border_bits : 1),
        detector_(target.family) {
    // Kalibr's grid has black squares where four tags meet.
    const bool bare_corners = target.type != TargetType::kAprilGrid;
    for (const TargetTag& tag : target.tags) wanted_.insert(tag.id);
    if (target.type == TargetType::kAprilGrid) grid_ = target;
    if (border_bits_ != 1 && mayHaveWideBorder(target.family)) wide_detector_.emplace(target.family);
    if (!options.refine) return;
    refiner_.emplace(target.family, bare_corners, options.camera);
    if (wide_detector_) wide_refiner_.emplace(target.family, bare_corners, options.camera, 2);
  }

  FoundCorners find(const cv::Mat& grey) override {
    std::vector<TagDetection> tags;
    if (border_bits_ != 2) tags = detector_.detect(grey, quad_decimate_, true);
    // A tag that is read without a correction is not one of the other kind.
    if (wide_detector_ && !anyWantedReadIn(tags)) {
      const std::vector<TagDetection> wide = wide_detector_->detect(grey);
      if (border_bits_ == 2 || anyWantedReadIn(wide)) return settle(choose(wide), grey, wide_refiner_ ? &*wide_refiner_ : nullptr);
    }
    if (!allWantedIn(tags)) {
      // Slower by an order of magnitude, so only where the quick pass has missed something.
      std::vector<TagDetection> more = detectThoroughly(detector_, grey);
      addUnseen(more, tags);
      tags = std::move(more);
    }
    return settle(choose(tags), grey, refiner_ ? &*refiner_ : nullptr);
  }

 private:
  bool anyWantedReadIn(const std::vector<TagDetection>& tags) const {
    return std::any_of(tags.begin(), tags.end(),
                       [&](const TagDetection& tag) { return tag.corrected_bits == 0 && wanted_.contains(tag.id); });
  }

  /// The corners of single tags as those of the target. @param refiner  of tags with such a border; nullptr: they are not fitted.
  FoundCorners settle(FoundCorners finding, const cv::Mat& grey, TagRefiner* refiner) const {
    if (grid_) settleGridCorners(*grid_, grey, finding.corners);
    if (refiner != nullptr) finding.look = refine(*refiner, grey, finding.corners);
    if (refiner != nullptr && grid_ && !finding.look) dropLoneTag(finding);
    return finding;
  }

  bool allWantedIn(const std::vector<TagDetection>& tags) const {
    std::set<int> missing = wanted_;
    for (const TagDetection& tag : tags) missing.erase(tag.id);
    return missing.empty();
  }

  FoundCorners choose(const std::vector<TagDetection>& tags) {
    std::map<int, std::vector<const TagDetection*>> by_id;
    for (const TagDetection& tag : tags) by_id[tag.id].push_back(&tag);
    FoundCorners finding;
    for (auto& [id, seen] : by_id) {
      // What was read without correction is the tag; what needed correction beside it is clutter.
      const auto fewest = [](const TagDetection* a, const TagDetection* b) { return a->corrected_bits < b->corrected_bits; };
      const int bits = (*std::min_element(seen.begin(), seen.end(), fewest))->corrected_bits;
      std::erase_if(seen, [bits](const TagDetection* tag) { return tag->corrected_bits > bits; });
      if (!wanted_.contains(id)) {
        if (bits == 0 && !others_.contains(id)) finding.notes.push_back(fmt::format("tag {} is not the target's", id));
      } else if (seen.size() > 1) {
        finding.notes.push_back(fmt::format("tag {} is seen {} times and left out", id, seen.size()));
      } else {
        const double sigma = unrefinedSigma(seen.front()->px);
        for (int corner = 0; corner < 4; ++corner) finding.corners.push_back({{id, corner}, seen.front()->px.col(corner), sigma});
      }
    }
    if (finding.corners.empty() && finding.notes.empty()) finding.notes.push_back(fmt::format("no tag of family {} was found", family_));
    return finding;
  }

  /// Fits the tags that have all four corners to the picture; others stay as they are. @return what the fits say of the picture.
  static std::optional<PictureLook> refine(TagRefiner& refiner, const cv::Mat& grey, std::vector<Corner>& corners) {
    std::vector<PictureLook> looks;
    for (std::size_t first = 0; first + 4 <= corners.size(); ++first) {
      const int id = corners[first].id.tag;
      if (corners[first].id.corner != 0 || corners[first + 3].id != PointId{id, 3}) continue;
      TagCorners px;
      for (int k = 0; k < 4; ++k) px.col(k) = corners[first + static_cast<std::size_t>(k)].px;
      const std::optional<TagFit> fit = refiner.refine(grey, id, px);
      if (!fit) continue;
      const Eigen::Vector4d sigmas = fit->sigmas();
      for (int k = 0; k < 4; ++k) corners[first + static_cast<std::size_t>(k)] = {{id, k}, fit->px.col(k), sigmas(k)};
      looks.push_back(fit->look());
    }
    return medianLook(looks);
  }

  /// Kalibr's black squares draw the corners of tags away by pixels; where only one is in view, its fit alone could have told.
  static void dropLoneTag(FoundCorners& finding) {
    if (finding.corners.size() != 4) return;
    finding.notes.push_back(fmt::format("tag {} stands alone and does not fit the picture", finding.corners.front().id.tag));
    finding.corners.clear();
  }

  std::string family_;
  double quad_decimate_;
  std::set<int> others_;
  std::set<int> wanted_;
  std::optional<Target> grid_;
  int border_bits_;  ///< 0: whichever a picture shows
  TagDetector detector_;
  std::optional<WideTagDetector> wide_detector_;
  std::optional<TagRefiner> refiner_, wide_refiner_;
};

}  // namespace

std::unique_ptr<CornerFinder> makeAprilTagFinder(const Target& target, const DetectOptions& options) {
  return std::make_unique<AprilTagFinder>(target, options);
}

}  // namespace poecal
