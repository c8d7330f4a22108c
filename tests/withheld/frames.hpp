// Small helpers on KDL's frames, the only poses that the withheld world knows.
#pragma once

#include <kdl/frames.hpp>

#include "withheld/chance.hpp"

namespace withheld {

using KDL::Frame;
using KDL::Rotation;
using KDL::Vector;

/// Rotation about the direction of `turn` by its length [rad], then a shift [m]; both in the frame that it moves.
inline Frame motion(const Vector& turn, const Vector& shift = Vector::Zero()) {
  const double angle = turn.Norm();
  // KDL's Rot() takes the x axis for turns below 1e-6 rad.
  return {angle > 0.0 ? Rotation::Rot2(turn / angle, angle) : Rotation::Identity(), shift};
}

/// Modified Denavit-Hartenberg step without its joint: turn alpha about x, go a along x, then d along the new z.
inline Frame step(double alpha, double a, double d) {
  const Rotation turned = Rotation::RotX(alpha);
  return {turned, Vector(a, 0.0, 0.0) + turned * Vector(0.0, 0.0, d)};
}

inline Vector normalVector(Chance& chance, double sigma) {
  const double x = chance.normal(sigma), y = chance.normal(sigma), z = chance.normal(sigma);
  return {x, y, z};
}

inline Vector randomDirection(Chance& chance) {
  Vector direction = normalVector(chance, 1.0);
  direction.Normalize();
  return direction;
}

}  // namespace withheld
