#include "poecal/calibration/load_capture.hpp"

#include <fmt/format.h>

#include "calibration/kept_result.hpp"
#include "poecal/calibration/board_folder.hpp"
#include "poecal/core/content_key.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/detect_capture.hpp"
#include "poecal/detection/known_corners.hpp"

namespace poecal {
namespace {

Camera cameraOf(const Capture& capture, const std::filesystem::path& out, int jobs, Listener& listener) {
  if (capture.camera) return *capture.camera;
  const std::filesystem::path file = out / "camera.yaml";
  ContentKey key;
  key.add(detectionKey(readTarget(capture.intrinsics_folder / "target.yaml"), {}));
  for (const std::string& picture : listPictures(capture.intrinsics_folder)) key.addFile(capture.intrinsics_folder / picture);
  const KeptResult kept(out, "intrinsics", {file}, key);
  if (kept.upToDate()) return readCamera(file);
  const IntrinsicsResult result = calibrateBoardFolder(capture.intrinsics_folder, {}, jobs, file, listener);
  kept.markDone();
  return result.chosen().camera;
}

/// Leaves a file of this content alone: its time tells others that nothing is new.
void writeWhereNew(const std::filesystem::path& file, const std::string& content) {
  if (!std::filesystem::exists(file) || readTextFile(file) != content) writeTextFile(file, content);
}

Detections detectionsOf(const Capture& capture, const Camera& camera, const std::filesystem::path& out, int jobs, Listener& listener) {
  const Target* reference = capture.reference ? &*capture.reference : nullptr;
  if (!capture.detections_file.empty()) return readDetections(capture.detections_file, capture.target, reference);
  DetectOptions options;
  options.jobs = jobs;
  options.progress = listener.progressFunction();
  options.expected_width = camera.width;
  options.expected_height = camera.height;
  options.camera = camera;
  KnownCorners known(knownCornersFile(out));
  const DetectResult result = detectCapture(capture, options, &known);
  known.finish();
  listener.warnings(texts(result.notes));
  requireTarget(capture, result);
  const std::filesystem::path file = out / "detections.csv";
  writeWhereNew(file, detectionsCsv(result.detections));
  writeWhereNew(picturesFile(file), picturesCsv(result.detections));
  return result.detections;
}

}  // namespace

void requireTarget(const Capture& capture, const DetectResult& result) {
  for (const ImageCorners& picture : result.detections.images) {
    for (const Corner& corner : picture.corners) {
      if (capture.target.find(corner.id) != nullptr) return;
    }
  }
  throw InsufficientData(fmt::format("{}: the target was found in none of the {} pictures{}", capture.folder.string(),
                                     result.detections.images.size(), result.notes.empty() ? "" : " (" + result.notes.back().text() + ")"));
}

Capture openCapture(const CaptureSource& source) {
  Capture capture = readCapture(source.folder);
  if (!source.intrinsics.empty()) capture.camera = readCameraOfPictures(source.intrinsics);
  takeSizeFromPictures(capture);
  if (!source.detections.empty()) capture.detections_file = source.detections;
  return capture;
}

std::filesystem::path knownCornersFile(const std::filesystem::path& folder) { return folder / ".stages" / "corners"; }

LoadedCapture loadCapture(const CaptureSource& source, const std::filesystem::path& out, int jobs, Listener& listener) {
  LoadedCapture loaded;
  loaded.capture = openCapture(source);
  if (loaded.capture.camera) listener.warnings(loaded.capture.camera->remarks);
  const Capture& capture = loaded.capture;
  loaded.nominal.camera = cameraOf(capture, out, jobs, listener);
  if (capture.table.has_joints) loaded.nominal.arm = capture.arm;
  loaded.nominal.registration.setup = capture.setup;
  loaded.measurements = measurementsOf(capture, detectionsOf(capture, *loaded.nominal.camera, out, jobs, listener));
  if (loaded.measurements.observations.empty()) {
    throw InsufficientData(
        fmt::format("{}: none of the {} samples has corners of the target", capture.folder.string(), capture.table.samples.size()));
  }
  return loaded;
}

}  // namespace poecal
