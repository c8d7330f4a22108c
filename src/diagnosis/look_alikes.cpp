#include "diagnosis/look_alikes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include <fmt/format.h>

namespace poecal {
namespace {

/// A joint's errors as single shots show them, beside all other noise.
struct JointErrors {
  std::vector<double> error, deviation;
  std::vector<std::size_t> group;
};

JointErrors jointErrors(const Selection& selection, std::size_t joint) {
  const Linearised& linear = selection.linear;
  const Eigen::VectorXd r = linear.residual();
  Eigen::VectorXd theta = linear.noise.theta;
  for (std::size_t i = 0; i < linear.components.size(); ++i) {
    if (linear.components[i].name == scatterName(joint)) theta(static_cast<Eigen::Index>(i)) = 0.0;
  }
  const Whitening whitening(linear.rows, linear.components, theta);
  JointErrors errors;
  for (std::size_t g = 0; g < linear.rows.groups.size(); ++g) {
    const int begin = whitening.begin(g), size = whitening.size(g);
    for (const std::size_t k : linear.rows.groups[g]) {
      const ObservationRows& part = linear.rows.observations[k];
      Eigen::VectorXd column = Eigen::VectorXd::Zero(size), own = column;
      column.segment(part.begin - begin, part.size) = part.rows.H * part.ports.joints.col(static_cast<Eigen::Index>(joint));
      own.segment(part.begin - begin, part.size) = r.segment(part.begin, part.size);
      const Eigen::VectorXd w = whitening.applyTo(g, column);
      const double information = w.squaredNorm();
      if (!(information > 0.0)) continue;
      errors.error.push_back(w.dot(whitening.applyTo(g, own).col(0)) / information);
      errors.deviation.push_back(1.0 / std::sqrt(information));
      errors.group.push_back(g);
    }
  }
  return errors;
}

/// Variance of a joint's errors among the shots of one pose, beyond their deviations; nothing where there are too few.
std::optional<double> varianceAmongRepeats(const JointErrors& errors) {
  double squares = 0.0, expected = 0.0, freedom = 0.0;
  for (std::size_t begin = 0, end = 0; begin < errors.error.size(); begin = end) {
    double sum = 0.0, own = 0.0, noise = 0.0;
    for (end = begin; end < errors.error.size() && errors.group[end] == errors.group[begin]; ++end) {
      sum += errors.error[end];
      own += errors.error[end] * errors.error[end];
      noise += errors.deviation[end] * errors.deviation[end];
    }
    const auto shots = static_cast<double>(end - begin);
    squares += own - sum * sum / shots;
    expected += noise * (shots - 1.0) / shots;
    freedom += shots - 1.0;
  }
  constexpr double kFewest = 8.0;
  if (freedom < kFewest) return {};
  return std::max(0.0, squares - expected) / freedom;
}

// What tells structure from a joint that moves at random.
constexpr const char* kTakeAgain = "the same poses taken again after other ones: what differs then is random, what does not is structure";

/// Gives others a share of a finding's probability. @param weight  of the other one, where the finding's own is 1.
struct Sharing {
  Finding& finding;
  double total = 1.0;
  std::vector<AlternativeCause> others = {};

  void add(const std::string& effect, const std::string& location, const std::string& driver, double weight) {
    const bool there = std::any_of(finding.alternatives.begin(), finding.alternatives.end(), [&](const AlternativeCause& other) {
      return other.effect == effect && other.location == location && other.probability >= weight * finding.probability;
    });
    if (there || !(weight > 0.0)) return;
    std::erase_if(finding.alternatives,
                  [&](const AlternativeCause& other) { return other.effect == effect && other.location == location; });
    others.push_back({effect, location, driver, weight});
    total += weight;
  }

  /// @param way  what would tell them apart.
  void share(const std::string& way) {
    if (others.empty()) return;
    for (AlternativeCause& other : others) {
      other.probability *= finding.probability / total;
      finding.alternatives.push_back(other);
    }
    finding.probability /= total;
    std::stable_sort(finding.alternatives.begin(), finding.alternatives.end(),
                     [](const AlternativeCause& a, const AlternativeCause& b) { return a.probability > b.probability; });
    if (way.empty() || finding.separate_with.find(way) != std::string::npos) return;
    finding.separate_with += (finding.separate_with.empty() ? "" : "; or ") + way;
  }
};

std::string allJoints(const Selection& selection) {
  std::string names;
  for (std::size_t k = 0; k < selection.measured.start.arm->joints.size(); ++k) names += fmt::format("{}q{}", k > 0 ? "," : "", k + 1);
  return names;
}

/// The name of what is more probable goes first: play, or structure that repeats show to be no chance.
void putMostProbableFirst(double half_gap, bool repeated, Finding& finding) {
  if (finding.alternatives.empty() || !(finding.alternatives.front().probability > finding.probability)) return;
  AlternativeCause& best = finding.alternatives.front();
  const bool play = best.effect == "joint_backlash";
  if (!play && !(repeated && best.effect == kUnknownEffect && best.location == finding.location)) return;
  const AlternativeCause former{finding.effect, finding.location, finding.driver, finding.probability};
  finding.effect = best.effect;
  finding.driver = best.driver;
  finding.probability = best.probability;
  finding.remedy.clear();
  if (play) {
    finding.parameters = {{"half_gap", half_gap}};
    finding.units = {{"half_gap", finding.units["sigma"]}};
    finding.remedy = effectKind(finding.effect).remedy;
  }
  best = former;
}

void shareScatter(const Selection& selection, std::size_t joint, const RowOrder& row_order, Finding& finding) {
  const JointErrors errors = jointErrors(selection, joint);
  Sharing sharing{finding};
  constexpr double kSame = 0.5;
  double finer = kSame;
  if (comesBack(selection.measured)) {
    // What differs each time that the arm comes back is no function of where it stands.
    const double variance = finding.parameters["sigma"] * finding.parameters["sigma"];
    const std::optional<double> among = varianceAmongRepeats(errors);
    if (among) finer = *among > 0.5 * variance ? 0.0 : kSame * std::exp(std::min(5.0, variance / std::max(*among, 0.01 * variance)));
  }
  sharing.add(kUnknownEffect, finding.location, allJoints(selection), finer);
  std::string way = kTakeAgain;
  double half_gap = 0.0;
  if (row_order.dir) {
    const TwoValues two =
        twoValues(Eigen::Map<const Eigen::VectorXd>(errors.error.data(), static_cast<Eigen::Index>(errors.error.size())),
                  Eigen::Map<const Eigen::VectorXd>(errors.deviation.data(), static_cast<Eigen::Index>(errors.error.size())));
    half_gap = two.size;
    constexpr double kBefore = 0.3, kMost = 5.0;  // play from a side that the order of the rows does not tell
    sharing.add("joint_backlash", finding.location, fmt::format("dir{}", joint + 1),
                kBefore * std::exp(std::clamp(two.log_odds, -kMost, kMost)));
    way += "; record dir1.. (the side that each joint came from)";
  }
  if (row_order.stamp) {
    constexpr double kOutOfOrder = 0.05;  // rows that are not in the order taken
    sharing.add("joint_slip", finding.location, "stamp", kOutOfOrder);
    way += "; record stamp";
  }
  sharing.share(way);
  putMostProbableFirst(half_gap, comesBack(selection.measured), finding);
}

/// What the capture lacks a column for, where the catalogue says that it would look like the finding.
void shareUntested(const Selection& selection, Finding& finding) {
  const EffectKind* kind = findEffectKind(finding.effect);
  if (kind == nullptr) return;
  Sharing sharing{finding};
  std::string ways;
  for (const NotTestable& each : selection.not_testable) {
    constexpr std::string_view kNo = "no ";
    const bool column = each.why.starts_with(kNo) && each.why.find("column") != std::string::npos;
    const EffectKind* other = findEffectKind(each.effect);
    if (!column || other == nullptr) continue;
    const auto names = [](const EffectKind& a, const EffectKind& b) {
      return std::find(a.confused_with.begin(), a.confused_with.end(), b.name) != a.confused_with.end();
    };
    const bool elsewhere = each.location.find(':') != std::string::npos && finding.location.find(':') != std::string::npos &&
                           each.location != finding.location;
    if (elsewhere || !(names(*kind, *other) || names(*other, *kind))) continue;
    constexpr double kUntested = 0.1;
    sharing.add(each.effect, each.location, other->drivers.front(), kUntested);
    const std::string way = "record " + each.why.substr(kNo.size());
    if (ways.find(way) == std::string::npos) ways += (ways.empty() ? "" : "; ") + way;
  }
  sharing.share(ways);
}

/// A compliance of unknown masses: the joint and the link before it bend with the same moments about the same axis; and so does the base
/// where that is the first link, which mostly stands upright.
void shareMasses(const Selection& selection, std::size_t joint, Finding& finding) {
  if (joint == 0 || !selection.measured.start.arm->links.empty()) return;
  constexpr double kSame = 0.9;
  Sharing sharing{finding};
  const auto share = [&](const char* effect, const std::string& location, const std::string& driver) {
    if (finding.effect != effect) sharing.add(effect, location, driver, kSame);
  };
  const bool any = joint < selection.measured.start.arm->joints.size();  // after the last link there is none
  if (any) share("joint_compliance", fmt::format("joint:{}", joint + 1), fmt::format("tau{}", joint + 1));
  share("link_bending", fmt::format("link:{}", joint), "gravity");
  if (joint == 1 && finding.effect != "joint_compliance") share("base_compliance", "base", "gravity");
  sharing.share("state the links' masses in the robot's file");
}

/// What a joint drives at a mount, where the capture went through its readings in order: time drives the same.
void shareTime(const Selection& selection, Finding& finding) {
  if (!selection.ordered_by) return;
  const std::string reading = fmt::format("q{}", *selection.ordered_by + 1);
  if (finding.driver != reading || finding.location == fmt::format("joint:{}", *selection.ordered_by + 1)) return;
  constexpr double kSame = 0.9;
  Sharing sharing{finding};
  sharing.add(kUnknownEffect, finding.location, "stamp", kSame);
  sharing.share(fmt::format("poses in an order that does not follow {}, and record stamp", reading));
}

/// Structure that was taken before a joint that moves at random: what it does not follow of the joint's errors speaks for the other as much
/// as for structure finer than the poses.
void shareStructure(Finding& finding) {
  constexpr double kSame = 0.5;
  for (AlternativeCause& other : finding.alternatives) {
    if (other.effect != "joint_scatter" || other.location != finding.location || other.probability <= kSame * finding.probability) continue;
    const double both = finding.probability + other.probability;
    finding.probability = both / (1.0 + kSame);
    other.probability = both - finding.probability;
    finding.separate_with = kTakeAgain;
  }
  std::stable_sort(finding.alternatives.begin(), finding.alternatives.end(),
                   [](const AlternativeCause& a, const AlternativeCause& b) { return a.probability > b.probability; });
}

double logNormal(double x, double variance) { return -0.5 * (std::log(variance) + x * x / variance); }

}  // namespace

bool comesBack(const MeasuredCell& measured) {
  return std::any_of(measured.groups.begin(), measured.groups.end(),
                     [](const std::vector<std::size_t>& shots) { return !shots.empty() && shots.back() - shots.front() >= shots.size(); });
}

TwoValues twoValues(const Eigen::VectorXd& errors, const Eigen::VectorXd& deviations) {
  const double spread = std::sqrt(errors.squaredNorm() / std::max<double>(1.0, static_cast<double>(errors.size())));
  TwoValues best{-std::numeric_limits<double>::infinity(), 0.0};
  double normal = -std::numeric_limits<double>::infinity();
  constexpr int kSizes = 60;
  for (int i = 1; i <= kSizes; ++i) {
    const double b = 2.0 * spread * i / kSizes;
    double two = 0.0, one = 0.0;
    for (Eigen::Index k = 0; k < errors.size(); ++k) {
      const double variance = deviations(k) * deviations(k), d = std::abs(errors(k));
      two += logNormal(d - b, variance) + std::log1p(std::exp(-2.0 * d * b / variance)) - std::log(2.0);
      one += logNormal(d, b * b + variance);
    }
    normal = std::max(normal, one);
    if (two > best.log_odds) best = {two, b};
  }
  if (errors.size() == 0 || !(spread > 0.0)) return {};
  best.log_odds -= normal;
  return best;
}

void addLookAlikes(const Selection& selection, const FoundEffect& found, const RowOrder& row_order, Finding& finding) {
  if (found.scatter) shareScatter(selection, *found.scatter, row_order, finding);
  if (found.accepted && found.accepted->candidate.known() && found.accepted->candidate.effect->kind().yields_to_gravity) {
    const Effect& effect = *found.accepted->candidate.effect;
    const bool link = effect.name() == "link_bending";
    shareMasses(selection, effect.name() == "base_compliance" ? 1 : effect.index() + (link ? 1 : 0), finding);
  }
  if (found.accepted && !found.accepted->candidate.known()) {
    shareStructure(finding);
    shareTime(selection, finding);
  }
  if (!found.scatter) shareUntested(selection, finding);
}

}  // namespace poecal
