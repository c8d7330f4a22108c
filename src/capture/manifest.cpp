#include "capture/manifest.hpp"

#include <fmt/format.h>

#include "poecal/robot/robot_file.hpp"

namespace poecal {

namespace {

/// The path of a key. @throws FileError where nothing of that type is there, or where the system will not say.
std::filesystem::path named(const YamlNode& node, std::filesystem::file_type type, const char* what) {
  const std::filesystem::path path = node.file().parent_path() / node.text();
  std::error_code error;
  const std::filesystem::file_type found = std::filesystem::status(path, error).type();
  if (found == type) return path;
  if (found == std::filesystem::file_type::none) node.fail(fmt::format("'{}' cannot be read: {}", node.text(), error.message()));
  node.fail(fmt::format("'{}' is {}, expected a {} named from the folder of {}", node.text(),
                        found == std::filesystem::file_type::not_found ? "not there" : fmt::format("no {}", what), what,
                        node.file().filename().string()));
}

}  // namespace

std::filesystem::path namedFile(const YamlNode& node) { return named(node, std::filesystem::file_type::regular, "file"); }

std::filesystem::path namedFolder(const YamlNode& node) { return named(node, std::filesystem::file_type::directory, "folder"); }

Setup readSetup(const YamlNode& node) {
  for (const Setup setup : {Setup::kEyeToHand, Setup::kEyeInHand}) {
    if (node.text() == setupName(setup)) return setup;
  }
  node.fail(fmt::format("is '{}', expected eye_to_hand or eye_in_hand", node.text()));
}

std::optional<NamedRobot> readNamedRobot(const YamlNode& root) {
  const auto robot = root.find("robot");
  NamedRobot named;
  if (robot) named.file = namedFile(*robot);
  const bool urdf = robot && isUrdf(named.file);
  for (const char* key : {"base_link", "tip_link"}) {
    if (!urdf && root.has(key)) root[key].fail("only a robot that is a URDF has links to name");
    // What is wrong with the file comes first: whoever names a xacro has no use for links yet.
    if (urdf && !root.has(key)) urdfEnds(named.file);
  }
  if (!robot) return std::nullopt;
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
