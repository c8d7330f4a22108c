#include "registration/wrong_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "poecal/core/statistics.hpp"
#include "registration/mistakes.hpp"

namespace poecal {
namespace {

// Fewer rows may be brought to anything by one of a hundred mistakes.
constexpr std::size_t kFewestWrong = 4;
// Of the rows on either side, those that have to be as the text says.
constexpr double kMost = 0.8;
// What is left of the wrong rows' misfit once they are put right.
constexpr double kLeft = 0.2;
// Rows that each mistake is tried on.
constexpr std::size_t kTried = 16;

/// Rows that fit a registration, and those that do not.
struct Sides {
  Registration registration;
  double limit = 0.0;  ///< of the misfit of those that fit
  std::vector<std::size_t> wrong;
  double before = 0.0;  ///< median misfit of the wrong ones
};

std::optional<Sides> sidesOf(const Registration& registration, double misfit_of_right, const std::vector<HypothesisSample>& samples,
                             const Misfit& misfit) {
  Sides sides{registration, kBeside * misfit_of_right + 1e-9, {}, 0.0};
  std::vector<double> of_wrong;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double left = misfit(registration, samples[k]);
    if (left <= sides.limit) continue;
    sides.wrong.push_back(k);
    of_wrong.push_back(left);
  }
  if (sides.wrong.size() < kFewestWrong || samples.size() - sides.wrong.size() < kFewestRows) return std::nullopt;
  // The upper one of the two in the middle: what shows no pixel is infinitely far off.
  const auto middle = of_wrong.begin() + static_cast<std::ptrdiff_t>(of_wrong.size() / 2);
  std::nth_element(of_wrong.begin(), middle, of_wrong.end());
  sides.before = *middle;
  return sides;
}

/// Where the wrong rows are among all.
std::string whereText(const std::vector<std::size_t>& wrong, std::size_t rows, std::size_t& told) {
  const auto dense = [&](std::size_t span) { return static_cast<double>(wrong.size()) >= kMost * static_cast<double>(span); };
  told = wrong.front();
  if (wrong.front() > 0 && dense(rows - wrong.front())) return "from this row on";
  if (wrong.back() + 1 < rows && dense(wrong.back() + 1)) {
    told = wrong.back() + 1;
    return "in the rows before this one";
  }
  return fmt::format("in {} rows, of which this is the first,", wrong.size());
}

std::vector<Mistake> mistakesOfRows(const Problem& wrong) {
  std::vector<Mistake> all;
  for (std::vector<Mistake>& kind : std::array{poseMistakes(wrong), inversions(wrong), jointMistakes(wrong), pictureMistakes(wrong),
                                               cornerMistakes(wrong), resolutionMistakes(wrong)}) {
    std::move(kind.begin(), kind.end(), std::back_inserter(all));
  }
  return all;
}

/// The median misfit of rows that are put right; nothing where too few of them then fit.
std::optional<double> mended(const Problem& right, const Sides& sides, std::size_t tried) {
  const Misfit misfit = misfitIn(right.cell, right.observations);
  std::vector<double> left;
  for (const HypothesisSample& sample : right.samples) left.push_back(misfit(sides.registration, sample));
  const auto fitting = std::count_if(left.begin(), left.end(), [&](double one) { return one <= sides.limit; });
  if (static_cast<double>(fitting) < kMost * static_cast<double>(tried)) return std::nullopt;
  return median(left);
}

std::optional<WrongRows> mistakeIn(const Sides& sides, const Cell& cell, const std::vector<Observation>& observations,
                                   const std::vector<HypothesisSample>& samples) {
  Problem tried;
  tried.cell = cell;
  const std::size_t count = std::min(kTried, sides.wrong.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = sides.wrong[i * sides.wrong.size() / count];
    tried.add(observations[k], samples[k]);
  }
  std::optional<WrongRows> best;
  for (const Mistake& mistake : mistakesOfRows(tried)) {
    Problem altered = tried;
    mistake.undo(altered);
    if (!keepsMost(altered, tried)) continue;
    const std::optional<double> left = mended(altered, sides, tried.observations.size());
    if (!left || *left > kLeft * sides.before || (best && *left >= kClearlyBetter * best->misfit)) continue;
    std::size_t told = 0;
    const std::string where = whereText(sides.wrong, observations.size(), told);
    best = WrongRows{fmt::format("{} {}", where, mistake.text), observations[told].sample, *left, sides.before};
  }
  return best;
}

}  // namespace

std::optional<WrongRows> findWrongRows(const Cell& cell, const std::vector<Observation>& observations,
                                       const std::vector<HypothesisSample>& samples, const Registration& registration, const Problem& few) {
  const Misfit misfit = misfitIn(cell, observations);
  std::vector<std::pair<Registration, double>> judges{{registration, medianMisfit(registration, samples, misfit)}};
  // Few rows err by less than others do, many may hold wrong ones.
  const std::size_t rows = few.samples.size();
  for (const std::size_t part : {rows / 3, rows / 2}) {
    for (const Consensus& end : registeredEnds(few, part)) judges.emplace_back(end.fit.cell.registration, end.misfit);
  }
  std::optional<WrongRows> best;
  for (const auto& [judge, of_right] : judges) {
    const std::optional<Sides> sides = sidesOf(judge, of_right, samples, misfit);
    if (!sides) continue;
    std::optional<WrongRows> wrong = mistakeIn(*sides, cell, observations, samples);
    if (wrong && (!best || wrong->misfit < best->misfit)) best = std::move(wrong);
  }
  return best;
}

}  // namespace poecal
