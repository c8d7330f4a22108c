#include "registration/plausibility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "poecal/core/statistics.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/registration/implausible.hpp"
#include "registration/mistakes.hpp"
#include "registration/moved_once.hpp"
#include "registration/row_order.hpp"
#include "registration/stuck_readings.hpp"
#include "registration/target_size.hpp"
#include "registration/wrong_rows.hpp"

namespace poecal {

double mirroredShare(const std::vector<Observation>& observations) {
  int whole = 0, mirrored = 0;
  for (const Observation& observation : observations) {
    std::map<int, std::map<int, Eigen::Vector2d>> tags;
    for (const CornerMeasurement& corner : observation.corners) {
      if (corner.id.tag >= 0) tags[corner.id.tag][corner.id.corner] = corner.px;
    }
    for (const auto& [tag, corners] : tags) {
      if (corners.size() != 4) continue;
      double twice_area = 0.0;
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector2d& a = corners.at(k);
        const Eigen::Vector2d& b = corners.at((k + 1) % 4);
        twice_area += a.x() * b.y() - a.y() * b.x();
      }
      ++whole;
      mirrored += twice_area > 0.0;  // v points down: clockwise to the eye is positive
    }
  }
  return whole > 0 ? static_cast<double>(mirrored) / whole : 0.0;
}

namespace {

// A cell whose registration leaves less than this of what random pairings leave is taken as it is: nominal arms leave a per cent or two.
constexpr double kSuspicious = 0.04;
// Half of what random pairings leave: then readings and pictures have next to nothing to do with each other.
constexpr double kHopeless = 0.5;
// With the arm's axes free effects of any size leave up to seven per cent (190 cells of the withheld world, raw errors to 100 px).
constexpr double kHopelessOfArms = 0.2;
// Poses of the flange have no gains and no zeros that are off: nominal arms leave a per cent or two of it, soft and worn ones some more.
constexpr double kHopelessOfPoses = 0.2;
// A mistake explains a registration where undoing it leaves this share, and less of what random pairings leave than this.
constexpr double kMends = 0.3;
constexpr double kMendedOfChance = 0.15;
// With the arm's axes free, what is left is the pictures' and what the arm has besides its geometry.
constexpr double kMendsCalibrated = 0.2;
// An arm that deviates by more sigma of a loose arm than this is looked at for a mistake, whatever its fit explains.
constexpr double kOtherArm = 3.0;
// Times the pictures' own floor: within it there is nothing to explain.
constexpr double kNothing = 3.0;
// Rows beside the pictures of others, or of a camera that stood elsewhere: so many rows beyond kBeside.
constexpr double kManyBeside = 0.2;
// Two registrations leave no more rows beside them than this, and no more in the others than this many times what one leaves in most rows.
constexpr double kFewBeside = 0.1;
constexpr double kAsMostRows = 2.0;
// Of two mistakes that explain as much with the arm's errors taken out, the share of the other's misfit at which one stands before it.
constexpr double kFarBetter = 0.5;
constexpr std::size_t kRefined = 12;

struct Suspicion {
  std::string text;
  InputPart part = InputPart::kSamples;
  std::optional<std::size_t> sample;
  double misfit = 0.0, calibrated = 0.0;
  std::string left;        ///< misfit with its unit
  std::string other = {};  ///< another mistake that explains as much
};

const char* misfitUnit(const Observation& observation) { return observation.pose ? "of their deviations" : "px"; }

/// "0.11 px", or of poses "0.05 mm and 0.2 mrad".
std::string leftText(const Problem& problem, const Registration& registration, double misfit) {
  if (!problem.observations.front().pose) return std::isfinite(misfit) ? fmt::format("{:.4g} px", misfit) : "no pixel";
  std::vector<double> ways, turns;
  for (const HypothesisSample& sample : problem.samples) {
    const Eigen::Isometry3d modelled = registration.T_camera_near * sample.T_near_far * registration.T_far_target;
    const Eigen::Isometry3d& measured = problem.observations[sample.observation].pose->T_camera_target;
    ways.push_back((measured.translation() - modelled.translation()).norm());
    turns.push_back(rotationAngle(modelled.linear().transpose() * measured.linear()));
  }
  if (problem.observations.front().pose->position_only) return fmt::format("{:.4g} mm", 1e3 * median(ways));
  return fmt::format("{:.4g} mm and {:.3g} mrad", 1e3 * median(ways), 1e3 * median(turns));
}

/// @param misfit  of the registration as it stands.
std::vector<Mistake> mistakesOf(const Problem& few, const std::vector<Observation>& observations, double misfit) {
  // Corners that fit with a pose of their own in each picture are in order, or turned with their target, which the registration takes up.
  const bool in_order = freeMisfit(few.samples) <= kMends * misfit;
  std::vector<Mistake> all;
  for (std::vector<Mistake>& kind :
       std::array{unitMistakes(few), setupMistakes(few), poseMistakes(few), jointMistakes(few), orderMistakes(few, observations),
                  in_order ? std::vector<Mistake>{} : cornerMistakes(few), lensMistakes(few)}) {
    std::move(kind.begin(), kind.end(), std::back_inserter(all));
  }
  return all;
}

Suspicion suspicionOf(const std::string& text, std::optional<std::size_t> sample, double misfit, const Problem& few) {
  return {text, InputPart::kSamples, sample, misfit, misfit, fmt::format("{:.4g} {}", misfit, misfitUnit(few.observations.front()))};
}

Suspicion suspicionOf(const MispairedRows& rows, const Problem& few) { return suspicionOf(rows.text, rows.sample, rows.misfit, few); }

Suspicion suspicionOf(const MovedOnce& moved, const Problem& few) {
  return suspicionOf("from about this row on the camera or the target stands elsewhere than before: expected a capture in which both stay",
                     moved.sample, moved.misfit, few);
}

/// The search over single mistakes in one capture.
class MistakeSearch {
 public:
  MistakeSearch(const Problem& few, const Registration& registration, double misfit, double chance)
      : few_(few), misfit_(misfit), chance_(chance), calibrated_(calibrate(few, registration)), moved_(findMove(few)) {
    if (moved_ && !explains(moved_->misfit)) moved_.reset();
  }

  /// A camera or target that was moved once explains it, and no mistake does so clearly better.
  std::optional<MovedOnce> moved() const {
    return moved_ && !(best_ && best_->misfit < kClearlyBetter * moved_->misfit) ? moved_ : std::nullopt;
  }

  /// The arm's own errors explain everything, down to such a misfit.
  bool armExplains(double misfit) const { return calibrated_.misfit <= misfit && calibrated_.deviation <= kOtherArm; }

  /// With the arm's own errors taken out no more is left than this share of what random pairings leave.
  bool armExplainsTo(double share) const { return few_.cell.arm && calibrated_.misfit <= share * chance_; }

  /// Every mistake by its hypotheses alone; the best of them adjusted.
  void tryAll(const std::vector<Mistake>& mistakes) {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t k = 0; k < mistakes.size(); ++k) {
      Problem altered = few_;
      mistakes[k].undo(altered);
      if (!keepsMost(altered, few_)) continue;
      order.emplace_back(quickMisfit(altered), k);
    }
    std::stable_sort(order.begin(), order.end());
    order.resize(std::min(order.size(), kRefined));
    // Simple mistakes stand before others.
    std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    for (const auto& [quick, k] : order) {
      if (!std::isfinite(quick)) continue;
      Problem altered = few_;
      mistakes[k].undo(altered);
      consider(altered, mistakes[k].text, mistakes[k].part);
    }
  }

  /// Sizes of the target from half to twice the stated one, beyond what an arm's lengths may err.
  void trySizes() {
    if (few_.observations.front().pose) return;
    constexpr double kStep = 0.04, kFrom = -0.8, kNear = 0.1;
    double best = std::numeric_limits<double>::infinity(), at = 0.0;
    for (double log_size = kFrom; log_size < -kFrom + 0.5 * kStep; log_size += kStep) {
      if (std::abs(log_size) < kNear) continue;
      Problem scaled = few_;
      scaleTarget(scaled, std::exp(log_size));
      const double quick = quickMisfit(scaled);
      if (quick < best) {
        best = quick;
        at = log_size;
      }
    }
    Problem scaled = few_;
    scaleTarget(scaled, std::exp(at));
    const std::optional<Consensus> found = solve(scaled, 2);
    const std::optional<TargetSize> size = found ? fitTargetSize(scaled, found->fit.cell.registration) : std::nullopt;
    if (!size || std::abs(std::log(size->factor) + at) < kNear) return;
    scaleTarget(scaled, size->factor);
    consider(scaled, sizeText(std::exp(at) * size->factor, std::exp(at) * size->deviation), InputPart::kTarget);
  }

  void considerRows(const MispairedRows& rows) {
    if (explains(rows.misfit)) keep(suspicionOf(rows, few_));
  }

  const std::optional<Suspicion>& best() const { return best_; }

 private:
  bool explains(double misfit) const { return std::isfinite(misfit) && misfit <= kMends * misfit_ && misfit <= kMendedOfChance * chance_; }

  void consider(const Problem& altered, const std::string& text, InputPart part) {
    const std::optional<Consensus> found = solve(altered, 2);
    if (!found || !(found->misfit < misfit_)) return;
    const Registration& registration = found->fit.cell.registration;
    const double calibrated = calibrate(altered, registration).misfit;
    const bool arm_explains_rest = few_.cell.arm && std::isfinite(calibrated) && calibrated <= kMendsCalibrated * calibrated_.misfit &&
                                   calibrated <= kSuspicious * chance_;
    const bool alone = explains(found->misfit);
    if (!alone && !arm_explains_rest) return;
    std::string left = leftText(altered, registration, found->misfit);
    if (!alone)
      left += fmt::format(", and to {:.3g} {} if the robot is not that of its file,", calibrated, misfitUnit(few_.observations.front()));
    keep({text, part, std::nullopt, found->misfit, calibrated, left});
  }

  /// The earlier one stays unless another is clearly better: by what is left with the arm's errors taken out, and among equals before that.
  void keep(Suspicion suspicion) {
    const auto left = [&](const Suspicion& one) { return few_.cell.arm ? one.calibrated : one.misfit; };
    const bool as_good = best_ && left(suspicion) <= kAsGood * left(*best_);
    if (!best_ || left(suspicion) < kClearlyBetter * left(*best_) || (as_good && suspicion.misfit < kFarBetter * best_->misfit)) {
      best_ = std::move(suspicion);
    } else if (as_good && suspicion.misfit < kAsGood * best_->misfit && best_->other.empty()) {
      best_->other = suspicion.text;
    }
  }

  const Problem& few_;
  double misfit_, chance_;
  Calibrated calibrated_;
  std::optional<MovedOnce> moved_;
  std::optional<Suspicion> best_;
};

/// Number of samples far beyond the median.
std::size_t countBeside(const Consensus& found, const std::vector<HypothesisSample>& samples, const Misfit& misfit) {
  return static_cast<std::size_t>(std::count_if(samples.begin(), samples.end(), [&](const HypothesisSample& sample) {
    return !(misfit(found.fit.cell.registration, sample) <= kBeside * found.misfit);
  }));
}

[[noreturn]] void refuse(const Suspicion& suspicion, const std::string& stated) {
  throw ImplausibleCapture(
      fmt::format("{} (put right, it fits to {} instead of {}{})", suspicion.text, suspicion.left, stated, asLikely(suspicion.other)),
      suspicion.part, suspicion.sample);
}

[[noreturn]] void refuse(const WrongRows& wrong, const std::vector<Observation>& observations) {
  const char* unit = misfitUnit(observations.front());
  const std::string before = std::isfinite(wrong.before) ? fmt::format("{:.3g} {}", wrong.before, unit) : "no pixel";
  throw ImplausibleCapture(fmt::format("{} (put right, these rows leave {:.3g} {} instead of {})", wrong.text, wrong.misfit, unit, before),
                           InputPart::kSamples, wrong.sample);
}

[[noreturn]] void refuse(const StuckReadings& stuck, const std::vector<Observation>& observations) {
  throw ImplausibleCapture(fmt::format("{} (these rows leave {:.3g} {}, the others {:.3g})", stuck.text, stuck.misfit,
                                       misfitUnit(observations.front()), stuck.others),
                           InputPart::kSamples, stuck.sample);
}

}  // namespace

std::string sizeText(double factor, double deviation) {
  const bool margin = std::abs(factor - 0.8) < 0.03;
  return fmt::format("the target is {:.3f} +- {:.3f} of its stated size{}", factor, deviation,
                     margin ? " (white margin measured too?)" : "");
}

void requirePlausible(const Cell& cell, const std::vector<Observation>& observations, const std::vector<HypothesisSample>& samples,
                      const Consensus& found) {
  const double floor = kNothing * freeMisfit(samples);
  if (const std::optional<StuckReadings> stuck = findStuckReadings(cell, observations, samples)) refuse(*stuck, observations);
  const std::size_t rows_beside = countBeside(found, samples, misfitIn(cell, observations));
  const bool beside = static_cast<double>(rows_beside) > kManyBeside * static_cast<double>(samples.size());
  if (rows_beside == 0 && found.misfit <= floor) return;
  const Problem few = thinned(cell, observations, samples, kSearchedRows);
  const std::optional<WrongRows> wrong = findWrongRows(cell, observations, samples, found.fit.cell.registration, few);
  // Rows that still leave much of what random pairings do were not put right: all the others are wrong too.
  if (wrong && !(wrong->misfit > kMendedOfChance * chanceMisfit(few))) refuse(*wrong, observations);
  if (!beside && found.misfit <= floor) return;
  // Fewer poses fit any pictures.
  if (few.observations.size() < 4) return;
  double chance = chanceMisfit(few);
  // Random pairings that show no pixel at all say nothing of one that shows some.
  if (!std::isfinite(chance)) chance = found.misfit;
  const std::string stated = leftText(few, found.fit.cell.registration, found.misfit);
  const bool suspicious = found.misfit >= kSuspicious * chance;
  if (!beside && !suspicious) return;
  const std::optional<MispairedRows> mispaired = findMispairedRows(cell, observations, samples, few);
  if (!suspicious) {
    if (mispaired) refuse(suspicionOf(*mispaired, few), stated);
    // With an arm it is an effect like others, which a diagnosis names.
    const std::optional<MovedOnce> moved = cell.arm ? std::nullopt : findMove(few);
    if (moved && moved->beside < kFewBeside && moved->misfit <= kAsMostRows * found.misfit) refuse(suspicionOf(*moved, few), stated);
    return;
  }
  if (const std::string copied = copiedColumns(observations); !copied.empty()) throw ImplausibleCapture(copied, InputPart::kSamples);
  // What the arm could take up in its axes too, if half of the rows were left out.
  if (mispaired && mispaired->misfit <= std::min(kSuspicious * chance, kMends * found.misfit)) refuse(suspicionOf(*mispaired, few), stated);
  MistakeSearch search(few, found.fit.cell.registration, found.misfit, chance);
  if (cell.arm && std::isfinite(found.misfit) && search.armExplains(std::max(floor, 0.25 * kSuspicious * chance))) return;
  if (mispaired) search.considerRows(*mispaired);
  search.tryAll(mistakesOf(few, observations, found.misfit));
  search.trySizes();
  if (const std::optional<MovedOnce> moved = search.moved()) {
    if (cell.arm) return;
    refuse(suspicionOf(*moved, few), stated);
  }
  if (search.best()) refuse(*search.best(), stated);
  if (!search.armExplainsTo(kSuspicious)) {
    search.tryAll(jointMistakePairs(few));
    if (search.best()) refuse(*search.best(), stated);
  }
  const bool hopeless =
      cell.arm ? found.misfit >= kHopeless * chance || !search.armExplainsTo(kHopelessOfArms) : found.misfit >= kHopelessOfPoses * chance;
  if (std::isfinite(found.misfit) && !hopeless) return;
  throw ImplausibleCapture(
      fmt::format("no registration explains most of the pictures (the best leaves {}, as rows that have nothing to do "
                  "with them would): expected readings, robot and pictures that belong together",
                  stated));
}

void requireRegistered(const Cell& cell, const std::vector<Observation>& observations) {
  const std::vector<HypothesisSample> samples = hypothesisSamples(cell, observations);
  Consensus stated;
  stated.fit.cell = cell;
  stated.misfit = medianMisfit(cell.registration, samples, misfitIn(cell, observations));
  const Problem few = thinned(cell, observations, samples, kSearchedRows);
  const std::optional<Consensus> anew = solve(few, 2);
  if (anew && anew->misfit <= kMends * stated.misfit) {
    const double chance = chanceMisfit(few);
    if (stated.misfit >= kSuspicious * chance && anew->misfit <= kMendedOfChance * chance) {
      throw ImplausibleCapture(
          fmt::format("the poses are not those of the flange in base, as registered poses are: registered anew they "
                      "fit to {} instead of {}",
                      leftText(few, anew->fit.cell.registration, anew->misfit), leftText(few, cell.registration, stated.misfit)),
          InputPart::kSamples);
    }
  }
  requirePlausible(cell, observations, samples, stated);
}

}  // namespace poecal
