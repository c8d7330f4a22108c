// What a plan may be asked beside the tool: which of the rivals that a diagnosis left open is right, and whether an effect of a given size
// is there.
#pragma once

#include <string>
#include <vector>

#include "planning/aims.hpp"
#include "planning/knowledge.hpp"

namespace poecal {

/// Contrasts with what each is about.
struct Question {
  std::vector<Contrast> contrasts;
  std::vector<RivalOdds> pairs;       ///< names of each; separation alone
  std::vector<std::string> not_told;  ///< rivals that have no columns, with what tells them apart
  bool sides_matter = false;          ///< some explanation hangs on the side from which a joint comes
};

/// Each rival against the finding, and the finding against each rival. Let a be right: with the factors b_a that the data so far give,
/// a pose's rows become X_a b_a, and the model of b expects X_b b_b with covariance C + X_b Sigma_b X_b'. The contrast is of
/// d = X_a b_a - X_b b_b.
/// @throws InsufficientData where no rival is open, or none can be told apart by poses.
Question separation(const PlanningCell& cell, const std::vector<Sample>& candidates, double odds);

/// An effect of that size against none, with the rows taken so far in it: one contrast for each instance and size. Of waves the orders 2
/// to 6.
/// @throws InvalidArgument: no such effect or place, or one that no pose decides.
Question detection(const PlanningCell& cell, const std::vector<Sample>& candidates, const PlanOptions& options);

}  // namespace poecal
