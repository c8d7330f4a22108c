#include "capture/row_checks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/geometry/se3.hpp"
#include "robot/arm_size.hpp"

namespace poecal {
namespace {

/// Shots of one pose: encoders of an arm at rest repeat to a tenth of a degree, and poses worth taking differ by many degrees.
constexpr double kFarForOnePose = 0.05;  // [rad], [m]

void requireOnePose(const std::filesystem::path& file, const std::vector<Sample>& samples) {
  std::map<long, const Sample*> first_of_pose;
  for (const Sample& sample : samples) {
    if (!sample.pose) continue;
    const Sample& first = *first_of_pose.emplace(*sample.pose, &sample).first->second;
    const auto refuse = [&](const std::string& what) {
      throw FileError(file, sample.line,
                      fmt::format("is pose {} as line {} is, but {}, expected shots of an arm at rest", *sample.pose, first.line, what));
    };
    for (Eigen::Index k = 0; k < std::min(sample.q.size(), first.q.size()); ++k) {
      if (std::abs(sample.q(k) - first.q(k)) <= kFarForOnePose) continue;
      refuse(fmt::format("q{} is {:.4g} here and {:.4g} there", k + 1, sample.q(k), first.q(k)));
    }
    if (!sample.T_base_flange || !first.T_base_flange) continue;
    const Eigen::Isometry3d T = first.T_base_flange->inverse() * *sample.T_base_flange;
    if (T.translation().norm() > kFarForOnePose || rotationAngle(T.linear()) > kFarForOnePose) {
      refuse(fmt::format("its flange is {:.3g} m and {:.3g} rad away", T.translation().norm(), rotationAngle(T.linear())));
    }
  }
}

void requireFewTurns(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm, bool from_zero) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  constexpr double kMany = 5.0;  // 90 degrees, taken for radians, are 14 turns
  for (Eigen::Index k = 0; k < arm.jointCount(); ++k) {
    const Joint& joint = arm.joints[static_cast<std::size_t>(k)];
    if (joint.type != JointType::kRevolute || joint.limits) continue;
    const auto [low, high] =
        std::minmax_element(samples.begin(), samples.end(), [k](const Sample& a, const Sample& b) { return a.q(k) < b.q(k); });
    const double zero = from_zero ? 0.0 : low->q(k);
    const double turns = (std::max(high->q(k), zero) - std::min(low->q(k), zero)) / kTurn;
    if (turns <= kMany) continue;
    const Sample& extreme = std::abs(high->q(k)) >= std::abs(low->q(k)) ? *high : *low;
    throw FileError(file, extreme.line,
                    fmt::format("q{} ({}) is {:.6g} here and spans {:.0f} turns in all, expected radians; are the readings in degrees?",
                                k + 1, joint.name, extreme.q(k), turns));
  }
}

/// The speed that a joint may have at most, and whose word that is.
struct SpeedLimit {
  double speed = 0.0;  ///< [rad/s], [m/s]
  std::string said;
};

SpeedLimit speedLimitOf(const Joint* joint) {
  constexpr double kFastest = 40.0;  // [rad/s], [m/s]: the fastest wrists make 35 rad/s, the fastest tracks 5 m/s
  constexpr double kBeyond = 3.0;    // controllers pass a URDF's limit by little, degrees for radians by 57
  if (joint == nullptr || !joint->largest_speed) return {kFastest, "faster than any arm"};
  return {kBeyond * *joint->largest_speed, fmt::format("far beyond the velocity limit {:.4g} of {}", *joint->largest_speed, joint->name)};
}

void requirePossibleSpeeds(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm* arm) {
  for (const Sample& sample : samples) {
    for (Eigen::Index k = 0; k < sample.dq.size(); ++k) {
      const Joint* joint = arm != nullptr ? &arm->joints[static_cast<std::size_t>(k)] : nullptr;
      const SpeedLimit limit = speedLimitOf(joint);
      if (std::abs(sample.dq(k)) <= limit.speed) continue;
      const bool slides = joint != nullptr && joint->type == JointType::kPrismatic;
      throw FileError(file, sample.line,
                      fmt::format("dq{} is {:.4g}, {}, expected {}", k + 1, sample.dq(k), limit.said,
                                  slides ? "m/s; are they in mm/s?" : "rad/s; are they in degrees per second?"));
    }
  }
}

void requirePossiblePayloads(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm* arm) {
  constexpr double kLargeArm = 2.0;                         // [m] of reach: arms that carry half a ton reach 2.5 m
  constexpr double kLargest = 500.0, kOfLargeArm = 2500.0;  // [kg] the strongest arm carries 2300 kg
  const double most = arm != nullptr && reachOf(*arm) < kLargeArm ? kLargest : kOfLargeArm;
  for (const Sample& sample : samples) {
    if (sample.payload.value_or(0.0) <= most) continue;
    throw FileError(file, sample.line,
                    fmt::format("payload is {:.6g}, more than such an arm carries, expected kg; is it in grams?", *sample.payload));
  }
}

std::optional<std::string> unitOfStamps(double value, double gap) {
  // Unix time is 2e9 s; rows of a capture are seconds to minutes apart.
  constexpr double kLateUnix = 1e11, kLongGap = 3600.0;
  if (value <= kLateUnix && gap <= kLongGap) return std::nullopt;
  const bool nano = value > 1e17 || gap > 1e8, micro = value > 1e14 || gap > 1e6;
  return nano ? "nanoseconds" : micro ? "microseconds" : "milliseconds";
}

}  // namespace

double impossibleSpeed(const Joint* joint) { return speedLimitOf(joint).speed; }

double distanceOfRows(const Sample& a, const Sample& b) {
  if (a.q.size() > 0 && a.q.size() == b.q.size()) return (a.q - b.q).cwiseAbs().maxCoeff();
  if (!a.T_base_flange || !b.T_base_flange) return 0.0;
  const Eigen::Isometry3d T = a.T_base_flange->inverse() * *b.T_base_flange;
  return std::max(T.translation().norm(), rotationAngle(T.linear()));
}

void checkRows(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm* arm) {
  if (samples.empty()) return;
  // A joint without an end may stand at any turn, but no capture winds it up.
  if (arm != nullptr && samples.front().q.size() > 0) requireFewTurns(file, samples, *arm, false);
  requireOnePose(file, samples);
  requirePossibleRows(file, samples, arm);
}

void requireCommands(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm) {
  if (!samples.empty() && samples.front().q.size() > 0) requireFewTurns(file, samples, arm, true);
  requirePossibleRows(file, samples, &arm);
}

void requirePossibleRows(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm* arm) {
  requirePossibleSpeeds(file, samples, arm);
  requirePossiblePayloads(file, samples, arm);
}

std::vector<std::string> stampRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples) {
  std::vector<const Sample*> stamped;
  for (const Sample& sample : samples) {
    if (sample.stamp) stamped.push_back(&sample);
  }
  if (stamped.size() < 2) return {};
  std::vector<std::string> remarks;
  const auto remark = [&](const Sample& sample, const std::string& text) {
    remarks.push_back(fmt::format("{}:{}: stamp {}", file.string(), sample.line, text));
  };
  std::vector<double> gaps;
  const Sample* back = nullptr;
  const Sample* before = nullptr;
  for (std::size_t k = 1; k < stamped.size(); ++k) {
    const double gap = *stamped[k]->stamp - *stamped[k - 1]->stamp;
    gaps.push_back(std::abs(gap));
    if (gap >= 0.0 || back != nullptr) continue;
    back = stamped[k];
    before = stamped[k - 1];
  }
  const Sample& first = *stamped.front();
  if (*std::max_element(gaps.begin(), gaps.end()) == 0.0) {
    remark(first, fmt::format("is {} in all rows, expected the time of each exposure [s]", *first.stamp));
    return remarks;
  }
  if (back != nullptr) {
    remark(*back, fmt::format("is {}, earlier than {} of line {}, expected rows in the order in which they were taken", *back->stamp,
                              *before->stamp, before->line));
  }
  const double gap = median(std::move(gaps));
  if (const auto unit = unitOfStamps(std::abs(*first.stamp), gap)) {
    remark(first, fmt::format("is {:.6g} and rows are {:.3g} apart, expected seconds; are they {}?", *first.stamp, gap, *unit));
  }
  return remarks;
}

std::vector<std::string> temperatureRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples) {
  constexpr double kHottest = 150.0, kJump = 25.0;  // [degrees Celsius]; no joint is hotter, and none heats so between two pictures
  const Sample* before = nullptr;
  for (const Sample& sample : samples) {
    if (!sample.temperature) continue;
    const bool jumps = before != nullptr && std::abs(*sample.temperature - *before->temperature) > kJump;
    if (jumps) {
      return {fmt::format("{}:{}: temperature is {:.6g} here and {:.6g} in line {}, expected one unit, degrees Celsius", file.string(),
                          sample.line, *sample.temperature, *before->temperature, before->line)};
    }
    if (*sample.temperature > kHottest) {
      return {fmt::format("{}:{}: temperature is {:.6g}, expected degrees Celsius; is it in kelvin?", file.string(), sample.line,
                          *sample.temperature)};
    }
    before = &sample;
  }
  return {};
}

std::vector<std::string> payloadRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm) {
  const bool slides =
      std::any_of(arm.joints.begin(), arm.joints.end(), [](const Joint& joint) { return joint.type == JointType::kPrismatic; });
  const bool known = std::all_of(arm.links.begin(), arm.links.end(), [](const LinkMass& link) { return link.mass > 0.0; });
  if (arm.links.empty() || slides || !known) return {};
  double mass = 0.0;
  for (const LinkMass& link : arm.links) mass += link.mass;
  for (const Sample& sample : samples) {
    if (sample.payload.value_or(0.0) <= mass) continue;
    return {fmt::format("{}:{}: payload is {:.6g}, more than the {:.3g} kg of the arm itself, expected kg; is it in grams or newtons?",
                        file.string(), sample.line, *sample.payload, mass)};
  }
  return {};
}

std::vector<std::string> turnRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  constexpr std::size_t kFewest = 6;  // fewer lie within half a turn by chance
  std::vector<std::string> remarks;
  if (samples.size() < kFewest) return remarks;
  for (Eigen::Index k = 0; k < arm.jointCount(); ++k) {
    const Joint& joint = arm.joints[static_cast<std::size_t>(k)];
    if (joint.type != JointType::kRevolute) continue;
    double sine = 0.0, cosine = 0.0;
    for (const Sample& sample : samples) {
      sine += std::sin(sample.q(k));
      cosine += std::cos(sample.q(k));
    }
    const double middle = std::atan2(sine, cosine);
    const auto turnsOf = [&](const Sample& sample) { return std::round((sample.q(k) - middle) / kTurn); };
    const bool narrow = std::all_of(samples.begin(), samples.end(), [&](const Sample& sample) {
      return std::abs(sample.q(k) - middle - kTurn * turnsOf(sample)) < 0.25 * kTurn;
    });
    if (!narrow) continue;
    const auto jump =
        std::adjacent_find(samples.begin(), samples.end(), [&](const Sample& a, const Sample& b) { return turnsOf(a) != turnsOf(b); });
    if (jump == samples.end()) continue;
    const Sample& after = *std::next(jump);
    remarks.push_back(
        fmt::format("{}:{}: q{} ({}) is {:.6g} here and {:.6g} in line {}, and but for whole turns it never leaves half a "
                    "turn: expected readings that do not wrap around (2 pi off in some rows?)",
                    file.string(), after.line, k + 1, joint.name, after.q(k), jump->q(k), jump->line));
  }
  return remarks;
}

}  // namespace poecal
