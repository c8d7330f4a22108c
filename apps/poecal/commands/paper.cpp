// poecal paper: the experiment of Gao, Wang and Jiang (2013), section 4: Table 2, figures 3 and 4.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "numbers.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/identification/paper_experiment.hpp"
#include "poecal/robot/robot_file.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

/// A twist as the paper prints it: w, then v in mm.
std::string twistText(const Vector6d& xi) {
  return fmt::format("{:8.4f}{:8.4f}{:8.4f} /{:10.4f}{:10.4f}{:10.4f}", xi(0), xi(1), xi(2), 1e3 * xi(3), 1e3 * xi(4), 1e3 * xi(5));
}

std::string tableTwo(const Arm& nominal, const Arm& actual, const PaperSeed& seed) {
  std::string text = "Table 2 (w / v in mm): nominal, actual, identified by gao and by weighted (seed 1)\n";
  const auto rows = [&text](const std::string& name, const Vector6d& a, const Vector6d& b, const Vector6d& c, const Vector6d& d) {
    text += fmt::format("  {:<6}{}\n        {}\n        {}\n        {}\n", name, twistText(a), twistText(b), twistText(c), twistText(d));
  };
  for (std::size_t k = 0; k < nominal.joints.size(); ++k) {
    rows(fmt::format("xi_{}", k + 1), nominal.joints[k].xi, actual.joints[k].xi, seed.gao.arm.joints[k].xi, seed.weighted.arm.joints[k].xi);
  }
  rows("Gamma", nominal.gamma, actual.gamma, seed.gao.arm.gamma, seed.weighted.arm.gamma);
  return text;
}

std::string figureThree(const std::vector<double>& noisy, const std::vector<double>& exact) {
  std::string text = "Figure 3: RMS of y after each iteration of gao (mm and rad mixed)\n  iteration   with noise   without\n";
  for (std::size_t k = 0; k < std::max(noisy.size(), exact.size()); ++k) {
    text += fmt::format("  {:>9}   {:>10}   {:>10}\n", k, k < noisy.size() ? fmt::format("{:.3e}", noisy[k]) : "",
                        k < exact.size() ? fmt::format("{:.3e}", exact[k]) : "");
  }
  return text;
}

double medianOver(const std::vector<PaperSeed>& seeds, const std::function<double(const PaperSeed&)>& figure) {
  std::vector<double> values;
  for (const PaperSeed& seed : seeds) values.push_back(figure(seed));
  return median(std::move(values));
}

std::string figureFour(const PaperSeed& seed) {
  std::string text = "Figure 4: error at poses that calibration did not see (seed 1; mm and rad): nominal, gao, weighted\n";
  for (std::size_t k = 0; k < seed.nominal_test_poses.size(); ++k) {
    const auto entry = [](const FlangeError& error) { return fmt::format("{:9.4f} {:.2e}", 1e3 * error.position, error.rotation); };
    text += fmt::format("  {:>3} {}   {}   {}\n", k + 1, entry(seed.nominal_test_poses[k]), entry(seed.gao.test_poses[k]),
                        entry(seed.weighted.test_poses[k]));
  }
  return text;
}

constexpr const char* kExample = R"(
Example:
  $ poecal paper calib_data/puma560 --seeds 20
  ...
  Median error at 50 unseen poses, median over 20 seeds
    nominal      9.3051 mm  6.99e-02 rad
    gao          0.0496 mm  3.08e-04 rad
    weighted     0.0185 mm  2.43e-04 rad
)";

}  // namespace

std::function<int()> setUpPaper(CLI::App& app, const Common& common) {
  struct Options {
    std::filesystem::path folder;
    PaperOptions paper;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("FOLDER", options->folder, "Folder with robot.yaml (nominal) and actual.yaml: calib_data/puma560")->required();
  app.add_option("--seeds", options->paper.seeds, "Seeds of poses and noise")->capture_default_str()->check(positiveNumber());
  app.footer(kExample);
  return [options, &common] {
    const Arm nominal = readRobotYaml(options->folder / "robot.yaml");
    const Arm actual = readRobotYaml(options->folder / "actual.yaml");
    const std::vector<PaperSeed> seeds = paperExperiment(nominal, actual, options->paper);
    PaperOptions exact = options->paper;
    exact.seeds = 1;
    exact.noise_position = exact.noise_rotation = 0.0;
    const std::vector<PaperSeed> without = paperExperiment(nominal, actual, exact);

    nlohmann::json json;
    std::string medians = fmt::format("Median error at {} unseen poses, median over {} seeds\n", options->paper.test_poses, seeds.size());
    const auto row = [&](const char* name, FlangeError (*figure)(const PaperSeed&)) {
      const double position = medianOver(seeds, [figure](const PaperSeed& seed) { return figure(seed).position; });
      const double rotation = medianOver(seeds, [figure](const PaperSeed& seed) { return figure(seed).rotation; });
      medians += fmt::format("  {:<10}{:9.4f} mm  {:.2e} rad\n", name, 1e3 * position, rotation);
      json["unseen_poses"][name] = {{"position_mm", 1e3 * position}, {"rotation_rad", rotation}};
    };
    row("nominal", [](const PaperSeed& seed) { return seed.nominal; });
    row("gao", [](const PaperSeed& seed) { return seed.gao.error; });
    row("weighted", [](const PaperSeed& seed) { return seed.weighted.error; });
    json["rms_y"] = seeds.front().gao.residuals;
    json["rms_y_without_noise"] = without.front().gao.residuals;
    printSummary(common,
                 tableTwo(nominal, actual, seeds.front()) + figureThree(seeds.front().gao.residuals, without.front().gao.residuals) +
                     figureFour(seeds.front()) + medians,
                 json);
    return 0;
  };
}

}  // namespace poecal::app
