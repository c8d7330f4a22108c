// A smooth field over several joints' angles that turns a joint: what has a place and drivers, but no shape that is known.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/evidence.hpp"
#include "diagnosis/wave_folds.hpp"

namespace poecal {

/// Smooth fields at joints that turn with the posture, the best at each joint where one is worth its price. The joint turns by f(q), and f
/// is a Gaussian process with the kernel sigma^2 exp(-|q_S - q_S'|^2 / (2 l^2)) over the angles q_S of some joints:
///   ln B = 1/2 u' (K^-1 + J)^-1 u - 1/2 ln det(1 + K J)
/// with J and u the information and the score of the joint's turns in the poses, beside all that the linearisation has in it. The joints S
/// and the length l are those of the largest B. The candidate is the same process as a sum of waves cos(n.q) and sin(n.q) whose n are drawn
/// from the kernel's spectrum, a normal density of 1 sigma 1/l, evenly. Sources: Rasmussen and Williams, Gaussian Processes for Machine
/// Learning, 2006, chapters 2 and 5; Rahimi and Recht, Random Features for Large-Scale Kernel Machines, 2007.
std::vector<Candidate> fieldCandidates(const WaveFolds& ports, const Linearised& linear);

}  // namespace poecal
