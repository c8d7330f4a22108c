// The sealed answer of a case, and what poecal said of it.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace withheld {

/// "effect@location", the name of an effect in its place.
std::string placeName(const std::string& effect, const std::string& location);

struct TrueEffect {
  std::string effect, location, driver;
  bool listed = true;  ///< in the contract's table
  double S = 0.0;
  double left_by_nearest = 0.0;      ///< S that the nearest other listed effect, no alias, leaves of it
  double size = 0.0;                 ///< of target_scale
  std::vector<std::string> aliases;  ///< places that are the same thing in this cell
  std::vector<std::string> close;    ///< places that are less than 3.3 sigma from it in this capture
  /// By the contract's names, without those that say when or which.
  std::map<std::string, double> parameters;
  bool is(const std::string& place) const;
};

struct Truth {
  std::filesystem::path folder;  ///< of the case; capture/, unseen/ and out/ are in it
  std::string set;
  std::string recording;  ///< real one that the effect was brought into; empty for cells
  std::vector<TrueEffect> effects;
  std::vector<std::string> silent;
  std::vector<std::string> wild;
  std::size_t shots = 0;
  std::optional<double> oracle_px;                            ///< rms on the unseen corners of a fit that is told the effects
  std::map<std::string, std::vector<std::string>> baselines;  ///< places that simple diagnoses name
};

/// @throws std::runtime_error, nlohmann::json::exception
Truth readTruth(const std::filesystem::path& file);

struct Named {
  std::string effect, location;
  double probability = 0.0;
  std::string place() const { return placeName(effect, location); }
};

struct Finding : Named {
  std::string driver;
  std::vector<Named> alternatives;
  std::optional<double> size;  ///< parameter `scale`
  std::map<std::string, double> parameters, deviations;
};

/// What diagnosis.json says.
struct Answer {
  std::vector<Finding> findings;
  std::vector<std::string> not_testable;  ///< places
  std::optional<double> shrinkage;
  double shrinkage_low = 0.0, shrinkage_high = 0.0;
};
Answer readAnswer(const std::filesystem::path& file);

}  // namespace withheld
