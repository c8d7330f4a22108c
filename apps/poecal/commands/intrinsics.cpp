// poecal intrinsics: camera intrinsics from pictures of a board.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "poecal/calibration/board_folder.hpp"
#include "poecal/calibration/outputs.hpp"
#include "poecal/camera/intrinsics.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

struct Arguments {
  std::filesystem::path folder, out;
  std::string model = distortionModelName(IntrinsicsOptions{}.model);
  bool plain = false;
};

constexpr const char* kExample = R"(
Example:
  $ poecal intrinsics capture/intrinsics --out camera.yaml
  camera.yaml: plumb_bob, 13 pictures, 702 points, 0.175 px rms
    fx      533.276 +- 0.89
    fy      533.335 +- 0.93
    cx      342.139 +- 0.93
    cy      233.922 +- 1
    k1     -0.28333 +- 0.011
    k2      0.04812 +- 0.082
    p1      0.00110 +- 0.00022
    p2     -0.00004 +- 0.00028
    k3      0.11215 +- 0.17
  projection: 1 sigma is 0.47 px in the median over the picture, 11 px at most
  worst pictures:
    chessboard-02.jpg  1.514 px rms, 6.33 px at most, bad, 6 of 54 corners do not count
    chessboard-12.jpg  0.542 px rms, 3.30 px at most, 5 of 54 corners do not count
    chessboard-09.jpg  0.337 px rms, 1.48 px at most, 3 of 54 corners do not count
  camera-residuals.csv: every picture's residuals
)";

/// The used pictures, the worst first.
std::vector<const ViewResidual*> worstFirst(const IntrinsicsResult& result) {
  std::vector<const ViewResidual*> views;
  for (const ViewResidual& view : result.views) {
    if (view.used) views.push_back(&view);
  }
  std::stable_sort(views.begin(), views.end(), [](const auto* a, const auto* b) { return a->rms_px > b->rms_px; });
  return views;
}

std::string deviationText(const IntrinsicsFit& fit, const std::string& name, double deviation) {
  if (std::find(fit.held.begin(), fit.held.end(), name) != fit.held.end()) return "held: any value fits";
  return std::isfinite(deviation) ? fmt::format("+- {:.2g}", deviation) : "(open)";
}

std::string judgementText(const ViewResidual& view, bool is_robust) {
  std::string text = view.bad ? ", bad" : "";
  if (is_robust && view.left_out) return text + ", left out";
  if (is_robust && view.outliers > 0) text += fmt::format(", {} of {} corners do not count", view.outliers, view.points);
  return text;
}

std::string summaryText(const Arguments& arguments, const IntrinsicsResult& result) {
  constexpr std::size_t kWorstShown = 3;
  const IntrinsicsFit& fit = result.chosen();
  std::string text = fmt::format("{}: {}, {} pictures, {} points, {:.3f} px rms\n", arguments.out.string(),
                                 distortionModelName(fit.camera.model), fit.pictures, fit.points, fit.rms_px);
  const Eigen::VectorXd values = fit.camera.parameters();
  const std::vector<std::string> names = fit.camera.parameterNames();
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const std::string& name = names[static_cast<std::size_t>(k)];
    text +=
        fmt::format("  {:<3} {:>11.{}f} {}\n", name, values(k), k < 4 ? 3 : 5, deviationText(fit, name, fit.camera.standard_deviation(k)));
  }
  text += fmt::format("projection: 1 sigma is {:.2g} px in the median over the picture, {:.2g} px at most\n", fit.uncertainty.median_px,
                      fit.uncertainty.largest_px);
  const std::vector<const ViewResidual*> worst = worstFirst(result);
  text += "worst pictures:\n";
  for (std::size_t k = 0; k < std::min(kWorstShown, worst.size()); ++k) {
    text += fmt::format("  {}  {:.3f} px rms, {:.2f} px at most{}\n", worst[k]->image, worst[k]->rms_px, worst[k]->max_px,
                        judgementText(*worst[k], result.is_robust));
  }
  return text + fmt::format("{}: every picture's residuals\n", residualsFile(arguments.out).string());
}

nlohmann::json summaryJson(const Arguments& arguments, const IntrinsicsResult& result) {
  const IntrinsicsFit& fit = result.chosen();
  nlohmann::json parameters, deviations;
  const std::vector<std::string> names = fit.camera.parameterNames();
  for (std::size_t k = 0; k < names.size(); ++k) {
    parameters[names[k]] = fit.camera.parameters()(static_cast<Eigen::Index>(k));
    deviations[names[k]] = fit.camera.standard_deviation(static_cast<Eigen::Index>(k));  // NaN becomes null
  }
  nlohmann::json bad = nlohmann::json::array(), left_out = nlohmann::json::array();
  for (const ViewResidual& view : result.views) {
    if (view.bad) bad.push_back(view.image);
    if (view.left_out && result.is_robust) left_out.push_back(view.image);
  }
  return {{"camera", arguments.out.string()},
          {"residuals", residualsFile(arguments.out).string()},
          {"model", distortionModelName(fit.camera.model)},
          {"parameters", parameters},
          {"standard_deviation", deviations},
          {"rms_px", fit.rms_px},
          {"sigma_px", fit.sigma_px},
          {"pictures", fit.pictures},
          {"points", fit.points},
          {"outliers", fit.outliers},
          {"held", fit.held},
          {"projection_uncertainty_px", {{"median", fit.uncertainty.median_px}, {"largest", fit.uncertainty.largest_px}}},
          {"bad_pictures", bad},
          {"left_out", left_out},
          {"warnings", result.warnings}};
}

int run(const Arguments& arguments, const Common& common) {
  IntrinsicsOptions options;
  options.model = findDistortionModel(arguments.model).value();
  options.robust = !arguments.plain;
  requireOutputs({arguments.out, residualsFile(arguments.out)}, filesOfBoard(arguments.folder));
  TerminalListener listener(common);
  const IntrinsicsResult result = calibrateBoardFolder(arguments.folder, options, common.jobs, arguments.out, listener);
  printSummary(common, summaryText(arguments, result), summaryJson(arguments, result));
  return 0;
}

}  // namespace

std::function<int()> setUpIntrinsics(CLI::App& app, const Common& common) {
  const auto arguments = std::make_shared<Arguments>();
  std::vector<std::string> models;
  for (const DistortionModel model : kDistortionModels) models.emplace_back(distortionModelName(model));
  app.add_option("FOLDER", arguments->folder, "Folder with pictures of a board and its target.yaml")->required();
  app.add_option("--out", arguments->out, "The camera file to write; STEM-residuals.csv goes beside it")->required();
  app.add_option("--model", arguments->model, "Distortion model")->check(CLI::IsMember(models))->capture_default_str();
  app.add_flag("--plain", arguments->plain,
               "Plain least squares over every corner of every picture: bad pictures are only named, and wild corners count");
  // What it asked for is what happens without it now.
  app.add_flag("--drop-bad")->group("");
  app.footer(kExample);
  return [arguments, &common] { return run(*arguments, common); };
}

}  // namespace poecal::app
