#include "poecal/calibration/new_capture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/yaml.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/printable.hpp"
#include "poecal/core/text.hpp"
#include "poecal/robot/robot_file.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBoardTemplate =
    R"(# The board whose pictures are in this folder. Take 15 or more: near and far, tilted by 20 to 40 degrees both ways, in every corner of the
# picture. Measure the printed board. Then remove the # of one of these types and enter its sizes.

# type: chessboard
# cols: 9          # inner corners along x
# rows: 6          # inner corners along y
# square: 0.03     # edge of a square [m]

# type: charuco
# cols: 9          # squares along x
# rows: 7
# square: 0.045    # [m]
# marker: 0.034    # [m]
# dictionary: DICT_6X6_250
)";

void requireNewFolder(const fs::path& folder) {
  std::error_code status;
  if (!fs::exists(folder, status)) return;
  if (fs::is_directory(folder, status) && fs::is_empty(folder, status)) return;
  throw InvalidArgument(fmt::format("{} is there already, expected a new folder or an empty one", folder.string()));
}

void chooseEnds(NewCapture& capture) {
  if (!isUrdf(capture.robot)) return;
  const UrdfEnds ends = urdfEnds(capture.robot);
  if (capture.base_link.empty()) capture.base_link = ends.root;
  if (!capture.tip_link.empty()) return;
  if (ends.leaves.size() != 1) {
    throw InvalidArgument(fmt::format("{} has {} chains, expected --tip-link to name the flange, one of their ends ({}) or a link before",
                                      capture.robot.string(), ends.leaves.size(), fmt::join(ends.leaves, ", ")));
  }
  capture.tip_link = ends.leaves.front();
}

std::string captureYaml(const NewCapture& capture, const std::string& robot) {
  const auto line = [](const std::string& entry, const std::string& comment) { return fmt::format("{:32} # {}\n", entry, comment); };
  const bool urdf = !capture.base_link.empty();
  std::string text = "# A capture for poecal. `poecal check` says what is still missing, `poecal run` calibrates from it.\n";
  text += "format: poecal-capture/1\n";
  text += line(fmt::format("name: {}", yamlText(fs::absolute(capture.folder).lexically_normal().filename().string())), "any text");
  text += line(fmt::format("setup: {}", setupName(capture.setup)),
               capture.setup == Setup::kEyeToHand ? "the camera is fixed, the target is on the flange (else eye_in_hand)"
                                                  : "the camera is on the flange, the target is fixed (else eye_to_hand)");
  text += line(fmt::format("robot: {}", yamlText(robot)), "the nominal arm");
  if (urdf) {
    text += line(fmt::format("base_link: {}", yamlText(capture.base_link)), "its link that is `base`");
    text += line(fmt::format("tip_link: {}", yamlText(capture.tip_link)), "its link that is `flange`");
  }
  text += line("target: target.yaml", "what the camera looks at");
  text += capture.camera.empty() ? line("intrinsics: intrinsics", "a folder with pictures of a board, from which the lens is found")
                                 : line("camera: camera.yaml", "the lens");
  text += line("samples: samples.csv", "one row per picture");
  text += line("# detections: detections.csv", "corners found earlier: then no picture is read");
  text += line("# reference: reference.yaml", "tags in view that never move, with ids of their own: they tell a camera that moved");
  text += line("# gravity: [0, 0, -9.80665]", "in `base` [m/s^2]; needed where the arm hangs or stands on a wall");
  return text;
}

std::string jointLine(int k, const Joint& joint) {
  const char* unit = joint.type == JointType::kRevolute ? "rad" : "m";
  std::string text = fmt::format("#   {:12} {} [{}]", fmt::format("q{}", k), printableLine(joint.name), unit);
  if (joint.limits) text += fmt::format(", {} to {}", joint.limits->lower, joint.limits->upper);
  return text + "\n";
}

std::string samplesTemplate(const Arm& arm) {
  const int n = arm.jointCount();
  std::string text =
      "# One row per picture, in the order in which they are taken. 40 poses or more, the target turned each way and seen all over the\n"
      "# picture, each joint moved as far as it goes. Lines that begin with # are comments.\n"
      "#   image        path of the picture from this folder, such as images/0000.png (PNG, JPEG or TIFF)\n";
  std::string header = "image";
  for (int k = 1; k <= n; ++k) {
    text += jointLine(k, arm.joints[static_cast<std::size_t>(k - 1)]);
    header += fmt::format(",q{}", k);
  }
  text += "#   stamp        time of exposure [s]; finds what drifts or slips. A cell may stay empty\n";
  text += fmt::format(
      "# Columns to add to the header where they are known; a diagnosis finds more with them:\n"
      "#   pose         whole number; rows that share it are shots of one pose, with the arm at rest in between. Repeats tell the noise\n"
      "#   dir1..dir{0}   -1, 0 or 1: the direction in which each joint last moved before it came to rest; finds backlash\n"
      "#   dq1..dq{0}     joint velocities at exposure [rad/s or m/s]; finds wrong stamps and rolling shutters\n"
      "#   temperature  of the arm or the cell [degrees Celsius]\n"
      "#   payload      mass carried at the flange [kg]\n"
      "#   x,y,z,qx,qy,qz,qw  T_base_flange as the controller reports it [m; quaternion]\n"
      "# A column of any other name is kept and may be found to drive an error.\n",
      n);
  return text + header + ",stamp\n";
}

}  // namespace

std::vector<fs::path> createCapture(const NewCapture& given) {
  NewCapture capture = given;
  // "x/.." is there as soon as x is made.
  capture.folder = given.folder.lexically_normal();
  requireNewFolder(capture.folder);
  chooseEnds(capture);
  const Arm arm = readArm(capture.robot, capture.base_link, capture.tip_link);
  readTarget(capture.target);
  if (!capture.camera.empty()) readCameraOfPictures(capture.camera);
  if (!capture.board.empty()) readTarget(capture.board);
  std::string robot = capture.robot.filename().string();
  for (const char* taken : {"target.yaml", "camera.yaml", "capture.yaml", "samples.csv", "images", "intrinsics"}) {
    if (robot == taken) robot = isUrdf(capture.robot) ? "robot.urdf" : "robot.yaml";
  }
  std::vector<std::pair<fs::path, std::string>> files{{robot, readTextFile(capture.robot)}, {"target.yaml", readTextFile(capture.target)}};
  if (!capture.camera.empty()) {
    files.emplace_back("camera.yaml", readTextFile(capture.camera));
  } else {
    files.emplace_back("intrinsics/target.yaml", capture.board.empty() ? kBoardTemplate : readTextFile(capture.board));
  }
  files.emplace_back("samples.csv", samplesTemplate(arm));
  files.emplace_back("capture.yaml", captureYaml(capture, robot));
  std::vector<fs::path> written;
  for (const auto& [name, text] : files) {
    writeTextFile(capture.folder / name, text);
    written.push_back(capture.folder / name);
  }
  std::error_code status;
  if (!fs::create_directories(capture.folder / "images", status) && status) {
    throw FileError(capture.folder / "images", 0, "cannot be made: " + status.message());
  }
  return written;
}

}  // namespace poecal
