// How large the gap of each rung of the ladder is, and how far it shrinks from one to another.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/folds.hpp"
#include "diagnosis/measurement_noise.hpp"
#include "diagnosis/selection.hpp"
#include "poecal/core/random.hpp"
#include "poecal/diagnosis/diagnose.hpp"

namespace poecal {

/// One rung: per pose that was kept, in the order of the groups, collected over the folds.
struct Rung {
  std::string stage;
  std::vector<PoseSquares> poses;
  ErrorSummary every_row;  ///< the rows that were set aside among them
  /// Of poses of an instrument with their orientations: squares in stated deviations, turns among them. Empty for all else.
  std::vector<double> whitened = {};
};

/// Two rungs on the same poses.
struct RungPair {
  Rung before, after;
};

/// The excess of a rung is what its squares on poses that it did not see are above the noise of the measuring,
///
///   excess^2 = max(0, rms^2 - noise^2),
///
/// which repeats, stated deviations or the corners of a target tell and never what the last rung leaves. On poses of the capture the noise
/// came to what it did: where the last rung is no farther from `least` than chance allows, its excess is better known from the covariance
/// of its fit, a, and noise^2 = rms^2 - a there; the farther it is, the more of it is excess. The noise is at most any rung's rms.
class Gap {
 public:
  /// @param rungs  all of them, of which the last has all findings. @param folds  the poses that its fits did not see, each in turn.
  Gap(const Selection& selection, const MeasurementNoise& noise, const std::vector<Rung>& rungs, const Folds& folds, std::uint64_t seed);

  GapStage stageOf(const Rung& rung) const;
  /// Of a point [px] or [m], as it is subtracted.
  double noiseRms() const;
  /// Root of least and of most that it may be, neither above any rung's rms.
  std::pair<double, double> noiseBounds() const;
  /// 95 % interval of the last rung's excess: the noise anywhere within its bounds, the poses a sample, and what the fit may be off by
  /// drawn from its covariance.
  std::pair<double, double> remaining() const;
  /// 1 - excess(after) / excess(before), and where it lies 95 times in 100. The lower end takes the squares of `after` as they were
  /// measured, less the least noise, at their upper end, and the worst of the ways to hold out poses; the upper end may take them from the
  /// covariance of the last fit. Only where there are findings.
  /// @param blocks  the same two rungs with other poses held out together.
  /// @param kept  `after` with the waves that all poses chose, which the model has and which no pose can judge alone: for the upper end.
  /// Nothing where there are no waves.
  Shrinkage shrinkage(const Rung& before, const Rung& after, const std::vector<RungPair>& blocks, const std::optional<Rung>& kept) const;

 private:
  /// Shrinkages as they may be foretold and measured, by poses drawn again.
  struct Drawn {
    std::vector<double> foretold, measured;
  };
  Drawn drawn(const Rung& before, const Rung& after) const;
  /// Lower end of the interval where the poses of `rungs` were held out together.
  double lowerEnd(const RungPair& rungs) const;

  const Selection& selection_;
  MeasurementNoise noise_;
  std::vector<double> expected_;  ///< squares of each pose that the uncertainty of a fit without it makes
  std::vector<double> fewer_;     ///< what a fit without the whole fold makes more
  Eigen::MatrixXd drawn_;         ///< the same by drawn parameters, poses x draws
  Rung last_;
  double subtracted_ = 0.0;   ///< mean square of the noise
  double lowest_ = 0.0;       ///< least mean square of any rung
  double unexplained_ = 0.0;  ///< share of what is above all noise and the covariance that is no chance
  Rng resampling_;
};

/// Root mean square of a rung's points.
double rmsOf(const Rung& rung);

/// What models are compared by: rmsOf(), or, where turns were measured too, the root mean square of a pose in stated deviations. A tool
/// that slipped about the point which is measured moves no point.
double errorOf(const Rung& rung);

/// How much better off these poses themselves are with the one rung than with the other: their mean difference of squares in standard
/// errors.
double gain(const Rung& before, const Rung& after);

/// What some of these poses lose by the other rung, as a share of what the others gain; infinity where none gains.
double lostShare(const Rung& before, const Rung& after);

}  // namespace poecal
