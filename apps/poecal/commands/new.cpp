// poecal new: a capture folder to fill in.
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "poecal/calibration/new_capture.hpp"
#include "poecal/core/error.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Comments in every file say what belongs in it. Existing files are never replaced.

Example:
  $ poecal new cell-3 --robot arm.urdf --target tag/target.yaml
  cell-3/arm.urdf
  cell-3/target.yaml
  cell-3/intrinsics/target.yaml
  cell-3/samples.csv
  cell-3/capture.yaml
  next: pictures into cell-3/images, their rows into cell-3/samples.csv, pictures of a board into cell-3/intrinsics; then poecal check cell-3
)";

int runNew(const NewCapture& capture, const Common& common) {
  const std::vector<std::filesystem::path> written = createCapture(capture);
  std::string text;
  std::vector<std::string> files;
  for (const std::filesystem::path& file : written) {
    files.push_back(file.string());
    text += file.string() + "\n";
  }
  const std::string folder = capture.folder.string();
  text += fmt::format("next: pictures into {0}/images, their rows into {0}/samples.csv{1}; then poecal check {0}\n", folder,
                      capture.camera.empty() ? fmt::format(", pictures of a board into {}/intrinsics", folder) : "");
  printSummary(common, text, {{"folder", folder}, {"files", files}});
  return 0;
}

}  // namespace

std::function<int()> setUpNew(CLI::App& app, const Common& common) {
  struct Options {
    NewCapture capture;
    std::string setup = setupName(Setup::kEyeToHand);
  };
  const auto options = std::make_shared<Options>();
  NewCapture& capture = options->capture;
  app.add_option("FOLDER", capture.folder, "The folder to make")->required();
  app.add_option("--robot", capture.robot, "The nominal arm, robot.yaml or URDF")->required()->option_text("FILE");
  app.add_option("--base-link", capture.base_link, "Of a URDF: the link that is base (default: its root)")->option_text("LINK");
  app.add_option("--tip-link", capture.tip_link, "Of a URDF: the link that is flange (default: its only leaf)")->option_text("LINK");
  app.add_option("--target", capture.target, "What the camera looks at")->required()->option_text("target.yaml");
  CLI::Option* camera = app.add_option("--camera", capture.camera, "The lens; without it a folder for pictures of a board is made")
                            ->option_text("camera.yaml");
  app.add_option("--board", capture.board, "The board in those pictures")->option_text("target.yaml")->excludes(camera);
  app.add_option("--setup", options->setup, "eye_to_hand: camera fixed; eye_in_hand: camera on the flange")
      ->check(CLI::IsMember({setupName(Setup::kEyeToHand), setupName(Setup::kEyeInHand)}))
      ->capture_default_str();
  app.footer(kExample);
  return [options, &common] {
    options->capture.setup = options->setup == setupName(Setup::kEyeInHand) ? Setup::kEyeInHand : Setup::kEyeToHand;
    return runNew(options->capture, common);
  };
}

}  // namespace poecal::app
