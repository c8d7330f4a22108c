// A cell whose truth is known, for tests of the diagnosis: corners with noise, straight from the forward model.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/capture_rows.hpp"
#include "diagnosis/evidence.hpp"
#include "poecal/diagnosis/diagnose.hpp"
#include "support/random.hpp"

namespace poecal::test {

struct SmallCell {
  Cell cell;  ///< true arm
  Arm nominal;
  Target target;
  std::vector<Sample> samples;
  std::vector<Observation> observations;

  Measurements measurements() const;
  /// The diagnosis of what was observed, as the program makes it.
  Diagnosis diagnosis() const;
  /// What was measured, each picture a pose of its own, and the nominal arm with its tolerances.
  MeasuredCell measured() const;
  /// Its first poses alone.
  SmallCell head(std::size_t poses) const;
  /// Root mean square distance [px] of a model's corners from those observed, from the pose `first` on.
  double rmsOf(const Model& model, std::size_t first) const;
};

/// Where a search begins: the nominal arm as it was registered.
ModelState nominalState(const MeasuredCell& measured);

/// A cell as a search finds it before anything is taken up.
struct Fitted {
  MeasuredCell measured;
  Linearised linear;
};
Fitted fitted(const SmallCell& small);

/// Six turning joints with masses before a fixed camera; axes off by 0.5 mm and 2 mrad, `poses` poses, corners with `sigma` [px] and what
/// the effects do.
SmallCell smallCell(std::uint64_t seed, int poses, double sigma, const std::vector<EffectSpec>& effects);

/// Error of a joint by the readings of all joints [rad].
using JointError = std::function<double(const Eigen::VectorXd&)>;

/// The same cell observed anew, as joint k (from 0) really stands where `error` moves it; `sigma` [px] of noise.
void observeWith(SmallCell& small, std::size_t k, const JointError& error, double sigma);

/// An instrument's poses of the target in place of corners, off by `sigma` [m] and 5 rad/m of it.
void measurePoses(SmallCell& small, std::size_t k, const JointError& error, double sigma);

}  // namespace poecal::test
