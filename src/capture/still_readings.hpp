// Readings that stay exactly as they are from row to row.
#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"

namespace poecal {

// Fewer rows of one value tell nothing of a joint, and fewer others do not say how it is read elsewhere.
constexpr std::size_t kFewestStill = 4, kFewestOthers = 8;

/// Rows [begin, end) in the order in which they were taken.
struct RowRun {
  std::size_t begin = 0, end = 0;
  std::size_t size() const { return end - begin; }
};

/// The longest run of equal readings. @param same  whether row k has the reading of row k - 1.
template <typename Same>
RowRun longestRun(std::size_t rows, const Same& same) {
  RowRun longest, run;
  for (std::size_t k = 0; k < rows; ++k) {
    run = k > 0 && same(k) ? RowRun{run.begin, k + 1} : RowRun{k, k + 1};
    if (run.size() > longest.size()) longest = run;
  }
  return longest;
}

/// Whether values outside of a run come back: commanded values do, readings of a joint that moves do not. @param value  of row k.
template <typename Value>
bool comeBack(std::size_t rows, const RowRun& run, const Value& value) {
  std::set<double> values;
  for (std::size_t k = 0; k < rows; ++k) {
    if (k < run.begin || k >= run.end) values.insert(value(k));
  }
  return 4 * values.size() < 3 * (rows - run.size());
}

/// Runs of kFewestStill rows and more in which a joint reads exactly the same while others move and it never repeats elsewhere, or in which
/// no reading changes though no `pose` says that they are shots of one: it was parked there, or its reading is stuck, which only pictures
/// can tell. One sentence each, with file and line of the first row.
std::vector<std::string> stillRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples);

}  // namespace poecal
