// The arms of the withheld world: chains of KDL segments, each joint turning about or sliding along z of its own frame.
#pragma once

#include <string>
#include <vector>

#include "withheld/frames.hpp"

namespace withheld {

struct Joint {
  bool slides = false;
  Frame T_before;                ///< from the previous joint's frame (after its motion), or base, to this one's
  double low = 0.0, high = 0.0;  ///< range that poses are drawn from [rad] or [m]
  Frame moved(double q) const { return slides ? Frame(Vector(0.0, 0.0, q)) : Frame(Rotation::RotZ(q)); }
};

/// What moves with a joint, in that joint's frame.
struct Body {
  double mass = 0.0;  ///< [kg]
  Vector com;         ///< [m]
};

struct Arm {
  std::string name;
  std::vector<Joint> joints;
  std::vector<Body> bodies;
  Frame T_last_flange;
  std::size_t size() const { return joints.size(); }
};

/// Frames of the joints in base with all joints at zero, then the flange: size() + 1 of them.
std::vector<Frame> framesAtRest(const Arm& arm);

/// An arm of a random family and size: "cobot" (6 joints, offset wrist), "wrist" (6, spherical wrist), "seven" or "scara".
Arm drawArm(Chance& chance, const std::string& family);
std::string drawFamily(Chance& chance);

/// What errors of manufacture do.
struct Tolerances {
  double position = 6e-4;  ///< 1 sigma per axis and coordinate [m]
  double rotation = 2e-3;  ///< [rad]
  /// Each link is off by itself, so that errors add up along the arm; otherwise each axis is off by itself where it stands at rest.
  bool by_link = false;
};
Arm withErrors(const Arm& nominal, const Tolerances& tolerances, Chance& chance);

/// Moves one joint's frame by a small motion in that frame and leaves the later ones where they are at rest.
void moveAxis(Arm& arm, std::size_t joint, const Frame& small);

}  // namespace withheld
