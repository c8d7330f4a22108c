// Names that stand for one that is not there.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace poecal {

/// Levenshtein's distance: the fewest letters to insert, remove or replace that make one word of the other.
std::size_t editDistance(const std::string& a, const std::string& b);

/// The names for an error that says what was expected, parted by ", ": all of them as they come, but of more than ten the five that are
/// nearest to `word` and how many there are ("joint_gain, joint_drift, joint_slip, axis_wobble, joint_scatter, ... (29 in all)").
std::string choices(const std::string& word, std::vector<std::string> names);

}  // namespace poecal
