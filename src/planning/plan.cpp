#include "poecal/planning/plan.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>

#include <fmt/format.h>

#include "cell/visible_poses.hpp"
#include "planning/aims.hpp"
#include "planning/pool.hpp"
#include "planning/questions.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

constexpr int kWorkspace = 200;        ///< postures of the mean over the workspace
constexpr std::size_t kSequences = 5;  ///< of random poses, of which the median is told
constexpr int kMostRandom = 10;        ///< times the poses of the plan: beyond that it is only said that more are needed

Eigen::MatrixXd squaresOf(const std::vector<WhiteRows>& poses, Eigen::Index columns) {
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(columns, columns);
  for (const WhiteRows& rows : poses) squares += rows.leftCols(columns).transpose() * rows.leftCols(columns);
  return squares;
}

std::shared_ptr<const std::vector<WhiteRows>> condensedRows(std::vector<WhiteRows> rows) {
  for (WhiteRows& each : rows) each = condensed(std::move(each));
  return std::make_shared<const std::vector<WhiteRows>>(std::move(rows));
}

/// The tool over the workspace.
class Workspace {
 public:
  Workspace(const Knowledge& knowledge, const std::vector<Sample>& samples)
      : position_(Eigen::MatrixXd::Zero(knowledge.columns(), knowledge.columns())), rotation_(position_) {
    for (const Eigen::MatrixXd& moves : knowledge.tool(samples)) {
      rotation_ += moves.topRows<3>().transpose() * moves.topRows<3>() / static_cast<double>(samples.size());
      position_ += moves.bottomRows<3>().transpose() * moves.bottomRows<3>() / static_cast<double>(samples.size());
    }
  }
  ToolUncertainty of(const Eigen::MatrixXd& covariance) const {
    return {std::sqrt(position_.cwiseProduct(covariance).sum()), std::sqrt(rotation_.cwiseProduct(covariance).sum())};
  }
  const Eigen::MatrixXd& position() const { return position_; }

 private:
  Eigen::MatrixXd position_, rotation_;
};

void requireCamera(const PlanningCell& cell) {
  if (!cell.model.cell.arm || !cell.nominal.arm) throw InvalidArgument("a plan needs an arm");
  if (!cell.model.cell.camera || !cell.nominal.camera)
    throw InvalidArgument("a plan needs a camera: poses of an instrument cannot be planned");
}

std::vector<Sample> candidatesOf(const Pool& pool, const PlanOptions& options, Plan& plan) {
  Progress told(options.progress, "looking for postures that show the target", static_cast<std::size_t>(options.candidates));
  std::vector<Sample> candidates = pool.visible(PoolPurpose::kCandidates, 0, options.candidates, &plan.drawn, &told);
  plan.visible = static_cast<int>(candidates.size());
  if (plan.visible < options.count) {
    throw InsufficientData(fmt::format(
        "only {} of {} random postures within the joint limits show the whole target well, apart from collisions, and {} poses are asked "
        "for; expected camera and target where more postures bring the target before the camera, a camera or target whose place is known "
        "better, or a smaller --link-radius",
        plan.visible, plan.drawn, options.count));
  }
  told.finish();
  return candidates;
}

/// An aim with no pose of the plan in it, and these as candidates.
using AimOf = std::function<std::unique_ptr<Aim>(const std::vector<Sample>&)>;

/// Tells how many random visible poses, in the order in which they were drawn, cost as little as `cost`.
void tellRandomPoses(const Pool& pool, const AimOf& aim_of, const PlanOptions& options, double cost, Plan& plan) {
  const int most = kMostRandom * options.count;
  std::vector<Sample> samples;
  std::vector<std::pair<std::size_t, std::size_t>> sequences;
  Progress drawing(options.progress, "random postures to compare with", kSequences * static_cast<std::size_t>(most));
  for (std::size_t number = 0; number < kSequences; ++number) {
    const std::vector<Sample> random = pool.visible(PoolPurpose::kRandom, number, most, nullptr, &drawing);
    sequences.emplace_back(samples.size(), samples.size() + random.size());
    const int found = static_cast<int>(random.size());
    plan.random_tried = number == 0 ? found : std::min(plan.random_tried, found);  // fewer where hardly any posture shows the target
    samples.insert(samples.end(), random.begin(), random.end());
  }
  drawing.finish();
  const std::unique_ptr<Aim> before = aim_of(samples);
  std::vector<double> counts;
  Progress comparing(options.progress, "comparing with random poses", kSequences);
  comparing.show();
  for (const auto& [begin, end] : sequences) {
    const std::unique_ptr<Aim> aim = before->copy();
    std::size_t next = begin;
    while (next < end && aim->cost() > cost) {
      comparing.show();
      aim->add(next++);
    }
    counts.push_back(aim->cost() > cost ? std::numeric_limits<double>::infinity() : static_cast<double>(next - begin));
    comparing.advance();
  }
  const double middle = median(counts);
  if (std::isfinite(middle)) plan.random_poses = static_cast<int>(middle);
}

/// A cost at which a plan has what it is for.
double enoughFor(const PlanOptions& options) {
  return options.aim == PlanAim::kSeparate ? -std::log(options.odds) : -std::numeric_limits<double>::infinity();
}

std::vector<Sample> chosenOf(const std::vector<Sample>& samples, const std::vector<std::size_t>& chosen) {
  std::vector<Sample> some;
  for (const std::size_t k : chosen) some.push_back(samples[k]);
  return some;
}

/// Poses chosen from the candidates, and then from postures ever nearer to them.
std::vector<Sample> choose(const Pool& pool, const AimOf& aim_of, const std::vector<Sample>& candidates, const PlanOptions& options,
                           Plan& plan) {
  constexpr int kNear = 40;  // variants of each pose
  const double enough = enoughFor(options);
  std::unique_ptr<Aim> aim = aim_of(candidates);
  std::vector<Sample> poses = chosenOf(candidates, choosePoses(*aim, candidates.size(), {}, static_cast<std::size_t>(options.count),
                                                               options.jobs, enough, options.progress));
  std::size_t sequence = 0;
  for (const double share : {0.1, 0.05, 0.025}) {
    const std::vector<Sample> before = poses;
    for (const Sample& pose : before) {
      const std::vector<Sample> variants = pool.near(pose, share, sequence++, kNear);
      poses.insert(poses.end(), variants.begin(), variants.end());
    }
    std::vector<std::size_t> first(before.size());
    std::iota(first.begin(), first.end(), std::size_t{0});
    aim = aim_of(poses);
    poses = chosenOf(poses, choosePoses(*aim, poses.size(), first, first.size(), options.jobs, enough, options.progress));
  }
  tellRandomPoses(pool, aim_of, options, aim->cost(), plan);
  return poses;
}

Detection detectionOf(const ContrastAim& aim) {
  // Found four times in five at an expected chi-square of 36: its root is normal about its expectation.
  const double needed = 6.0 - normalQuantile(0.8);
  const std::vector<double> all = aim.chiSquares();
  const double least = *std::min_element(all.begin(), all.end());
  return {least, 0.5 * std::erfc((needed - std::sqrt(std::max(0.0, least))) / std::sqrt(2.0))};
}

/// What the poses of a plan tell of what it was asked.
void tellAnswer(const Question& question, const std::vector<Sample>& poses, PlanAim kind, Plan& plan) {
  ContrastAim aim(question.contrasts(poses));
  if (kind == PlanAim::kDetect) plan.detection_before = detectionOf(aim);
  for (std::size_t k = 0; k < poses.size(); ++k) aim.add(k);
  if (kind == PlanAim::kDetect) plan.detection_after = detectionOf(aim);
  plan.not_told = question.not_told;
  plan.odds = question.pairs;
  const std::vector<double> chi_squares = aim.chiSquares();
  for (std::size_t i = 0; i < plan.odds.size(); ++i) plan.odds[i].expected = plan.odds[i].before * std::exp(0.5 * chi_squares[i]);
}

void order(const PlanningCell& cell, const std::vector<Sample>& chosen, Plan& plan) {
  std::vector<Eigen::VectorXd> poses;
  for (const Sample& sample : chosen) poses.push_back(sample.q);
  Eigen::VectorXd at = cell.taken.samples.empty() ? Eigen::VectorXd() : cell.taken.samples.back().q;
  for (const std::size_t k : pathOrder(poses, at, readingRanges(*cell.model.cell.arm, cell.robot_file))) {
    const bool known = at.size() == poses[k].size();
    const Eigen::VectorXd straight = known ? Eigen::VectorXd((poses[k] - at).cwiseSign()) : Eigen::VectorXd::Ones(poses[k].size());
    plan.poses.push_back({poses[k], plan.sides_matter ? chosen[k].dir : straight});
    at = poses[k];
  }
}

}  // namespace

void PlanOptions::validate() const {
  constexpr double kLargestSize = 1e6;     // of no effect on any machine, in any of their units
  constexpr int kMostCandidates = 50'000;  // each keeps its rows: some gigabytes
  if (count < 1) throw InvalidArgument(fmt::format("count is {}, expected at least 1", count));
  if (candidates < count)
    throw InvalidArgument(fmt::format("candidates is {}, expected at least the {} poses of the plan", candidates, count));
  if (candidates > kMostCandidates)
    throw InvalidArgument(fmt::format("candidates is {}, expected at most {}", candidates, kMostCandidates));
  if (!(link_radius >= 0.0)) throw InvalidArgument(fmt::format("link_radius is {}, expected 0 or more", link_radius));
  if (!(camera_radius >= 0.0)) throw InvalidArgument(fmt::format("camera_radius is {}, expected 0 or more", camera_radius));
  if (!std::isfinite(link_radius) || !std::isfinite(camera_radius)) throw InvalidArgument("link_radius and camera_radius must be finite");
  if (!(odds > 1.0)) throw InvalidArgument(fmt::format("odds is {}, expected more than 1", odds));
  if (aim == PlanAim::kDetect && !(detect_size > 0.0 && detect_size < kLargestSize))
    throw InvalidArgument(fmt::format("detect_size is {}, expected more than 0 and below {}", detect_size, kLargestSize));
}

Plan planPoses(const PlanningCell& cell, const PlanOptions& options) {
  options.validate();
  requireCamera(cell);
  Plan plan;
  const Pool pool(cell, options);
  plan.link_radius = pool.clearance().linkRadius();
  const std::vector<Sample> candidates = candidatesOf(pool, options, plan);
  const Knowledge knowledge(cell, cell.model.effects);
  for (const AppliedEffect& applied : cell.model.effects)
    plan.sides_matter = plan.sides_matter || applied.effect.driver().kind() == DriverKind::kDirection;
  const Workspace workspace(knowledge, pool.anywhere(kWorkspace));
  const Eigen::MatrixXd before = knowledge.prior().precision + squaresOf(knowledge.taken(), knowledge.columns());
  AimOf aim_of = [&](const std::vector<Sample>& samples) -> std::unique_ptr<Aim> {
    const Eigen::MatrixXd Q = options.criterion == PlanCriterion::kA ? workspace.position() : Eigen::MatrixXd();
    Progress told(options.progress, kShowing, 1);
    told.show();
    std::unique_ptr<Aim> aim = std::make_unique<CertaintyAim>(before, Q, condensedRows(knowledge.expected(samples)));
    told.advance();
    return aim;
  };
  Question question;
  if (options.aim != PlanAim::kTool) {
    question = options.aim == PlanAim::kSeparate ? separation(cell, candidates, options) : detection(cell, candidates, options);
    plan.sides_matter = plan.sides_matter || question.sides_matter;
    aim_of = [&](const std::vector<Sample>& samples) -> std::unique_ptr<Aim> {
      return std::make_unique<ContrastAim>(question.contrasts(samples, options.progress));
    };
  }
  const std::vector<Sample> chosen = choose(pool, aim_of, candidates, options, plan);
  if (options.aim != PlanAim::kTool) tellAnswer(question, chosen, options.aim, plan);
  plan.before = workspace.of(covarianceOf(before));
  plan.after = workspace.of(covarianceOf(before + squaresOf(knowledge.expected(chosen), knowledge.columns())));
  order(cell, chosen, plan);
  return plan;
}

ToolUncertainty toolUncertainty(const PlanningCell& cell, const std::vector<Sample>& more) {
  requireCamera(cell);
  const Knowledge knowledge(cell, cell.model.effects);
  const PlanOptions options;
  const Pool pool(cell, options);
  const Workspace workspace(knowledge, pool.anywhere(kWorkspace));
  const Eigen::Index columns = knowledge.columns();
  return workspace.of(
      covarianceOf(knowledge.prior().precision + squaresOf(knowledge.taken(), columns) + squaresOf(knowledge.expected(more), columns)));
}

std::string planCsv(const Plan& plan, std::size_t taken) {
  const Eigen::Index joints = plan.poses.empty() ? 0 : plan.poses.front().q.size();
  std::vector<std::string> header{"image"};
  for (const char* name : {"q", "dir"}) {
    for (Eigen::Index k = 1; k <= joints; ++k) header.push_back(fmt::format("{}{}", name, k));
  }
  CsvWriter csv(header);
  for (std::size_t i = 0; i < plan.poses.size(); ++i) {
    csv.cell(fmt::format("images/{:04}.png", taken + i));
    for (const double q : plan.poses[i].q) csv.cell(q);
    for (const double dir : plan.poses[i].dir) csv.cell(static_cast<int>(dir));
    csv.endRow();
  }
  return csv.str();
}

}  // namespace poecal
