// What a plan may be asked beside the tool: which of the rivals that a diagnosis left open is right, and whether an effect of a given size
// is there.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planning/aims.hpp"
#include "planning/knowledge.hpp"

namespace poecal {

/// A contrast before any pose of the plan, and the rows that a pose would add to it.
struct AskedContrast {
  std::shared_ptr<const Knowledge> knowledge;
  Contrast before;             ///< without rows
  Eigen::Index base = 0;       ///< first columns of the knowledge, which are nuisances
  Eigen::Index own_begin = 0;  ///< and those of the wrong explanation
  Eigen::Index own_size = 0;
  Eigen::VectorXd mean;  ///< factors of all columns: d = X mean
};

struct Question {
  std::vector<AskedContrast> asked;
  std::vector<RivalOdds> pairs;       ///< names of each; separation alone
  std::vector<std::string> not_told;  ///< rivals that no pose tells apart, with what does
  bool sides_matter = false;          ///< some explanation hangs on the side from which a joint comes

  /// With the rows of poses that may be taken. @param progress  told of each contrast.
  std::vector<Contrast> contrasts(const std::vector<Sample>& samples, const ProgressFunction& progress = {}) const;
};

/// Each rival against the finding, and the finding against each rival. Let a be right: with the factors b_a that the data so far give,
/// a pose's rows become X_a b_a, and the model of b expects X_b b_b with covariance C + X_b Sigma_b X_b'. The contrast is of
/// d = X_a b_a - X_b b_b. @param candidates  what they all together do not tell apart, no pose does.
/// @throws InsufficientData where no rival is open, or none can be told apart by poses.
Question separation(const PlanningCell& cell, const std::vector<Sample>& candidates, const PlanOptions& options);

/// An effect of that size against none, with the rows taken so far in it: one contrast for each instance and size. Of waves the orders 2
/// to 6.
/// @throws InvalidArgument: no such effect or place, or one that no pose decides.
Question detection(const PlanningCell& cell, const std::vector<Sample>& candidates, const PlanOptions& options);

}  // namespace poecal
