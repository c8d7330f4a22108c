// Structure of several joints: what waves of integer combinations of the joint angles explain at each joint's port, tens of thousands of
// them weighed at once.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/evidence.hpp"
#include "diagnosis/wave_folds.hpp"

namespace poecal {

/// The waves that may enter at a joint, and what each costs. cos(n.q) and sin(n.q) for all n with at most three joints and |n_j| <= 4, and
/// of the joint's own angle alone any order up to the finest gear. A joint that slides or stands still is in no wave.
class WaveDictionary {
 public:
  WaveDictionary(const Arm& arm, const std::vector<Sample>& samples);

  struct Entry {
    AngleWave wave;
    double log_share = 0.0;  ///< of all waves at a joint; the shares of one joint add up to one
    double typical = 0.0;    ///< 1 sigma of either factor [rad]; smaller the finer the wave
  };
  /// Waves of whole factors, which may enter at every joint.
  const std::vector<Entry>& common() const { return common_; }
  /// Orders of joint k's own angle.
  const std::vector<Entry>& own(std::size_t k) const { return own_[k]; }
  /// A sliding joint's factors are metres.
  double unit(std::size_t k) const { return unit_[k]; }

 private:
  std::vector<Entry> common_;
  std::vector<std::vector<Entry>> own_;
  std::vector<double> unit_;
};

/// Waves at each joint that explain best what a linearisation leaves, one candidate a joint at which any is worth its price. With p_i the
/// whitened column of a joint's turning in pose i, e the whitened residual, V V' what the model explains already, phi_i = n.q_i:
///
///   u = (sum_i (p_i.e_i) cos phi_i, ... sin phi_i),   S_cc = sum_i |p_i|^2 cos^2 phi_i - |sum_i V_i' p_i cos phi_i|^2, ...
///
/// Waves are taken one after the other, the best first, each beside those before it, as long as the evidence pays the price, there is not
/// more than one for eight poses, and stretches of poses that are left out are explained better.
/// @param most  waves of one candidate.
std::vector<Candidate> waveCandidates(const WaveFolds& ports, const Linearised& linear, const WaveDictionary& dictionary, std::size_t most);

/// The waves at a joint that serve best, at most so many; nothing where none is worth its price.
std::optional<Candidate> wavesAt(const MeasuredCell& measured, const Linearised& linear, const WaveDictionary& dictionary,
                                 std::size_t joint, std::size_t most);

/// A candidate of waves at a joint that is in the linearisation, with the further ones that are worth their price there; nothing where none
/// is.
std::optional<Candidate> moreWaves(const MeasuredCell& measured, const Linearised& linear, const WaveDictionary& dictionary,
                                   const Candidate& waves);

/// Waves that a capture of so many poses can carry.
inline std::size_t mostWaves(std::size_t poses) { return poses / 8; }

}  // namespace poecal
