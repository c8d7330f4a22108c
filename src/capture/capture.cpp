#include "poecal/capture/capture.hpp"

#include <fmt/format.h>

#include "capture/manifest.hpp"
#include "core/yaml.hpp"
#include "poecal/core/error.hpp"
#include "robot/gravity_yaml.hpp"

namespace poecal {
namespace {

/// The file that a key names, noted down as one of the capture's.
std::filesystem::path fileOf(const YamlNode& node, Capture& capture) { return capture.files.emplace_back(namedFile(node)); }

void readLens(const YamlNode& root, Capture& capture) {
  const auto camera = root.find("camera");
  const auto intrinsics = root.find("intrinsics");
  if (camera && intrinsics) intrinsics->fail("stands beside camera, expected one of them");
  if (!camera && !intrinsics) root.fail("key 'camera' is missing, expected it, or 'intrinsics' with the folder to find it from");
  if (camera) capture.camera = readCameraOfPictures(fileOf(*camera, capture));
  if (intrinsics) capture.intrinsics_folder = namedFolder(*intrinsics);
}

/// detections.csv tells target and reference apart by the names of their points alone.
void checkReference(const YamlNode& node, const Target& target, const Target& reference) {
  for (const TargetPoint& point : reference.points) {
    if (target.find(point.id) == nullptr) continue;
    node.fail(point.id.tag < 0 ? std::string("is a board as the target is, expected tags or points beside a board")
                               : fmt::format("tag {} is the target's too, expected other ids", point.id.tag));
  }
}

}  // namespace

const char* setupName(Setup setup) { return setup == Setup::kEyeToHand ? "eye_to_hand" : "eye_in_hand"; }

Capture readCapture(const std::filesystem::path& folder) {
  const YamlNode root = YamlNode::load(folder / "capture.yaml");
  root.checkFormat("poecal-capture/1");
  root.checkKeys({"format", "name", "setup", "robot", "base_link", "tip_link", "camera", "intrinsics", "target", "samples", "detections",
                  "reference", "gravity", "registration"});
  Capture capture;
  capture.folder = folder;
  capture.files.push_back(root.file());
  capture.name = root["name"].text();
  capture.setup = readSetup(root["setup"]);
  if (auto robot = readNamedRobot(root)) {
    capture.arm = std::move(robot->arm);
    capture.robot_file = robot->file;
    capture.files.push_back(robot->file);
    capture.base_link = robot->base_link;
    capture.tip_link = robot->tip_link;
  }
  readLens(root, capture);
  capture.target = readTarget(fileOf(root["target"], capture));
  if (const auto reference = root.find("reference")) {
    capture.reference = readTarget(fileOf(*reference, capture));
    checkReference(*reference, capture.target, *capture.reference);
  }
  if (const auto detections = root.find("detections")) capture.detections_file = namedFile(*detections);
  if (const auto registration = root.find("registration")) capture.registration_file = fileOf(*registration, capture);
  if (const auto gravity = root.find("gravity")) capture.gravity = readGravity(*gravity);
  capture.table =
      readSamples(fileOf(root["samples"], capture), capture.arm ? capture.arm->jointCount() : 0, capture.arm ? &*capture.arm : nullptr);
  if (capture.table.has_joints && !capture.arm) {
    root.fail(fmt::format("key 'robot' is missing, expected the arm whose joints {} gives", capture.table.file.filename().string()));
  }
  return capture;
}

}  // namespace poecal
