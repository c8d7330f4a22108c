// poecal simulate: a scene -> a capture folder, with its truth beside it.
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "poecal/simulation/simulate.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

struct Arguments {
  std::filesystem::path scene, out;
};

constexpr const char* kExample = R"(
Example:
  $ poecal simulate calib_data/scara/scene.yaml --out scara
  scara: 60 poses, 60 pictures with 240 corners, 12 intrinsics pictures
  scara-truth: the arm, lens, registration and corners that they were made from
)";

std::string summaryText(const Arguments& arguments, const SimulateSummary& summary) {
  std::string text = fmt::format("{}: {} poses, {} {} with {} corners", arguments.out.string(), summary.poses, summary.samples,
                                 summary.pictures ? "pictures" : "samples", summary.corners);
  if (summary.without_target > 0) text += fmt::format(", {} of them without a whole target", summary.without_target);
  if (summary.boards > 0) text += fmt::format(", {} intrinsics pictures", summary.boards);
  return text + fmt::format("\n{}: the arm, lens, registration and corners that they were made from\n", summary.truth.string());
}

nlohmann::json summaryJson(const Arguments& arguments, const SimulateSummary& summary) {
  return {{"capture", arguments.out.string()},
          {"truth", summary.truth.string()},
          {"poses", summary.poses},
          {"samples", summary.samples},
          {"samples_without_target", summary.without_target},
          {"corners", summary.corners},
          {"pictures", summary.pictures},
          {"intrinsics_pictures", summary.boards}};
}

int run(const Arguments& arguments, const Common& common) {
  const Scene scene = readScene(arguments.scene);
  TerminalListener listener(common);
  const SimulateSummary summary = simulate(scene, arguments.out, {.jobs = common.jobs, .progress = listener.progressFunction()});
  printSummary(common, summaryText(arguments, summary), summaryJson(arguments, summary));
  return 0;
}

}  // namespace

std::function<int()> setUpSimulate(CLI::App& app, const Common& common) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("SCENE", arguments->scene, "scene.yaml: arm, camera, target and their flaws")->required();
  app.add_option("--out", arguments->out, "The capture folder to write, new or empty; the truth goes to OUT-truth")->required();
  app.footer(kExample);
  return [arguments, &common] { return run(*arguments, common); };
}

}  // namespace poecal::app
