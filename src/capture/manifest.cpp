#include "capture/manifest.hpp"

#include <fmt/format.h>

#include "poecal/robot/robot_file.hpp"

namespace poecal {

std::filesystem::path namedFile(const YamlNode& node) {
  const std::filesystem::path file = node.file().parent_path() / node.text();
  if (!std::filesystem::is_regular_file(file)) {
    node.fail(fmt::format("'{}' is not there, expected a file named from the folder of {}", node.text(), node.file().filename().string()));
  }
  return file;
}

std::filesystem::path namedFolder(const YamlNode& node) {
  const std::filesystem::path folder = node.file().parent_path() / node.text();
  if (!std::filesystem::is_directory(folder)) {
    node.fail(
        fmt::format("'{}' is not there, expected a folder named from the folder of {}", node.text(), node.file().filename().string()));
  }
  return folder;
}

Setup readSetup(const YamlNode& node) {
  for (const Setup setup : {Setup::kEyeToHand, Setup::kEyeInHand}) {
    if (node.text() == setupName(setup)) return setup;
  }
  node.fail(fmt::format("is '{}', expected eye_to_hand or eye_in_hand", node.text()));
}

std::optional<NamedRobot> readNamedRobot(const YamlNode& root) {
  const auto robot = root.find("robot");
  const bool urdf = robot && std::filesystem::path(robot->text()).extension() == ".urdf";
  for (const char* key : {"base_link", "tip_link"}) {
    if (!urdf && root.has(key)) root[key].fail("only a robot that is a URDF has links to name");
  }
  if (!robot) return std::nullopt;
  NamedRobot named;
  named.file = namedFile(*robot);
  if (!urdf) {
    named.arm = readRobotYaml(named.file);
    return named;
  }
  named.base_link = root["base_link"].text();
  named.tip_link = root["tip_link"].text();
  named.arm = readUrdf(named.file, named.base_link, named.tip_link);
  return named;
}

}  // namespace poecal
