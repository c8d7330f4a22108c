// What could explain a gap: every effect of the catalogue at every place, and, for what nobody listed, a smooth curve of every driver at
// every place.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "diagnosis/capture_rows.hpp"
#include "effects/curve.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {

/// A smooth function of a driver at a place, as a sum of waves of the driver: "unknown, there, driven by that".
struct Curve {
  Place place;                        ///< a joint, camera.mount, target.mount or camera.lens
  CurveRange range;                   ///< of the driver in the capture; not for the lens, whose waves are of the pixel
  Eigen::Index waves = 0;             ///< how many
  int orders = 0;                     ///< lens only: waves along u and v in all
  std::vector<double> cycles = {};    ///< mounts only: sways that come and go so often over the range, in place of `waves`
  std::vector<AngleWave> terms = {};  ///< joint only: waves of several angles, in place of those of one driver; ascending
  bool smooth = false;                ///< `terms` stand for all smooth functions of their angles; none was chosen by what it explains
};

/// Where a candidate enters the cell. Its action there is what each of its columns does, in an observation: one number where it turns a
/// joint, six where it moves the target's pose (w; v) in camera, otherwise the rows themselves.
struct Entry {
  Reach reach = Reach::kPicture;
  std::size_t joint = 0;  ///< kJoint: which, from 0; otherwise 0

  bool operator<(const Entry& other) const { return std::pair(reach, joint) < std::pair(other.reach, other.joint); }
};

/// "joint_slip@joint:2/stamp".
inline std::string answerName(const std::string& name, const Place& place, const Driver& driver) {
  return name + "@" + place.name() + "/" + driver.name();
}

/// One explanation. Its columns are the derivatives of the rows by its linear parameters, or by what these are made of.
struct Candidate {
  std::optional<Effect> effect;  ///< a named one, or
  std::optional<Curve> curve;    ///< an unknown one
  std::string name;              ///< of the effect, "unknown" for curves
  Place place;
  Driver driver;
  Eigen::VectorXd parameters;        ///< effect: scanned and fixed ones set, linear ones 0
  std::vector<Eigen::Index> linear;  ///< effect: which parameters are the first columns
  /// The same effect by unknown masses: what wrongly stated ones leave out, as further columns beside those of the effect.
  std::optional<Effect> mass_errors;
  /// Linear parameters by the factors of their columns, where these are not the same; empty where they are.
  Eigen::MatrixXd to_parameters;
  Eigen::VectorXd typical;  ///< 1 sigma of each column's factor on real cells
  double log_prior = 0.0;   ///< share among all explanations
  /// At camera.mount, where the pictures show a reference: whether it is the camera that moves, which moves the reference too, and not the
  /// base. Both are weighed, as two ways to one answer.
  bool moves_reference = false;

  bool known() const { return effect.has_value(); }
  /// Waves of several joint angles, however many of them.
  bool isWaves() const { return curve && !curve->terms.empty(); }
  /// Which of `parameters` says when a slip was; nothing for other candidates.
  std::optional<Eigen::Index> slipTime() const;
  /// Whether its first factor cannot be below zero: how far a part yields to a load.
  bool isPositive() const;
  /// Number of columns that stand by themselves: all but what wrongly stated masses leave out.
  Eigen::Index own() const { return mass_errors ? static_cast<Eigen::Index>(linear.size()) : typical.size(); }
  /// 1 sigma of each column's factor for an effect of `scale` times its typical size. Stated masses are off by a share of themselves: what
  /// they leave out is no larger than that share of the compliance that was found.
  /// @param found  size of each own factor, in its unit.
  Eigen::VectorXd spread(double scale, const Eigen::VectorXd& found) const;
  /// The effect's linear parameters, in their order, by the factors of all columns.
  Eigen::VectorXd linearParameters(const Eigen::VectorXd& factors) const;
  Entry entry() const;
  /// What is one answer, whatever its scanned parameters.
  std::string answer() const { return answerName(name, place, driver); }
};

struct CandidateList {
  std::vector<Candidate> candidates;
  std::vector<NotTestable> not_testable;
  /// The joint whose readings the capture went through in order, so that time and this joint drive alike; nothing where there is none.
  std::optional<std::size_t> ordered_by;
};

CandidateList allCandidates(const MeasuredCell& measured, const ModelState& state);

/// A slip at the times around its own that allCandidates() did not try, where there are more than it tries; none of other candidates.
std::vector<Candidate> untriedTimes(const Candidate& slip, const std::vector<Sample>& samples);

/// d(rows)/d(action) of an observation at an entry that is not kPicture: rows x 1 or 6.
Eigen::MatrixXd entryColumns(const Entry& entry, const ObservationRows& part);

/// Actions of a candidate at its entry, of observations [begin, end) below each other; as many columns as typical.size().
Eigen::MatrixXd actionsOf(const Candidate& candidate, const CaptureRows& rows, std::size_t begin, std::size_t end);

/// d(rows)/d(column factor), rows x typical.size().
Eigen::MatrixXd columnsOf(const Candidate& candidate, const CaptureRows& rows);

}  // namespace poecal
