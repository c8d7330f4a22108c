#include <fmt/format.h>

#include "capture/column_names.hpp"
#include "capture/row_checks.hpp"
#include "capture/sample_columns.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

/// A standard deviation, or nothing where the column is not there or the cell is empty.
std::optional<double> readSigma(const CsvTable& csv, std::size_t row, const char* name) {
  const auto column = csv.findColumn(name);
  if (!column || csv.text(row, *column).empty()) return std::nullopt;
  const double sigma = csv.number(row, *column);
  constexpr double kSmallest = 1e-12, kLargest = 1e6;  // beyond these weights are no numbers
  if (!(sigma >= kSmallest && sigma <= kLargest)) {
    throw FileError(csv.file(), csv.line(row), fmt::format("{} is {}, expected a positive number", name, sigma));
  }
  return sigma;
}

}  // namespace

PoseTable readPoses(const std::filesystem::path& file, const Arm& arm) {
  const CsvTable csv = CsvTable::read(file);
  // With those of flange_poses.csv: what a registration says of its poses drives nothing.
  const SampleColumns columns(csv, arm.jointCount(),
                              {"x",      "y",           "z",        "qx",    "qy",    "qz",    "qw",    "sigma_position", "sigma_rotation",
                               "rms_px", "free_rms_px", "left_out", "image", "cov11", "cov12", "cov13", "cov14",          "cov15",
                               "cov16",  "cov22",       "cov23",    "cov24", "cov25", "cov26", "cov33", "cov34",          "cov35",
                               "cov36",  "cov44",       "cov45",    "cov46", "cov55", "cov56", "cov66"});
  if (!columns.hasJoints()) {
    throw FileError(file, 1,
                    fmt::format("no joint readings, expected columns q1 to q{}{}", arm.jointCount(), hintOfJointColumns(csv, &arm)));
  }
  PoseTable table;
  table.file = file;
  table.other_columns = columns.otherColumns();
  table.position_only = true;
  for (const char* name : {"qx", "qy", "qz", "qw"}) table.position_only = table.position_only && !csv.findColumn(name);
  requireKnownOrientation(csv);
  std::array<std::size_t, 7> pose_columns{csv.column("x"), csv.column("y"), csv.column("z")};
  if (!table.position_only) {
    for (std::size_t k = 0; k < 4; ++k) pose_columns[3 + k] = csv.column(std::array{"qx", "qy", "qz", "qw"}[k]);
  }
  std::vector<Sample> samples;
  for (std::size_t row = 0; row < csv.rowCount(); ++row) {
    MeasuredPose pose;
    pose.sample = columns.read(row);
    pose.position_only = table.position_only;
    if (table.position_only) {
      for (Eigen::Index k = 0; k < 3; ++k)
        pose.T_instrument_tool.translation()(k) = csv.number(row, pose_columns[static_cast<std::size_t>(k)]);
    } else {
      pose.T_instrument_tool = readPoseCells(csv, row, pose_columns);
    }
    pose.sigma_position = readSigma(csv, row, "sigma_position");
    pose.sigma_rotation = readSigma(csv, row, "sigma_rotation");
    samples.push_back(pose.sample);
    table.poses.push_back(std::move(pose));
  }
  checkReadings(file, samples, arm);
  requireSeveralPoses(file, samples);
  checkRows(file, samples, &arm);
  return table;
}

}  // namespace poecal
