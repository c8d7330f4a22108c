#include "capture/motion_checks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "capture/row_checks.hpp"

namespace poecal {
namespace {

constexpr std::size_t kFewest = 20;  // poses: fewer may agree by chance

/// How fast the joints would have moved, as a share of what they cannot.
struct Hurry {
  double share = 0.0;
  Eigen::Index joint = 0;
};

Hurry hurryBetween(const Sample& before, const Sample& here, const Arm& arm) {
  const double seconds = *here.stamp - *before.stamp;
  Hurry most;
  for (Eigen::Index k = 0; k < here.q.size(); ++k) {
    const double way = std::abs(here.q(k) - before.q(k));
    const double share = way / (seconds * impossibleSpeed(&arm.joints[static_cast<std::size_t>(k)]));
    if (share > most.share) most = {share, k};
  }
  return most;
}

/// In how many rows a column goes with the way that a joint came, of those in which both say something.
struct Agreement {
  std::size_t same = 0, all = 0;

  double share() const { return all > 0 ? static_cast<double>(same) / static_cast<double>(all) : 0.0; }
};

/// @param dir, joint  from 0. @param later  rows by which the way is later than the column.
Agreement agreementOf(const std::vector<Sample>& samples, Eigen::Index dir, Eigen::Index joint, std::size_t later) {
  constexpr double kStill = 1e-4;  // [rad], [m]: a joint that moved by less did not move
  Agreement agreement;
  for (std::size_t n = 1; n + later < samples.size(); ++n) {
    const double way = samples[n + later].q(joint) - samples[n + later - 1].q(joint);
    const double side = samples[n].dir(dir);
    if (std::abs(way) < kStill || side == 0.0) continue;
    ++agreement.all;
    agreement.same += (way > 0.0) == (side > 0.0) ? 1 : 0;
  }
  return agreement;
}

/// What a dir column contradicts; empty where it contradicts nothing.
std::string contradictionOf(const std::vector<Sample>& samples, Eigen::Index k) {
  constexpr double kNearlyAll = 0.95, kHardlyAny = 0.05, kByChance = 0.75;
  const Agreement own = agreementOf(samples, k, k, 0);
  if (own.all < kFewest) return "";
  if (own.share() <= kHardlyAny) {
    return "opposite to the move from the row before in nearly every row, expected 1 where the reading grew (or does the arm overshoot?)";
  }
  if (own.share() > kByChance) return "";
  if (agreementOf(samples, k, k, 1).share() >= kNearlyAll) return "as the move to the next row in nearly every row: shifted by one row?";
  for (Eigen::Index j = 0; j < samples.front().q.size(); ++j) {
    if (j == k || agreementOf(samples, k, j, 0).share() < kNearlyAll) continue;
    return fmt::format("follows joint {} and not its own in nearly every row: are columns exchanged?", j + 1);
  }
  return "";
}

/// Poses that are taken again and again say no more than once.
std::size_t differentPoses(const std::vector<Sample>& samples) {
  constexpr double kSame = 1e-3;  // [rad], [m]: encoders repeat to less
  std::set<std::vector<long>> poses;
  for (const Sample& sample : samples) {
    std::vector<long> pose;
    for (const double q : sample.q) pose.push_back(std::lround(q / kSame));
    poses.insert(std::move(pose));
  }
  return poses.size();
}

/// Whether 0 stands where the joint came down, as in a column of true and false.
bool isZeroOrOne(const std::vector<Sample>& samples, Eigen::Index k) {
  constexpr double kNearlyAll = 0.8;
  std::size_t zeros = 0, fallen = 0;
  for (std::size_t n = 1; n < samples.size(); ++n) {
    const double side = samples[n].dir(k);
    if (side != 0.0 && side != 1.0) return false;
    if (side != 0.0) continue;
    ++zeros;
    fallen += samples[n].q(k) < samples[n - 1].q(k) ? 1 : 0;
  }
  return zeros >= kFewest / 2 && static_cast<double>(fallen) >= kNearlyAll * static_cast<double>(zeros);
}

}  // namespace

std::vector<std::string> speedRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm) {
  std::size_t ways = 0, fast = 0, fastest = 0;
  Hurry most;
  for (std::size_t n = 1; n < samples.size(); ++n) {
    const Sample &before = samples[n - 1], &here = samples[n];
    if (!here.stamp || !before.stamp || here.q.size() == 0 || !(*here.stamp > *before.stamp)) continue;
    ++ways;
    const Hurry hurry = hurryBetween(before, here, arm);
    fast += hurry.share > 1.0 ? 1 : 0;
    if (!(hurry.share > most.share)) continue;
    most = hurry;
    fastest = n;
  }
  if (ways < kFewest / 2 || 2 * fast <= ways) return {};
  const Sample &before = samples[fastest - 1], &here = samples[fastest];
  const bool slides = arm.joints[static_cast<std::size_t>(most.joint)].type == JointType::kPrismatic;
  return {
      fmt::format("{}:{}: joint {} moves by {:.3g} {} within {:.3g} s of stamp, which no such arm can, and so do most rows: expected "
                  "seconds; is stamp in minutes, hours or days?",
                  file.string(), here.line, most.joint + 1, std::abs(here.q(most.joint) - before.q(most.joint)), slides ? "m" : "rad",
                  *here.stamp - *before.stamp)};
}

std::vector<std::string> directionRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm) {
  std::vector<std::string> remarks;
  if (differentPoses(samples) < kFewest) return remarks;
  for (const Sample& sample : samples) {
    if (sample.dir.size() != arm.jointCount() || sample.q.size() != arm.jointCount()) return remarks;
  }
  std::map<std::string, std::vector<std::string>> columns_of;
  for (Eigen::Index k = 0; k < arm.jointCount(); ++k) {
    const std::string what =
        isZeroOrOne(samples, k) ? "only 0 and 1, expected -1 and 1: the side that the joint came from" : contradictionOf(samples, k);
    if (!what.empty()) columns_of[what].push_back(fmt::format("dir{}", k + 1));
  }
  for (const auto& [what, columns] : columns_of) {
    remarks.push_back(fmt::format("{}: {}: {}", file.string(), fmt::join(columns, ", "), what));
  }
  return remarks;
}

}  // namespace poecal
