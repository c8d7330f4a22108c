#include "poecal/compensation/compensate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "compensation/commanded_arm.hpp"
#include "poecal/capture/row_order.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/random.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

constexpr int kOtherStarts = 60;  // a six-joint arm has at most 16 solutions, and half of the starts find one
constexpr std::uint64_t kSeed = 1;

JointLimits rangeOf(const Joint& joint) {
  constexpr double kTravel = 1.0;  // [m] of a slide that states no limits
  const double reach = joint.type == JointType::kRevolute ? std::numbers::pi : kTravel;
  return joint.limits.value_or(JointLimits{-reach, reach});
}

Eigen::VectorXd middleOf(const Arm& arm) {
  Eigen::VectorXd q(arm.jointCount());
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const JointLimits range = rangeOf(arm.joints[static_cast<std::size_t>(k)]);
    q(k) = 0.5 * (range.lower + range.upper);
  }
  return q;
}

Eigen::VectorXd drawnFrom(const Arm& arm, Rng& rng) {
  Eigen::VectorXd q(arm.jointCount());
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const JointLimits range = rangeOf(arm.joints[static_cast<std::size_t>(k)]);
    q(k) = rng.uniform(range.lower, range.upper);
  }
  return q;
}

/// Of the same posture, the turn that is nearest to `near`, where the limits allow it.
Eigen::VectorXd nearestTurn(const Arm& arm, Eigen::VectorXd q, const Eigen::VectorXd& near) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const Joint& joint = arm.joints[static_cast<std::size_t>(k)];
    if (joint.type != JointType::kRevolute) continue;
    const double turned = q(k) - kTurn * std::round((q(k) - near(k)) / kTurn);
    if (!joint.limits || (turned >= joint.limits->lower && turned <= joint.limits->upper)) q(k) = turned;
  }
  return q;
}

/// The joints of a geometry that reach a pose, the nearest to `near` that is found; nothing where none is.
std::optional<Eigen::VectorXd> jointsNear(const CommandedArm& geometry, const Sample& sample, const Eigen::VectorXd& near) {
  const JointCommand direct = geometry.solve(sample, 0, near, true);
  if (isReached(direct)) return nearestTurn(geometry.arm(), direct.q, near);
  Rng rng(kSeed);
  std::optional<Eigen::VectorXd> nearest;
  for (int k = 0; k < kOtherStarts; ++k) {
    const JointCommand found = geometry.solve(sample, 0, drawnFrom(geometry.arm(), rng), true);
    if (!isReached(found)) continue;
    const Eigen::VectorXd q = nearestTurn(geometry.arm(), found.q, near);
    if (!nearest || (q - near).norm() < (*nearest - near).norm()) nearest = q;
  }
  return nearest;
}

/// Where each search begins.
void findStarts(const Arm& arm, const ProgressFunction& progress, SampleTable& table) {
  const auto without = std::count_if(table.samples.begin(), table.samples.end(), [](const Sample& sample) { return sample.q.size() == 0; });
  Progress told(progress, "joints to begin from", static_cast<std::size_t>(without));
  const CommandedArm geometry({.arm = arm, .effects = {}}, table);
  Eigen::VectorXd near = middleOf(arm);
  for (Sample& sample : table.samples) {
    if (sample.q.size() == 0) {
      sample.q = jointsNear(geometry, sample, near).value_or(near);
      told.advance();
    }
    near = sample.q;
  }
}

/// Times stay as they are: the number of a row is no time on the clock of the capture.
void standInForSides(SampleTable& table) {
  std::vector<Sample> ordered = table.samples;
  standInByRowOrder(ordered);
  for (std::size_t k = 0; k < ordered.size(); ++k) table.samples[k].dir = ordered[k].dir;
}

std::string whyNotReached(const CommandedArm& reach, const Sample& sample, std::size_t number, const JointCommand& command) {
  const JointCommand unlimited = reach.solve(sample, number, command.start, false);
  if (isReached(unlimited)) {
    for (Eigen::Index k = 0; k < unlimited.q.size(); ++k) {
      const Joint& joint = reach.arm().joints[static_cast<std::size_t>(k)];
      if (!joint.limits) continue;
      const double q = unlimited.q(k);
      if (q >= joint.limits->lower && q <= joint.limits->upper) continue;
      return fmt::format("q{} ({}) would have to be {:.6g}, beyond its limits [{}, {}]", k + 1, joint.name, q, joint.limits->lower,
                         joint.limits->upper);
    }
  }
  return fmt::format("no joints were found that reach it: {:.3f} mm and {:.3f} mrad are missing at the nearest",
                     1e3 * command.position_error, 1e3 * command.rotation_error);
}

}  // namespace

bool movesFlange(const Effect& effect) {
  const PlaceKind place = effect.kind().place;
  const bool of_arm = place == PlaceKind::kJoint || place == PlaceKind::kLink || place == PlaceKind::kBase;
  return of_arm && effect.kind().add_draw == nullptr;
}

std::vector<Eigen::Isometry3d> reachedPoses(const RealArm& arm, const SampleTable& commands) {
  SampleTable table = commands;
  for (const Sample& sample : table.samples) {
    if (sample.q.size() == arm.arm.jointCount()) continue;
    throw InvalidArgument(fmt::format("a command has {} joints, expected {}", sample.q.size(), arm.arm.jointCount()));
  }
  standInForSides(table);
  const CommandedArm reach(arm, table);
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t k = 0; k < table.samples.size(); ++k) {
    poses.push_back(reach.at(table.samples[k], k, table.samples[k].q).T_base_flange);
  }
  return poses;
}

std::vector<JointCommand> compensate(const RealArm& arm, const SampleTable& wanted, const Arm* start_arm,
                                     const ProgressFunction& progress) {
  SampleTable table = wanted;
  for (const Sample& sample : table.samples) {
    if (!sample.T_base_flange) throw InvalidArgument("a sample has no pose to reach, expected T_base_flange");
  }
  findStarts(start_arm == nullptr ? arm.arm : *start_arm, progress, table);
  standInForSides(table);
  const CommandedArm reach(arm, table);
  std::vector<JointCommand> commands;
  Progress told(progress, "joints for each pose", table.samples.size());
  for (std::size_t k = 0; k < table.samples.size(); ++k) {
    const Sample& sample = table.samples[k];
    JointCommand command = reach.solve(sample, k, sample.q, true);
    if (!isReached(command)) command.why_not = whyNotReached(reach, sample, k, command);
    commands.push_back(std::move(command));
    told.advance();
  }
  return commands;
}

std::string commandsCsv(const SampleTable& wanted, const std::vector<JointCommand>& commands) {
  std::vector<std::string> header{"line"};
  const Eigen::Index joints = commands.empty() ? 0 : commands.front().q.size();
  for (Eigen::Index k = 1; k <= joints; ++k) header.push_back(fmt::format("q{}", k));
  for (const char* name : {"x", "y", "z", "qx", "qy", "qz", "qw", "position_error", "rotation_error"}) header.emplace_back(name);
  CsvWriter csv(header);
  for (std::size_t k = 0; k < commands.size(); ++k) {
    const JointCommand& command = commands[k];
    if (!command.why_not.empty()) continue;
    csv.cell(wanted.samples[k].line);
    for (const double q : command.q) csv.cell(q);
    for (const double t : command.T_base_flange.translation()) csv.cell(t);
    const Eigen::Vector4d quaternion = quaternionXyzw(command.T_base_flange);
    for (const double c : quaternion) csv.cell(c);
    csv.cell(command.position_error).cell(command.rotation_error);
    csv.endRow();
  }
  return csv.str();
}

}  // namespace poecal
