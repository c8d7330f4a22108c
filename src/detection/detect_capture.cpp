#include "poecal/detection/detect_capture.hpp"

#include <algorithm>

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
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.id < b.id; });
  }
  const std::vector<PictureNote> target_notes = result.notes;
  for (PictureNote& note : reference.notes) {
    const bool said = std::any_of(target_notes.begin(), target_notes.end(),
                                  [&](const PictureNote& other) { return other.image == note.image && other.message == note.message; });
    if (said) continue;
    note.message = "reference: " + note.message;
    note.failed = false;
    result.notes.push_back(std::move(note));
  }
}

}  // namespace

DetectResult detectCapture(const Capture& capture, DetectOptions options) {
  if (capture.camera) {
    options.expected_width = capture.camera->width;
    options.expected_height = capture.camera->height;
    options.camera = capture.camera;
  }
  std::vector<std::string> images;
  for (const Sample& sample : capture.table.samples) images.push_back(sample.image);
  if (!capture.reference) return detect(capture.folder, images, capture.target, options);
  options.other_tags = tagIds(*capture.reference);
  DetectResult result = detect(capture.folder, images, capture.target, options);
  options.other_tags = tagIds(capture.target);
  addReference(result, detect(capture.folder, images, *capture.reference, options));
  return result;
}

}  // namespace poecal
