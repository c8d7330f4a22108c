// The answer of a report in words.
#pragma once

#include <string>
#include <vector>

#include "poecal/calibration/calibrate.hpp"

namespace poecal {

struct Verdict {
  std::string headline;                ///< a few words
  std::vector<std::string> sentences;  ///< three: where, which, how far and how much remains
  std::vector<std::string> actions;    ///< what to do, one sentence each
};

Verdict verdictOf(const Calibration& calibration);

}  // namespace poecal
