// What a plan may be chosen for, as a cost of a set of candidate poses that is cheap to evaluate for one pose more or less.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "planning/knowledge.hpp"
#include "poecal/core/progress.hpp"

namespace poecal {

/// A cost of poses, smaller is better; poses are numbers of candidates.
class Aim {
 public:
  virtual ~Aim() = default;
  virtual std::unique_ptr<Aim> copy() const = 0;
  /// Of the poses that are in.
  virtual double cost() const = 0;
  /// What it would be with one more.
  virtual double costWith(std::size_t candidate) const = 0;
  virtual void add(std::size_t candidate) = 0;
  virtual void remove(std::size_t candidate) = 0;
};

/// Inverse of an information matrix; its unknowns are radians, metres and pixels.
Eigen::MatrixXd covarianceOf(const Eigen::MatrixXd& information);

/// Uncertainty of what is estimated, A or D:
///
///   A: tr(Q Sigma),   with one more pose   tr(Q Sigma) - tr((I + X Sigma X')^-1 X Sigma Q Sigma X')
///   D: -log det Lambda,                    -log det Lambda - log det(I + X Sigma X')
///
/// with Sigma = Lambda^-1, X the pose's rows and tr(Q Sigma) the mean variance that matters.
class CertaintyAim : public Aim {
 public:
  /// @param rows  of the candidates; their last column is not used. @param Q  empty: D.
  CertaintyAim(Eigen::MatrixXd information, Eigen::MatrixXd Q, std::shared_ptr<const std::vector<WhiteRows>> rows);
  std::unique_ptr<Aim> copy() const override { return std::make_unique<CertaintyAim>(*this); }
  double cost() const override { return cost_; }
  double costWith(std::size_t candidate) const override;
  void add(std::size_t candidate) override { change(candidate, 1.0); }
  void remove(std::size_t candidate) override { change(candidate, -1.0); }
  const Eigen::MatrixXd& covariance() const { return Sigma_; }

 private:
  void change(std::size_t candidate, double sign);
  void refresh();

  Eigen::MatrixXd Lambda_, Sigma_, Q_, SigmaQSigma_;
  double cost_ = 0.0;
  std::shared_ptr<const std::vector<WhiteRows>> rows_;
};

/// What rows y with mean d would add to the chi-square of a model that explains them by X alone, whatever its unknowns:
///
///   s - v' Lambda^-1 v,   s = sum d'd,   v = sum X'd,   Lambda = Lambda_0 + sum X'X
///
/// which is d' S^-1 d with S = I + X Sigma_0 X', the covariance of y as that model predicts it from what it has seen (all in units of the
/// noise). Half of it is the expected log odds against the model if d is right (Kullback-Leibler, both models equally sure).
struct Contrast {
  Eigen::MatrixXd information;  ///< Lambda
  Eigen::VectorXd v;
  double s = 0.0;
  std::shared_ptr<const std::vector<WhiteRows>> rows = {};  ///< [X d] of each candidate
  double log_odds = 0.0;                                    ///< before

  /// Adds (sign 1) or takes away (-1) the rows [X d] of a pose.
  void add(const WhiteRows& pose, double sign);
};

/// Cost of contrasts: log of the sum of 1 / odds, each with the expected log odds log_odds + chi-square / 2. The worst told counts most.
class ContrastAim : public Aim {
 public:
  explicit ContrastAim(std::vector<Contrast> contrasts);
  std::unique_ptr<Aim> copy() const override { return std::make_unique<ContrastAim>(*this); }
  double cost() const override { return combined(chiSquares()); }
  double costWith(std::size_t candidate) const override;
  void add(std::size_t candidate) override { change(candidate, 1.0); }
  void remove(std::size_t candidate) override { change(candidate, -1.0); }
  /// Of each contrast.
  std::vector<double> chiSquares() const;
  const std::vector<Contrast>& contrasts() const { return contrasts_; }

 private:
  void change(std::size_t candidate, double sign);
  double combined(const std::vector<double>& chi_squares) const;

  std::vector<Contrast> contrasts_;
  std::vector<Eigen::MatrixXd> Sigma_;
};

/// Poses that make a cost small: one after the other each the best beside those before, then each in turn exchanged for the best that there
/// is instead until none helps (Fedorov 1972). Each candidate at most once. @param enough  a cost at which no further pose is added.
/// @param chosen  poses to begin with, not in the aim yet. @param progress  told of each pose that is chosen or may be exchanged.
std::vector<std::size_t> choosePoses(Aim& aim, std::size_t candidates, std::vector<std::size_t> chosen, std::size_t count, int jobs,
                                     double enough, const ProgressFunction& progress = {});

}  // namespace poecal
