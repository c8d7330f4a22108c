#include "inputs.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "board_folder.hpp"
#include "poecal/core/content_key.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/detect_capture.hpp"
#include "poecal/detection/known_corners.hpp"
#include "stage.hpp"

namespace poecal::app {
namespace {

Camera cameraOf(const Capture& capture, const std::filesystem::path& out, const Common& common) {
  if (capture.camera) return *capture.camera;
  const std::filesystem::path file = out / "camera.yaml";
  ContentKey key;
  key.add(detectionKey(readTarget(capture.intrinsics_folder / "target.yaml"), {}));
  for (const std::string& picture : listPictures(capture.intrinsics_folder)) key.addFile(capture.intrinsics_folder / picture);
  const Stage stage(out, "intrinsics", {file}, key);
  if (!stage.upToDate()) {
    calibrateBoardFolder(capture.intrinsics_folder, {}, common, file);
    stage.markDone();
  }
  return readCamera(file);
}

/// Leaves a file of this content alone: its time tells others that nothing is new.
void writeWhereNew(const std::filesystem::path& file, const std::string& content) {
  if (!std::filesystem::exists(file) || readTextFile(file) != content) writeTextFile(file, content);
}

Detections detectionsOf(const Capture& capture, const Camera& camera, const std::filesystem::path& out, const Common& common) {
  const Target* reference = capture.reference ? &*capture.reference : nullptr;
  if (!capture.detections_file.empty()) return readDetections(capture.detections_file, capture.target, reference);
  DetectOptions options;
  options.jobs = common.jobs;
  options.expected_width = camera.width;
  options.expected_height = camera.height;
  options.camera = camera;
  KnownCorners known(knownCornersFile(out));
  const DetectResult result = detectCapture(capture, options, &known);
  known.finish();
  warnAll(describe(result.notes));
  requireTarget(capture, result);
  const std::filesystem::path file = out / "detections.csv";
  writeWhereNew(file, detectionsCsv(result.detections));
  writeWhereNew(picturesFile(file), picturesCsv(result.detections));
  return readDetections(file, capture.target, reference);
}

}  // namespace

void requireTarget(const Capture& capture, const DetectResult& result) {
  for (const ImageCorners& picture : result.detections.images) {
    for (const Corner& corner : picture.corners) {
      if (capture.target.find(corner.id) != nullptr) return;
    }
  }
  const std::vector<std::string> notes = describe(result.notes);
  throw InsufficientData(fmt::format("{}: the target was found in none of the {} pictures{}", capture.folder.string(),
                                     result.detections.images.size(), notes.empty() ? "" : " (" + notes.back() + ")"));
}

std::vector<std::string> describe(const std::vector<PictureNote>& notes) {
  std::vector<std::string> messages;
  for (const PictureNote& note : notes) messages.push_back(note.image + ": " + note.message);
  return messages;
}

void warnAll(const std::vector<std::string>& messages) {
  constexpr std::size_t kShown = 20;
  for (std::size_t k = 0; k < std::min(kShown, messages.size()); ++k) warn(messages[k]);
  if (messages.size() > kShown) warn(fmt::format("and {} more of this kind", messages.size() - kShown));
}

CLI::Option* addCaptureOption(CLI::App& app, CaptureSource& source) {
  CLI::Option* capture = app.add_option("CAPTURE", source.folder, "Capture folder");
  app.add_option("--intrinsics", source.intrinsics, "Camera file (camera.yaml) instead of what the capture names")->needs(capture);
  return capture;
}

CLI::Option* addMeasuredCaptureOption(CLI::App& app, CaptureSource& source) {
  CLI::Option* capture = addCaptureOption(app, source);
  app.add_option("--detections", source.detections, "Corners found earlier (detections.csv); no picture is read")->needs(capture);
  return capture;
}

Capture openCapture(const CaptureSource& source) {
  Capture capture = readCapture(source.folder);
  if (!source.intrinsics.empty()) capture.camera = readCamera(source.intrinsics);
  if (!source.detections.empty()) capture.detections_file = source.detections;
  return capture;
}

std::filesystem::path knownCornersFile(const std::filesystem::path& folder) { return folder / ".stages" / "corners"; }

CaptureInputs loadCapture(const CaptureSource& source, const std::filesystem::path& out, const Common& common) {
  CaptureInputs inputs;
  inputs.capture = openCapture(source);
  const Capture& capture = inputs.capture;
  inputs.camera = cameraOf(capture, out, common);
  inputs.detections = detectionsOf(capture, inputs.camera, out, common);
  if (capture.table.has_joints) inputs.cell.arm = capture.arm;
  inputs.cell.camera = inputs.camera;
  inputs.cell.registration.setup = capture.setup;
  inputs.observations = cornerObservations(capture.table, inputs.detections, capture.target);
  if (inputs.observations.empty()) {
    throw InsufficientData(
        fmt::format("{}: none of the {} samples has corners of the target", capture.folder.string(), capture.table.samples.size()));
  }
  return inputs;
}

}  // namespace poecal::app
