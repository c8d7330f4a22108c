#include "registration/row_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "poecal/core/statistics.hpp"
#include "registration/mistakes.hpp"

namespace poecal {
namespace {

constexpr int kFarthest = 5;
constexpr int kShifts = 2 * kFarthest + 1;
// Pictures that are followed; more would tell nothing new.
constexpr std::size_t kFollowed = 400;
// A change of the shift must bring more than two pictures to their rows.
constexpr double kChange = 2.5;
constexpr double kMostPictures = 0.8;
// Times the misfit of those that fit.
constexpr double kFits = 4.0;

using ReadingsOfSamples = std::map<std::size_t, const Observation*>;

/// The observation with the reading of the row `shift` further down; nothing where that row is not there.
std::optional<Observation> shifted(const Observation& observation, const ReadingsOfSamples& readings, int shift) {
  const long row = static_cast<long>(observation.sample) + shift;
  const auto found = row < 0 ? readings.end() : readings.find(static_cast<std::size_t>(row));
  if (found == readings.end()) return std::nullopt;
  Observation other = observation;
  other.q = found->second->q;
  other.T_base_flange = found->second->T_base_flange;
  return other;
}

/// @param shift_of  of the row of a sample.
template <typename ShiftOf>
Problem shiftedBy(const Problem& few, const ReadingsOfSamples& readings, const ShiftOf& shift_of) {
  Problem problem;
  problem.cell = few.cell;
  for (std::size_t k = 0; k < few.observations.size(); ++k) {
    std::optional<Observation> other = shifted(few.observations[k], readings, shift_of(few.observations[k].sample));
    if (!other) continue;
    problem.samples.push_back(few.samples[k]);
    problem.samples.back().observation = problem.observations.size();
    problem.observations.push_back(std::move(*other));
  }
  renewPoses(problem);
  return problem;
}

Problem shiftedProblem(const Problem& few, const ReadingsOfSamples& readings, int shift) {
  return shiftedBy(few, readings, [shift](std::size_t) { return shift; });
}

/// The registration of the shift that fits best.
std::optional<Consensus> bestOfShifts(const Problem& few, const ReadingsOfSamples& readings) {
  std::vector<std::pair<double, int>> order;
  for (int shift = -kFarthest; shift <= kFarthest; ++shift) {
    order.emplace_back(quickMisfit(shiftedProblem(few, readings, shift)), shift);
  }
  std::sort(order.begin(), order.end());
  std::optional<Consensus> best;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!std::isfinite(order[k].first)) continue;
    auto found = solve(shiftedProblem(few, readings, order[k].second), 2);
    if (found && (!best || found->misfit < best->misfit)) best = std::move(found);
  }
  return best;
}

/// misfits[k][shift + kFarthest] of each followed picture; infinity where the row is not there.
using ShiftMisfits = std::vector<std::array<double, kShifts>>;

/// The cheapest sequence of shifts: one for each picture that does not fit, kChange for each change.
std::vector<int> followShifts(const ShiftMisfits& misfits, double limit) {
  std::vector<std::array<int, kShifts>> came_from(misfits.size());
  std::array<double, kShifts> cost{};
  for (std::size_t k = 0; k < misfits.size(); ++k) {
    std::array<double, kShifts> next{};
    for (int s = 0; s < kShifts; ++s) {
      int from = s;
      for (int other = 0; k > 0 && other < kShifts; ++other) {
        if (cost[static_cast<std::size_t>(other)] + kChange < cost[static_cast<std::size_t>(from)] + (from == s ? 0.0 : kChange))
          from = other;
      }
      const auto i = static_cast<std::size_t>(s);
      came_from[k][i] = from;
      next[i] = cost[static_cast<std::size_t>(from)] + (from == s ? 0.0 : kChange) + (misfits[k][i] <= limit ? 0.0 : 1.0) +
                1e-4 * std::abs(s - kFarthest);
    }
    cost = next;
  }
  std::vector<int> shifts(misfits.size());
  auto at = static_cast<int>(std::min_element(cost.begin(), cost.end()) - cost.begin());
  for (std::size_t k = misfits.size(); k-- > 0;) {
    shifts[k] = at - kFarthest;
    at = came_from[k][static_cast<std::size_t>(at)];
  }
  return shifts;
}

std::string countText(int shift) { return std::abs(shift) == 1 ? "one" : std::to_string(std::abs(shift)); }

std::string describe(const std::vector<int>& shifts, std::size_t first_wrong) {
  const int shift = shifts[first_wrong];
  std::string text = first_wrong == 0 ? "the rows are shifted" : "from this row on the rows are shifted";
  text += fmt::format(" by {} against the pictures", countText(shift));
  const auto next =
      std::find_if(shifts.begin() + static_cast<std::ptrdiff_t>(first_wrong), shifts.end(), [&](int s) { return s != shift; });
  if (next != shifts.end()) text += *next == 0 ? ", further on they are right again" : fmt::format(", further on by {}", countText(*next));
  return text;
}

/// Shifts of the rows with even and with odd numbers.
struct Alternation {
  int even = 0, odd = 0;
  int of(std::size_t sample) const { return sample % 2 == 0 ? even : odd; }
};

std::string describe(const Alternation& shifts) {
  if (shifts.even != 0 && shifts.odd != 0) {
    return fmt::format("the rows look shifted by {} and by {} in turn against the pictures (neighbours exchanged?)", shifts.even,
                       shifts.odd);
  }
  const int shift = shifts.even != 0 ? shifts.even : shifts.odd;
  return fmt::format("every second row looks shifted by {} against the pictures, the {}", countText(shift),
                     shift > 0 ? "reading stands before its picture" : "reading stands after its picture");
}

/// Rows that are mispaired in turn, which no sequence of few changes follows.
std::optional<MispairedRows> findAlternation(const Cell& cell, const std::vector<Observation>& observations,
                                             const std::vector<HypothesisSample>& samples, const Problem& few,
                                             const ReadingsOfSamples& readings) {
  constexpr int kNear = 2;
  constexpr double kMostOfHalf = 0.65;  // of all rows: half of them stand right, and some more by chance
  std::vector<std::pair<double, Alternation>> order;
  for (int even = -kNear; even <= kNear; ++even) {
    for (int odd = -kNear; odd <= kNear; ++odd) {
      if (even == odd) continue;
      const Alternation shifts{even, odd};
      order.emplace_back(quickMisfit(shiftedBy(few, readings, [&shifts](std::size_t sample) { return shifts.of(sample); })), shifts);
    }
  }
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const Misfit misfit = misfitIn(cell, observations);
  std::optional<MispairedRows> best;
  for (std::size_t i = 0; i < 3; ++i) {
    const Alternation& shifts = order[i].second;
    if (!std::isfinite(order[i].first)) continue;
    const auto found = solve(shiftedBy(few, readings, [&shifts](std::size_t sample) { return shifts.of(sample); }), 2);
    if (!found || (best && !(found->misfit < best->misfit))) continue;
    const double limit = kFits * found->misfit + 1e-9;
    double judged = 0.0, as_they_stand = 0.0, with_shifts = 0.0;
    std::optional<std::size_t> first;
    for (std::size_t k = 0; k < observations.size(); ++k) {
      const int shift = shifts.of(observations[k].sample);
      const std::optional<Observation> other = shifted(observations[k], readings, shift);
      if (!other) continue;
      if (shift != 0 && !first) first = observations[k].sample;
      judged += 1.0;
      HypothesisSample sample = samples[k];
      as_they_stand += misfit(found->fit.cell.registration, sample) <= limit;
      sample.T_near_far = nearFar(cell, *other);
      with_shifts += misfit(found->fit.cell.registration, sample) <= limit;
    }
    if (judged < 8.0 || with_shifts < kMostPictures * judged || as_they_stand > kMostOfHalf * judged) continue;
    best = MispairedRows{describe(shifts), first, found->misfit};
  }
  return best;
}

/// Which row each picture belongs to in one registration. @param misfit_of_right  what it leaves in rows that it was found from.
std::optional<MispairedRows> follow(const Cell& cell, const std::vector<Observation>& observations,
                                    const std::vector<HypothesisSample>& samples, const ReadingsOfSamples& readings,
                                    const Registration& registration, double misfit_of_right) {
  const Misfit misfit = misfitIn(cell, observations);
  const std::size_t stride = (observations.size() + kFollowed - 1) / kFollowed;
  ShiftMisfits misfits;
  std::vector<std::size_t> followed;
  for (std::size_t k = 0; k < observations.size(); k += stride) {
    followed.push_back(k);
    std::array<double, kShifts>& of_shifts = misfits.emplace_back();
    for (int s = 0; s < kShifts; ++s) {
      double& value = of_shifts[static_cast<std::size_t>(s)];
      value = std::numeric_limits<double>::infinity();
      const std::optional<Observation> other = shifted(observations[k], readings, s - kFarthest);
      if (!other) continue;
      HypothesisSample sample = samples[k];
      sample.T_near_far = nearFar(cell, *other);
      value = misfit(registration, sample);
    }
  }
  const double limit = kFits * misfit_of_right + 1e-9;
  const std::vector<int> shifts = followShifts(misfits, limit);
  std::vector<double> left;
  double as_they_stand = 0.0, with_shifts = 0.0, judged = 0.0;
  for (std::size_t k = 0; k < shifts.size(); ++k) {
    const double moved = misfits[k][static_cast<std::size_t>(shifts[k] + kFarthest)];
    if (!std::isfinite(moved)) continue;
    judged += 1.0;
    as_they_stand += misfits[k][kFarthest] <= limit;
    with_shifts += moved <= limit;
    left.push_back(moved);
  }
  const auto wrong = std::find_if(shifts.begin(), shifts.end(), [](int s) { return s != 0; });
  if (wrong == shifts.end() || judged < 6.0 || with_shifts < kMostPictures * judged ||
      with_shifts - as_they_stand < std::max(3.0, 0.15 * judged)) {
    return std::nullopt;
  }
  const auto first = static_cast<std::size_t>(wrong - shifts.begin());
  MispairedRows rows{describe(shifts, first), std::nullopt, median(left)};
  if (first > 0) rows.sample = observations[followed[first]].sample;
  return rows;
}

}  // namespace

std::optional<MispairedRows> findMispairedRows(const Cell& cell, const std::vector<Observation>& observations,
                                               const std::vector<HypothesisSample>& samples, const Problem& few) {
  ReadingsOfSamples readings;
  for (const Observation& observation : observations) readings[observation.sample] = &observation;
  std::vector<Consensus> judges;
  if (std::optional<Consensus> best = bestOfShifts(few, readings)) judges.push_back(std::move(*best));
  // Where as many rows are shifted as are not, all of them together agree on nothing.
  for (Consensus& end : registeredEnds(few, few.samples.size() / 3)) judges.push_back(std::move(end));
  std::optional<MispairedRows> best;
  for (const Consensus& judge : judges) {
    std::optional<MispairedRows> rows_found = follow(cell, observations, samples, readings, judge.fit.cell.registration, judge.misfit);
    if (rows_found && (!best || rows_found->misfit < kClearlyBetter * best->misfit)) best = std::move(rows_found);
  }
  return best ? best : findAlternation(cell, observations, samples, few, readings);
}

}  // namespace poecal
