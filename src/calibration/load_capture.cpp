#include "poecal/calibration/load_capture.hpp"

#include <fmt/format.h>

#include "calibration/kept_result.hpp"
#include "calibration/reference_remarks.hpp"
#include "calibration/row_contradictions.hpp"
#include "poecal/calibration/board_folder.hpp"
#include "poecal/calibration/outputs.hpp"
#include "poecal/capture/image_names.hpp"
#include "poecal/cell/known_registration.hpp"
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
  const KeptResult kept(out, "intrinsics", {file, residualsFile(file)}, key);
  if (kept.upToDate()) return readCamera(file);
  const IntrinsicsResult result = calibrateBoardFolder(capture.intrinsics_folder, {}, jobs, file, listener);
  kept.markDone();
  return result.chosen().camera;
}

/// Leaves a file of this content alone: its time tells others that nothing is new.
void writeWhereNew(const std::filesystem::path& file, const std::string& content) {
  std::error_code status;
  if (!std::filesystem::exists(file, status) || readTextFile(file) != content) writeTextFile(file, content);
}

Detections detectionsOf(const Capture& capture, const Camera& camera, const std::filesystem::path& out, int jobs, Listener& listener) {
  const Target* reference = capture.reference ? &*capture.reference : nullptr;
  if (!capture.detections_file.empty()) {
    Detections detections = readDetections(capture.detections_file, capture.target, reference, ImageSize{camera.width, camera.height});
    listener.warnings(checkImagesMeet(capture.table, detections, capture.detections_file));
    listener.warnings(compareCornersOfPictures(capture.table, detections));
    listener.warnings(remarksOnCorners(capture.detections_file, detections));
    return detections;
  }
  listener.warnings(compareBytesOfPictures(capture, listener.progressFunction()));
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

std::vector<std::filesystem::path> resultsOf(const Capture& capture, const std::filesystem::path& out) {
  std::vector<std::filesystem::path> results;
  for (const char* name : {"registration.yaml", "flange_poses.csv", "model.yaml", "identification.json", "diagnosis.json"}) {
    results.push_back(out / name);
  }
  if (!capture.camera) {
    results.push_back(out / "camera.yaml");
    results.push_back(residualsFile(results.back()));
  }
  if (capture.detections_file.empty()) {
    results.push_back(out / "detections.csv");
    results.push_back(picturesFile(results.back()));
  }
  return results;
}

LoadedCapture loadCapture(const CaptureSource& source, const std::filesystem::path& out, int jobs, Listener& listener) {
  LoadedCapture loaded;
  loaded.capture = openCapture(source);
  if (loaded.capture.camera) listener.warnings(loaded.capture.camera->remarks);
  const Capture& capture = loaded.capture;
  const bool joints = capture.arm && capture.table.has_joints;
  listener.warnings(remarksOnRows(capture.table.file, capture.table.samples, joints ? &*capture.arm : nullptr));
  if (capture.reference && capture.setup == Setup::kEyeInHand) {
    listener.warning("reference: is not used: before a camera on the flange every tag that stands still moves, as the target does");
  }
  std::vector<std::filesystem::path> files = filesOf(capture, true);
  if (!source.intrinsics.empty()) files.push_back(source.intrinsics);
  const std::vector<std::filesystem::path> results = resultsOf(capture, out);
  requireOutputs(results, files);
  requireOutputs(reportFiles(out), files);
  loaded.record = std::make_shared<const ResultRecord>(out, results, listener);
  loaded.nominal.camera = cameraOf(capture, out, jobs, listener);
  if (capture.table.has_joints) loaded.nominal.arm = capture.arm;
  loaded.nominal.registration.setup = capture.setup;
  if (!capture.registration_file.empty()) readKnownRegistration(capture.registration_file, loaded.nominal.registration);
  loaded.measurements = measurementsOf(capture, detectionsOf(capture, *loaded.nominal.camera, out, jobs, listener));
  if (capture.reference && capture.setup == Setup::kEyeToHand) listener.warnings(remarksOnReference(loaded.measurements.observations));
  if (loaded.measurements.observations.empty()) {
    throw InsufficientData(
        fmt::format("{}: none of the {} samples has corners of the target", capture.folder.string(), capture.table.samples.size()));
  }
  return loaded;
}

}  // namespace poecal
