// The gap as a ladder, each rung on poses that its fit did not see.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/folds.hpp"
#include "diagnosis/gap.hpp"
#include "diagnosis/harmonics.hpp"
#include "diagnosis/selection.hpp"

namespace poecal {

/// By which waves poses are judged that their fit did not see: those that all poses chose, or some that were chosen without them.
enum class Waves { kKept, kChosenAnew };

class Ladder {
 public:
  /// @param all  with the rows that belong to no model. @param identification  of them, with held-out poses.
  Ladder(const Selection& selection, const MeasuredCell& all, const Identification& identification, int folds, std::uint64_t seed);

  /// nominal, registered, identified: the identification's own.
  std::vector<Rung> geometricRungs() const;
  /// The identified model as `identify` makes it, which knows corners that are off by chance and nothing else, by other folds than its own.
  Rung identifiedRung(HeldOut kind) const;
  /// The identified model with some of the findings.
  Rung rungWith(const std::string& stage, const std::vector<std::size_t>& findings, HeldOut kind, Waves waves) const;
  /// Which poses are held out in turn.
  const Folds& folds(HeldOut kind) const { return folds_.at(kind); }
  /// Whether there are waves among some of the findings: otherwise either choice of Waves gives the same.
  bool hasWaves(const std::vector<std::size_t>& findings) const;

  /// The ways beside random ones in which poses can be held out. What moves with time asks for poses from before and after: stretches of
  /// time that are held out tell nothing of it.
  std::vector<HeldOut> blocks() const;

 private:
  using Groups = std::vector<std::vector<std::size_t>>;
  /// A model fitted to the poses outside of a fold.
  struct Fitted {
    ModelState state;
    std::vector<Accepted> accepted;
  };
  template <typename Fit>
  Rung judged(const std::string& stage, HeldOut kind, Fit fit) const;
  Rung fitted(const std::string& stage, HeldOut kind, const ModelState& start, const std::vector<Accepted>& accepted,
              const std::vector<std::size_t>& scatter, const NoiseEstimate& noise, Waves waves) const;
  /// A model with waves beside it, for each of those that were chosen one of what its own poses leave.
  Fitted withWaves(const Linearised& without, const std::vector<Accepted>& chosen) const;
  /// Folds of the identification, as numbers of groups; a pose that a fold splits goes with its first row.
  Folds identificationFolds() const;
  void addErrors(const MeasuredCell& measured, const Linearised& at, const std::vector<std::size_t>& numbers, ErrorCollector& errors) const;
  /// @param rows  by the numbers of all observations.
  Rung rungOf(const std::string& stage, const std::vector<RowErrors>& rows, const ErrorSummary& every_row) const;

  const Selection& selection_;
  std::optional<WaveDictionary> waves_;  ///< to choose from; where there are waves among the findings
  const MeasuredCell& all_;
  const Identification& identification_;
  std::vector<std::size_t> every_;  ///< numbers of all observations
  std::vector<std::size_t> kept_;   ///< numbers of the selection's observations among all
  std::map<HeldOut, Folds> folds_;
};

}  // namespace poecal
