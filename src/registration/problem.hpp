// A capture cut down to what can be registered hundreds of times within a second.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "registration/consensus.hpp"

namespace poecal {

// A row that leaves more than this many times the median stands beside a registration.
constexpr double kBeside = 5.0;

// A registration has twelve numbers and a picture gives six: three times as many as it takes.
constexpr std::size_t kFewestRows = 6;

struct Problem {
  Cell cell;
  std::vector<Observation> observations;
  std::vector<HypothesisSample> samples;  ///< one per observation

  /// Adds an observation with its sample, which then has its number here.
  void add(Observation observation, HypothesisSample sample);
};

// Rows that a search over mistakes looks at: it registers them hundreds of times.
constexpr std::size_t kSearchedRows = 40;

/// At most `rows` observations of different poses that have candidates (or positions), evenly over the series, each with at most twelve
/// corners far from each other.
Problem thinned(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples,
                std::size_t rows);

/// At most `rows` observations evenly over the series, with what their pictures tell yet to be renewed.
Problem evenly(const Cell& cell, const std::vector<Observation>& observations, std::size_t rows);

/// Where the target has each point that some observation shows.
std::map<PointId, Eigen::Vector3d> pointsSeen(const std::vector<Observation>& observations);

/// Values, ascending, without those that are the same to a micrometre as one before.
std::vector<double> distinctPlaces(std::vector<double> values);

/// Whether most rows and most of their corners are left in a problem that was altered: an explanation of few explains nothing.
bool keepsMost(const Problem& altered, const Problem& whole);

/// The samples' T_near_far again, after the cell's arm, its setup or the readings were altered.
void renewPoses(Problem& problem);
/// Likewise everything that the pictures tell, after corners, target or camera were altered.
void renewPictures(Problem& problem);
/// The target (or the positions of an instrument's poses) at `factor` times its size.
void scaleTarget(Problem& problem, double factor);

/// Without the samples that a registration contradicts: those beyond four times the median misfit.
Problem agreeing(const Problem& problem, const Registration& registration);

/// What a search over few hypotheses finds; nothing where there is none. `refined` as ConsensusOptions has it.
std::optional<Consensus> solve(const Problem& problem, std::size_t refined);

/// What the first and the last `part` rows register to, each by themselves; nothing of fewer than kFewestRows.
std::vector<Consensus> registeredEnds(const Problem& problem, std::size_t part);

/// The median misfit of the best hypothesis before any adjustment; infinity where there is none.
double quickMisfit(const Problem& problem);

/// A registration with the arm's axes free within the tolerances of a loose arm. Without an arm it is the registration itself.
struct Calibrated {
  double misfit = 0.0;     ///< median; what an arm's errors cannot explain
  double deviation = 0.0;  ///< of the arm from its nominal, rms in 1 sigma of a loose arm: 1 is usual
};
Calibrated calibrate(const Problem& problem, const Registration& start);

/// What is left where readings and pictures have nothing to do with each other: median over some random pairings.
double chanceMisfit(const Problem& problem);

/// Median of what the pictures leave with a pose of their own; 0 for poses.
double freeMisfit(const std::vector<HypothesisSample>& samples);

}  // namespace poecal
