// The gap as a ladder, each rung on poses that its fit did not see.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "diagnosis/folds.hpp"
#include "diagnosis/gap.hpp"
#include "diagnosis/selection.hpp"

namespace poecal {

class Ladder {
 public:
  Ladder(const Selection& selection, const Registration& closed_form, int folds, std::uint64_t seed);

  /// nominal, registered, identified: the last as `identify` does it, which knows corners that are off by chance and nothing else.
  std::vector<Rung> geometricRungs() const;
  Rung identifiedRung(HeldOut kind) const;
  /// The identified model with some of the findings.
  Rung rungWith(const std::string& stage, const std::vector<std::size_t>& findings, HeldOut kind) const;

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
              const std::vector<std::size_t>& scatter, const NoiseEstimate& noise) const;
  void addErrors(const Linearised& at, const Groups& test, const std::vector<std::size_t>& numbers, Rung& rung) const;

  const Selection& selection_;
  Registration closed_form_;
  std::map<HeldOut, Folds> folds_;
};

}  // namespace poecal
