// The withheld world's cell: arm, camera and tags, and the corners that they give with some flaws in them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "withheld/arms.hpp"
#include "withheld/lens.hpp"
#include "withheld/shot.hpp"

namespace withheld {

struct Tag {
  int id = 0;
  double size = 0.08;  ///< [m]
  Vector center;       ///< in target [m]
};

struct Cell {
  Arm arm;
  bool in_hand = false;                  ///< the camera is on the flange and the target stands; else the target is on the flange
  Frame T_camera_mount, T_mount_target;  ///< from what holds each of them: base and flange, in hand flange and base
  Lens lens;
  std::vector<Tag> tags;
  double gravity = 9.80665;  ///< along -z of base [m/s^2]
};

/// Corners of the tags in target, four a tag in AprilTag's order [m].
std::vector<Vector> tagCorners(const std::vector<Tag>& tags);

/// What a cell looks like at one shot; flaws change it.
struct State {
  Eigen::VectorXd q;             ///< where the joints really are
  std::vector<Frame> tilt;       ///< before each joint's motion, in its frame
  std::vector<Frame> bend;       ///< after each joint's motion, in its body's frame
  std::vector<double> growth;    ///< factor on the length from each joint to the next
  Frame pedestal, camera, grip;  ///< moves of base in base, of what the camera sees in camera, of the target in target
  Lens lens;
  std::vector<Vector> points;                                   ///< of the tags, in target [m]
  double line_time = 0.0;                                       ///< from row to row [s]
  double outward = 0.0;                                         ///< by which edges of tags are seen too far out [px]
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> warp;  ///< of pixels, last of all; may be empty
};

/// What gravity does to the arm in a state. Moments about the joints' origins, of all that the joint carries.
struct Loads {
  Eigen::VectorXd torque;           ///< about or along each joint's axis [N m] or [N]
  std::vector<Vector> moment_body;  ///< in the frame of the body that the joint moves [N m]
  Vector moment_base;               ///< of the whole arm about base [N m]
};
Loads gravityLoads(const Cell& cell, const State& state, double payload);

struct Parameter {
  std::string name;
  double value = 0.0;
  double usual = 0.0;  ///< size at which it matters; 0: says which instance it is and is never scaled
  double most = 0.0;   ///< beyond this no real cell goes
};

/// One effect at one place. Named as the contract names it where it is in the contract.
struct Flaw {
  std::string effect, location, driver;
  std::vector<Parameter> parameters;
  std::function<void(const Flaw&, const Shot&, const Loads&, State&)> act;
  bool yields = false;     ///< deflects under gravity: the state and its loads are found together
  bool at_random = false;  ///< new at every pose, so that no model can predict it

  double operator[](std::size_t parameter) const { return parameters[parameter].value; }
  void scale(double factor);
  bool credible() const;  ///< no parameter is beyond its most
  std::string place() const { return effect + "@" + location; }
};

/// Pixels of all corners at one shot, stacked u, v. Arms that yield to gravity are in equilibrium with their loads where they have come to
/// rest.
Eigen::VectorXd corners(const Cell& cell, const Shot& shot, const std::vector<Flaw>& flaws);
/// The same for many shots, one below the other.
Eigen::VectorXd corners(const Cell& cell, const std::vector<Shot>& shots, const std::vector<Flaw>& flaws);

/// Poses of the target in camera in a state.
Frame targetInCamera(const Cell& cell, const State& state);
/// A state without flaws.
State flawless(const Cell& cell, const Shot& shot);
/// A state with flaws, in equilibrium with its loads.
State stateAt(const Cell& cell, const Shot& shot, const std::vector<Flaw>& flaws);
/// The state at the time when a row of the picture is exposed.
State stateAtRow(const Shot& shot, const State& state, double row);

}  // namespace withheld
