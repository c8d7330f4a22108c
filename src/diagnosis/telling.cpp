#include "diagnosis/telling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "diagnosis/found_model.hpp"
#include "diagnosis/look_alikes.hpp"
#include "diagnosis/measurement_noise.hpp"
#include "diagnosis/refit.hpp"
#include "diagnosis/screening.hpp"
#include "diagnosis/thresholds.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

/// Effects and where they are, all scanned parameters together, as the data of this capture could tell of them.
struct Sight {
  double smallest = std::numeric_limits<double>::infinity();
  std::string unit;
  double times_typical = std::numeric_limits<double>::infinity();
};

std::map<std::pair<std::string, Place>, Sight> sights(const Selection& selection) {
  std::map<std::pair<std::string, Place>, Sight> all;
  for (std::size_t i = 0; i < selection.base_candidates.size(); ++i) {
    const Candidate& candidate = selection.base_candidates[i];
    if (!candidate.known()) continue;
    Sight& sight = all[{candidate.name, candidate.place}];
    const auto first = static_cast<std::size_t>(candidate.linear.front());
    const double times = smallestSeen(selection.base_evidence[i].information);
    if (times < sight.times_typical || sight.unit.empty()) {
      sight = {times * candidate.typical(0), candidate.effect->parameters()[first].unit, times};
    }
  }
  return all;
}

/// Why an effect that has its columns still shows nothing.
std::string whyUnseen(const std::string& effect, const Place& place, const MeasuredCell& measured) {
  if (place.kind == PlaceKind::kJoint) {
    const auto k = static_cast<Eigen::Index>(place.index);
    const auto all = [&measured](auto is) { return std::all_of(measured.samples.begin(), measured.samples.end(), is); };
    const Sample& first = measured.samples.front();
    if (effect == "joint_backlash" && all([&](const Sample& s) { return s.dir(k) == first.dir(k); })) {
      return fmt::format(
          "the joint was always reached from the same side (dir{}): one half of its play is a joint zero, which no data can tell", k + 1);
    }
    if (effect == "joint_compliance" &&
        std::abs(measured.start.arm->joints[place.index].axis().dot(measured.gravity.normalized())) > 0.999 && k == 0) {
      return "its axis is vertical: gravity has no moment about it";
    }
  }
  return "the arm's axes and the two transforms can move in the same way: these data cannot tell them apart";
}

void fillParameters(const Accepted& accepted, const Eigen::VectorXd& deviation, Finding& finding) {
  const Candidate& candidate = accepted.candidate;
  if (!candidate.known()) return;
  const std::vector<EffectParameter>& parameters = candidate.effect->parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    finding.parameters[parameters[i].name] = candidate.parameters(static_cast<Eigen::Index>(i));
    finding.units[parameters[i].name] = parameters[i].unit;
  }
  const Eigen::VectorXd linear = candidate.linearParameters(accepted.factors);
  for (std::size_t i = 0; i < candidate.linear.size(); ++i) {
    const std::string& name = parameters[static_cast<std::size_t>(candidate.linear[i])].name;
    finding.parameters[name] = linear(static_cast<Eigen::Index>(i));
    finding.standard_deviation[name] = deviation(static_cast<Eigen::Index>(i));
  }
}

void fillAlternatives(const Ranking& ranking, Finding& finding) {
  constexpr double kWorthNaming = 0.005;
  constexpr std::size_t kMost = 8;
  finding.probability = ranking.probability(0);
  finding.p_value = ranking.pValue();
  for (std::size_t i = 1; i < ranking.answers.size() && finding.alternatives.size() < kMost; ++i) {
    const RankedAnswer& other = ranking.answers[i];
    const double probability = ranking.probability(i);
    if (probability > kWorthNaming) finding.alternatives.push_back({other.name, other.place.name(), other.driver.name(), probability});
  }
  std::stable_sort(finding.alternatives.begin(), finding.alternatives.end(),
                   [](const AlternativeCause& a, const AlternativeCause& b) { return a.probability > b.probability; });
  if (finding.alternatives.empty()) return;
  std::set<std::string> ways;
  for (const std::string& name : {finding.effect, finding.alternatives.front().effect}) {
    if (const EffectKind* kind = findEffectKind(name)) ways.insert(kind->separate);
  }
  for (const std::string& way : ways) finding.separate_with += (finding.separate_with.empty() ? "" : "; or ") + way;
}

/// Curves of unknown shape, of every driver at every place.
std::vector<Candidate> curvesOf(const Selection& selection) {
  std::vector<Candidate> curves;
  for (const Candidate& candidate : selection.candidates) {
    if (!candidate.known()) curves.push_back(candidate);
  }
  return curves;
}

/// What constant turns of the base and of every body up to the place do there, 3 rows a pose; or a joint's zero, 1 row a pose. The
/// registration and the arm's axes take these up, whatever a compliance of unknown masses would have of them.
Eigen::MatrixXd constantTurns(const Candidate& candidate, const CaptureRows& rows) {
  const auto poses = static_cast<Eigen::Index>(rows.observations.size());
  if (candidate.entry().reach == Reach::kJoint) return Eigen::MatrixXd::Ones(poses, 1);
  const std::size_t bodies = candidate.place.kind == PlaceKind::kLink ? candidate.place.index + 1 : 0;
  Eigen::MatrixXd turns(3 * poses, 3 * static_cast<Eigen::Index>(bodies + 1));
  for (Eigen::Index n = 0; n < poses; ++n) {
    const PosePortJacobian& ports = rows.observations[static_cast<std::size_t>(n)].ports;
    turns.block<3, 3>(3 * n, 0) = ports.base.topLeftCorner<3, 3>();
    for (std::size_t body = 0; body < bodies; ++body) {
      turns.block<3, 3>(3 * n, 3 * static_cast<Eigen::Index>(body + 1)) = ports.links[body].topLeftCorner<3, 3>();
    }
  }
  return turns;
}

/// The turning parts of a candidate's actions (w of the target's pose, or the joint's reading), below each other.
Eigen::MatrixXd turningActions(const Candidate& candidate, const CaptureRows& rows) {
  const Eigen::MatrixXd actions = actionsOf(candidate, rows, 0, rows.observations.size());
  const auto poses = static_cast<Eigen::Index>(rows.observations.size());
  const Eigen::Index size = actions.rows() / poses, turning = std::min<Eigen::Index>(size, 3);
  Eigen::MatrixXd some(turning * poses, actions.cols());
  for (Eigen::Index n = 0; n < poses; ++n) some.middleRows(turning * n, turning) = actions.middleRows(size * n, turning);
  return some;
}

/// Of a compliance: the most that it turns or shifts its place over the poses of the capture, and its standard deviation. Of unknown masses
/// without the constant turns: large moments that cancel each other would otherwise make it impossibly large.
void fillDeflection(const Selection& selection, std::size_t number, Finding& finding) {
  const Accepted& accepted = *selection.findings[number].accepted;
  const Candidate& candidate = accepted.candidate;
  if (!candidate.known() || !candidate.effect->kind().yields_to_gravity) return;
  Eigen::MatrixXd actions = turningActions(candidate, selection.linear.rows);
  if (candidate.effect->byMasses()) {
    const Eigen::MatrixXd constant = constantTurns(candidate, selection.linear.rows);
    actions -= constant * constant.completeOrthogonalDecomposition().solve(actions);
  }
  const Eigen::Index turning = actions.rows() / static_cast<Eigen::Index>(selection.linear.rows.observations.size());
  Eigen::RowVectorXd most = Eigen::RowVectorXd::Zero(actions.cols());  // the largest one's length by the factors
  double largest = 0.0;
  for (Eigen::Index row = 0; row < actions.rows(); row += turning) {
    const Eigen::VectorXd deflection = actions.middleRows(row, turning) * accepted.factors;
    if (!(deflection.norm() > largest)) continue;
    largest = deflection.norm();
    most = deflection.normalized().transpose() * actions.middleRows(row, turning);
  }
  finding.largest_deflection = largest;
  finding.largest_deflection_deviation = std::sqrt(std::max(0.0, most.dot(factorCovariance(selection, number) * most.transpose())));
}

Finding findingOf(const Selection& selection, std::size_t number, const Eigen::VectorXd& deviation) {
  const FoundEffect& found = selection.findings[number];
  Finding finding{.effect = found.name, .location = found.place.name(), .driver = found.driver.name()};
  finding.log_evidence = found.log_bayes;
  finding.chi_square = found.chi_square;
  if (found.accepted) fillParameters(*found.accepted, deviation, finding);
  if (found.scatter) {
    finding.parameters["sigma"] = scatterSigma(selection, found);
    finding.units["sigma"] = selection.measured.start.arm->joints[*found.scatter].type == JointType::kRevolute ? "rad" : "m";
  }
  if (found.accepted) fillDeflection(selection, number, finding);
  fillAlternatives(found.ranking, finding);
  if (const EffectKind* kind = findEffectKind(found.name)) finding.remedy = kind->remedy;
  if (found.accepted && found.place.kind == PlaceKind::kCameraMount && !selection.linear.reference.empty()) {
    finding.reference = found.accepted->candidate.moves_reference
                            ? "the reference tags moved with it: it is the camera that moved"
                            : "the reference tags stood still: it is the base that moved, not the camera";
  }
  return finding;
}

}  // namespace

Diagnosis tellFindings(const Selection& selection, const RowOrder& row_order) {
  Diagnosis diagnosis;
  diagnosis.row_order = row_order;
  diagnosis.log_odds = selection.base_ranking.log_total;
  diagnosis.answers = static_cast<int>(selection.candidates.size());
  diagnosis.pixels = selection.measured.start.camera.has_value();
  const std::vector<Eigen::VectorXd> deviations = parameterDeviations(selection);
  std::size_t next = 0;
  for (std::size_t i = 0; i < selection.findings.size(); ++i) {
    const FoundEffect& found = selection.findings[i];
    diagnosis.findings.push_back(findingOf(selection, i, found.accepted ? deviations[next++] : Eigen::VectorXd()));
    addLookAlikes(selection, found, row_order, diagnosis.findings.back());
  }
  return diagnosis;
}

void tellTooMuchNoise(const Selection& selection, Diagnosis& diagnosis) {
  if (diagnosis.tag_sigma > kSearch.any_tag) {
    diagnosis.gap_remains = true;
    diagnosis.warnings.push_back(
        severalTags(selection.linear.rows)
            ? fmt::format(
                  "the tags of one picture lie {:.2f} px from where the target's file puts them beside each other, expected some 0.1 px: "
                  "a tag that is tilted or out of the plane, or sizes and places that are not those of the printed target",
                  diagnosis.tag_sigma)
            : fmt::format(
                  "the whole target lies {:.2f} px off in each picture, expected some 0.1 px: pictures of an arm or a camera that shook",
                  diagnosis.tag_sigma));
  }
  if (!(diagnosis.repeatability > kSearch.any_arm) || comesBack(selection.measured)) return;
  diagnosis.gap_remains = true;
  const std::string ways = diagnosis.pixels
                               ? "readings taken at another moment than the picture, an arm that moved during the exposure (record "
                                 "dq1..), or joints that do not come back"
                               : "readings taken at another moment than the pose, or joints that do not come back";
  diagnosis.warnings.push_back(
      fmt::format("readings and {} agree only to {:.2f} mrad a joint, expected some 0.1 mrad: {}; the same poses taken again after other "
                  "ones tell which",
                  diagnosis.pixels ? "pictures" : "poses", 1e3 * diagnosis.repeatability, ways));
}

void tellUnmoved(Diagnosis& diagnosis) {
  constexpr double kNearly = 0.05;
  for (const Finding& finding : diagnosis.findings) {
    if (finding.effect != "joint_gain") continue;
    const double off = std::abs(finding.parameters.at("gain") + 1.0), deviation = finding.standard_deviation.at("gain");
    if (off > kNearly || deviation > kNearly) continue;
    diagnosis.warnings.push_back(
        fmt::format("{} does not move what is seen: is the target or the camera mounted before it, or is the arm's last link wrong?",
                    finding.location));
  }
}

void tellContradictions(const Selection& selection, Diagnosis& diagnosis) {
  const Ranking& first = selection.base_ranking;
  const std::optional<AgainstGravity>& against = first.against_gravity;
  // Whatever else was found in its place, it would have stood before it, or beside it.
  constexpr double kBeside = 3.0;
  const double found = first.answers.empty() ? 0.0 : std::max(0.0, first.answers.front().log_weight);
  if (!against || against->log_weight < found - kBeside) return;
  const Eigen::Vector3d& g = selection.measured.gravity;
  diagnosis.warnings.push_back(fmt::format(
      "{} at {} would explain the gap, but with a size below zero: it fits to gravity the other way round than gravity: [{:.6g}, "
      "{:.6g}, {:.6g}], expected gravity in base, which points down (or a spring pulls there that no mass of the robot file tells)",
      against->name, against->place.name(), g.x(), g.y(), g.z()));
}

void tellWhatCanBeSeen(const Selection& selection, Diagnosis& diagnosis) {
  diagnosis.not_testable = selection.not_testable;
  const auto is_found = [&selection](const std::pair<std::string, Place>& name) {
    return std::any_of(selection.findings.begin(), selection.findings.end(),
                       [&name](const FoundEffect& found) { return found.name == name.first && found.place == name.second; });
  };
  for (const auto& [name, sight] : sights(selection)) {
    if (sight.times_typical > kSearch.absurd_size && !is_found(name)) {
      diagnosis.not_testable.push_back({name.first, name.second.name(), whyUnseen(name.first, name.second, selection.measured)});
    } else {
      diagnosis.detectable.push_back({name.first, name.second.name(), sight.smallest, sight.unit});
    }
  }
  const std::vector<Joint>& joints = selection.measured.start.arm->joints;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    diagnosis.not_testable.push_back(
        {"joint_offset", fmt::format("joint:{}", k + 1),
         "a joint's zero is where all axes after it are turned to: it is part of the twists, not an effect beside them"});
  }
}

void tellNoise(const Selection& selection, Diagnosis& diagnosis) {
  const NoiseEstimate& noise = selection.linear.noise;
  std::vector<double> sigmas;
  for (const ObservationRows& part : selection.linear.rows.observations) {
    sigmas.insert(sigmas.end(), part.unit_sigma.begin(), part.unit_sigma.end());
  }
  const double stated = sigmas.empty() ? 1.0 : median(sigmas);
  const auto sigma = [&selection](const std::string& name) {
    const std::optional<double> variance = varianceOf(name, selection.linear.components, selection.linear.noise);
    return variance ? std::optional(std::sqrt(*variance)) : std::nullopt;
  };
  if (const auto corner = sigma(diagnosis.pixels ? "corner" : "position")) diagnosis.noise_sigma = stated * *corner;
  diagnosis.tag_sigma = sigma("tag").value_or(0.0);
  diagnosis.repeatability = sigma("repeatability").value_or(0.0);
  if (const auto rotation = sigma("rotation")) {
    const PoseMeasurement& pose = *selection.measured.observations.front().pose;
    diagnosis.rotation_sigma = *rotation / pose.whitening(0, 0);
  }
  diagnosis.arm_beyond_tolerance = noise.tolerance;
}

void tellWhere(const Selection& selection, Diagnosis& diagnosis) {
  if (selection.findings.empty()) return;
  Linearised before = refit(selection.measured, selection.base, {}, {}, selection.linear.noise, {}, false);
  std::vector<Candidate> places = curvesOf(selection);
  const std::size_t curves = places.size();
  for (const FoundEffect& found : selection.findings) {
    if (found.accepted) places.push_back(found.accepted->candidate);
  }
  const std::vector<Evidence> evidence = screen(before, places);
  double explained = 0.0;
  for (std::size_t i = curves; i < places.size(); ++i) explained += evidence[i].chi_square;
  explained = std::max(explained, 1.0);
  std::map<std::pair<std::string, std::string>, GapPlace> found;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double chi_square = evidence[i].chi_square;
    GapPlace place{places[i].place.name(), places[i].driver.name(), std::clamp((chi_square - evidence[i].dimension) / explained, 0.0, 1.0),
                   std::min(1.0, static_cast<double>(places.size()) * chiSquareTail(chi_square, evidence[i].dimension))};
    GapPlace& known = found[{place.location, place.driver}];
    if (known.location.empty() || known.share < place.share) known = place;
  }
  for (const auto& [key, place] : found) {
    if (place.p_value < 0.01 && place.share > 0.02) diagnosis.where.push_back(place);
  }
  std::stable_sort(diagnosis.where.begin(), diagnosis.where.end(), [](const GapPlace& a, const GapPlace& b) { return a.share > b.share; });
  constexpr std::size_t kMost = 10;
  if (diagnosis.where.size() > kMost) diagnosis.where.resize(kMost);
}

void tellRemaining(const Selection& selection, Diagnosis& diagnosis) {
  const std::vector<Candidate> curves = curvesOf(selection);
  if (curves.empty()) return;
  const std::vector<Evidence> evidence = screen(selection.linear, curves);
  const double all = static_cast<double>(curves.size());
  std::size_t best = 0;
  double total = 0.0;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    total += std::exp(std::min(700.0, evidence[i].log_bayes)) / all;
    if (evidence[i].log_bayes > evidence[best].log_bayes) best = i;
  }
  diagnosis.remaining_p_value = std::min(1.0, 1.0 / total);
  diagnosis.remaining_significant = diagnosis.remaining_p_value < 0.01;
  if (!diagnosis.remaining_significant) return;
  diagnosis.remaining_location = curves[best].place.name();
  diagnosis.remaining_driver = curves[best].driver.name();
}

void tellExplained(const Selection& selection, Diagnosis& diagnosis) {
  const auto seen = sights(selection);
  std::map<std::string, Explained> answers;
  for (std::size_t i = 0; i < selection.base_candidates.size(); ++i) {
    const Candidate& candidate = selection.base_candidates[i];
    const Evidence& evidence = selection.base_evidence[i];
    Explained& explained = answers[candidate.answer()];
    if (!explained.effect.empty() && explained.log_evidence > evidence.log_bayes) continue;
    explained = {candidate.name, candidate.place.name(), candidate.driver.name(), evidence.log_bayes, evidence.chi_square, 0.0, 0.0, ""};
    const auto sight = seen.find({candidate.name, candidate.place});
    if (sight != seen.end()) {
      explained.smallest = sight->second.smallest;
      explained.unit = sight->second.unit;
    }
  }
  std::vector<const Ranking*> rankings{&selection.base_ranking};
  for (const FoundEffect& found : selection.findings) rankings.push_back(&found.ranking);
  for (const Ranking* ranking : rankings) {
    for (std::size_t i = 0; i < ranking->answers.size(); ++i) {
      const RankedAnswer& answer = ranking->answers[i];
      Explained& explained = answers[answerName(answer.name, answer.place, answer.driver)];
      explained.effect = answer.name;
      explained.location = answer.place.name();
      explained.driver = answer.driver.name();
      explained.log_evidence = answer.log_bayes;
      explained.probability = std::max(explained.probability, ranking->probability(i));
    }
  }
  for (const auto& [name, explained] : answers) diagnosis.explained.push_back(explained);
  std::stable_sort(diagnosis.explained.begin(), diagnosis.explained.end(),
                   [](const Explained& a, const Explained& b) { return a.log_evidence > b.log_evidence; });
}

void tellBad(const Selection& selection, const std::vector<Observation>& observations, const std::vector<Sample>& samples,
             Diagnosis& diagnosis) {
  if (selection.bad.empty()) return;
  Finding finding{.effect = "bad_samples", .location = "samples", .driver = "none"};
  // Each of them passed the test of wildRows(), which every row could have passed by chance.
  finding.p_value = std::min(1.0, static_cast<double>(observations.size()) * kSearch.wild_at_last.probability);
  finding.probability = 1.0 - finding.p_value;
  finding.remedy = effectKind("bad_samples").remedy;
  for (std::size_t i = 0; i < selection.bad.size(); ++i) {
    const std::size_t sample = observations[selection.bad[i]].sample;
    diagnosis.bad_samples.push_back({sample, selection.bad_rms[i]});
    finding.images.push_back(samples[sample].image.empty() ? fmt::format("line {}", samples[sample].line) : samples[sample].image);
  }
  finding.parameters["share"] = static_cast<double>(selection.bad.size()) / static_cast<double>(observations.size());
  finding.units["share"] = "";
  // A tag that was fitted a few hundredths of a pixel off is left out, but its joints and picture do belong together.
  constexpr double kWrong = 0.1;  // [px]
  const double worst = *std::max_element(selection.bad_rms.begin(), selection.bad_rms.end());
  if (!diagnosis.pixels || worst > kWrong) diagnosis.findings.push_back(std::move(finding));
}

}  // namespace poecal
