#include "poecal/diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "capture/reading_steps.hpp"
#include "diagnosis/found_model.hpp"
#include "diagnosis/ladder.hpp"
#include "diagnosis/reference_check.hpp"
#include "diagnosis/selection.hpp"
#include "diagnosis/telling.hpp"
#include "diagnosis/thresholds.hpp"
#include "identification/fit.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

constexpr std::size_t kFewestPoses = 12;
constexpr std::size_t kIdentified = 2;   // rung
constexpr std::size_t kMostRefused = 3;  // names before it is said that none serves

MeasuredCell measuredCell(const Identification& identification, const Measurements& measurements, const DiagnoseOptions& options) {
  MeasuredCell measured;
  measured.other_columns = measurements.other_columns;
  measured.start = identification.start;
  measured.free = identification.free;
  // A camera that was re-fitted though its file states no deviations is the lens that it was found to be, or the finding would be lost in
  // it.
  const bool stated = measured.start.camera && measured.start.camera->standard_deviation.size() > 0;
  measured.free.intrinsics = identification.free.intrinsics && stated;
  if (measured.free.intrinsics) measured.camera_sigma = measured.start.camera->standard_deviation;
  measured.observations = measurements.observations;
  for (Observation& observation : measured.observations) {
    measured.samples.push_back(measurements.samples[observation.sample]);
    if (!observation.pose || identification.sigmas_stated || observation.pose->position_only) continue;
    Vector6d weight;
    weight << Eigen::Vector3d::Constant(1.0 / identification.sigma_rotation),
        Eigen::Vector3d::Constant(1.0 / identification.sigma_position);
    observation.pose->whitening = weight.asDiagonal();
  }
  const Rounding rounding = roundingOf(*measured.start.arm, measurements.samples);
  if (rounding.isCoarse()) measured.rounding = rounding.sigmas();
  measured.groups = measurements.poseGroups();
  measured.target = measurements.target;
  measured.gravity = measurements.gravity;
  measured.jobs = options.jobs;
  measured.progress = options.progress;
  // Without tolerances geometry may be anything: wide ones say so and keep the search well-posed.
  constexpr double kAnywhere = 1.0;
  measured.twists = identification.twist_prior.empty() ? TwistPrior(*measured.start.arm, kAnywhere, kAnywhere) : identification.twist_prior;
  return measured;
}

/// Observations that a robust fit left out by far: so wild that they would spoil the noise of all others, whatever else there is.
std::vector<std::size_t> grosslyWild(const Identification& identification, const MeasuredCell& measured) {
  // Mean square in units of the fit's noise: twelve standard deviations, farther than an effect throws single poses.
  const double gross = kSearch.wild_at_once.mean_square;
  const double scale = std::max(identification.adjustment.scale, 1e-12);
  std::vector<std::size_t> wild;
  for (std::size_t k = 0; k < measured.observations.size(); ++k) {
    if (keptShare(identification.adjustment.weights[k]) >= 0.5) continue;
    const std::vector<UnitResidual> units = residuals(identification.model.cell, measured.observations[k]);
    double squares = 0.0, numbers = 0.0;
    for (const UnitResidual& unit : units) {
      if (!std::isfinite(unit.squared_norm)) continue;  // beyond the lens model: of no use, but not wild
      squares += unit.squared_norm;
      numbers += static_cast<double>(unit.residual.size());
    }
    if (squares > gross * scale * scale * numbers) wild.push_back(k);
  }
  return wild;
}

ModelState identifiedState(const Identification& identification, const MeasuredCell& measured) {
  CellState state(measured.start, measured.free);
  state.cell = identification.model.cell;
  if (measured.start.camera && !measured.free.intrinsics) state.cell.camera = measured.start.camera;
  state.cell.arm->links = measured.start.arm->links;
  state.beta = identification.adjustment.beta;
  state.reference->gamma = identification.model.cell.arm->gamma;
  return {state, {}};
}

std::string rungName(const Selection& selection, const std::string& identified, const std::vector<std::size_t>& findings) {
  std::string name = identified;
  for (const std::size_t i : findings) name += fmt::format(" + {}@{}", selection.findings[i].name, selection.findings[i].place.name());
  return name;
}

/// Captures of so few poses that a name is given only to what serves poses that its fit did not see.
bool isSmall(const MeasuredCell& measured) {
  constexpr std::size_t kFew = 30;
  return measured.groups.size() <= kFew;
}

/// Whether a finding serves poses that its fit did not see. An effect beyond doubt that shows in a few poses gains too little in the mean
/// of all to stand out of their scatter: of a name it is then enough that the others do not lose what these gain. Structure without a name
/// need only not harm them. @param without, with  rungs of the model without the finding and with it.
bool servesOthers(const FoundEffect& found, const Rung& without, const Rung& with) {
  constexpr double kBeyondChance = 1.96, kBeyondDoubt = 20.0;
  constexpr double kLost = 0.25;  // where all poses see it and it is 1.96 standard errors, the losses of chance are so much of the gains
  const double gained = gain(without, with);
  if (gained > kBeyondChance) return true;
  if (found.log_bayes <= kBeyondDoubt) return false;
  return found.isUnknown() ? gained > 0.0 : lostShare(without, with) < kLost;
}

/// What the whole model is judged by: rungs with all findings and with none, other poses held out together.
std::vector<RungPair> blockRungs(const Ladder& ladder, const std::vector<std::size_t>& findings, Progress& progress) {
  std::vector<RungPair> pairs;
  for (const HeldOut kind : ladder.blocks()) {
    RungPair& pair = pairs.emplace_back();
    pair.before = ladder.identifiedRung(kind);
    progress.advance();
    pair.after = ladder.rungWith("", findings, kind, Waves::kKept);
    progress.advance();
  }
  return pairs;
}

/// What a gap is to be compared with: the noise, or the most that it may be where it is not known, within what instruments have.
double mostNoise(const Diagnosis& diagnosis) {
  constexpr double kLeastPx = 0.01, kMostPx = 2.0;
  constexpr double kLeastPosition = 1e-6, kMostPosition = 5e-3;
  const double noise = diagnosis.noiseKnown() ? diagnosis.noise_rms : diagnosis.noise_bounds.second;
  return diagnosis.pixels ? std::clamp(noise, kLeastPx, kMostPx) : std::clamp(noise, kLeastPosition, kMostPosition);
}

void tellGap(const Gap& gap, const std::vector<Rung>& rungs, Diagnosis& diagnosis) {
  for (const Rung& rung : rungs) diagnosis.stages.push_back(gap.stageOf(rung));
  diagnosis.noise_rms = gap.noiseRms();
  diagnosis.noise_bounds = gap.noiseBounds();
  diagnosis.before_excess = diagnosis.stages[kIdentified].excess;
  diagnosis.after_excess = diagnosis.stages.back().excess;
  diagnosis.after_interval = gap.remaining();
  diagnosis.gap_remains = diagnosis.after_interval.first > kSearch.gap_remains * mostNoise(diagnosis);
}

/// How the findings serve poses that their fit did not see.
struct Climbed {
  std::vector<bool> serves;    ///< each of them
  std::vector<double> ratios;  ///< of each: rms without it over that with it
  bool worse = false;          ///< all together make them worse than the identification left them: then none is named
};

/// The ladder, and how much each finding shrinks the excess.
Climbed climb(const Selection& selection, const MeasuredCell& measured, const Identification& identification,
              const DiagnoseOptions& options, Diagnosis& diagnosis) {
  const Ladder ladder(selection, measured, identification, options.folds, options.seed);
  const std::size_t findings = selection.findings.size();
  std::vector<std::size_t> taken(findings);
  std::iota(taken.begin(), taken.end(), 0);
  const std::size_t choices = ladder.hasWaves(taken) ? 2 : 1;
  // A rung with each finding, those with none and with all by other folds, and one without each where there are several.
  const std::size_t rung_count =
      findings == 0 ? 0 : findings + choices - 1 + 2 * ladder.blocks().size() + (findings > 1 ? choices * findings : 0);
  Progress progress(options.progress, "judging on poses held out", rung_count);
  progress.show();
  std::map<std::pair<std::vector<std::size_t>, Waves>, Rung> known;
  const auto rungOf = [&](const std::string& stage, const std::vector<std::size_t>& some, Waves waves) {
    if (!ladder.hasWaves(some)) waves = Waves::kKept;
    auto at = known.find({some, waves});
    if (at == known.end()) at = known.emplace(std::pair{some, waves}, ladder.rungWith(stage, some, HeldOut::kRandom, waves)).first;
    progress.advance();
    Rung rung = at->second;
    rung.stage = stage;
    return rung;
  };
  std::vector<Rung> rungs = ladder.geometricRungs();
  const Rung identified = rungs[kIdentified];
  for (std::size_t i = 0; i < findings; ++i) {
    const std::vector<std::size_t> first(taken.begin(), taken.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    rungs.push_back(rungOf(rungName(selection, identified.stage, first), first, Waves::kChosenAnew));
  }
  const Rung& all = rungs.back();
  std::optional<Rung> with_waves;
  if (choices > 1) with_waves = rungOf("", taken, Waves::kKept);
  const Rung& kept = with_waves ? *with_waves : all;
  const MeasurementNoise noise = measurementNoise(selection.measured, selection.linear, identification.sigmas_stated);
  const Gap gap(selection, noise, rungs, ladder.folds(HeldOut::kRandom), options.seed);
  diagnosis.noise_source = noise.source;
  tellGap(gap, rungs, diagnosis);
  if (findings > 0) diagnosis.shrinkage = gap.shrinkage(identified, all, blockRungs(ladder, taken, progress), with_waves);
  Climbed climbed;
  for (std::size_t i = 0; i < findings; ++i) {
    std::vector<std::size_t> others = taken;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Rung without = others.empty() ? identified : rungOf("", others, Waves::kChosenAnew);
    const Rung without_kept = others.empty() || choices == 1 ? without : rungOf("", others, Waves::kKept);
    diagnosis.findings[i].shrinkage = others.empty() ? diagnosis.shrinkage : gap.shrinkage(without, all, {}, with_waves);
    climbed.ratios.push_back(errorOf(without_kept) / std::max(errorOf(kept), 1e-12));
    climbed.serves.push_back(servesOthers(selection.findings[i], without_kept, kept));
  }
  constexpr double kWorse = 1.05;
  climbed.worse = errorOf(kept) > kWorse * errorOf(identified);
  return climbed;
}

/// A name that rests on what is believed of the cell alone: it makes no other pose better, and either the arm is far from its robot file
/// with it too, or its own size is nothing beyond its deviation, or that of no real cell.
bool isHollow(const Selection& selection, const Climbed& climbed, std::size_t i) {
  constexpr double kBetter = 1.05;
  constexpr double kOtherArm = 4.0;  // times the tolerances: loose arms exceed them up to three times
  constexpr double kNothing = 9.0;   // three sigma
  const FoundEffect& found = selection.findings[i];
  if (!found.accepted || !found.accepted->candidate.known() || climbed.ratios[i] > kBetter) return false;
  // Of a lens the identification may have made the same fit.
  if (found.place.kind == PlaceKind::kCameraLens) return false;
  const Candidate& candidate = found.accepted->candidate;
  const auto sizes = found.accepted->factors.head(candidate.own()).cwiseAbs().cwiseQuotient(candidate.typical.head(candidate.own()));
  return sizes.maxCoeff() > kSearch.absurd_size || selection.linear.noise.tolerance > kOtherArm ||
         factorsChiSquare(selection, i) < kNothing;
}

/// The effect with a name that makes poses worst that its fit did not see; nothing where all of them make them better.
std::optional<std::size_t> worstName(const Selection& selection, const Climbed& climbed) {
  std::optional<std::size_t> worst;
  for (std::size_t i = 0; i < selection.findings.size(); ++i) {
    const FoundEffect& found = selection.findings[i];
    if (!found.accepted || found.isUnknown() || climbed.ratios[i] >= 1.0) continue;
    if (!worst || climbed.ratios[i] < climbed.ratios[*worst]) worst = i;
  }
  return worst;
}

/// Has the next search do without a name. @return false where there were too many already
bool refuse(const FoundEffect& named, SearchLimits& limits) {
  if (limits.refused.size() >= kMostRefused) return false;
  limits.refused.insert(named.accepted->candidate.answer());
  return true;
}

/// The first finding that is not to be given; as many as there are where all are.
std::size_t firstUseless(const Selection& selection, const Climbed& climbed, bool judge_names) {
  std::size_t i = 0;
  for (; i < selection.findings.size(); ++i) {
    const FoundEffect& found = selection.findings[i];
    const bool judged = found.isUnknown() || judge_names;
    if (!found.scatter && ((judged && !climbed.serves[i]) || isHollow(selection, climbed, i))) break;
  }
  return i;
}

}  // namespace

Diagnosis diagnose(const Identification& identification, const Measurements& given, const DiagnoseOptions& options) {
  if (!identification.start.arm) throw InsufficientData("a diagnosis needs joint readings");
  if (identification.folds.empty()) throw InsufficientData("no pose was held out to judge a model");
  Measurements measurements = given;
  const RowOrder row_order = standInByRowOrder(measurements.samples);
  MeasuredCell measured = measuredCell(identification, measurements, options);
  measured.timed = !row_order.stamp;
  if (measured.groups.size() < kFewestPoses) {
    throw InsufficientData(
        fmt::format("{} poses are too few to tell an effect from the arm's own geometry: at least {} are needed, 40 or more are advised",
                    measured.groups.size(), kFewestPoses));
  }
  const std::string wandering = referenceContradiction(identification.model.cell, measured.observations);
  if (!wandering.empty()) {
    for (Observation& observation : measured.observations) observation.reference.clear();
  }
  const ModelState state = identifiedState(identification, measured);
  const std::vector<std::size_t> wild = grosslyWild(identification, measured);
  // A curve of unknown shape that does not serve poses which it did not see is none that could be told of, nor is what came after it. Where
  // it is the first, what has a name may still serve; names that do not either are not given in its place.
  std::vector<Finding> possibilities, refused;
  for (SearchLimits limits;; limits.label = "searching for effects again") {
    const Selection selection = selectEffects(measured, state, wild, limits);
    Diagnosis diagnosis = tellFindings(selection, row_order);
    const Climbed climbed = climb(selection, measured, identification, options, diagnosis);
    if (limits.most > 0 && climbed.worse) {
      const std::optional<std::size_t> spoils = worstName(selection, climbed);
      if (spoils && refuse(selection.findings[*spoils], limits)) continue;
      if (limits.curves) {
        limits.curves = false;
      } else {
        limits.most = 0;
      }
      continue;
    }
    const std::size_t useless = firstUseless(selection, climbed, !limits.curves || isSmall(measured));
    if (useless == diagnosis.findings.size()) {
      tellNoise(selection, diagnosis);
      tellWhere(selection, diagnosis);
      tellRemaining(selection, diagnosis);
      tellWhatCanBeSeen(selection, diagnosis);
      tellExplained(selection, diagnosis);
      tellModel(selection, identification, diagnosis);
      tellTooMuchNoise(selection, diagnosis);
      tellUnmoved(diagnosis);
      tellContradictions(selection, diagnosis);
      if (!wandering.empty()) diagnosis.warnings.push_back(wandering);
      tellBad(selection, measurements.observations, measurements.samples, diagnosis);
      // A name that was refused remains one where nothing else was found in its place.
      if (selection.findings.empty()) possibilities.insert(possibilities.end(), refused.begin(), refused.end());
      diagnosis.possibilities = std::move(possibilities);
      return diagnosis;
    }
    const bool hollow = isHollow(selection, climbed, useless);
    if (diagnosis.findings[useless].effect != kUnknownEffect && (isSmall(measured) || hollow)) {
      // What was found after it may be of use without it. Where nothing was, the next best name would only stand in its place.
      const bool others = useless + 1 < diagnosis.findings.size();
      const bool again = (hollow || others) && refuse(selection.findings[useless], limits);
      (again && hollow ? refused : possibilities).push_back(diagnosis.findings[useless]);
      if (!again) limits.most = useless;
      continue;
    }
    if (useless == 0 && limits.curves) {
      limits.curves = false;
    } else {
      limits.most = useless;
    }
  }
}

}  // namespace poecal
