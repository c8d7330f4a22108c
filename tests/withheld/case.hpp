// One case of the withheld check: what poecal is given, and what only the scorer may know.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "withheld/family.hpp"
#include "withheld/leftover.hpp"
#include "withheld/pictures.hpp"

namespace withheld {

/// 1 sigma of the intrinsics, as camera.yaml states them.
struct LensDeviation {
  double f = 0.0, c = 0.0, k1 = 0.0, k2 = 0.0;
};

/// One tag as a shot saw it.
struct Sighting {
  std::size_t shot = 0;
  int tag = 0;
  Eigen::Matrix<double, 2, 4> pixels;
};

/// An effect that a case has.
struct Hidden {
  Flaw flaw;
  double S = 0.0;                    ///< see Leftover
  bool listed = true;                ///< in the contract's table
  std::vector<std::string> aliases;  ///< "effect@location" of listed ones that explain it without a rest, besides geometry
  std::vector<std::string> close;    ///< those, no aliases, that leave less of it than kTellable
  std::string nearest;               ///< the listed one, not an alias, that explains most of it
  double left_by_nearest = 0.0;      ///< S that the nearest one does not explain
};

struct Case {
  std::string set;
  std::uint64_t seed = 0, number = 0;
  Family family = Family::first;  ///< of unlisted structure
  std::string recording;          ///< real one that the effect was brought into; see injected.hpp

  // Given.
  Cell told;  ///< nominal arm (as drawn, before the errors), lens as stated
  std::optional<std::vector<Body>> told_masses;
  std::optional<LensDeviation> lens_deviation;
  bool sigma_told = false;
  Columns columns;
  std::vector<Shot> shots;
  std::vector<Sighting> sightings;
  std::optional<Look> look;  ///< pictures are given instead of sightings

  // Sealed.
  Cell actual;
  std::vector<Hidden> hidden;
  Noise noise;
  std::vector<std::string> wild;    ///< images
  std::size_t missing = 0;          ///< tags that were not seen
  std::optional<Flaw> unfindable;   ///< there, but nothing can show it
  std::vector<std::string> silent;  ///< "effect@location" of it where the contract's table has it: to be listed as not testable
  std::optional<double> oracle_px;  ///< see oracle.hpp
  std::map<std::string, std::vector<std::string>> baselines;  ///< see baselines.hpp
  std::vector<Shot> unseen;
  Eigen::VectorXd unseen_corners;

  /// All that is wrong in the cell, findable or not.
  std::vector<Flaw> flaws() const {
    std::vector<Flaw> all;
    for (const Hidden& one : hidden) all.push_back(one.flaw);
    if (unfindable) all.push_back(*unfindable);
    return all;
  }
};

/// The sets that there are.
const std::vector<std::string>& setNames();

/// Case `number` of a set; always the same for a seed and family.
/// @throws std::invalid_argument: no such set.
Case makeCase(const std::string& set, std::uint64_t seed, std::uint64_t number, Family family = Family::first);

/// Writes FOLDER/NNNN/capture, FOLDER/NNNN/unseen and FOLDER/NNNN.truth.json.
void writeCase(const Case& made, const std::string& folder);
/// The last of these alone.
void writeTruth(const Case& made, const std::string& folder);

}  // namespace withheld
