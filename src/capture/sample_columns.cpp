#include "capture/sample_columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "core/numbered.hpp"
#include "poecal/core/error.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

constexpr double kLimitSlack = 0.05;  // of a joint's range: limits in files are rounded, and controllers let arms pass them a little

/// Columns prefix1 .. prefixN, or none.
std::vector<std::size_t> numberedColumns(const CsvTable& table, const std::string& prefix, int joint_count) {
  int largest = -1;
  for (const std::string& name : table.header()) {
    const int number = numberAfter(name, prefix).value_or(-1);
    if (number == 0) throw FileError(table.file(), 1, fmt::format("column '{}': joints count from 1", name));
    if (joint_count > 0 && number > joint_count) {
      throw FileError(table.file(), 1, fmt::format("column '{}', but the robot has {} joints", name, joint_count));
    }
    largest = std::max(largest, number);
  }
  std::vector<std::size_t> columns;
  if (largest < 0) return columns;
  for (int k = 1; k <= (joint_count > 0 ? joint_count : largest); ++k) columns.push_back(table.column(prefix + std::to_string(k)));
  return columns;
}

Eigen::VectorXd readCells(const CsvTable& table, std::size_t row, const std::vector<std::size_t>& columns) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) values(static_cast<Eigen::Index>(k)) = table.number(row, columns[k]);
  return values;
}

bool within(double reading, const JointLimits& limits) {
  const double slack = kLimitSlack * (limits.upper - limits.lower);
  return reading >= limits.lower - slack && reading <= limits.upper + slack;
}

/// "; are the readings in degrees?" where all readings of the joint would then lie within its limits, and some are far beyond now.
std::string unitHint(const std::vector<Sample>& samples, Eigen::Index k, const Joint& joint) {
  const bool revolute = joint.type == JointType::kRevolute;
  const double to_si = revolute ? std::numbers::pi / 180.0 : 1e-3;
  double largest = 0.0;
  for (const Sample& sample : samples) {
    if (!within(sample.q(k) * to_si, *joint.limits)) return "";
    largest = std::max(largest, std::abs(sample.q(k)));
  }
  if (largest <= 2.0 * std::max(std::abs(joint.limits->lower), std::abs(joint.limits->upper))) return "";
  return revolute ? "; are the readings in degrees?" : "; are the readings in millimetres?";
}

/// "; 0.3, a whole turn away, is within them ..." where that holds for all readings of the joint.
std::string turnHint(const std::vector<Sample>& samples, Eigen::Index k, const Joint& joint, double beyond) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  if (joint.type != JointType::kRevolute) return "";
  const double middle = 0.5 * (joint.limits->lower + joint.limits->upper);
  // A counter that wraps around is off by one turn; by many a reading of another unit comes near as well.
  const auto unwound = [middle](double reading) { return reading - kTurn * std::clamp(std::round((reading - middle) / kTurn), -1.0, 1.0); };
  const bool all =
      std::all_of(samples.begin(), samples.end(), [&](const Sample& sample) { return within(unwound(sample.q(k)), *joint.limits); });
  return all ? fmt::format("; {:.6g}, a whole turn away, is within them: do the readings wrap around?", unwound(beyond)) : "";
}

/// Without limits a turn too many is legitimate in one joint, but not in most of them at once.
void checkUnlimitedReadings(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm) {
  constexpr double kOneTurn = 1.05 * 2.0 * std::numbers::pi;
  int unlimited = 0;
  int beyond = 0;
  std::optional<std::pair<const Sample*, Eigen::Index>> example;
  for (Eigen::Index k = 0; k < arm.jointCount(); ++k) {
    const Joint& joint = arm.joints[static_cast<std::size_t>(k)];
    if (joint.type != JointType::kRevolute || joint.limits) continue;
    ++unlimited;
    const auto found = std::find_if(samples.begin(), samples.end(), [k](const Sample& sample) { return std::abs(sample.q(k)) > kOneTurn; });
    if (found == samples.end()) continue;
    ++beyond;
    if (!example) example.emplace(&*found, k);
  }
  if (beyond < 2 || 2 * beyond <= unlimited) return;
  const auto& [sample, k] = *example;
  throw FileError(file, sample->line,
                  fmt::format("q{} is {}, and {} of {} joints are beyond a full turn, expected radians; are the readings in degrees?",
                              k + 1, sample->q(k), beyond, unlimited));
}

}  // namespace

SampleColumns::SampleColumns(const CsvTable& table, int joint_count, std::initializer_list<const char*> own)
    : table_(table),
      q_(numberedColumns(table, "q", joint_count)),
      pose_(table.findColumn("pose")),
      stamp_(table.findColumn("stamp")),
      temperature_(table.findColumn("temperature")),
      payload_(table.findColumn("payload")) {
  const int joints = joint_count > 0 ? joint_count : static_cast<int>(q_.size());
  dir_ = numberedColumns(table, "dir", joints);
  dq_ = numberedColumns(table, "dq", joints);

  std::set<std::size_t> known;
  for (const auto* columns : {&q_, &dir_, &dq_}) known.insert(columns->begin(), columns->end());
  for (const auto& column : {pose_, stamp_, temperature_, payload_}) {
    if (column) known.insert(*column);
  }
  for (const char* name : own) {
    if (const auto column = table.findColumn(name)) known.insert(*column);
  }
  for (std::size_t column = 0; column < table.header().size(); ++column) {
    if (known.contains(column)) continue;
    other_.push_back(column);
    other_names_.push_back(table.header()[column]);
  }
}

std::optional<double> SampleColumns::optionalNumber(std::size_t row, const std::optional<std::size_t>& column) const {
  if (!column || table_.text(row, *column).empty()) return std::nullopt;
  return table_.number(row, *column);
}

Sample SampleColumns::read(std::size_t row) const {
  Sample sample;
  sample.line = table_.line(row);
  sample.q = readCells(table_, row, q_);
  sample.dq = readCells(table_, row, dq_);
  sample.dir.resize(static_cast<Eigen::Index>(dir_.size()));
  for (std::size_t k = 0; k < dir_.size(); ++k) {
    const long direction = table_.integer(row, dir_[k]);
    if (direction < -1 || direction > 1) {
      throw FileError(table_.file(), sample.line, fmt::format("dir{} is {}, expected -1, 0 or 1", k + 1, direction));
    }
    sample.dir(static_cast<Eigen::Index>(k)) = static_cast<double>(direction);
  }
  if (pose_ && !table_.text(row, *pose_).empty()) sample.pose = table_.integer(row, *pose_);
  sample.stamp = optionalNumber(row, stamp_);
  sample.temperature = optionalNumber(row, temperature_);
  sample.payload = optionalNumber(row, payload_);
  if (sample.payload && *sample.payload < 0.0) {
    throw FileError(table_.file(), sample.line, fmt::format("payload is {}, expected a mass in kg", *sample.payload));
  }
  for (const std::size_t column : other_) {
    sample.other.push_back(table_.findNumber(row, column).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return sample;
}

Eigen::Isometry3d readPoseCells(const CsvTable& table, std::size_t row, const std::array<std::size_t, 7>& columns) {
  Eigen::Matrix<double, 7, 1> cells;
  for (std::size_t k = 0; k < columns.size(); ++k) cells(static_cast<Eigen::Index>(k)) = table.number(row, columns[k]);
  const Eigen::Vector4d quaternion = cells.tail<4>();
  if (std::abs(quaternion.norm() - 1.0) > 1e-3) {
    throw FileError(table.file(), table.line(row),
                    fmt::format("the quaternion has length {:.6f}, expected 1 (to 1e-3)", quaternion.norm()));
  }
  return poseFromQuaternion(cells.head<3>(), quaternion);
}

void checkReadings(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm) {
  for (const Sample& sample : samples) {
    for (Eigen::Index k = 0; k < sample.q.size(); ++k) {
      const Joint& joint = arm.joints[static_cast<std::size_t>(k)];
      if (!joint.limits || within(sample.q(k), *joint.limits)) continue;
      const std::string hints = unitHint(samples, k, joint) + turnHint(samples, k, joint, sample.q(k));
      throw FileError(file, sample.line,
                      fmt::format("q{} is {}, beyond the limits [{}, {}] of {}{}", k + 1, sample.q(k), joint.limits->lower,
                                  joint.limits->upper, joint.name, hints));
    }
  }
  checkUnlimitedReadings(file, samples, arm);
}

void requireSeveralPoses(const std::filesystem::path& file, const std::vector<Sample>& samples) {
  if (samples.empty()) throw InsufficientData(file.string() + ": no rows, expected one per pose");
  // A single row is a legitimate file; what needs more poses says so itself.
  if (samples.size() == 1) return;
  const bool joints = samples.front().q.size() > 0;
  if (!joints && !samples.front().T_base_flange) return;
  const auto isFirst = [&](const Sample& sample) {
    if (joints) return (sample.q - samples.front().q).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kSameReading;
    const Eigen::Isometry3d T = samples.front().T_base_flange->inverse() * *sample.T_base_flange;
    return T.translation().norm() <= kSameReading && rotationAngle(T.linear()) <= kSameReading;
  };
  if (std::all_of(samples.begin(), samples.end(), isFirst)) {
    throw InsufficientData(fmt::format("{}: all {} rows have the same {}, expected poses that differ", file.string(), samples.size(),
                                       joints ? "joint readings" : "flange pose"));
  }
}

}  // namespace poecal
