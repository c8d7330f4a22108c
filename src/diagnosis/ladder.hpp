// The gap as a ladder, each rung on poses that its fit did not see, and how far it shrinks from one rung to the next.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "diagnosis/selection.hpp"
#include "poecal/diagnosis/diagnose.hpp"

namespace poecal {

/// Sums of one pose (all its shots), collected over the folds.
struct PoseErrors {
  double squares = 0.0;                                  ///< of corner lengths [px^2], or positions [m^2]
  double points = 0.0;                                   ///< corners, or positions
  double position = 0.0, rotation = 0.0, targets = 0.0;  ///< squares at the flange, and of how many pictures
};

/// One rung: per pose, in the order of the groups.
struct Rung {
  std::string stage;
  std::vector<PoseErrors> poses;
};

/// The noise of each pose's corners (or positions), as the sum of squares that it gives by itself.
std::vector<double> noiseSquares(const Linearised& linear);

class Ladder {
 public:
  Ladder(const Selection& selection, const Registration& closed_form, int folds, std::uint64_t seed);

  /// nominal, registered, identified.
  std::vector<Rung> geometricRungs() const;
  /// The identified model with some of the findings.
  Rung rungWith(const std::string& stage, const std::vector<std::size_t>& findings) const;

  GapStage stageOf(const Rung& rung) const;
  Shrinkage shrinkage(const Rung& before, const Rung& after) const;
  double noiseRms() const;

 private:
  using Groups = std::vector<std::vector<std::size_t>>;
  template <typename Fit>
  Rung judged(const std::string& stage, Fit fit) const;
  void addErrors(const Linearised& at, const Groups& test, const std::vector<std::size_t>& numbers, Rung& rung) const;

  const Selection& selection_;
  Registration closed_form_;
  std::vector<std::vector<std::size_t>> folds_;  ///< numbers of groups
  std::vector<double> noise_;
  std::uint64_t seed_;
};

}  // namespace poecal
