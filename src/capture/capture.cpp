#include "poecal/capture/capture.hpp"

#include <fmt/format.h>

#include "core/yaml.hpp"
#include "poecal/core/error.hpp"
#include "poecal/robot/robot_file.hpp"

namespace poecal {
namespace {

/// The file that a key of the manifest names, relative to its folder. @throws FileError where it is not there.
std::filesystem::path namedFile(const YamlNode& node) {
  const std::filesystem::path file = node.file().parent_path() / node.text();
  if (!std::filesystem::is_regular_file(file)) node.fail(fmt::format("'{}' is no file of the capture folder", node.text()));
  return file;
}

std::filesystem::path namedFolder(const YamlNode& node) {
  const std::filesystem::path folder = node.file().parent_path() / node.text();
  if (!std::filesystem::is_directory(folder)) node.fail(fmt::format("'{}' is no folder of the capture folder", node.text()));
  return folder;
}

Setup readSetup(const YamlNode& node) {
  for (const Setup setup : {Setup::kEyeToHand, Setup::kEyeInHand}) {
    if (node.text() == setupName(setup)) return setup;
  }
  node.fail(fmt::format("is '{}', expected eye_to_hand or eye_in_hand", node.text()));
}

void readRobot(const YamlNode& root, Capture& capture) {
  const auto robot = root.find("robot");
  const bool urdf = robot && std::filesystem::path(robot->text()).extension() == ".urdf";
  for (const char* key : {"base_link", "tip_link"}) {
    if (!urdf && root.has(key)) root[key].fail("only a robot that is a URDF has links to name");
  }
  if (!robot) return;
  capture.robot_file = namedFile(*robot);
  if (!urdf) {
    capture.arm = readRobotYaml(capture.robot_file);
    return;
  }
  capture.base_link = root["base_link"].text();
  capture.tip_link = root["tip_link"].text();
  capture.arm = readUrdf(capture.robot_file, capture.base_link, capture.tip_link);
}

void readLens(const YamlNode& root, Capture& capture) {
  const auto camera = root.find("camera");
  const auto intrinsics = root.find("intrinsics");
  if (camera && intrinsics) intrinsics->fail("stands beside camera, expected one of them");
  if (!camera && !intrinsics) root.fail("key 'camera' is missing, expected it, or 'intrinsics' with the folder to find it from");
  if (camera) capture.camera = readCamera(namedFile(*camera));
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
                  "reference", "gravity"});
  Capture capture;
  capture.folder = folder;
  capture.name = root["name"].text();
  capture.setup = readSetup(root["setup"]);
  readRobot(root, capture);
  readLens(root, capture);
  capture.target = readTarget(namedFile(root["target"]));
  if (const auto reference = root.find("reference")) {
    capture.reference = readTarget(namedFile(*reference));
    checkReference(*reference, capture.target, *capture.reference);
  }
  if (const auto detections = root.find("detections")) capture.detections_file = namedFile(*detections);
  if (const auto gravity = root.find("gravity")) capture.gravity = gravity->vector3();
  capture.table =
      readSamples(namedFile(root["samples"]), capture.arm ? capture.arm->jointCount() : 0, capture.arm ? &*capture.arm : nullptr);
  if (capture.table.has_joints && !capture.arm) {
    root.fail(fmt::format("key 'robot' is missing, expected the arm whose joints {} gives", capture.table.file.filename().string()));
  }
  return capture;
}

}  // namespace poecal
