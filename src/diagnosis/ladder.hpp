// The gap as a ladder, each rung on poses that its fit did not see, and how far it shrinks from one rung to the next.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "diagnosis/selection.hpp"
#include "poecal/core/random.hpp"
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

/// The excess of a rung is what its squares are above the noise of the same poses. What that noise came to on them, the last rung tells:
/// its squares without those that its own parameters' uncertainty makes. So the excess of the last rung is what the covariance of its fit
/// says of poses that it did not see, which is far better known than a difference of two nearly equal sums, and that of every other one is
/// this and by how much it is worse.
class Ladder {
 public:
  Ladder(const Selection& selection, const Registration& closed_form, int folds, std::uint64_t seed);

  /// nominal, registered, identified: the last as `identify` does it, which knows corners that are off by chance and nothing else.
  std::vector<Rung> geometricRungs() const;
  /// The identified model with some of the findings.
  Rung rungWith(const std::string& stage, const std::vector<std::size_t>& findings) const;

  GapStage stageOf(const Rung& rung, const Rung& last) const;
  /// 1 - excess(last) / excess(before), and where it lies 95 times in 100 on other poses, 60 or as many as there are: bootstrap of the
  /// poses, with the whole model's parameters drawn from their covariance. Only where there are findings.
  Shrinkage shrinkage(const Rung& before, const Rung& last) const;
  /// How much better off these poses themselves are with the last rung than with the other: their mean difference of squares in standard
  /// errors.
  double gain(const Rung& before, const Rung& last) const;
  /// What single points are off by chance.
  double noiseRms(const Rung& last) const;

 private:
  using Groups = std::vector<std::vector<std::size_t>>;
  /// A model fitted to the poses outside of a fold.
  struct Fitted {
    ModelState state;
    std::vector<Accepted> accepted;
  };
  template <typename Fit>
  Rung judged(const std::string& stage, Fit fit) const;
  Rung fitted(const std::string& stage, const ModelState& start, const std::vector<Accepted>& accepted,
              const std::vector<std::size_t>& scatter, const NoiseEstimate& noise) const;
  void addErrors(const Linearised& at, const Groups& test, const std::vector<std::size_t>& numbers, Rung& rung) const;

  const Selection& selection_;
  Registration closed_form_;
  std::vector<std::vector<std::size_t>> folds_;  ///< numbers of groups
  std::vector<double> expected_;                 ///< squares of each pose that the uncertainty of a fit without it makes
  Eigen::MatrixXd drawn_;                        ///< the same by drawn parameters, poses x draws; empty without findings
  Rng resampling_;
};

}  // namespace poecal
