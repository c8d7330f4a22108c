#include "diagnosis/ladder.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "diagnosis/refit.hpp"
#include "diagnosis/search_state.hpp"

namespace poecal {
namespace {

/// The noise as `identify` sees it, which takes all of it for single corners' own, and the arm for one that keeps its tolerances: the same
/// in all corners, and of the same mean square.
NoiseEstimate asCornerNoise(const Linearised& linear) {
  const auto corner = std::find_if(linear.components.begin(), linear.components.end(), [](const auto& c) { return c.white; });
  if (corner == linear.components.end()) return linear.noise;
  double squares = 0.0;
  for (std::size_t i = 0; i < linear.components.size(); ++i) {
    for (const Eigen::MatrixXd& Z : linear.components[i].Z) squares += linear.noise.theta(static_cast<Eigen::Index>(i)) * Z.squaredNorm();
  }
  NoiseEstimate white = linear.noise;
  white.tolerance = 1.0;
  white.theta.setZero();
  white.theta(corner - linear.components.begin()) = squares / linear.rows.size();
  return white;
}

/// Waves that were chosen among many by what they explain of these very poses.
bool wasChosen(const Accepted& one) { return one.candidate.isWaves() && !one.candidate.curve->smooth; }

}  // namespace

Ladder::Ladder(const Selection& selection, const MeasuredCell& all, const Identification& identification, int folds, std::uint64_t seed)
    : selection_(selection), all_(all), identification_(identification) {
  if (std::any_of(selection.findings.begin(), selection.findings.end(), isWaves))
    waves_.emplace(*selection.measured.start.arm, selection.measured.samples);
  const std::set<std::size_t> bad(selection.bad.begin(), selection.bad.end());
  for (std::size_t k = 0; k < all.observations.size(); ++k) {
    every_.push_back(k);
    if (!bad.contains(k)) kept_.push_back(k);
  }
  folds_[HeldOut::kRandom] = identificationFolds();
  for (const HeldOut kind : {HeldOut::kTime, HeldOut::kPosture}) folds_[kind] = makeFolds(selection.measured, kind, folds, seed);
}

Folds Ladder::identificationFolds() const {
  std::map<std::size_t, std::size_t> fold_of;
  for (std::size_t fold = 0; fold < identification_.folds.size(); ++fold) {
    for (const std::size_t k : identification_.folds[fold]) fold_of[k] = fold;
  }
  Folds folds(identification_.folds.size());
  for (std::size_t g = 0; g < selection_.measured.groups.size(); ++g) {
    folds.at(fold_of.at(kept_[selection_.measured.groups[g].front()])).push_back(g);
  }
  return folds;
}

std::vector<HeldOut> Ladder::blocks() const {
  const bool in_time = std::any_of(selection_.findings.begin(), selection_.findings.end(), [](const FoundEffect& found) {
    return found.driver.kind() == DriverKind::kStamp || (found.accepted && found.accepted->candidate.slipTime());
  });
  if (in_time) return {HeldOut::kPosture};
  return {HeldOut::kTime, HeldOut::kPosture};
}

void Ladder::addErrors(const MeasuredCell& measured, const Linearised& at, const std::vector<std::size_t>& numbers,
                       ErrorCollector& errors) const {
  for (const ObservationRows& part : at.rows.observations) {
    const PlainSight plain = plainSight(measured, at.state, part);
    // The rows know of curves too, which are in no port.
    const Eigen::VectorXd r = at.rows.r.segment(part.begin, part.size);
    errors.add(plain.cell, numbers[part.context.number], plain.observation, part.ports.T_camera_target, r);
  }
}

Rung Ladder::rungOf(const std::string& stage, const std::vector<RowErrors>& rows, const ErrorSummary& every_row) const {
  std::map<std::size_t, const RowErrors*> by_number;
  for (const RowErrors& row : rows) by_number[row.index] = &row;
  Rung rung{stage, {}, every_row};
  const std::optional<PoseMeasurement>& first = selection_.measured.observations.front().pose;
  const bool turns = first && !first->position_only;
  for (const std::vector<std::size_t>& group : selection_.measured.groups) {
    PoseSquares& pose = rung.poses.emplace_back();
    if (turns) rung.whitened.push_back(0.0);
    for (const std::size_t k : group) {
      if (turns) rung.whitened.back() += by_number.at(kept_[k])->whitened_squares;
      for (const double length : by_number.at(kept_[k])->lengths) {
        pose.squares += length * length;
        pose.points += 1.0;
      }
    }
  }
  return rung;
}

template <typename Fit>
Rung Ladder::judged(const std::string& stage, HeldOut kind, Fit fit) const {
  const Groups& groups = selection_.measured.groups;
  const Folds& folds = folds_.at(kind);
  ErrorCollector errors(identification_.corner_noise);
  for (std::size_t f = 0; f < folds.size(); ++f) {
    Groups train, test;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      (std::binary_search(folds[f].begin(), folds[f].end(), g) ? test : train).push_back(groups[g]);
    }
    const Fitted model = fit(train);
    // Of a fold whose poses were all set aside nothing is left; no groups would mean all of them.
    if (!test.empty()) {
      addErrors(selection_.measured, linearise(selection_.measured, model.state, model.accepted, {}, test), kept_, errors);
    }
    if (kind != HeldOut::kRandom) continue;
    // Rows that were set aside are in no fit, and are judged by that of their fold all the same.
    Groups set_aside;
    for (const std::size_t k : identification_.folds[f]) {
      if (!std::binary_search(kept_.begin(), kept_.end(), k)) set_aside.push_back({k});
    }
    if (!set_aside.empty()) addErrors(all_, linearise(all_, model.state, model.accepted, {}, set_aside), every_, errors);
  }
  // Blocks are read pose by pose alone.
  return rungOf(stage, errors.rows(), kind == HeldOut::kRandom ? errors.summary() : ErrorSummary{});
}

std::vector<Rung> Ladder::geometricRungs() const {
  std::vector<Rung> rungs;
  for (const ModelStage& stage : identification_.stages) rungs.push_back(rungOf(stage.name, stage.held_out_rows, stage.held_out));
  return rungs;
}

Rung Ladder::identifiedRung(HeldOut kind) const {
  return fitted("identified", kind, selection_.base, {}, {}, asCornerNoise(selection_.linear), Waves::kKept);
}

Rung Ladder::fitted(const std::string& stage, HeldOut kind, const ModelState& start, const std::vector<Accepted>& accepted,
                    const std::vector<std::size_t>& scatter, const NoiseEstimate& noise, Waves waves) const {
  const auto fit = [&](const Fitted& from, const Groups& poses) {
    return refit(selection_.measured, from.state, from.accepted, scatter, noise, poses, false);
  };
  const auto fittedBy = [](const Linearised& linear) { return Fitted{linear.state, linear.accepted}; };
  std::vector<Accepted> known, chosen;
  const bool anew = waves == Waves::kChosenAnew;
  std::partition_copy(accepted.begin(), accepted.end(), std::back_inserter(chosen), std::back_inserter(known),
                      [anew](const Accepted& one) { return anew && wasChosen(one); });
  // A long way that all folds share, where some of the findings are missing, is gone once.
  const Fitted all = known.empty() ? Fitted{start, {}} : fittedBy(fit({start, known}, selection_.measured.groups));
  return judged(stage, kind, [&](const Groups& train) {
    const Linearised one = fit(all, train);
    return fittedBy(chosen.empty() ? one : fit(withWaves(one, chosen), train));
  });
}

Ladder::Fitted Ladder::withWaves(const Linearised& without, const std::vector<Accepted>& chosen) const {
  Fitted fitted{without.state, without.accepted};
  for (const Accepted& one : chosen) {
    Accepted made = one;
    const std::size_t most = one.candidate.curve->terms.size();
    std::optional<Candidate> waves = wavesAt(selection_.measured, without, *waves_, one.candidate.curve->place.index, most);
    if (!waves) continue;
    made.candidate = std::move(*waves);
    made.factors = Eigen::VectorXd::Zero(made.candidate.typical.size());
    fitted.accepted.push_back(std::move(made));
  }
  return fitted;
}

bool Ladder::hasWaves(const std::vector<std::size_t>& findings) const {
  return std::any_of(findings.begin(), findings.end(), [this](std::size_t i) { return isWaves(selection_.findings[i]); });
}

Rung Ladder::rungWith(const std::string& stage, const std::vector<std::size_t>& findings, HeldOut kind, Waves waves) const {
  std::vector<Accepted> accepted;
  std::vector<std::size_t> scatter;
  for (const std::size_t i : findings) {
    const FoundEffect& found = selection_.findings[i];
    if (found.accepted) accepted.push_back(*found.accepted);
    if (found.scatter) scatter.push_back(*found.scatter);
  }
  const bool whole = findings.size() == selection_.findings.size();
  const ModelState& start = whole ? selection_.linear.state : selection_.base;
  const auto all_scatter = std::count_if(selection_.findings.begin(), selection_.findings.end(), [](const auto& f) { return f.scatter; });
  // What a single pose is worth does not hang on which rung it judges: the noise is that of the whole model.
  if (static_cast<std::ptrdiff_t>(scatter.size()) == all_scatter)
    return fitted(stage, kind, start, accepted, scatter, selection_.linear.noise, waves);
  // A joint that moves at random is noise itself: who does not know of it takes it for that of all joints.
  const Linearised without = refit(selection_.measured, start, accepted, scatter, selection_.base_noise, {}, true);
  return fitted(stage, kind, start, accepted, scatter, without.noise, waves);
}

}  // namespace poecal
