// Holds one answer against the truth.
#pragma once

#include <string>
#include <vector>

#include "withheld/truth.hpp"

namespace withheld {

/// How one hidden effect fared.
struct Fate {
  bool right = false;           ///< a finding names it, or an alias of it, in its place
  bool right_driver = false;    ///< and says what drives it
  bool among = false;           ///< a finding or one of its alternatives does
  bool in_class = false;        ///< right, or a finding names one close to it with it among the alternatives
  bool right_place = false;     ///< a finding of any name is at its place
  bool unknown_there = false;   ///< a finding `unknown` is at its place
  bool unknown_driver = false;  ///< and says what drives it
};

/// A probability that was stated, and whether what it was stated of is true.
struct Stated {
  double probability = 0.0;
  bool true_ = false;
};

struct Verdict {
  std::vector<Fate> fates;        ///< one per hidden effect
  std::size_t findings = 0;       ///< of all kinds, without bad_samples where there are wild rows
  std::size_t wrong_names = 0;    ///< findings of a listed effect that is not there, nor close to one that is named beside it
  std::size_t extras = 0;         ///< findings beyond one per hidden effect
  std::vector<std::string> said;  ///< "effect@location" of all findings
  std::vector<Stated> stated;
  bool silent_listed = true;  ///< what cannot be seen is listed as not testable
};

Verdict judge(const Truth& truth, const Answer& answer);

}  // namespace withheld
