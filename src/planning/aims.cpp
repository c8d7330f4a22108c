#include "planning/aims.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "poecal/core/parallel.hpp"

namespace poecal {
namespace {

/// X and d of a candidate's rows.
auto columnsOf(const WhiteRows& rows) { return rows.leftCols(rows.cols() - 1); }
auto lastColumn(const WhiteRows& rows) { return rows.col(rows.cols() - 1); }

/// Cholesky factor of I + X Sigma X'.
Eigen::LLT<Eigen::MatrixXd> predicted(const Eigen::MatrixXd& XSigma, const WhiteRows& rows) {
  Eigen::MatrixXd S = XSigma * columnsOf(rows).transpose();
  S.diagonal().array() += 1.0;
  return Eigen::LLT<Eigen::MatrixXd>(S);
}

/// Scaled to a unit diagonal.
struct Scaled {
  explicit Scaled(const Eigen::MatrixXd& information) : scale(information.diagonal().cwiseSqrt().cwiseInverse()) {
    const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    llt.compute(scaled);
  }
  double logDeterminant() const { return 2.0 * (llt.matrixLLT().diagonal().array().log().sum() - scale.array().log().sum()); }

  Eigen::VectorXd scale;
  Eigen::LLT<Eigen::MatrixXd> llt;
};

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// The candidate that is not chosen and makes the cost least; kNone where all are chosen.
std::size_t bestOf(const Aim& aim, const std::vector<bool>& chosen, int jobs) {
  constexpr std::size_t kAtATime = 64;
  std::vector<double> costs(chosen.size(), std::numeric_limits<double>::infinity());
  parallelFor((chosen.size() + kAtATime - 1) / kAtATime, jobs, [&](std::size_t block) {
    const std::size_t end = std::min(chosen.size(), (block + 1) * kAtATime);
    for (std::size_t k = block * kAtATime; k < end; ++k) {
      if (!chosen[k]) costs[k] = aim.costWith(k);
    }
  });
  const auto best = std::min_element(costs.begin(), costs.end());
  return best == costs.end() || !std::isfinite(*best) ? kNone : static_cast<std::size_t>(best - costs.begin());
}

}  // namespace

Eigen::MatrixXd covarianceOf(const Eigen::MatrixXd& information) {
  const Scaled scaled(information);
  const Eigen::MatrixXd inverse = scaled.llt.solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
  return scaled.scale.asDiagonal() * inverse * scaled.scale.asDiagonal();
}

CertaintyAim::CertaintyAim(Eigen::MatrixXd information, Eigen::MatrixXd Q, std::shared_ptr<const std::vector<WhiteRows>> rows)
    : Lambda_(std::move(information)), Q_(std::move(Q)), rows_(std::move(rows)) {
  refresh();
}

void CertaintyAim::refresh() {
  Sigma_ = covarianceOf(Lambda_);
  if (Q_.size() == 0) {
    cost_ = -Scaled(Lambda_).logDeterminant();
    return;
  }
  SigmaQSigma_ = Sigma_ * Q_ * Sigma_;
  cost_ = Q_.cwiseProduct(Sigma_).sum();
}

void CertaintyAim::change(std::size_t candidate, double sign) {
  const auto X = columnsOf((*rows_)[candidate]);
  Lambda_ += sign * X.transpose() * X;
  refresh();
}

double CertaintyAim::costWith(std::size_t candidate) const {
  const auto X = columnsOf((*rows_)[candidate]);
  const Eigen::LLT<Eigen::MatrixXd> S = predicted(X * Sigma_, (*rows_)[candidate]);
  if (Q_.size() == 0) return cost_ - 2.0 * S.matrixLLT().diagonal().array().log().sum();
  const Eigen::MatrixXd removed = X * SigmaQSigma_ * X.transpose();
  return cost_ - S.solve(removed).trace();
}

void Contrast::add(const WhiteRows& pose, double sign) {
  const auto X = columnsOf(pose);
  const auto d = lastColumn(pose);
  information += sign * X.transpose() * X;
  v += sign * X.transpose() * d;
  s += sign * d.squaredNorm();
}

ContrastAim::ContrastAim(std::vector<Contrast> contrasts) : contrasts_(std::move(contrasts)) {
  for (const Contrast& contrast : contrasts_) Sigma_.push_back(covarianceOf(contrast.information));
}

void ContrastAim::change(std::size_t candidate, double sign) {
  for (std::size_t i = 0; i < contrasts_.size(); ++i) {
    contrasts_[i].add((*contrasts_[i].rows)[candidate], sign);
    Sigma_[i] = covarianceOf(contrasts_[i].information);
  }
}

std::vector<double> ContrastAim::chiSquares() const {
  std::vector<double> values;
  for (std::size_t i = 0; i < contrasts_.size(); ++i) values.push_back(contrasts_[i].s - contrasts_[i].v.dot(Sigma_[i] * contrasts_[i].v));
  return values;
}

double ContrastAim::costWith(std::size_t candidate) const {
  std::vector<double> values;
  for (std::size_t i = 0; i < contrasts_.size(); ++i) {
    const Contrast& contrast = contrasts_[i];
    const WhiteRows& rows = (*contrast.rows)[candidate];
    const auto d = lastColumn(rows);
    const Eigen::VectorXd w = contrast.v + columnsOf(rows).transpose() * d;
    const Eigen::MatrixXd XSigma = columnsOf(rows) * Sigma_[i];
    const Eigen::VectorXd e = XSigma * w;
    values.push_back(contrast.s + d.squaredNorm() - w.dot(Sigma_[i] * w) + e.dot(predicted(XSigma, rows).solve(e)));
  }
  return combined(values);
}

double ContrastAim::combined(const std::vector<double>& chi_squares) const {
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < chi_squares.size(); ++i) largest = std::max(largest, -contrasts_[i].log_odds - 0.5 * chi_squares[i]);
  double sum = 0.0;
  for (std::size_t i = 0; i < chi_squares.size(); ++i) sum += std::exp(-contrasts_[i].log_odds - 0.5 * chi_squares[i] - largest);
  return largest + std::log(sum);
}

std::vector<std::size_t> choosePoses(Aim& aim, std::size_t candidates, std::vector<std::size_t> chosen, std::size_t count, int jobs,
                                     double enough, const ProgressFunction& progress) {
  std::vector<bool> in(candidates, false);
  const auto take = [&](std::size_t k) {
    aim.add(k);
    in[k] = true;
  };
  for (const std::size_t k : chosen) take(k);
  Progress choosing(progress, "choosing poses", count - std::min(count, chosen.size()));
  choosing.show();
  while (chosen.size() < count && aim.cost() > enough) {
    const std::size_t best = bestOf(aim, in, jobs);
    if (best == kNone) break;
    take(best);
    chosen.push_back(best);
    choosing.advance();
  }
  choosing.finish();
  constexpr int kMostRounds = 20;
  constexpr double kGain = 1e-6;  // of the cost: less is rounding
  bool helped = true;
  for (int round = 0; helped && round < kMostRounds; ++round) {
    helped = false;
    Progress exchanging(progress, "exchanging poses for better ones", chosen.size());
    exchanging.show();
    for (std::size_t& pose : chosen) {
      const double before = aim.cost();
      aim.remove(pose);
      const std::size_t best = bestOf(aim, in, jobs);
      const bool better = best != kNone && aim.costWith(best) < before - kGain * std::abs(before);
      if (better) {
        in[pose] = false;
        pose = best;
        helped = true;
      }
      take(pose);
      exchanging.advance();
    }
  }
  return chosen;
}

}  // namespace poecal
