// What the shapes of several effects have in common.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "effects/mass_layout.hpp"
#include "poecal/core/random.hpp"
#include "poecal/effects/effect.hpp"

namespace poecal::kinds {

/// Reading and disturbance of the joint that an effect sits at.
double reading(const Effect& effect, const SampleContext& context);
double& jointPort(const Effect& effect, Disturbance& disturbance);

/// The arm that the effect moves.
const Arm& armOf(const SampleContext& context);

/// Twist of a rotation about a point: (w; -w x point).
Vector6d rotationAbout(const Eigen::Vector3d& rotation, const Eigen::Vector3d& point);

/// The two directions across a joint's axis that twistBasis tilts it about, at q = 0 in base: columns a, b.
Eigen::Matrix<double, 3, 2> acrossAxis(const Joint& joint);

/// Parameters rx ry rz tx ty tz of a twist; `per` is appended to the units ("/t").
std::vector<EffectParameter> twistParameters(double rotation, double translation, const char* per);

/// The time of a slip [s], scanned, and the six numbers of its twist.
std::vector<EffectParameter> slipParameters(double rotation, double translation);

/// Where the masses are not known: the function of them that parameter i stands for.
MassTerm massTerm(const Effect& effect, Eigen::Index i, const SampleContext& context);

/// The wrench (moment about the origin of base; force) that an effect by masses yields to in one of its ways: compliance times gravity's,
/// of all bodies that the place carries.
Vector6d wrenchByMasses(const Effect& effect, const Eigen::VectorXd& parameters, const SampleContext& context, Eigen::Index way = 0);

/// When or at which temperature a drift is zero; where it is left out, at the first sample.
EffectParameter driftReference();

/// Hours or kelvin since a drift's reference, the last of its parameters.
double drifted(const Effect& effect, const Eigen::VectorXd& parameters, const SampleContext& context);

/// 1 from `time` on, 0 before it and where no stamp is known.
double hasHappened(const SampleContext& context, double time);

/// Random numbers of one sample for a seed: always the same.
Rng drawsOf(double seed, const SampleContext& context);

}  // namespace poecal::kinds
