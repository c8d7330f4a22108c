#include "poecal/detection/detect_capture.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "detection/picture.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

std::vector<int> tagIds(const Target& target) {
  std::vector<int> ids;
  for (const TargetTag& tag : target.tags) ids.push_back(tag.id);
  return ids;
}

void addReference(DetectResult& result, DetectResult reference) {
  for (std::size_t k = 0; k < result.detections.images.size(); ++k) {
    std::vector<Corner>& corners = result.detections.images[k].corners;
    const std::vector<Corner>& more = reference.detections.images[k].corners;
    corners.insert(corners.end(), more.begin(), more.end());
    std::optional<PictureLook>& look = result.detections.images[k].look;
    if (!look) look = reference.detections.images[k].look;
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.id < b.id; });
  }
  std::set<std::pair<std::string, std::string>> said;
  for (const PictureNote& note : result.notes) said.emplace(note.image, note.message);
  for (PictureNote& note : reference.notes) {
    if (said.contains({note.image, note.message})) continue;
    note.message = "reference: " + note.message;
    note.failed = false;
    result.notes.push_back(std::move(note));
  }
}

}  // namespace

void takeSizeFromPictures(Capture& capture) {
  if (!capture.camera || capture.camera->width > 0) return;
  for (const Sample& sample : capture.table.samples) {
    const cv::Mat grey = sample.image.empty() ? cv::Mat() : readPicture(capture.folder / sample.image).grey;
    if (grey.empty()) continue;
    capture.camera->width = grey.cols;
    capture.camera->height = grey.rows;
    return;
  }
  throw FileError(capture.folder, 0,
                  "its camera file states no image_width and image_height, expected them or a picture to take them from");
}

DetectResult detectCapture(const Capture& capture, DetectOptions options, KnownCorners* known) {
  if (capture.camera) {
    options.expected_width = capture.camera->width;
    options.expected_height = capture.camera->height;
    options.camera = capture.camera;
  }
  std::vector<std::string> images;
  for (const Sample& sample : capture.table.samples) images.push_back(sample.image);
  if (!capture.reference) return detect(capture.folder, images, capture.target, options, known);
  options.other_tags = tagIds(*capture.reference);
  DetectResult result = detect(capture.folder, images, capture.target, options, known);
  options.other_tags = tagIds(capture.target);
  addReference(result, detect(capture.folder, images, *capture.reference, options, known));
  return result;
}

}  // namespace poecal
