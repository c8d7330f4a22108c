#include "capture/motion_checks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace poecal {
namespace {

constexpr std::size_t kFewest = 20;  // poses: fewer go together by chance

/// How fast the joints would have moved, as a share of what they can.
struct Hurry {
  double share = 0.0;
  Eigen::Index joint = 0;
};

Hurry hurryBetween(const Sample& before, const Sample& here, const Arm& arm) {
  constexpr double kFastest = 40.0;  // [rad/s], [m/s]: the fastest wrists make 35 rad/s
  const double seconds = *here.stamp - *before.stamp;
  Hurry most;
  for (Eigen::Index k = 0; k < here.q.size(); ++k) {
    const double share =
        std::abs(here.q(k) - before.q(k)) / (seconds * arm.joints[static_cast<std::size_t>(k)].largest_speed.value_or(kFastest));
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
  constexpr double kStill = 1e-4;  // [rad], [m]: a joint that moved by less came from nowhere
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
    return "opposite to the way from the row before in nearly every row, expected 1 where the reading grew on the way to the pose";
  }
  if (own.share() > kByChance) return "";
  if (agreementOf(samples, k, k, 1).share() >= kNearlyAll) return "as the way to the row after in nearly every row: a row off?";
  for (Eigen::Index j = 0; j < samples.front().q.size(); ++j) {
    if (j == k || agreementOf(samples, k, j, 0).share() < kNearlyAll) continue;
    return fmt::format("as joint {} came in nearly every row, and not as its own joint did: are columns exchanged?", j + 1);
  }
  return "";
}

/// Poses that are taken again and again say no more than once.
std::size_t differentPoses(const std::vector<Sample>& samples) {
  std::set<std::vector<double>> poses;
  for (const Sample& sample : samples) poses.emplace(sample.q.begin(), sample.q.end());
  return poses.size();
}

bool isZeroOrOne(const std::vector<Sample>& samples, Eigen::Index k) {
  const auto count = [&](double value) {
    return static_cast<std::size_t>(
        std::count_if(samples.begin(), samples.end(), [&](const Sample& sample) { return sample.dir(k) == value; }));
  };
  const std::size_t zeros = count(0.0), ones = count(1.0);
  return zeros + ones == samples.size() && std::min(zeros, ones) > samples.size() / 5;
}

}  // namespace

std::vector<std::string> speedRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm) {
  constexpr double kBeyond = 3.0;  // controllers pass a URDF's limit by little
  std::size_t ways = 0, fast = 0, fastest = 0;
  Hurry most;
  for (std::size_t n = 1; n < samples.size(); ++n) {
    const Sample &before = samples[n - 1], &here = samples[n];
    if (!here.stamp || !before.stamp || here.q.size() == 0 || !(*here.stamp > *before.stamp)) continue;
    ++ways;
    const Hurry hurry = hurryBetween(before, here, arm);
    fast += hurry.share > kBeyond ? 1 : 0;
    if (!(hurry.share > most.share)) continue;
    most = hurry;
    fastest = n;
  }
  if (ways < kFewest / 2 || 2 * fast < ways) return {};
  const Sample &before = samples[fastest - 1], &here = samples[fastest];
  return {
      fmt::format("{}:{}: joint {} moves by {:.3g} within {:.3g} s of stamp, {:.0f} times as fast as it can, and so do most rows: "
                  "expected seconds; is stamp in minutes, hours or days?",
                  file.string(), here.line, most.joint + 1, std::abs(here.q(most.joint) - before.q(most.joint)),
                  *here.stamp - *before.stamp, most.share)};
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
        isZeroOrOne(samples, k) ? "0 and 1 alone, expected -1 and 1: the side that the joint came from" : contradictionOf(samples, k);
    if (!what.empty()) columns_of[what].push_back(fmt::format("dir{}", k + 1));
  }
  for (const auto& [what, columns] : columns_of) {
    remarks.push_back(fmt::format("{}: {}: {}", file.string(), fmt::join(columns, ", "), what));
  }
  return remarks;
}

}  // namespace poecal
