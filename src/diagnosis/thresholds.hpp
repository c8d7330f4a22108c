// The numbers that the search decides by, each with where it comes from.
#pragma once

#include <cstddef>

namespace poecal {

/// When a pose belongs to no model: its mean square in units of its noise, and how improbable that is.
struct Wild {
  double mean_square;
  double probability;
};

/// Evidence is in logs of odds. Prior shares are of all explanations; they need not sum to 1, since only their ratios matter.
/// "Withheld world" means set on the cells of tests/withheld so that alarms on cells without an effect stay below 1 in 100 and the named
/// share falls no further.
struct SearchThresholds {
  // Prior shares.
  double named_share = 0.75;    ///< effects of the catalogue together: three of four causes on real cells have a name
  double curve_share = 0.25;    ///< smooth curves of one driver together: the rest
  double wave_share = 0.05;     ///< waves of several joints together; withheld world: 0.30 in all for what nobody listed
  double named_wave = 0.01;     ///< factor for a single wave that has a name: the name stands for it
  double scatter_share = 0.2;   ///< joints that move at random together; withheld world
  double whole_factors = 0.75;  ///< of a joint's waves, those of whole factors of several joints; the rest are orders of its own angle

  // Evidence that is needed.
  double anything = 1.0;              ///< of all explanations together: 1 capture in 200 without an effect reaches 0.5
  double beside = 4.5;                ///< of another finding beside the first; withheld world
  double needed = 2.5;                ///< of each of several, with all others in; withheld world
  double structure = 3.0;             ///< of a curve beside a named effect at its place, above which the name is not the cause: odds of 20
  double beside_unknown = 14.0;       ///< more, beside a curve: what the curve did not follow is worth up to this in the withheld world
  double unknown_misfit = 0.02;       ///< and more by this share of the largest chi-square: a curve follows to 14 % of its size
  double unknown_own_misfit = 0.1;    ///< at the curve's own place: two causes at one place are rarer than a curve that follows badly
  double named_part = 1.0 / 3.0;      ///< of the evidence for structure, by a name at its place: less is no cause to look for beside it
  double relative_misfit = 0.005;     ///< likewise of a named effect: 7 % of its size
  double scatter_worth_trying = 0.0;  ///< score in sigmas of a joint that moves at random: the likelihood falls where it is negative

  // How many are looked at again, for time; a larger number changes no figure of the withheld world.
  std::size_t named_shortlist = 8, curve_shortlist = 5;  ///< weighed with the noise estimated beside them
  std::size_t fitted_again = 10;                         ///< fitted without linearisation
  double reach = 30.0;                                   ///< log evidence below the best within which they are
  double far_reach = 0.01;  ///< or this share of the best one's chi-square: a large effect is linearised the worse the larger it is

  /// A gap remains where its lower end is beyond so many times the noise: cells without an effect reach 0.8 in the withheld world.
  double gap_remains = 2.0;
  /// The most noise besides the corners' own that an arm [rad] or a printed target [px] has: good arms come back by 0.05 to 0.1 mrad a
  /// joint and worn ones by 0.3; blur and light move the corners of a whole tag by 0.2 px on real cells.
  double any_arm = 5e-4;
  double any_tag = 0.5;

  // Structure of several joints, as waves or as a smooth field.
  double typical_wave = 2e-4;  ///< [rad] 1 sigma of what is smooth, on real cells
  double still = 0.05;         ///< [rad] a joint that turns by less drives nothing

  /// Sizes beyond so many typical ones are of no real cell: an effect that would be seen only there cannot be tested.
  double absurd_size = 20.0;
  /// Before any effect is known: only what no effect does to a single pose.
  Wild wild_at_once{150.0, 1e-30};
  /// At the end: what chance does not do once in ten million captures of 100 poses.
  Wild wild_at_last{8.0, 1e-9};
};
inline constexpr SearchThresholds kSearch;

}  // namespace poecal
