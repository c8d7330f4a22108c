// How strongly the rows speak for an explanation, with the noise estimated anew beside it; screening.hpp weighs all of them at once.
#pragma once

#include <vector>

#include "diagnosis/candidates.hpp"
#include "diagnosis/noise.hpp"
#include "diagnosis/reference_sight.hpp"

namespace poecal {

/// An explanation that was taken up: its columns' factors, of which the effect's own stand in ModelState::effects too.
struct Accepted {
  Candidate candidate;
  Eigen::VectorXd factors;  ///< one per column
  double scale = 1.0;       ///< size in units of the typical
  std::size_t effect = 0;   ///< index into ModelState::effects; curves have none
};

/// 1 sigma of its factors about zero while it is fitted: wide about what was found, so that nothing is drawn to zero; what hangs on the
/// effect's own factors as narrow as it was.
Eigen::VectorXd fittedSpread(const Accepted& one);

/// The capture linearised at a state, with what was taken up so far as columns beside those of the base model.
struct Linearised {
  ModelState state;
  std::vector<Accepted> accepted;
  CaptureRows rows;                   ///< r without the linear parts of what was accepted
  Eigen::MatrixXd columns;            ///< of what was accepted
  ColumnPrior plain_prior;            ///< of `columns`, before the reference is looked at
  ColumnPrior column_prior;           ///< with it
  ReferenceSight reference;           ///< empty where the pictures show none
  Eigen::MatrixXd reference_motions;  ///< by each of `columns`; zero where a column moves no camera
  double reference_log = 0.0;         ///< what the reference adds to the log of the likelihood
  double reference_misfit = 0.0;      ///< and to the misfit at b = 0
  std::vector<NoiseComponent> components;
  NoiseEstimate noise;  ///< with all of this
  bool settled = true;  ///< refit() came to rest here
  int jobs = 1;         ///< as MeasuredCell's

  /// X: columns of the base model, then those of what was accepted.
  Eigen::MatrixXd allColumns() const;
  /// r - X b.
  Eigen::VectorXd residual() const;
  /// Takes up a prior of `columns`, and what the reference tells of them.
  void believe(const ColumnPrior& prior);
  /// Log of the likelihood of all rows, those of the reference too.
  double logLikelihood() const { return noise.log_likelihood + reference_log; }
  /// Misfit likewise.
  double misfit() const { return noise.misfit + reference_misfit; }
};

/// @param groups  the poses to use; empty: all. @param scatter  joints that move at random by themselves.
Linearised linearise(const MeasuredCell& measured, const ModelState& state, const std::vector<Accepted>& accepted,
                     const std::vector<std::size_t>& scatter, const std::vector<std::vector<std::size_t>>& groups);
/// The noise of a linearisation, from an earlier estimate where there is one.
void setNoise(const MeasuredCell& measured, const NoiseEstimate& from, Linearised& linear);

/// Residuals of a linearisation in units of their noise.
struct WhiteResidual {
  Whitening whitening;
  Eigen::VectorXd e;
};
WhiteResidual whiteResidual(const Linearised& linear);

/// What the rows say of one explanation.
struct Evidence {
  double log_bayes = 0.0;    ///< against none, averaged over sizes from a thirtieth to a hundred times the typical
  double scale = 1.0;        ///< the size that fits best
  double chi_square = 0.0;   ///< drop of chi-square at its best fit
  int dimension = 0;         ///< columns that the rows can see
  double information = 0.0;  ///< mean over its own columns of information on a factor in units of the typical
  double clearest = 0.0;     ///< the same in the direction that the rows show best
  Eigen::VectorXd found;     ///< with mass errors: size of each own factor by its own columns alone, root of its expected square
};

/// Size in units of the typical of what is found four times in five, which takes an expected chi-square of 36 in a search over some hundred
/// answers. @param information  see Evidence. @return infinity where there is none.
double smallestSeen(double information);

/// Evidence of a candidate, from what all else leaves of its columns' information S and score u.
Evidence evidenceOf(const Eigen::MatrixXd& S, const Eigen::VectorXd& u, const Candidate& candidate);

/// ln(sum exp(v)); -infinity of nothing.
double logSumExp(const std::vector<double>& values);

/// Sizes in units of the typical over which evidence is averaged.
const std::vector<double>& evidenceScales();

/// What the reference adds to a candidate beside the columns that are there: information and score on all of these, those of the
/// candidate last. Empty where it adds nothing.
struct ReferenceInformation {
  Eigen::MatrixXd S;
  Eigen::VectorXd u;
};
ReferenceInformation referenceInformation(const Linearised& linear, const Candidate& candidate);

/// Evidence of one candidate with the noise estimated anew beside it.
struct ExactEvidence {
  double log_bayes = 0.0;
  double scale = 1.0;
  NoiseEstimate noise;  ///< its b ends with the candidate's factors
};
/// @param screened  its evidence at the linearisation.
ExactEvidence exactEvidence(const Linearised& linear, const MeasuredCell& measured, const Candidate& candidate, const Evidence& screened);

/// Evidence of joint k (from 0) moving at random by itself: one variance more, averaged over its size.
ExactEvidence scatterEvidence(const Linearised& linear, const MeasuredCell& measured, std::size_t k);

}  // namespace poecal
