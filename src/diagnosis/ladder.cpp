#include "diagnosis/ladder.hpp"

#include <algorithm>

#include "diagnosis/refit.hpp"
#include "poecal/registration/target_pose.hpp"

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

}  // namespace

Ladder::Ladder(const Selection& selection, const Registration& closed_form, int folds, std::uint64_t seed)
    : selection_(selection), closed_form_(closed_form) {
  for (const HeldOut kind : {HeldOut::kRandom, HeldOut::kTime, HeldOut::kPosture}) {
    folds_[kind] = makeFolds(selection.measured, kind, folds, seed);
  }
}

std::vector<HeldOut> Ladder::blocks() const {
  const bool in_time = std::any_of(selection_.findings.begin(), selection_.findings.end(), [](const FoundEffect& found) {
    return found.driver == "stamp" || (found.accepted && found.accepted->candidate.slipTime());
  });
  if (in_time) return {HeldOut::kPosture};
  return {HeldOut::kTime, HeldOut::kPosture};
}

void Ladder::addErrors(const Linearised& at, const Groups& test, const std::vector<std::size_t>& numbers, Rung& rung) const {
  for (std::size_t g = 0; g < test.size(); ++g) {
    PoseErrors& pose = rung.poses[numbers[g]];
    for (const std::size_t k : at.rows.groups[g]) {
      const ObservationRows& part = at.rows.observations[k];
      const Observation& observation = selection_.measured.observations[part.context.number];
      if (observation.pose) {
        const Vector6d e = poseDifference(observation.pose->T_camera_target, part.ports.T_camera_target);
        pose.squares += e.tail<3>().squaredNorm();
        pose.points += 1.0;
        pose.position += e.tail<3>().squaredNorm();
        if (!observation.pose->position_only) pose.rotation += e.head<3>().squaredNorm();
        pose.targets += 1.0;
        continue;
      }
      const Eigen::VectorXd r = at.rows.r.segment(part.begin, part.size);
      for (std::size_t j = 0; j < part.unit_sigma.size(); ++j) {
        if (!part.rows.valid[j]) continue;
        pose.squares += r.segment<2>(2 * static_cast<Eigen::Index>(j)).squaredNorm() * part.unit_sigma[j] * part.unit_sigma[j];
        pose.points += 1.0;
      }
      constexpr std::size_t kOfAPose = 4;  // corners that a pose of its own takes
      if (observation.corners.size() < kOfAPose) continue;
      const PlainSight plain = plainSight(selection_.measured, at.state, part);
      const FreePose free = refinePose(*plain.cell.camera, plain.observation, part.ports.T_camera_target);
      const Registration& registration = at.state.cell.cell.registration;
      const Vector6d e = poseDifference(registration.baseFlange(free.T_camera_target), registration.baseFlange(part.ports.T_camera_target));
      pose.position += e.tail<3>().squaredNorm();
      pose.rotation += e.head<3>().squaredNorm();
      pose.targets += 1.0;
    }
  }
}

template <typename Fit>
Rung Ladder::judged(const std::string& stage, HeldOut kind, Fit fit) const {
  const Groups& groups = selection_.measured.groups;
  Rung rung{stage, std::vector<PoseErrors>(groups.size())};
  for (const std::vector<std::size_t>& fold : folds_.at(kind)) {
    Groups train, test;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      (std::binary_search(fold.begin(), fold.end(), g) ? test : train).push_back(groups[g]);
    }
    const Fitted model = fit(train);
    addErrors(linearise(selection_.measured, model.state, model.accepted, {}, test), test, fold, rung);
  }
  return rung;
}

std::vector<Rung> Ladder::geometricRungs() const {
  const MeasuredCell& measured = selection_.measured;
  ModelState nominal{CellState(measured.start, measured.free), {}};
  nominal.cell.cell.registration = closed_form_;
  std::vector<Rung> rungs;
  rungs.push_back(judged("nominal", HeldOut::kRandom, [&](const Groups&) { return Fitted{nominal, {}}; }));
  rungs.push_back(judged("registered", HeldOut::kRandom, [&](const Groups& train) {
    std::vector<Observation> some;
    for (const std::vector<std::size_t>& group : train) {
      for (const std::size_t k : group) some.push_back(measured.observations[k]);
    }
    AdjustmentOptions options;
    options.free = {.near = measured.free.near, .far = measured.free.far};
    ModelState state{CellState(measured.start, measured.free), {}};
    if (options.free.near) state.cell.cell = adjust(measured.start, some, options).cell;
    return Fitted{state, {}};
  }));
  rungs.push_back(identifiedRung(HeldOut::kRandom));
  return rungs;
}

Rung Ladder::identifiedRung(HeldOut kind) const {
  return fitted("identified", kind, selection_.base, {}, {}, asCornerNoise(selection_.linear));
}

Rung Ladder::fitted(const std::string& stage, HeldOut kind, const ModelState& start, const std::vector<Accepted>& accepted,
                    const std::vector<std::size_t>& scatter, const NoiseEstimate& noise) const {
  return judged(stage, kind, [&](const Groups& train) {
    const Linearised linear = refit(selection_.measured, start, accepted, scatter, noise, train, false);
    return Fitted{linear.state, linear.accepted};
  });
}

Rung Ladder::rungWith(const std::string& stage, const std::vector<std::size_t>& findings, HeldOut kind) const {
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
    return fitted(stage, kind, start, accepted, scatter, selection_.linear.noise);
  // A joint that moves at random is noise itself: who does not know of it takes it for that of all joints.
  const Linearised without = refit(selection_.measured, start, accepted, scatter, selection_.base_noise, {}, true);
  return fitted(stage, kind, start, accepted, scatter, without.noise);
}

}  // namespace poecal
