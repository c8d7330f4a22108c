// What could explain a gap: every effect of the catalogue at every place, and, for what nobody listed, a smooth curve of every driver at
// every place.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "diagnosis/capture_rows.hpp"
#include "effects/curve.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {

/// A smooth function of a driver at a place, as a sum of waves of the driver: "unknown, there, driven by that".
struct Curve {
  PlaceKind place = PlaceKind::kJoint;  ///< joint, camera.mount, target.mount or camera.lens
  std::size_t index = 0;                ///< of the joint
  CurveRange range;                     ///< of the driver in the capture; not for the lens, whose waves are of the pixel
  Eigen::Index waves = 0;               ///< how many
  int orders = 0;                       ///< lens only: waves along u and v in all
};

/// One explanation. Its columns are the derivatives of the rows by its linear parameters.
struct Candidate {
  std::optional<Effect> effect;  ///< a named one, or
  std::optional<Curve> curve;    ///< an unknown one
  std::string name;              ///< of the effect, "unknown" for curves
  std::string location, driver;
  Eigen::VectorXd parameters;        ///< effect: scanned and fixed ones set, linear ones 0
  std::vector<Eigen::Index> linear;  ///< effect: which parameters are the first columns
  /// The same effect by unknown masses: what wrongly stated ones leave out, as further columns beside those of the effect.
  std::optional<Effect> mass_errors;
  Eigen::VectorXd typical;  ///< 1 sigma of each column's factor on real cells
  double log_prior = 0.0;   ///< share among all explanations

  bool known() const { return effect.has_value(); }
  /// "joint_slip@joint:2/stamp": what is one answer, whatever its scanned parameters.
  std::string answer() const { return name + "@" + location + "/" + driver; }
};

struct CandidateList {
  std::vector<Candidate> candidates;
  std::vector<NotTestable> not_testable;
};

CandidateList allCandidates(const MeasuredCell& measured, const ModelState& state);

/// d(rows)/d(column factor), rows x typical.size().
Eigen::MatrixXd columnsOf(const Candidate& candidate, const CaptureRows& rows);

}  // namespace poecal
