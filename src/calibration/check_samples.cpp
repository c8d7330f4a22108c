#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/check_parts.hpp"
#include "calibration/row_contradictions.hpp"
#include "capture/still_readings.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/registration/hand_eye.hpp"

namespace poecal {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

void sayPoses(const Arm* arm, const SampleTable& table, CheckList& list) {
  const std::vector<Sample>& samples = table.samples;
  const auto groups = poseGroups(samples);
  const auto repeated = std::count_if(groups.begin(), groups.end(), [](const auto& group) { return group.size() > 1; });
  const std::string text =
      fmt::format("{}, {}, {} of them taken more than once", counted(samples.size(), "row"), counted(groups.size(), "pose"), repeated);
  constexpr std::size_t kAdvised = 40;  // what a diagnosis asks for in its own messages
  const std::size_t needed = table.has_joints ? static_cast<std::size_t>((twistParameterCount(*arm) + 6) / 6 + 2) : std::size_t{3};
  if (groups.size() < needed) {
    list.add(CheckLevel::kTooLittle, "samples",
             fmt::format("{}: at least {} poses are needed, {} or more advised", text, needed, kAdvised));
  } else if (groups.size() < kAdvised) {
    list.add(CheckLevel::kAdvice, "samples", fmt::format("{}: {} poses or more tell effects from the arm's geometry", text, kAdvised));
  } else {
    list.add(CheckLevel::kOk, "samples", text);
  }
  if (repeated == 0) {
    list.add(CheckLevel::kAdvice, "samples",
             "no pose was taken twice: 5 poses taken 3 times tell the noise of the pictures apart from all else");
  }
  if (!table.has_joints) {
    list.add(CheckLevel::kAdvice, "samples", "no joint readings q1, q2, ...: only camera and target can be registered (poecal measure)");
  }
}

void sayJoint(const Joint& joint, std::size_t k, double moved, CheckList& list) {
  const bool turns = joint.type == JointType::kRevolute;
  const std::string name = fmt::format("q{} ({})", k + 1, joint.name);
  constexpr double kStill = 1e-4;                         // [rad], [m]: identify refuses it
  constexpr double kLittleTurn = 0.5, kLittleWay = 0.05;  // [rad], [m]: the axis is then known many times worse than the corners
  const std::string range = turns ? fmt::format("{:.1f} degrees", moved * kDegrees) : fmt::format("{:.1f} mm", 1e3 * moved);
  if (moved <= kStill) {
    list.add(CheckLevel::kTooLittle, "joints", name + " never moved: its axis cannot be identified");
  } else if (moved < (turns ? kLittleTurn : kLittleWay)) {
    list.add(CheckLevel::kAdvice, "joints",
             fmt::format("{} moved by only {}: its axis will be known poorly, {} or more are better", name, range,
                         turns ? "30 degrees" : "50 mm"));
  }
}

void sayJoints(const Arm* arm, const SampleTable& table, CheckList& list) {
  const std::vector<Sample>& samples = table.samples;
  Eigen::VectorXd low = samples.front().q, high = low;
  for (const Sample& sample : samples) {
    low = low.cwiseMin(sample.q);
    high = high.cwiseMax(sample.q);
  }
  std::vector<std::string> moved;
  for (std::size_t k = 0; k < arm->joints.size(); ++k) {
    const auto index = static_cast<Eigen::Index>(k);
    const Joint& joint = arm->joints[k];
    const double range = high(index) - low(index);
    const bool turns = joint.type == JointType::kRevolute;
    moved.push_back(fmt::format("q{} {:.0f} {}", k + 1, turns ? range * kDegrees : 1e3 * range, turns ? "deg" : "mm"));
    sayJoint(joint, k, range, list);
  }
  list.add(CheckLevel::kOk, "joints", fmt::format("moved over {}", fmt::join(moved, ", ")));
}

/// Turns about one axis alone leave the registration open along it; without any turn there is none.
void sayOrientations(const Arm* arm, const SampleTable& table, CheckList& list) {
  const std::vector<Sample>& samples = table.samples;
  std::vector<Eigen::Isometry3d> poses;
  std::vector<Eigen::Matrix3d> rotations;
  for (const Sample& sample : samples) {
    poses.push_back(table.has_joints ? forwardKinematics(*arm, sample.q) : *sample.T_base_flange);
    rotations.push_back(poses.back().linear());
  }
  if (rotationDirections(poses) == 0) {
    list.add(CheckLevel::kTooLittle, "samples",
             "the flange never turned by more than half a degree: registration needs poses of different orientation, or both of its "
             "transforms known (registration: FILE in capture.yaml)");
    return;
  }
  const Eigen::Matrix3d mean = meanRotation(rotations);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Matrix3d& R : rotations) {
    const Eigen::Vector3d turn = logSo3(R * mean.transpose());
    spread += turn * turn.transpose() / static_cast<double>(rotations.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  const double second = std::sqrt(std::max(0.0, axes.eigenvalues()(1)));  // ascending: the largest but one
  constexpr double kLittle = 0.15;                                        // [rad]
  if (second < kLittle) {
    list.add(
        CheckLevel::kAdvice, "samples",
        fmt::format("the flange turned by {:.1f} degrees rms about its second axis of rotation: turn it about two axes, 10 degrees or more",
                    second * kDegrees));
  }
}

/// The effects that ask for something which the samples lack.
std::string effectsThatNeed(Need need, const char* driver) {
  std::vector<std::string> names;
  for (const EffectKind& kind : effectKinds()) {
    const bool needs = std::find(kind.needs.begin(), kind.needs.end(), need) != kind.needs.end();
    const bool driven = std::find(kind.drivers.begin(), kind.drivers.end(), driver) != kind.drivers.end();
    if (needs || driven) names.push_back(kind.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

void sayColumns(const SampleTable& table, CheckList& list) {
  const std::vector<Sample>& samples = table.samples;
  const auto has = [&samples](auto of) { return std::any_of(samples.begin(), samples.end(), of); };
  const auto advise = [&list](const std::string& text) { list.add(CheckLevel::kAdvice, "columns", text); };
  if (!has([](const Sample& s) { return s.stamp.has_value(); })) {
    advise(fmt::format("no stamp [s]: the number of the row stands in for it, for {}", effectsThatNeed(Need::kStamp, "stamp")));
  }
  if (table.has_joints && !has([](const Sample& s) { return s.dir.size() > 0; })) {
    advise(fmt::format("no dir1.. (-1, 0, 1): joints are taken to come straight from the row before, for {}",
                       effectsThatNeed(Need::kDir, "dirK")));
  }
  if (table.has_joints && !has([](const Sample& s) { return s.dq.size() > 0; })) {
    advise(fmt::format("no dq1.. [rad/s]: if the arm moves at exposure, {} cannot be found", effectsThatNeed(Need::kDq, "dq")));
  }
  if (!has([](const Sample& s) { return s.temperature.has_value(); })) {
    advise(
        fmt::format("no temperature [degrees Celsius]: {} can follow only the time", effectsThatNeed(Need::kTemperature, "temperature")));
  }
  std::set<double> payloads;
  for (const Sample& sample : samples) payloads.insert(sample.payload.value_or(0.0));
  if (payloads.size() < 2) advise("one payload [kg] in all rows: a second one tells compliance from geometry");
  for (const std::string& name : table.other_columns) {
    list.add(CheckLevel::kOk, "columns", fmt::format("{} is kept and may drive an error", name));
  }
}

}  // namespace

void checkSamples(const Arm* arm, const SampleTable& table, bool known, CheckList& list) {
  sayPoses(arm, table, list);
  if (table.has_joints) sayJoints(arm, table, list);
  if (!known) sayOrientations(arm, table, list);
  const auto advise = [&list](const std::vector<std::string>& remarks) {
    for (const std::string& remark : remarks) list.add(CheckLevel::kAdvice, "samples", remark);
  };
  advise(remarksOnRows(table.file, table.samples, arm));
  if (table.has_joints) advise(stillRemarks(table.file, table.samples));
  if (arm != nullptr) list.attempt("samples", [&] { advise(compareFlangePoses(*arm, table)); });
  sayColumns(table, list);
}

}  // namespace poecal
