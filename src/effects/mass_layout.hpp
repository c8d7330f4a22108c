// Gravity on an arm of unknown masses: which function of the masses a parameter stands for.
#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace poecal {

/// One function of the masses: of a body its mass [kg] (part 0) or mass times centre along x, y, z [kg m] (1 to 3); of the payload, which
/// is known, how it acts whole (body = bodies of the arm, part 0).
struct MassTerm {
  Eigen::Index way = 0;  ///< in which the place yields: 0, and 1 where it yields about two axes
  std::size_t body = 0;  ///< from 0
  int part = 0;

  /// Its column in SampleContext::wrench_by_masses.
  Eigen::Index column() const { return kParts * static_cast<Eigen::Index>(body) + part; }
  static constexpr int kParts = 4;
};

/// Order of the parameters of an effect by masses (Effect::byMasses): for each way all bodies that the place carries, each with its parts,
/// and the payload.
class MassLayout {
 public:
  /// @param first  body that the place is at, from 0. @param bodies  of the arm.
  MassLayout(std::size_t first, std::size_t bodies) : first_(first), bodies_(bodies) {}

  /// Parameters of each way.
  Eigen::Index perWay() const { return MassTerm::kParts * static_cast<Eigen::Index>(bodies_ - first_) + 1; }
  bool isPayload(const MassTerm& term) const { return term.body == bodies_; }

  /// What parameter i stands for.
  MassTerm operator[](Eigen::Index i) const {
    const Eigen::Index within = i % perWay();
    return {i / perWay(), first_ + static_cast<std::size_t>(within / MassTerm::kParts), static_cast<int>(within % MassTerm::kParts)};
  }

 private:
  std::size_t first_, bodies_;
};

}  // namespace poecal
