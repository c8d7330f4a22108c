#include "diagnosis/ladder.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "poecal/core/random.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/registration/target_pose.hpp"

namespace poecal {
namespace {

/// Sum of squares of a rung above the noise, as a mean per point.
struct MeanSquare {
  double squares = 0.0, noise = 0.0, points = 0.0;
  double excess() const { return points > 0.0 ? std::sqrt(std::max(0.0, (squares - noise) / points)) : 0.0; }
};

double ratio(const MeanSquare& before, const MeanSquare& after) {
  const double b = before.excess();
  return b > 0.0 ? 1.0 - after.excess() / b : 0.0;
}

}  // namespace

std::vector<double> noiseSquares(const Linearised& linear) {
  std::vector<double> squares;
  for (std::size_t g = 0; g < linear.rows.groups.size(); ++g) {
    double sum = 0.0;
    for (std::size_t i = 0; i < linear.components.size(); ++i) {
      const Eigen::MatrixXd& Z = linear.components[i].Z[g];
      Eigen::Index row = 0;
      for (const std::size_t k : linear.rows.groups[g]) {
        const ObservationRows& part = linear.rows.observations[k];
        const bool pose = part.rows.unit_size != 2;
        for (Eigen::Index n = 0; n < part.size; ++n, ++row) {
          // Of a pose only the position counts; its rows are in units of its stated deviation.
          if (pose && part.size == 6 && n < 3) continue;
          const double sigma = part.unit_sigma[pose ? 0 : static_cast<std::size_t>(n / 2)];
          sum += linear.noise.theta(static_cast<Eigen::Index>(i)) * Z.row(row).squaredNorm() * sigma * sigma;
        }
      }
    }
    squares.push_back(sum);
  }
  return squares;
}

Ladder::Ladder(const Selection& selection, const Registration& closed_form, int folds, std::uint64_t seed)
    : selection_(selection), closed_form_(closed_form), noise_(noiseSquares(selection.linear)), seed_(seed) {
  const std::size_t groups = selection.measured.groups.size();
  std::vector<std::size_t> order(groups);
  std::iota(order.begin(), order.end(), 0);
  Rng rng(seed);
  for (std::size_t k = groups; k > 1; --k) std::swap(order[k - 1], order[rng.below(k)]);
  const auto count = std::min(groups, static_cast<std::size_t>(std::max(2, folds)));
  folds_.resize(count);
  for (std::size_t k = 0; k < groups; ++k) folds_[k % count].push_back(order[k]);
  for (std::vector<std::size_t>& fold : folds_) std::sort(fold.begin(), fold.end());
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
Rung Ladder::judged(const std::string& stage, Fit fit) const {
  const Groups& groups = selection_.measured.groups;
  Rung rung{stage, std::vector<PoseErrors>(groups.size())};
  for (const std::vector<std::size_t>& fold : folds_) {
    Groups train, test;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      (std::binary_search(fold.begin(), fold.end(), g) ? test : train).push_back(groups[g]);
    }
    const std::pair<ModelState, std::vector<Accepted>> model = fit(train);
    addErrors(linearise(selection_.measured, model.first, model.second, {}, test), test, fold, rung);
  }
  return rung;
}

std::vector<Rung> Ladder::geometricRungs() const {
  const MeasuredCell& measured = selection_.measured;
  ModelState nominal{CellState(measured.start, measured.free), {}};
  nominal.cell.cell.registration = closed_form_;
  std::vector<Rung> rungs;
  rungs.push_back(judged("nominal", [&](const Groups&) { return std::pair(nominal, std::vector<Accepted>{}); }));
  rungs.push_back(judged("registered", [&](const Groups& train) {
    std::vector<Observation> some;
    for (const std::vector<std::size_t>& group : train) {
      for (const std::size_t k : group) some.push_back(measured.observations[k]);
    }
    AdjustmentOptions options;
    options.free = {.near = measured.free.near, .far = measured.free.far};
    ModelState state{CellState(measured.start, measured.free), {}};
    if (options.free.near) state.cell.cell = adjust(measured.start, some, options).cell;
    return std::pair(state, std::vector<Accepted>{});
  }));
  rungs.push_back(rungWith("identified", {}));
  return rungs;
}

Rung Ladder::rungWith(const std::string& stage, const std::vector<std::size_t>& findings) const {
  std::vector<Accepted> accepted;
  for (const std::size_t i : findings) {
    if (selection_.findings[i].accepted) accepted.push_back(*selection_.findings[i].accepted);
  }
  // What a single pose is worth does not hang on which rung it judges: the noise is that of the whole model.
  NoiseEstimate noise = selection_.linear.noise;
  std::vector<std::size_t> scatter;
  for (const FoundEffect& found : selection_.findings) {
    if (found.scatter) scatter.push_back(*found.scatter);
  }
  const bool whole = accepted.size() + scatter.size() == selection_.findings.size();
  const ModelState& start = whole ? selection_.linear.state : selection_.base;
  return judged(stage, [&](const Groups& train) {
    const Linearised linear = refit(selection_.measured, start, accepted, scatter, noise, train, false);
    return std::pair(linear.state, linear.accepted);
  });
}

GapStage Ladder::stageOf(const Rung& rung) const {
  PoseErrors sum;
  MeanSquare mean;
  for (std::size_t g = 0; g < rung.poses.size(); ++g) {
    const PoseErrors& pose = rung.poses[g];
    sum.position += pose.position;
    sum.rotation += pose.rotation;
    sum.targets += pose.targets;
    mean.squares += pose.squares;
    mean.points += pose.points;
    mean.noise += noise_[g];
  }
  GapStage stage;
  stage.stage = rung.stage;
  stage.rms = mean.points > 0.0 ? std::sqrt(mean.squares / mean.points) : 0.0;
  stage.excess = mean.excess();
  stage.position = sum.targets > 0.0 ? std::sqrt(sum.position / sum.targets) : 0.0;
  stage.rotation = sum.targets > 0.0 ? std::sqrt(sum.rotation / sum.targets) : 0.0;
  return stage;
}

Shrinkage Ladder::shrinkage(const Rung& before, const Rung& after) const {
  constexpr int kResamples = 2000;
  const std::size_t count = before.poses.size();
  const auto add = [this](const PoseErrors& pose, std::size_t g, MeanSquare& mean) {
    mean.squares += pose.squares;
    mean.points += pose.points;
    mean.noise += noise_[g];
  };
  MeanSquare b, a;
  for (std::size_t g = 0; g < count; ++g) {
    add(before.poses[g], g, b);
    add(after.poses[g], g, a);
  }
  Shrinkage shrinkage;
  shrinkage.value = ratio(b, a);
  if (!(b.excess() > 0.0)) return shrinkage;
  Rng rng(seed_, 1);
  std::vector<double> values;
  for (int resample = 0; resample < kResamples; ++resample) {
    MeanSquare rb, ra;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t g = rng.below(count);
      add(before.poses[g], g, rb);
      add(after.poses[g], g, ra);
    }
    values.push_back(ratio(rb, ra));
  }
  shrinkage.interval = {quantile(values, 0.025), quantile(values, 0.975)};
  return shrinkage;
}

double Ladder::noiseRms() const {
  double noise = std::accumulate(noise_.begin(), noise_.end(), 0.0), points = 0.0;
  for (const std::vector<std::size_t>& group : selection_.measured.groups) {
    for (const std::size_t k : group) points += selection_.measured.observations[k].unitCount();
  }
  return points > 0.0 ? std::sqrt(noise / points) : 0.0;
}

}  // namespace poecal
