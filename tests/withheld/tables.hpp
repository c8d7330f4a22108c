// The tables that a score prints.
#pragma once

#include <string>
#include <vector>

#include "withheld/judge.hpp"

namespace withheld {

/// A case with all that is known of it.
struct Scored {
  Truth truth;
  Verdict verdict;
  Answer answer;
  bool answered = false;
  double seconds = 0.0, identify_seconds = 0.0;  ///< of processor time; 0 where not known
  double before_px = 0.0, after_px = 0.0;        ///< on unseen corners; 0 where not known
};

struct Interval {
  double low = 0.0, high = 1.0;
};
/// Wilson's 95 % interval of a share.
Interval wilson(std::size_t hits, std::size_t of);

/// "90.0 % (18/20; 69.9 to 97.2)": a share and its interval.
std::string share(std::size_t hits, std::size_t of);

/// All tables, in Markdown: what was wanted of each set and what came out, the listed effects one by one, wrong answers, calibration,
/// shrinkage and times. Sets without cases are left out.
std::string tables(const std::vector<Scored>& cases);

}  // namespace withheld
