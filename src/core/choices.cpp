#include "poecal/core/choices.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace poecal {

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t replaced = diagonal + (a[i] == b[k] ? 0 : 1);
      diagonal = row[k + 1];
      row[k + 1] = std::min({row[k] + 1, diagonal + 1, replaced});
    }
  }
  return row.back();
}

std::string choices(const std::string& word, std::vector<std::string> names) {
  constexpr std::size_t kListed = 10, kNearest = 5;
  if (names.size() <= kListed) return fmt::format("{}", fmt::join(names, ", "));
  const std::size_t all = names.size();
  std::stable_sort(names.begin(), names.end(),
                   [&word](const std::string& a, const std::string& b) { return editDistance(word, a) < editDistance(word, b); });
  names.resize(kNearest);
  return fmt::format("{}, ... ({} in all)", fmt::join(names, ", "), all);
}

}  // namespace poecal
