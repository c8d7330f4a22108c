// How the set `injected` fared: a recording has findings of its own, so each case is held against what is said of the recording as it is.
#pragma once

#include <string>
#include <vector>

#include "withheld/tables.hpp"

namespace withheld {

/// Whether the parameters agree with the truth as far as their standard deviations say: chi-square of the differences below its 95 % point.
/// False where a true parameter has no deviation.
bool agrees(const TrueEffect& effect, const Finding& finding);

/// Shares and one row a case, in Markdown; empty without such cases.
///
/// - found: the injected effect or an alias of it is a finding, in its place
/// - its size agrees: see agrees(); of those found by their own name
/// - absent: the recording as it is has no such finding
/// - else new: findings, neither injected nor said of the recording as it is
std::string injected(const std::vector<Scored>& cases);

}  // namespace withheld
