#include "registration/moved_once.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

std::vector<double> misfitsIn(const Problem& few, const Registration& registration) {
  const Misfit misfit = misfitIn(few.cell, few.observations);
  std::vector<double> misfits;
  for (const HypothesisSample& sample : few.samples) misfits.push_back(misfit(registration, sample));
  return misfits;
}

}  // namespace

std::optional<MovedOnce> findMove(const Problem& few) {
  const std::size_t rows = few.samples.size(), third = rows / 3;
  const std::vector<Consensus> ends = registeredEnds(few, third);
  if (ends.size() < 2) return std::nullopt;
  const std::vector<double> of_before = misfitsIn(few, ends.front().fit.cell.registration),
                            of_after = misfitsIn(few, ends.back().fit.cell.registration);
  const auto leftBy = [&](std::size_t split) {
    std::vector<double> left(of_before.begin(), of_before.begin() + static_cast<std::ptrdiff_t>(split));
    left.insert(left.end(), of_after.begin() + static_cast<std::ptrdiff_t>(split), of_after.end());
    return left;
  };
  // Logarithms: a row that fits neither is a row of its own, and a picture that shows no pixel is as bad as one far off.
  const auto badness = [](const std::vector<double>& left) {
    double sum = 0.0;
    for (const double misfit : left) sum += std::log(std::clamp(misfit, 1e-6, 1e6));
    return sum;
  };
  std::size_t best = third;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t split = third; split <= rows - third; ++split) {
    const double here = badness(leftBy(split));
    if (here < least) {
      least = here;
      best = split;
    }
  }
  const std::vector<double> left = leftBy(best);
  const double misfit = median(left);
  const auto beside = std::count_if(left.begin(), left.end(), [&](double one) { return !(one <= kBeside * misfit); });
  return MovedOnce{few.observations[few.samples[best].observation].sample, misfit,
                   static_cast<double>(beside) / static_cast<double>(left.size())};
}

}  // namespace poecal
