#include "poecal/planning/plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

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
  std::vector<Sample> candidates = pool.visible(PoolPurpose::kCandidates, 0, options.candidates, &plan.drawn);
  plan.visible = static_cast<int>(candidates.size());
  if (plan.visible < options.count) {
    throw InsufficientData(fmt::format(
        "only {} of {} random postures within the joint limits show the whole target well, apart from collisions, and {} poses are asked "
        "for; expected camera and target where more postures bring the target before the camera, a camera or target whose place is known "
        "better, or a smaller --link-radius",
        plan.visible, plan.drawn, options.count));
  }
  return candidates;
}

/// Candidates, and behind them sequences of random visible poses to hold the plan against.
struct Choice {
  std::vector<Sample> samples;
  std::size_t candidates = 0;
  std::vector<std::pair<std::size_t, std::size_t>> sequences;  ///< [begin, end)
};

Choice choiceOf(const Pool& pool, const PlanOptions& options, Plan& plan) {
  Choice choice;
  choice.samples = candidatesOf(pool, options, plan);
  choice.candidates = choice.samples.size();
  plan.random_tried = kMostRandom * options.count;
  for (std::size_t sequence = 0; sequence < kSequences; ++sequence) {
    const std::vector<Sample> random = pool.visible(PoolPurpose::kRandom, sequence, plan.random_tried);
    const std::size_t begin = choice.samples.size();
    choice.samples.insert(choice.samples.end(), random.begin(), random.end());
    choice.sequences.emplace_back(begin, choice.samples.size());
  }
  return choice;
}

/// How many random visible poses, in the order in which they were drawn, cost as little as `cost`.
std::optional<int> randomPosesFor(const Aim& before, const Choice& choice, double cost) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::vector<double> counts;
  for (const auto& [begin, end] : choice.sequences) {
    const std::unique_ptr<Aim> aim = before.copy();
    std::size_t next = begin;
    while (next < end && aim->cost() > cost) aim->add(next++);
    counts.push_back(aim->cost() > cost ? kNever : static_cast<double>(next - begin));
  }
  const double middle = median(counts);
  return std::isfinite(middle) ? std::optional(static_cast<int>(middle)) : std::nullopt;
}

/// A cost at which a plan has what it is for.
double enoughFor(const PlanOptions& options) {
  return options.aim == PlanAim::kSeparate ? -std::log(options.odds) : -std::numeric_limits<double>::infinity();
}

Detection detectionOf(const ContrastAim& aim) {
  // Found four times in five at an expected chi-square of 36: its root is normal about its expectation.
  const double needed = 6.0 - normalQuantile(0.8);
  const std::vector<double> all = aim.chiSquares();
  const double least = *std::min_element(all.begin(), all.end());
  return {least, 0.5 * std::erfc((needed - std::sqrt(std::max(0.0, least))) / std::sqrt(2.0))};
}

/// Chooses for what the plan is for, and tells how far it gets there.
std::vector<std::size_t> choose(Aim& aim, const Choice& choice, const PlanOptions& options, Plan& plan) {
  const std::unique_ptr<Aim> before = aim.copy();
  std::vector<std::size_t> chosen =
      choosePoses(aim, choice.candidates, static_cast<std::size_t>(options.count), options.jobs, enoughFor(options));
  plan.random_poses = randomPosesFor(*before, choice, aim.cost());
  return chosen;
}

std::vector<std::size_t> chooseFor(const Question& question, const Choice& choice, const PlanOptions& options, Plan& plan) {
  ContrastAim aim(question.contrasts);
  plan.sides_matter = plan.sides_matter || question.sides_matter;
  plan.not_told = question.not_told;
  if (options.aim == PlanAim::kDetect) plan.detection_before = detectionOf(aim);
  const std::vector<std::size_t> chosen = choose(aim, choice, options, plan);
  if (options.aim == PlanAim::kDetect) plan.detection_after = detectionOf(aim);
  plan.odds = question.pairs;
  const std::vector<double> chi_squares = aim.chiSquares();
  for (std::size_t i = 0; i < plan.odds.size(); ++i) plan.odds[i].expected = plan.odds[i].before * std::exp(0.5 * chi_squares[i]);
  return chosen;
}

void order(const PlanningCell& cell, const std::vector<Sample>& candidates, const std::vector<std::size_t>& chosen, Plan& plan) {
  std::vector<Eigen::VectorXd> poses;
  for (const std::size_t k : chosen) poses.push_back(candidates[k].q);
  Eigen::VectorXd at = cell.taken.samples.empty() ? Eigen::VectorXd() : cell.taken.samples.back().q;
  for (const std::size_t k : pathOrder(poses, at, readingRanges(*cell.model.cell.arm, cell.robot_file))) {
    const Eigen::VectorXd straight =
        at.size() == poses[k].size() ? Eigen::VectorXd((poses[k] - at).cwiseSign()) : Eigen::VectorXd::Ones(poses[k].size());
    plan.poses.push_back({poses[k], plan.sides_matter ? candidates[chosen[k]].dir : straight});
    at = poses[k];
  }
}

}  // namespace

void PlanOptions::validate() const {
  if (count < 1) throw InvalidArgument(fmt::format("count is {}, expected at least 1", count));
  if (candidates < count)
    throw InvalidArgument(fmt::format("candidates is {}, expected at least the {} poses of the plan", candidates, count));
  if (!(link_radius >= 0.0)) throw InvalidArgument(fmt::format("link_radius is {}, expected 0 or more", link_radius));
  if (!(camera_radius >= 0.0)) throw InvalidArgument(fmt::format("camera_radius is {}, expected 0 or more", camera_radius));
  if (!(odds > 1.0)) throw InvalidArgument(fmt::format("odds is {}, expected more than 1", odds));
  if (aim == PlanAim::kDetect && !(detect_size > 0.0))
    throw InvalidArgument(fmt::format("detect_size is {}, expected more than 0", detect_size));
}

Plan planPoses(const PlanningCell& cell, const PlanOptions& options) {
  options.validate();
  requireCamera(cell);
  Plan plan;
  const Pool pool(cell, options);
  plan.link_radius = pool.clearance().linkRadius();
  const Choice choice = choiceOf(pool, options, plan);
  const Knowledge knowledge(cell, cell.model.effects);
  for (const AppliedEffect& applied : cell.model.effects)
    plan.sides_matter = plan.sides_matter || applied.effect.driver().starts_with("dir");
  const Workspace workspace(knowledge, pool.anywhere(kWorkspace));
  CertaintyAim certainty(knowledge.prior().precision + squaresOf(knowledge.taken(), knowledge.columns()),
                         options.criterion == PlanCriterion::kA ? workspace.position() : Eigen::MatrixXd(),
                         condensedRows(knowledge.expected(choice.samples)));
  plan.before = workspace.of(certainty.covariance());
  std::vector<std::size_t> chosen;
  if (options.aim == PlanAim::kTool) {
    chosen = choose(certainty, choice, options, plan);
  } else {
    const Question question =
        options.aim == PlanAim::kSeparate ? separation(cell, choice.samples, options.odds) : detection(cell, choice.samples, options);
    chosen = chooseFor(question, choice, options, plan);
    for (const std::size_t k : chosen) certainty.add(k);
  }
  plan.after = workspace.of(certainty.covariance());
  order(cell, choice.samples, chosen, plan);
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
