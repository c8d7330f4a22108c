// What is known of a cell, linearised: rows of poses that were taken or may be, each in units of its noise.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "diagnosis/candidates.hpp"
#include "diagnosis/column_prior.hpp"
#include "poecal/planning/plan.hpp"

namespace poecal {

/// Rows of one pose in units of its noise, [X r]: columns of the base model, of the model's effects and of further candidates, and the
/// residual.
using WhiteRows = Eigen::MatrixXd;

/// Label of the progress of Knowledge::expected().
inline constexpr const char* kShowing = "what each pose would show";

/// [X r] with at most as many rows as columns and the same squares.
WhiteRows condensed(WhiteRows rows);

/// A candidate with what is believed of the size of each of its columns, 1 sigma.
struct FurtherColumns {
  Candidate candidate;
  Eigen::VectorXd sigma;
};

/// An effect of a model as a candidate, its scanned parameters as they were found.
Candidate modelCandidate(const AppliedEffect& applied);

/// A cell linearised at a model.
class Knowledge {
 public:
  /// @param effects  of the model, those to be fitted beside the geometry, ten times as wide as they usually are. @param further  columns
  /// that follow.
  Knowledge(const PlanningCell& cell, const std::vector<AppliedEffect>& effects, std::vector<FurtherColumns> further = {});

  Eigen::Index columns() const;
  /// Of all columns.
  ColumnPrior prior() const;

  /// The poses that were taken, with what was measured.
  std::vector<WhiteRows> taken() const;
  /// Poses that may be taken, one by one, their corners where the model expects them.
  std::vector<WhiteRows> expected(const std::vector<Sample>& samples) const;
  /// 6 x columns() for each sample: how the tool turns and moves (rotation; position) with the columns.
  std::vector<Eigen::MatrixXd> tool(const std::vector<Sample>& samples) const;

  const MeasuredCell& measured() const { return base_; }
  const ModelState& state() const { return state_; }

 private:
  Eigen::Isometry3d cameraTarget(const Sample& sample) const;
  std::vector<WhiteRows> rows(const MeasuredCell& cell) const;
  Eigen::MatrixXd columnsOfAll(const CaptureRows& rows) const;

  MeasuredCell base_;  ///< its observations are those taken
  ModelState state_;
  std::vector<FurtherColumns> further_;  ///< the model's effects, then what was given
  PlanNoise noise_;
  double beyond_ = 1.0, rough_position_ = 0.0, rough_rotation_ = 0.0;
};

/// Readings to come, with what effects may ask of a sample: later than all that was taken, else as the last of it.
Sample sampleToCome(const PlanningCell& cell, const Eigen::VectorXd& q);

}  // namespace poecal
