#include "diagnosis/mass_belief.hpp"

#include <algorithm>
#include <cmath>

#include "effects/mass_layout.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

double typicalMass(std::size_t body) { return 5.0 * std::pow(0.7, static_cast<double>(body)); }  // [kg]

/// Of the body that a joint moves, at q = 0 in base: from the joint's anchor to the next one's, or to the flange.
struct Link {
  Eigen::Vector3d from, to;

  Eigen::Vector3d middle() const { return 0.5 * (from + to); }
  double spread() const {
    constexpr double kLeast = 0.1, kUniform = 0.29;  // [m], 1 / sqrt(12)
    return std::max(kLeast, kUniform * (to - from).norm());
  }
};

Link linkOf(const Arm& arm, std::size_t body) {
  const bool last = body + 1 == arm.joints.size();
  return {arm.joints[body].anchor, last ? Eigen::Vector3d(expSe3(arm.gamma).translation()) : arm.joints[body + 1].anchor};
}

}  // namespace

void believeMasses(const Cell& cell, Candidate& candidate) {
  const Arm& arm = *cell.arm;
  const MassLayout layout(candidate.effect->index(), arm.joints.size());
  const double compliance = candidate.effect->kind().parameters.front().typical;
  candidate.to_parameters = Eigen::MatrixXd::Identity(candidate.typical.size(), candidate.typical.size());
  for (Eigen::Index i = 0; i < candidate.typical.size(); ++i) {
    const MassTerm term = layout[i];
    if (layout.isPayload(term)) continue;
    const Link link = linkOf(arm, term.body);
    candidate.typical(i) = compliance * typicalMass(term.body) * (term.part == 0 ? 1.0 : link.spread());
    if (term.part == 0) candidate.to_parameters.col(i).segment<3>(i + 1) = link.middle();
  }
}

}  // namespace poecal
