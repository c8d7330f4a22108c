#include "capture/still_readings.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace poecal {
namespace {

/// "27 to 42": the lines of a run.
std::string linesOf(const std::vector<Sample>& samples, const RowRun& run) {
  return fmt::format("{} to {}", samples[run.begin].line, samples[run.end - 1].line);
}

bool isWorthSaying(const std::vector<Sample>& samples, const RowRun& run) {
  return run.size() >= kFewestStill && samples.size() - run.size() >= kFewestOthers;
}

/// Runs of whole readings where those of a pose are not the rule: the run is far longer than any other.
bool isUsual(const std::vector<Sample>& samples, const RowRun& run) {
  std::size_t repeated = 0, others = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    if (k >= run.begin && k < run.end) continue;
    ++others;
    repeated += samples[k].q == samples[k - 1].q;
  }
  return 4 * repeated > others;
}

}  // namespace

std::vector<std::string> stillRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples) {
  if (samples.empty()) return {};
  std::vector<std::string> remarks;
  const auto remark = [&](const RowRun& run, const std::string& what) {
    remarks.push_back(fmt::format("{}:{}: {}: expected the reading of each moment", file.string(), samples[run.begin].line, what));
  };
  const RowRun frozen = longestRun(samples.size(), [&](std::size_t k) {
    const Sample &here = samples[k], &before = samples[k - 1];
    return here.q == before.q && !(here.pose && before.pose && *here.pose == *before.pose);
  });
  if (isWorthSaying(samples, frozen) && !isUsual(samples, frozen)) {
    remark(frozen, fmt::format("no reading changes in lines {}; if these are no shots of one pose, the readings are stuck",
                               linesOf(samples, frozen)));
    return remarks;
  }
  for (Eigen::Index joint = 0; joint < samples.front().q.size(); ++joint) {
    const auto reading = [&](std::size_t k) { return samples[k].q(joint); };
    const RowRun run = longestRun(samples.size(), [&](std::size_t k) { return reading(k) == reading(k - 1); });
    if (!isWorthSaying(samples, run) || comeBack(samples.size(), run, reading)) continue;
    std::size_t moves = 0;
    for (std::size_t k = run.begin + 1; k < run.end; ++k) moves += samples[k].q != samples[k - 1].q;
    if (2 * moves < run.size() - 1) continue;
    remark(run, fmt::format("q{} stays at exactly {:.6g} in lines {} while others move; if it was not parked there, its reading is stuck",
                            joint + 1, reading(run.begin), linesOf(samples, run)));
  }
  return remarks;
}

}  // namespace poecal
