#include "poecal/registration/implausible.hpp"

#include "capture/manifest.hpp"
#include "core/yaml.hpp"

namespace poecal {
namespace {

InputPart partOf(const ImplausibleInput& suspicion) {
  const auto* located = dynamic_cast<const ImplausibleCapture*>(&suspicion);
  return located != nullptr ? located->part() : InputPart::kSamples;
}

/// Line of the row that is meant, or of the header where all are.
template <typename LineOf>
int lineOf(const ImplausibleInput& suspicion, LineOf line) {
  const auto* located = dynamic_cast<const ImplausibleCapture*>(&suspicion);
  return located != nullptr && located->sample() ? line(*located->sample()) : 1;
}

}  // namespace

FileError fileErrorOf(const ImplausibleInput& suspicion, const Capture& capture) {
  const std::filesystem::path manifest = capture.folder / "capture.yaml";
  // A file that capture.yaml does not name (a folder of pictures instead, an option of the command line) is said by the manifest.
  const auto named = [&](const char* key) {
    const YamlNode root = YamlNode::load(manifest);
    const auto node = root.find(key);
    return node ? namedFile(*node) : manifest;
  };
  switch (partOf(suspicion)) {
    case InputPart::kSamples:
      return {capture.table.file, lineOf(suspicion, [&](std::size_t k) { return capture.table.samples.at(k).line; }), suspicion.what()};
    case InputPart::kRobot:
      return {capture.robot_file.empty() ? manifest : capture.robot_file, 0, suspicion.what()};
    case InputPart::kTarget:
      return {named("target"), 0, suspicion.what()};
    case InputPart::kCamera:
      return {named("camera"), 0, suspicion.what()};
    case InputPart::kDetections:
      return {capture.detections_file.empty() ? named("target") : capture.detections_file, 0, suspicion.what()};
    case InputPart::kRegistration:
      return {capture.registration_file.empty() ? manifest : capture.registration_file, 0, suspicion.what()};
    case InputPart::kManifest:
      break;
  }
  return {manifest, 0, suspicion.what()};
}

FileError fileErrorOf(const ImplausibleInput& suspicion, const PoseTable& table) {
  const InputPart part = partOf(suspicion);
  const char* of = part == InputPart::kRobot ? "the robot: " : part == InputPart::kRegistration ? "the known registration: " : "";
  const std::string message = std::string(of) + suspicion.what();
  return {table.file, lineOf(suspicion, [&](std::size_t k) { return table.poses.at(k).sample.line; }), message};
}

}  // namespace poecal
