// What is believed of masses that nobody stated.
#pragma once

#include "diagnosis/candidates.hpp"

namespace poecal {

/// Turns an effect by unknown masses (Effect::byMasses) into one whose factors can be believed in one by one. A body's mass m and its
/// moments m c go together, since its centre c lies near its link: with c = p + d, p the middle of the link, the factors are m and m d,
///
///   (m; m c) = [1 0; p I] (m; m d).
///
/// On real arms m is some 5 kg at the first body and 0.7 times that from one to the next: the makers say 3.8 to 0.4 kg of a UR5e and 5.8 to
/// 1.2 kg of an LBR iiwa 14. d is that of a point anywhere on the link, 0.29 of its length, and a decimetre at least.
/// Sets `to_parameters` and `typical`. @param candidate  of an effect by unknown masses. @param cell  with the arm.
void believeMasses(const Cell& cell, Candidate& candidate);

}  // namespace poecal
