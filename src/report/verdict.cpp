#include "report/verdict.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "diagnosis/wording.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {
namespace {

/// "a", "a and b", "a, b and c"
std::string listed(const std::vector<std::string>& parts) {
  if (parts.size() < 2) return parts.empty() ? "" : parts.front();
  return fmt::format("{} and {}", fmt::join(parts.begin(), parts.end() - 1, ", "), parts.back());
}

/// "joint:6" as people say it.
std::string spoken(std::string location) {
  std::replace(location.begin(), location.end(), ':', ' ');
  return location;
}

std::string capitalised(std::string text) {
  if (!text.empty() && text.front() >= 'a' && text.front() <= 'z') text.front() = static_cast<char>(text.front() - 'a' + 'A');
  return text;
}

void addUnique(std::vector<std::string>& parts, const std::string& text) {
  if (std::find(parts.begin(), parts.end(), text) == parts.end()) parts.push_back(text);
}

std::string where(const Diagnosis& diagnosis) {
  std::vector<std::string> places;
  for (const Finding& finding : diagnosis.findings) {
    addUnique(places, finding.driver == "none" ? spoken(finding.location) : spoken(finding.location) + ", driven by " + finding.driver);
  }
  const std::string text = fmt::format("{}", fmt::join(places, "; and at "));
  return "The gap lies at " + text + ".";
}

std::string which(const Diagnosis& diagnosis) {
  std::vector<std::string> causes;
  for (const Finding& finding : diagnosis.findings) {
    const std::string meaning = finding.effect == "unknown" ? "no listed effect explains it" : effectKind(finding.effect).meaning;
    const std::string reference = finding.reference.empty() ? "" : "; " + finding.reference;
    causes.push_back(fmt::format("{} ({}; {}{})", finding.effect, meaning, surenessText(finding.probability), reference));
  }
  return fmt::format("The {} {}.", causes.size() == 1 ? "cause is" : "causes are", listed(causes));
}

std::string remains(const Diagnosis& diagnosis) {
  return fmt::format("{} above the noise ({} to {}) on held-out poses", gapText(diagnosis, diagnosis.after_excess),
                     gapText(diagnosis, diagnosis.after_interval.first), gapText(diagnosis, diagnosis.after_interval.second));
}

std::string howFar(const Diagnosis& diagnosis) {
  const Shrinkage& shrinkage = diagnosis.shrinkage;
  const std::string before = gapText(diagnosis, diagnosis.before_excess);
  if (!shrinkage.claimed()) {
    return fmt::format("A smaller gap on held-out poses is not shown by these data; what remains is {}, of {} without the findings.",
                       remains(diagnosis), before);
  }
  return fmt::format("With {} in the model the gap shrinks by {} ({} to {}); what remains is {}, of {} without.",
                     diagnosis.findings.size() == 1 ? "it" : "them", percentText(shrinkage.value), percentText(shrinkage.interval.first),
                     percentText(shrinkage.interval.second), remains(diagnosis), before);
}

std::vector<std::string> actionsOf(const Diagnosis& diagnosis) {
  std::vector<std::string> actions;
  for (const Finding& finding : diagnosis.findings) {
    if (!finding.remedy.empty())
      addUnique(actions, fmt::format("At {} ({}): {}.", spoken(finding.location), finding.effect, finding.remedy));
    if (!finding.separate_with.empty()) addUnique(actions, fmt::format("To tell the causes apart: {}.", finding.separate_with));
  }
  for (const Finding& finding : diagnosis.possibilities) {
    actions.push_back(fmt::format("Take more poses: {} at {} is possible, but does not yet serve poses that the fit did not see.",
                                  finding.effect, spoken(finding.location)));
  }
  if (diagnosis.remaining_significant) {
    actions.push_back(fmt::format("Look at {} (driven by {}): structure is left there.", spoken(diagnosis.remaining_location),
                                  diagnosis.remaining_driver));
  }
  if (diagnosis.gap_remains) {
    actions.push_back(capitalised(gapRemainsText(diagnosis)) + ". Run poecal check on the capture, and compare its files with the cell.");
  }
  return actions;
}

std::string errorsOf(const ErrorSummary& errors) {
  const std::string flange = fmt::format("{:.3f} mm and {:.3f} mrad at the flange", 1e3 * errors.position.mean, 1e3 * errors.rotation.mean);
  return errors.corners > 0 ? fmt::format("{:.3f} px rms, in the mean {}", errors.px.rms, flange) : "in the mean " + flange;
}

Verdict withoutDiagnosis(const Calibration& calibration) {
  const Identification& identification = *calibration.identification;
  const ModelStage& last = identification.stages.back();
  const bool held_out = last.held_out.poses > 0;
  Verdict verdict;
  verdict.headline = "Identified, not diagnosed";
  verdict.sentences.push_back(fmt::format(
      "The axes were identified from {} poses, but where a gap lies is not known: {}.", identification.poses,
      calibration.no_diagnosis.empty() ? "no diagnosis was asked for" : "there is no diagnosis, as " + calibration.no_diagnosis));
  verdict.sentences.push_back("No cause can be named without a diagnosis.");
  verdict.sentences.push_back(fmt::format("The identified arm is off by {} on {}.", errorsOf(held_out ? last.held_out : last.calibration),
                                          held_out ? "held-out poses" : "the poses that it was fitted to"));
  if (calibration.no_diagnosis.empty()) {
    verdict.actions.push_back("Run poecal diagnose on the same data.");
  } else if (identification.method != Method::kBundle) {
    verdict.actions.push_back("Identify by method bundle, which a diagnosis starts from.");
  } else if (!held_out) {
    verdict.actions.push_back("Hold poses out, so that a diagnosis has something to judge by.");
  } else {
    verdict.actions.push_back("Take more poses, then run poecal diagnose.");
  }
  return verdict;
}

}  // namespace

Verdict verdictOf(const Calibration& calibration) {
  if (!calibration.diagnosis) return withoutDiagnosis(calibration);
  const Diagnosis& diagnosis = *calibration.diagnosis;
  Verdict verdict;
  verdict.actions = actionsOf(diagnosis);
  if (diagnosis.findings.empty() && !diagnosis.isClean()) {
    verdict.headline = "A gap without a known cause";
    verdict.sentences = {diagnosis.remaining_significant ? fmt::format("Structure is left at {}, driven by {}.",
                                                                       spoken(diagnosis.remaining_location), diagnosis.remaining_driver)
                                                         : capitalised(fmt::format("{}.", gapRemainsText(diagnosis))),
                         fmt::format("None of {} explanations makes held-out poses better.", diagnosis.answers),
                         capitalised(fmt::format("what remains is {}.", remains(diagnosis)))};
    verdict.actions.push_back("Take more poses, some of them twice: repeats tell structure from random motion.");
    return verdict;
  }
  if (diagnosis.findings.empty()) {
    verdict.headline = "Nothing beyond noise and geometry";
    verdict.sentences = {"No place of the cell shows a gap that the identified geometry leaves.",
                         fmt::format("None of {} explanations was more likely than noise alone.", diagnosis.answers),
                         capitalised(fmt::format("what remains is {}.", remains(diagnosis)))};
    if (verdict.actions.empty())
      verdict.actions.push_back("Nothing at the cell: use model.yaml as it is, or write it into a URDF with poecal export.");
    return verdict;
  }
  std::vector<std::string> names;
  for (const Finding& finding : diagnosis.findings) names.push_back(finding.effect + " at " + spoken(finding.location));
  verdict.headline = "Found: " + listed(names);
  verdict.sentences = {where(diagnosis), which(diagnosis), howFar(diagnosis)};
  return verdict;
}

}  // namespace poecal
