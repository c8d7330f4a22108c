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
  camera.yaml: plumb_bob, 13 pictures, 702 points, 0.181 px rms
    fx      533.301 +- 0.41
    fy      533.365 +- 0.43
    cx      342.127 +- 0.43
    cy      234.045 +- 0.47
    k1     -0.28094 +- 0.005
    k2      0.02911 +- 0.039
    p1      0.00112 +- 0.0001
    p2     -0.00005 +- 0.00013
    k3      0.15209 +- 0.082
  worst pictures:
    chessboard-08.jpg  0.236 px rms, 0.47 px at most
    chessboard-09.jpg  0.203 px rms, 0.53 px at most
    chessboard-12.jpg  0.199 px rms, 0.50 px at most
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
                        !worst[k]->bad     ? ""
                        : result.is_robust ? "  (bad, left out)"
                                           : "  (bad)");
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
  nlohmann::json bad = nlohmann::json::array();
  for (const ViewResidual& view : result.views) {
    if (view.bad) bad.push_back(view.image);
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
          {"warnings", result.warnings}};
}

int run(const Arguments& arguments, const Common& common) {
  IntrinsicsOptions options;
  options.model = findDistortionModel(arguments.model).value();
  options.robust = !arguments.plain;
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
