// poecal predict: what a model expects for joints: corners, or flange poses.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "poecal/calibration/model_of_capture.hpp"
#include "poecal/calibration/outputs.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/capture/row_order.hpp"
#include "poecal/cell/cell.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/identification/model.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

std::string posesCsv(const Model& model, const std::vector<Sample>& samples, const std::vector<Disturbance>& disturbances) {
  std::vector<std::string> header;
  const bool images = !samples.empty() && !samples.front().image.empty();
  if (images) header.emplace_back("image");
  for (int k = 1; k <= model.cell.arm->jointCount(); ++k) header.push_back(fmt::format("q{}", k));
  for (const char* name : {"x", "y", "z", "qx", "qy", "qz", "qw"}) header.emplace_back(name);
  CsvWriter csv(header);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const Sample& sample = samples[k];
    const Eigen::Isometry3d T_base_flange = disturbedFlange(model.cell, sample, disturbances[k]);
    if (images) csv.cell(sample.image);
    for (const double q : sample.q) csv.cell(q);
    for (const double t : T_base_flange.translation()) csv.cell(t);
    const Eigen::Vector4d quaternion = quaternionXyzw(T_base_flange);
    for (const double c : quaternion) csv.cell(c);
    csv.endRow();
  }
  return csv.str();
}

std::string cornersCsv(const Model& model, const std::vector<Sample>& samples, const std::vector<Disturbance>& disturbances) {
  if (!model.cell.camera || !model.target) throw InvalidArgument("this model has no camera and target: only --poses can be predicted");
  Detections detections;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    ImageCorners image{.image = samples[k].image, .corners = {}};
    const auto px = disturbedCorners(model.cell, samples[k], model.target->points, disturbances[k]);
    for (std::size_t j = 0; j < px.size(); ++j) {
      if (px[j]) image.corners.push_back({.id = model.target->points[j].id, .px = *px[j]});
    }
    detections.images.push_back(std::move(image));
  }
  return detectionsCsv(detections);
}

constexpr const char* kExample = R"(
Example:
  $ poecal predict capture --model out/model.yaml --out predicted.csv
  predicted corners for 60 samples: predicted.csv
)";

/// One sentence for each effect that follows what the order of the rows stands in for.
std::vector<std::string> standInWarnings(const Model& model, const RowOrder& order) {
  std::vector<std::string> warnings;
  for (const AppliedEffect& applied : model.effects) {
    const DriverKind kind = applied.effect.driver().kind();
    const std::string what = applied.effect.name() + " at " + applied.effect.location();
    if (kind == DriverKind::kStamp && order.stamp) {
      warnings.push_back(what +
                         " follows the time, and these samples have no stamp: their row numbers stand in, as if they were taken with "
                         "the capture that the model was made from, row by row");
    }
    if (kind == DriverKind::kDirection && order.dir) {
      warnings.push_back(what +
                         " follows the side that a joint came from, and these samples have no dir columns: each row is taken to come "
                         "straight from the one before");
    }
  }
  return warnings;
}

}  // namespace

std::function<int()> setUpPredict(CLI::App& app, const Common& common) {
  struct Options {
    std::filesystem::path capture, model, joints, out;
    bool poses = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::Option* folder = app.add_option("CAPTURE", options->capture, "Capture folder, for its samples");
  app.add_option("--joints", options->joints, "A table with columns q1, q2, ... instead of a capture: flange poses are predicted for it")
      ->excludes(folder);
  app.add_option("--model", options->model, "model.yaml")->required();
  app.add_option("--out", options->out, "The table to write")->required();
  app.add_flag("--poses", options->poses, "Flange poses T_base_flange instead of corners");
  app.footer(kExample);
  return [options, &common] {
    if (options->capture.empty() == options->joints.empty()) throw InvalidArgument("predict needs a CAPTURE or --joints");
    const Model model = readModel(options->model);
    Capture capture;
    capture.gravity = model.gravity;
    if (!options->capture.empty()) {
      capture = readCapture(options->capture);
      requireModelOf(partsOf(capture), model, options->model);
    }
    std::vector<std::filesystem::path> inputs = filesOf(capture, true);
    inputs.insert(inputs.end(), {options->model, options->joints});
    requireOutputs({options->out}, inputs);
    std::vector<Sample> samples = options->joints.empty() ? capture.table.samples : readJoints(options->joints, *model.cell.arm);
    for (const Sample& sample : samples) {
      if (sample.q.size() != model.cell.arm->jointCount()) {
        throw InsufficientData(
            fmt::format("the samples have {} joint readings, the model has {} joints", sample.q.size(), model.cell.arm->jointCount()));
      }
    }
    TerminalListener(common).warnings(
        remarksOnDrivers(model.driver_ranges, options->joints.empty() ? capture.table.file : options->joints, samples));
    // As a diagnosis found the effects.
    TerminalListener(common).warnings(standInWarnings(model, standInByRowOrder(samples)));
    const std::vector<Disturbance> disturbances = disturbancesOf(model.effects, model.cell, model.target.value_or(Target{}),
                                                                 capture.gravity, samples, false, capture.table.other_columns);
    const bool poses = options->poses || !options->joints.empty();
    writeTextFile(options->out, poses ? posesCsv(model, samples, disturbances) : cornersCsv(model, samples, disturbances));
    printSummary(
        common, fmt::format("predicted {} for {} samples: {}\n", poses ? "flange poses" : "corners", samples.size(), options->out.string()),
        {{"samples", samples.size()}, {"out", options->out.string()}});
    return 0;
  };
}

}  // namespace poecal::app
