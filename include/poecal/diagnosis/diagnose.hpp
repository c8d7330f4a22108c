// The diagnosis of the gap between a calibrated model and what was measured: where it lies, which effect causes it, how far it shrinks.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "poecal/capture/row_order.hpp"
#include "poecal/cell/measurements.hpp"
#include "poecal/core/progress.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/identification/identify.hpp"

namespace poecal {

struct DiagnoseOptions {
  int folds = 5;           ///< in how many turns the poses judge a fit that did not see them
  std::uint64_t seed = 1;  ///< of the folds and of the bootstrap
  int jobs = 1;            ///< candidates weighed at a time (0: one per core); the result does not depend on it
  /// Told of each round of the search, whose number nobody knows before, and of each model that is judged. May be empty.
  ProgressFunction progress = {};
};

/// What tells how noisy the measuring is.
enum class NoiseSource {
  kRepeats,    ///< poses measured again
  kGiven,      ///< stated deviations
  kEstimated,  ///< what a target's corners leave beside a free pose of it
  kUnknown     ///< nothing but what the model leaves
};
/// "repeats", "given", "estimated", "not known: no repeats, no stated deviation".
const char* noiseSourceName(NoiseSource source);

/// One model stage, on poses that its fit did not see.
struct GapStage {
  std::string stage;    ///< "nominal", "registered", "identified", "identified + joint_gain@joint:2", ...
  ErrorSummary errors;  ///< of every row; the first three are those of the identification
  double rms = 0.0;     ///< of the rows that were kept: length of a corner's residual [px]; for poses the distance [m]
  double excess = 0.0;  ///< sqrt(max(0, rms^2 - noise^2)) [px] or [m]
  std::pair<double, double> rms_interval{0.0, 0.0};  ///< 95 % of `rms`, the poses a sample
};

/// Where a finding's name is not the only one that the data leave open.
struct AlternativeCause {
  std::string effect, location, driver;
  double probability = 0.0;
};

/// How much smaller the excess became, with a 95 % interval from resampled poses, as measured and in the worst of the ways to hold out
/// poses: at random, stretches of time, clusters of posture.
struct Shrinkage {
  double value = 0.0;
  std::pair<double, double> interval{0.0, 0.0};
  bool claimed() const { return interval.first > 0.0; }
};

/// A change of a joint's axis when a finding entered.
struct AxisMove {
  std::string joint;
  double tilt = 0.0;   ///< [rad]
  double shift = 0.0;  ///< [m]
};

struct Finding {
  std::string effect = {}, location = {}, driver = {};
  std::map<std::string, double> parameters = {}, standard_deviation = {};
  std::map<std::string, std::string> units = {};
  double probability = 0.0;
  double p_value = 1.0;       ///< bound of the chance that nothing looks so, over all explanations tried (Ville)
  double log_evidence = 0.0;  ///< log of the odds against its absence that the data give, all else being in
  double chi_square = 0.0;
  Shrinkage shrinkage = {};  ///< of the model with it against the model with all others
  std::vector<AlternativeCause> alternatives = {};
  std::string separate_with = {};  ///< what would tell the alternatives apart; empty where none is close
  std::string remedy = {};
  /// At camera.mount, where the pictures show a reference: which of camera and base moved, and how that is known.
  std::string reference = {};
  /// Compliances: largest turn [rad] or shift [m] that it makes over the capture's poses. Where the links' masses are not stated, without
  /// constant turns of the base and of the bodies up to its place, or a joint's zero: the registration and the axes take these up.
  std::optional<double> largest_deflection = {};
  std::optional<double> largest_deflection_deviation = {};  ///< its standard deviation
  std::vector<std::string> images = {};                     ///< bad_samples: which
};

/// A place and a driver at which what identification left shows structure.
struct GapPlace {
  std::string location, driver;
  double share = 0.0;  ///< of the excess
  double p_value = 1.0;
};

struct Detectable {
  std::string effect, location;
  double smallest = 0.0;  ///< size that would have been seen four times in five
  std::string unit;
};

struct BadSample {
  std::size_t sample = 0;  ///< index into the samples of the capture
  double residual = 0.0;   ///< rms of its corners [px], or distance [m]
};

/// Why an effect is named or is not.
struct Explained {
  std::string effect, location, driver;
  double log_evidence = 0.0;
  double chi_square = 0.0;
  double probability = 0.0;
  double smallest = 0.0;  ///< detectable size
  std::string unit;
};

struct Diagnosis {
  bool pixels = true;           ///< corners; otherwise poses of an instrument
  double noise_sigma = 0.0;     ///< per axis [px], or of a position [m]
  double tag_sigma = 0.0;       ///< what all corners of a tag share, per axis [px]
  double repeatability = 0.0;   ///< of every joint [rad]
  double rotation_sigma = 0.0;  ///< poses [rad]
  NoiseSource noise_source = NoiseSource::kEstimated;
  double noise_rms = 0.0;  ///< of a corner's length [px], or a position's [m], as it is subtracted; at most any stage's rms
  /// Least and most that it may be: without repeats, what the arm comes back by and structure finer than the poses resolve look alike.
  std::pair<double, double> noise_bounds{0.0, 0.0};
  double log_odds = 0.0;              ///< of all explanations together against none, before anything was taken up
  int answers = 0;                    ///< explanations that were weighed
  double arm_beyond_tolerance = 1.0;  ///< factor by which the arm exceeds the tolerances
  std::vector<GapStage> stages;
  double before_excess = 0.0, after_excess = 0.0;
  std::pair<double, double> after_interval{0.0, 0.0};  ///< 95 %, the noise anywhere within its bounds
  Shrinkage shrinkage;
  std::vector<Finding> findings;
  std::vector<Finding> possibilities;  ///< of captures of few poses: named effects that do not serve poses which the fit did not see
  RowOrder row_order;                  ///< columns that the order of the rows stood in for
  std::vector<GapPlace> where;
  /// Held-out poses are off by far more than the noise may be, or that noise is beyond any arm's or target's.
  bool gap_remains = false;
  bool remaining_significant = false;
  double remaining_p_value = 1.0;
  std::string remaining_location, remaining_driver;
  std::vector<Detectable> detectable;
  std::vector<NotTestable> not_testable;
  std::vector<BadSample> bad_samples;
  std::vector<std::string> warnings;  ///< what in the input contradicts what was found, one sentence each
  std::vector<AxisMove> axis_moves;   ///< of the twists, when the findings entered
  std::vector<Explained> explained;   ///< every answer that was weighed, best first, nothing found yet
  Model model;                        ///< with the effects

  /// Whether there is nothing to say: no finding, and neither structure nor a gap that one is missing for.
  bool isClean() const { return findings.empty() && !remaining_significant && !gap_remains; }
  /// Otherwise none is subtracted.
  bool noiseKnown() const { return noise_source != NoiseSource::kUnknown; }
};

/// Diagnoses what an identification leaves.
/// @param identification  of these measurements; its model is where the search starts, its start is what the tolerances are about.
/// @throws InsufficientData: fewer than 12 poses, or no arm.
Diagnosis diagnose(const Identification& identification, const Measurements& measurements, const DiagnoseOptions& options = {});

/// diagnosis.json.
std::string diagnosisJson(const Diagnosis& diagnosis, const std::vector<Sample>& samples);
/// How much a text says.
enum class TextLength {
  kWhole,
  kScreen  ///< short lists; a diagnosis with one finding or two, and the steps before it, then fit 40 lines of 100 columns
};
/// One sentence each for where, which and how far, what to do, and what could not be tested. What is left out stands in diagnosis.json.
std::string diagnosisText(const Diagnosis& diagnosis, const std::vector<Sample>& samples, TextLength length = TextLength::kWhole);
/// A probability in words, "99.1 % sure": never that there is no doubt.
std::string surenessText(double probability);
/// Why an effect was or was not chosen, at each of its places. @throws InvalidArgument for a name that is no effect's.
std::string explainEffect(const Diagnosis& diagnosis, const std::string& effect);

}  // namespace poecal
