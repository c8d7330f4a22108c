// Waves of several joint angles at once: cos(n.q) and sin(n.q) of what no listed effect explains, as a model's file names them.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace poecal {

/// Phase n.q of a wave: factor of each joint in it, by the joint's number from 0; never empty, no factor is zero. Whole for postures and
/// gears; a saw or a disc of unknown pitch may have any factor of its own joint.
using AngleWave = std::map<std::size_t, double>;

/// n.q [rad]; NaN where a reading is missing. @param q  joint readings [rad].
double phaseOf(const AngleWave& wave, const Eigen::VectorXd& q);

/// What a model's file calls the two factors of a wave: "cos(3q1+2q3-q4)" and "sin(3q1+2q3-q4)".
std::string cosineName(const AngleWave& wave);
std::string sineName(const AngleWave& wave);

/// A wave's factor as its name says it.
struct NamedWave {
  bool sine = false;
  AngleWave wave;
  /// cos(n.q) or sin(n.q).
  double at(const Eigen::VectorXd& q) const;
};
/// Nothing where a name is no such word.
std::optional<NamedWave> namedWave(const std::string& name);

/// Words of the joints in some waves: "q1,q3,q4".
std::string driversOf(const std::vector<AngleWave>& waves);

}  // namespace poecal
