// The next poses worth taking: those that make the tool most certain, tell rival explanations apart, or would show an effect of a given
// size.
//
// The unknowns x are those of the bundle adjustment (twists, both transforms, stated intrinsics) and the sizes of the model's effects. With
// J_k the derivatives of pose k's corners by x and C_k the covariance of its noise, the information after the poses of a plan is
//
//   Lambda = P + sum_taken J_k' C_k^-1 J_k + sum_planned J_k' C_k^-1 J_k
//
// where P is what is believed before: the arm's tolerances, the stated deviations of the lens, and how roughly camera and target are known.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "poecal/cell/measurements.hpp"
#include "poecal/core/progress.hpp"
#include "poecal/identification/model.hpp"

namespace poecal {

/// Noise of the pictures to come, as a diagnosis found it or the user expects it.
struct PlanNoise {
  double corner = 0.1;         ///< of a corner's u and v [px]
  double tag = 0.0;            ///< of what all corners of a tag share [px]
  double repeatability = 0.0;  ///< of each joint [rad]; a sliding joint's is a tenth of it [m]
};

/// An explanation that a diagnosis left open.
struct Rival {
  std::string effect, location, driver;
  double probability = 0.0;
};

/// Explanations of one finding of which one is right.
struct Rivals {
  std::vector<Rival> explanations;  ///< the finding itself is the first
  std::string separate_with = {};   ///< what tells them apart, as the diagnosis says it
};

/// A cell, and all that is known of it before the poses that are planned.
struct PlanningCell {
  Cell nominal;                      ///< arm as drawn and camera as stated: what is believed before
  Model model;                       ///< where the rows are linearised: as identified, or nominal with a rough registration
  Target target;                     ///< that the camera looks at
  Measurements taken;                ///< corners that the model was found from; none before the first picture
  std::filesystem::path robot_file;  ///< named by errors about the arm
  PlanNoise noise;
  double tolerance_position = 1e-3;   ///< as IdentifyOptions
  double tolerance_rotation = 3e-3;   ///< as IdentifyOptions
  double arm_beyond_tolerance = 1.0;  ///< factor by which this arm exceeds them
  double rough_position = 0.0;        ///< 1 sigma of the places of camera and target where no picture has told them [m]
  double rough_rotation = 0.0;        ///< likewise of how they are turned [rad]
  std::vector<Rivals> open = {};      ///< what a diagnosis left open
};

enum class PlanAim {
  kTool,      ///< least uncertainty of the tool
  kSeparate,  ///< greatest expected change of the odds between rivals
  kDetect     ///< greatest expected chi-square of an effect of a given size
};

/// A: least mean variance of the tool's position over the workspace. D: least volume of the confidence region of all unknowns.
enum class PlanCriterion { kA, kD };

struct PlanOptions {
  PlanAim aim = PlanAim::kTool;
  PlanCriterion criterion = PlanCriterion::kA;
  int count = 20;          ///< poses
  int candidates = 1000;   ///< visible random poses that are chosen from
  std::uint64_t seed = 1;  ///< of the candidates
  /// Half the thickness of every link, a straight line from joint to joint [m]; 0: 4 % of the arm's length.
  double link_radius = 0.0;
  double camera_radius = 0.1;      ///< of the camera's body (or the target's, eye in hand) [m]
  std::optional<double> floor;     ///< height of the floor above the origin of base, against gravity [m]; unset: no floor
  std::string detect;              ///< "EFFECT@PLACE" or "EFFECT@PLACE/DRIVER"; kDetect
  double detect_size = 0.0;        ///< of each of its sizes, in its unit
  double odds = 20.0;              ///< kSeparate: enough
  int jobs = 1;                    ///< candidates weighed at a time (0: one per core); the result does not depend on it
  ProgressFunction progress = {};  ///< told of every step; may be empty
  void validate() const;           ///< @throws InvalidArgument with the field's name and value.
};

/// Root mean square over 200 random postures within the joint limits, in view or not, of the length of the error of the tool, 1 sigma: of
/// the target before the camera (eye in hand: of the camera before the target), free of the choice of the base frame.
struct ToolUncertainty {
  double position = 0.0;  ///< [m]
  double rotation = 0.0;  ///< [rad]
};

struct PlannedPose {
  Eigen::VectorXd q;    ///< [rad] or [m]
  Eigen::VectorXd dir;  ///< -1, 0 or 1: the side from which each joint is to come
};

/// Odds of the better of two rivals, where the first is right.
struct RivalOdds {
  std::string right, wrong;  ///< "joint_gain@joint:2/q2"
  double before = 1.0;       ///< from the posterior probabilities
  double expected = 1.0;     ///< after the plan, exp of the expected log odds
};

/// How well an effect of the size asked for would show.
struct Detection {
  double chi_square = 0.0;   ///< expected, beside the geometry and all nuisances
  double probability = 0.0;  ///< that a diagnosis finds it: it takes an expected chi-square of 36 to be found four times in five
};

struct Plan {
  std::vector<PlannedPose> poses;  ///< in an order that makes a short path
  ToolUncertainty before, after;
  /// Random visible poses that bring the same (median of five sequences); unset: more than `random_tried`.
  std::optional<int> random_poses;
  int random_tried = 0;
  std::vector<RivalOdds> odds;                                 ///< kSeparate
  std::vector<std::string> not_told;                           ///< kSeparate: rivals that poses alone do not tell apart, and what does
  std::optional<Detection> detection_before, detection_after;  ///< kDetect
  bool sides_matter = false;                                   ///< `dir` is part of the plan, not only what the path makes of it
  double link_radius = 0.0;                                    ///< that was checked [m]
  int visible = 0;                                             ///< candidates in view and apart
  long drawn = 0;                                              ///< random postures tried for them
};

/// Chooses poses: greedily from random visible ones, then exchanged one by one for better ones until none helps (Fedorov).
///
/// Of collisions the obvious ones are excluded: a link, as a straight capsule from joint to joint, that touches the camera, stands between
/// camera and target, or goes below the floor; a flange that is inside a link well before it. Bent links, cables, tools, fences and the
/// path between poses are not checked.
/// @throws InsufficientData: hardly any posture shows the target, with what to change; nothing is open to separate.
/// @throws InvalidArgument: an effect or place that does not exist; a model without a camera. FileError as readingRanges().
Plan planPoses(const PlanningCell& cell, const PlanOptions& options);

/// The uncertainty of the tool once corners are seen at these samples as well. Samples that do not show the target add nothing.
ToolUncertainty toolUncertainty(const PlanningCell& cell, const std::vector<Sample>& more);

/// next.csv: image, q1..qn, dir1..dirn, as samples.csv has them; pictures are numbered on from `taken`.
std::string planCsv(const Plan& plan, std::size_t taken);

}  // namespace poecal
