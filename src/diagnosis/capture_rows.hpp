// Residuals of a whole capture and their derivatives at a state of the model: what screening, noise and re-fits all work on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "cell/linearisation.hpp"
#include "poecal/cell/observation.hpp"
#include "poecal/cell/ports.hpp"
#include "poecal/cell/twist_prior.hpp"
#include "poecal/core/progress.hpp"
#include "poecal/effects/effect.hpp"
#include "poecal/effects/sample_context.hpp"

namespace poecal {

/// What was measured, and what is believed of the cell before looking at it.
struct MeasuredCell {
  Cell start;           ///< nominal arm, registered: what the priors are about
  FreeParameters free;  ///< of the base model: twists, and both transforms or gamma, and intrinsics where their deviations are stated
  std::vector<Observation> observations;
  std::vector<Sample> samples;                   ///< of each observation
  std::vector<std::string> other_columns;        ///< names of the samples' further columns, which may drive a curve
  std::vector<std::vector<std::size_t>> groups;  ///< repeat shots of one pose, as indices into observations
  Target target;
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};
  TwistPrior twists;
  Eigen::VectorXd camera_sigma;    ///< stated standard deviations of the intrinsics; empty where they are held
  Eigen::VectorXd rounding;        ///< 1 sigma of what rounding takes from each joint's reading [rad], [m]; empty where nobody sees a step
  bool timed = true;               ///< stamps are times, and not the order of the rows
  int jobs = 1;                    ///< candidates weighed at a time; 0: one per core
  ProgressFunction progress = {};  ///< may be empty
};

/// Some of the observations of a capture, with the repeat shots among them. @param numbers  ascending.
MeasuredCell part(const MeasuredCell& measured, const std::vector<std::size_t>& numbers);

/// A cell on its way, with the effects that it was given so far.
struct ModelState {
  CellState cell;
  std::vector<AppliedEffect> effects;
};

/// One observation's part of the rows.
struct ObservationRows {
  int begin = 0, size = 0;  ///< rows
  SampleContext context;
  PosePortJacobian ports;
  SampleRows rows;                 ///< r, H, K in units of the stated sigma
  std::vector<double> unit_sigma;  ///< stated sigma of each unit [px], or of a pose's position [m]
  Eigen::Matrix3d R_camera_target = Eigen::Matrix3d::Identity();

  /// d(model)/d(amount) of this observation's rows, for a direction in which its ports move.
  Eigen::VectorXd along(const Disturbance& direction) const;
};

struct CaptureRows {
  Eigen::VectorXd r;  ///< measured - model, in units of the stated sigma
  Eigen::MatrixXd J;  ///< d(model)/d(base parameters)
  std::vector<ObservationRows> observations;
  std::vector<std::vector<std::size_t>> groups;

  int size() const { return static_cast<int>(r.size()); }
  /// Rows of all shots of a pose; they follow each other.
  int groupSize(std::size_t g) const;
};

/// What a cell whose target and camera are as they should be would have measured in place of an observation, and that cell: corners without
/// the effects of shape and detector, the camera with those of the lens.
struct PlainSight {
  Cell cell;
  Observation observation;
};
PlainSight plainSight(const MeasuredCell& measured, const ModelState& state, const ObservationRows& part);

/// What each row is worth in the squares of its pose: of a corner its deviation squared, of a pose that of its position alone.
Eigen::VectorXd squareWeights(const CaptureRows& rows);

/// Rows of a subset of the groups (all where `groups` is empty).
CaptureRows captureRows(const MeasuredCell& measured, const ModelState& state, const std::vector<std::vector<std::size_t>>& groups);

}  // namespace poecal
