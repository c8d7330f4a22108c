#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "capture/column_names.hpp"
#include "capture/output_columns.hpp"
#include "capture/row_checks.hpp"
#include "capture/sample_columns.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/capture/image_names.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

constexpr const char* kPoseColumns[] = {"x", "y", "z", "qx", "qy", "qz", "qw"};

/// The columns of the flange pose; all seven or none.
std::optional<std::array<std::size_t, 7>> findPoseColumns(const CsvTable& table) {
  if (std::none_of(std::begin(kPoseColumns), std::end(kPoseColumns),
                   [&](const char* name) { return table.findColumn(name).has_value(); })) {
    return std::nullopt;
  }
  requireKnownOrientation(table);
  std::array<std::size_t, 7> columns{};
  for (std::size_t k = 0; k < columns.size(); ++k) columns[k] = table.column(kPoseColumns[k]);
  return columns;
}

/// Where the arm was, as numbers: its joint readings, or the flange pose where there are none; empty where there is neither.
Eigen::VectorXd readingOf(const Sample& sample) {
  if (sample.q.size() > 0 || !sample.T_base_flange) return sample.q;
  Eigen::VectorXd reading(12);
  reading << sample.T_base_flange->translation(), sample.T_base_flange->linear().reshaped();
  return reading;
}

/// Groups of equal readings. A row is compared with the first of a group, so that a slow motion is not one pose.
class EqualReadings {
 public:
  explicit EqualReadings(const std::vector<Sample>& samples) {
    readings_.reserve(samples.size());
    for (const Sample& sample : samples) readings_.push_back(readingOf(sample));
    if (readings_.empty() || readings_.front().size() == 0) return;
    // Sorted by the number that varies most, few rows have to be compared.
    Eigen::VectorXd lowest = readings_.front(), highest = lowest;
    for (const Eigen::VectorXd& reading : readings_) {
      lowest = lowest.cwiseMin(reading);
      highest = highest.cwiseMax(reading);
    }
    (highest - lowest).maxCoeff(&key_);
  }

  /// The group of row k; `fresh` where its reading is new.
  std::size_t groupOf(std::size_t k, std::size_t fresh) {
    const Eigen::VectorXd& reading = readings_[k];
    if (reading.size() == 0) return fresh;
    for (auto first = firsts_.lower_bound(reading(key_) - kSameReading);
         first != firsts_.end() && first->first <= reading(key_) + kSameReading; ++first) {
      const auto& [row, group] = first->second;
      if ((reading - readings_[row]).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kSameReading) return group;
    }
    firsts_.emplace(reading(key_), std::pair(k, fresh));
    return fresh;
  }

 private:
  std::vector<Eigen::VectorXd> readings_;
  Eigen::Index key_ = 0;
  std::multimap<double, std::pair<std::size_t, std::size_t>> firsts_;  ///< key -> (row, group)
};

}  // namespace

SampleTable readSamples(const std::filesystem::path& file, int joint_count, const Arm* limits_of) {
  const CsvTable csv = CsvTable::read(file);
  const std::size_t image = csv.column("image");
  const SampleColumns columns(csv, joint_count, {"image", "x", "y", "z", "qx", "qy", "qz", "qw"});
  const auto pose_columns = findPoseColumns(csv);
  if (!columns.hasJoints() && !pose_columns) {
    throw FileError(file, 1,
                    "neither joint readings nor flange poses, expected columns q1, q2, ... or x, y, z, qx, qy, qz, qw" +
                        hintOfJointColumns(csv, limits_of));
  }
  SampleTable table;
  table.file = file;
  table.other_columns = columns.otherColumns();
  table.has_joints = columns.hasJoints();
  table.has_flange_poses = pose_columns.has_value();
  std::map<std::string, int> line_of_image;
  for (std::size_t row = 0; row < csv.rowCount(); ++row) {
    Sample sample = columns.read(row);
    sample.image = imageName(csv.text(row, image));
    if (sample.image.empty()) throw FileError(file, sample.line, "the image is empty, expected its path");
    const auto [earlier, fresh] = line_of_image.emplace(sample.image, sample.line);
    if (!fresh) {
      throw FileError(file, sample.line,
                      fmt::format("image '{}' is in line {} already, expected one row per image", sample.image, earlier->second));
    }
    if (pose_columns) sample.T_base_flange = readPoseCells(csv, row, *pose_columns);
    table.samples.push_back(std::move(sample));
  }
  if (limits_of != nullptr && table.has_joints) checkReadings(file, table.samples, *limits_of);
  requireSeveralPoses(file, table.samples);
  checkRows(file, table.samples, limits_of);
  return table;
}

std::string samplesCsv(const SampleTable& table) {
  std::vector<OutputColumn> columns = readingColumns(table.samples);
  for (const std::vector<OutputColumn>& more : {flangePoseColumns(table.samples), otherColumns(table.samples, table.other_columns)}) {
    columns.insert(columns.end(), more.begin(), more.end());
  }
  const bool images = std::any_of(table.samples.begin(), table.samples.end(), [](const Sample& sample) { return !sample.image.empty(); });
  std::vector<std::string> header;
  if (images) header.push_back("image");
  for (const OutputColumn& column : columns) header.push_back(column.name);
  CsvWriter writer(header);
  for (const Sample& sample : table.samples) {
    if (images) writer.cell(sample.image);
    for (const OutputColumn& column : columns) column.write(sample, writer);
    writer.endRow();
  }
  return writer.str();
}

std::vector<std::vector<std::size_t>> poseGroups(const std::vector<Sample>& samples) {
  std::vector<std::vector<std::size_t>> groups;
  std::map<long, std::size_t> group_of_pose;
  EqualReadings equal(samples);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    std::size_t group = groups.size();
    if (samples[k].pose) {
      group = group_of_pose.emplace(*samples[k].pose, group).first->second;
    } else {
      group = equal.groupOf(k, group);
    }
    if (group == groups.size()) groups.emplace_back();
    groups[group].push_back(k);
  }
  return groups;
}

SampleTable readJointTable(const std::filesystem::path& file, const Arm& arm) {
  const CsvTable csv = CsvTable::read(file);
  const SampleColumns columns(csv, arm.jointCount(), {"image", "x", "y", "z", "qx", "qy", "qz", "qw"});
  if (!columns.hasJoints()) {
    throw FileError(file, 1,
                    fmt::format("no joint readings, expected columns q1 to q{}{}", arm.jointCount(), hintOfJointColumns(csv, &arm)));
  }
  const auto image = csv.findColumn("image");
  SampleTable table{.file = file, .samples = {}, .other_columns = columns.otherColumns(), .has_joints = true};
  for (std::size_t row = 0; row < csv.rowCount(); ++row) {
    table.samples.push_back(columns.read(row));
    if (image) table.samples.back().image = imageName(csv.text(row, *image));
  }
  checkReadings(file, table.samples, arm);
  requireCommands(file, table.samples, arm);
  return table;
}

std::vector<Sample> readJoints(const std::filesystem::path& file, const Arm& arm) { return readJointTable(file, arm).samples; }

SampleTable readWantedPoses(const std::filesystem::path& file, const Arm& arm) {
  const CsvTable csv = CsvTable::read(file);
  const SampleColumns columns(csv, arm.jointCount(), {"image", "x", "y", "z", "qx", "qy", "qz", "qw"});
  requireKnownOrientation(csv);
  std::array<std::size_t, 7> pose{};
  for (std::size_t k = 0; k < pose.size(); ++k) pose[k] = csv.column(kPoseColumns[k]);
  SampleTable table{.file = file, .samples = {}, .other_columns = columns.otherColumns(), .has_joints = columns.hasJoints()};
  table.has_flange_poses = true;
  for (std::size_t row = 0; row < csv.rowCount(); ++row) {
    table.samples.push_back(columns.read(row));
    table.samples.back().T_base_flange = readPoseCells(csv, row, pose);
  }
  if (table.has_joints) checkReadings(file, table.samples, arm);
  requireCommands(file, table.samples, arm);
  return table;
}

}  // namespace poecal
