// What a diagnosis says to people.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "diagnosis/wording.hpp"
#include "poecal/core/error.hpp"
#include "poecal/diagnosis/diagnose.hpp"

namespace poecal {
namespace {

std::string meaning(const std::string& effect) {
  if (effect == kUnknownEffect) return "structure that no listed effect explains";
  return effectKind(effect).meaning;
}

/// What the measuring itself is off by, or between what it lies.
std::string noise(const Diagnosis& diagnosis) {
  if (!diagnosis.noiseKnown()) {
    return fmt::format("noise {}: at most {}, of which none is subtracted", noiseSourceName(diagnosis.noise_source),
                       gapText(diagnosis, diagnosis.noise_bounds.second));
  }
  return "noise " + gapText(diagnosis, diagnosis.noise_rms);
}

/// How large the gap is that remains when all is done that was found.
std::string remains(const Diagnosis& diagnosis) {
  std::string text = fmt::format("  what remains: {} above the noise ({} to {})", gapText(diagnosis, diagnosis.after_excess),
                                 gapText(diagnosis, diagnosis.after_interval.first), gapText(diagnosis, diagnosis.after_interval.second));
  if (!diagnosis.findings.empty()) text += fmt::format(", of {} without the findings", gapText(diagnosis, diagnosis.before_excess));
  text += '\n';
  if (!diagnosis.noiseKnown()) {
    text +=
        "    noise, what the arm comes back by and structure finer than the poses look alike in it: poses measured again tell them apart\n";
  }
  return text;
}

/// The stages' names; on a screen the last finding of a long one stands for all of it.
std::vector<std::string> stageNames(const Diagnosis& diagnosis, TextLength length) {
  constexpr std::size_t kLongest = 38;  // with the figures of pixels, 100 columns
  std::vector<std::string> names;
  for (const GapStage& stage : diagnosis.stages) {
    const std::size_t last = stage.stage.rfind(" + ");
    const bool is_long = stage.stage.size() > kLongest && last != std::string::npos;
    names.push_back(length == TextLength::kScreen && is_long ? "..." + stage.stage.substr(last) : stage.stage);
  }
  return names;
}

std::string ladder(const Diagnosis& diagnosis, TextLength length) {
  std::string text = fmt::format("  on held-out poses, {}:\n", noise(diagnosis));
  const std::vector<std::string> names = stageNames(diagnosis, length);
  std::size_t width = 0;
  for (const std::string& name : names) width = std::max(width, name.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    const GapStage& stage = diagnosis.stages[k];
    const double rms = diagnosis.pixels ? stage.errors.px.rms : stage.errors.position.rms;
    text += fmt::format("    {:<{}}  rms {}, above noise {}, {:.3f} mm, {:.3f} mrad\n", names[k], width, gapText(diagnosis, rms),
                        gapText(diagnosis, stage.excess), 1e3 * stage.errors.position.mean, 1e3 * stage.errors.rotation.mean);
  }
  return text;
}

/// As many lines as the length allows, and how many more there are.
std::string listText(const std::vector<std::string>& lines, const std::string& indent, std::size_t most) {
  std::string text;
  for (std::size_t k = 0; k < std::min(most, lines.size()); ++k) text += indent + lines[k] + "\n";
  if (lines.size() > most) text += fmt::format("{}and {} more, see diagnosis.json\n", indent, lines.size() - most);
  return text;
}

/// Of things of which a screen shows the first.
constexpr std::size_t kShownOnScreen = 3;

std::string sizes(const Finding& finding) {
  std::string text;
  for (const auto& [name, value] : finding.parameters) {
    const auto deviation = finding.standard_deviation.find(name);
    const std::string plus = deviation == finding.standard_deviation.end() ? "" : fmt::format(" +- {:.2g}", deviation->second);
    const std::string& unit = finding.units.at(name);
    text += fmt::format("{}{} {:.4g}{}{}", text.empty() ? "" : ", ", name, value, plus, unit.empty() ? "" : " " + unit);
  }
  return text;
}

std::string howFar(const Shrinkage& shrinkage) {
  constexpr double kWorthwhile = 0.05;
  const std::string range = fmt::format("({} to {})", percentText(shrinkage.interval.first), percentText(shrinkage.interval.second));
  if (shrinkage.claimed()) return fmt::format("  how far: the gap shrinks by {} {}\n", percentText(shrinkage.value), range);
  if (shrinkage.interval.second > kWorthwhile) {
    return fmt::format("  how far: these poses do not tell {}: too few of them show it\n", range);
  }
  return "  how far: no smaller on held-out poses: the fitted axes had made up for it\n";
}

/// A driver that nobody recorded, and what stands in for it.
std::string drivenBy(const Diagnosis& diagnosis, const std::string& driver) {
  if (diagnosis.row_order.stamp && driver == "stamp") return "stamp (not recorded: the number of the row from 0 stands in for it)";
  if (diagnosis.row_order.dir && driver.starts_with("dir")) {
    return driver + " (not recorded: guessed, the joint coming straight from the row before)";
  }
  return driver;
}

std::string findingText(const Diagnosis& diagnosis, const Finding& finding, TextLength length) {
  constexpr std::size_t kMostSizes = 8, kMostImages = 10;
  const bool whole = length == TextLength::kWhole;
  const std::string indent(9, ' ');
  std::string text = fmt::format("  where: {}, driven by {}\n", finding.location, drivenBy(diagnosis, finding.driver));
  text += fmt::format("  which: {}: {} ({})\n", finding.effect, meaning(finding.effect), surenessText(finding.probability));
  if (!finding.parameters.empty() && finding.parameters.size() <= kMostSizes) text += fmt::format("         {}\n", sizes(finding));
  if (finding.largest_deflection) {
    text += fmt::format("         largest deflection over these poses {:.3f} +- {:.3f} mrad\n", 1e3 * *finding.largest_deflection,
                        1e3 * finding.largest_deflection_deviation.value_or(0.0));
  }
  text += listText(finding.images, indent, whole ? kMostImages : kShownOnScreen);
  std::vector<std::string> others;
  for (const AlternativeCause& other : finding.alternatives) {
    others.push_back(fmt::format("or {} at {} ({})", other.effect, other.location, percentText(other.probability)));
  }
  text += listText(others, indent, whole ? others.size() : kShownOnScreen);
  const bool random = finding.effect == "joint_scatter";  // no model foretells it; poses that it spoils less can count for more
  if (finding.effect != "bad_samples" && !(random && !finding.shrinkage.claimed())) {
    text += howFar(finding.shrinkage);
  }
  if (!finding.reference.empty()) text += fmt::format("  {}\n", finding.reference);
  if (!finding.remedy.empty()) text += fmt::format("  what to do: {}\n", finding.remedy);
  if (!finding.separate_with.empty()) text += fmt::format("  to tell them apart: {}\n", finding.separate_with);
  return text;
}

/// What this capture could not test and why, the places of an effect together.
std::vector<std::string> untestedLines(const Diagnosis& diagnosis) {
  std::vector<std::pair<const NotTestable*, std::string>> reasons;  // the first of each, and all its places
  for (const NotTestable& each : diagnosis.not_testable) {
    // Of every joint, always: it is no lack of this capture.
    if (each.effect == "joint_offset") continue;
    const auto same = std::find_if(reasons.begin(), reasons.end(),
                                   [&each](const auto& r) { return r.first->effect == each.effect && r.first->why == each.why; });
    if (same != reasons.end()) {
      same->second += ", " + each.location;
    } else {
      reasons.emplace_back(&each, each.location);
    }
  }
  std::vector<std::string> lines;
  for (const auto& [first, places] : reasons) lines.push_back(fmt::format("{} at {} ({})", first->effect, places, first->why));
  return lines;
}

std::string untestedText(const Diagnosis& diagnosis) {
  const std::vector<std::string> untested = untestedLines(diagnosis);
  constexpr std::size_t kShown = 6;
  std::string text;
  for (std::size_t k = 0; k < untested.size() && k < kShown; ++k) text += fmt::format("  not tested: {}\n", untested[k]);
  if (untested.size() > kShown) {
    text += fmt::format("  and {} more that this capture cannot test, see diagnosis.json\n", untested.size() - kShown);
  }
  return text;
}

/// The same in one line, without places and reasons.
std::string untestedNames(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const NotTestable& each : diagnosis.not_testable) {
    if (each.effect == "joint_offset" || std::find(names.begin(), names.end(), each.effect) != names.end()) continue;
    names.push_back(each.effect);
  }
  if (names.empty()) return "";
  const std::size_t shown = std::min(names.size(), kShownOnScreen);
  std::string text =
      fmt::format("  not tested everywhere: {}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  if (names.size() > shown) text += fmt::format(" and {} more", names.size() - shown);
  return text + ", see diagnosis.json\n";
}

}  // namespace

std::string surenessText(double probability) {
  constexpr double kBeyondTelling = 0.999, kNearly = 0.99;
  if (probability >= kBeyondTelling) return "99.9 % sure or more";
  // Whole numbers would round to no doubt.
  return probability >= kNearly ? fmt::format("{:.1f} % sure", std::floor(1e3 * probability) / 10.0) : percentText(probability) + " sure";
}

std::string diagnosisText(const Diagnosis& diagnosis, const std::vector<Sample>&, TextLength length) {
  std::string text;
  if (diagnosis.isClean()) {
    text = "diagnosis: nothing beyond noise and geometry\n";
  } else if (diagnosis.findings.empty()) {
    text = "diagnosis: a gap, but no cause that helps on held-out poses\n";
  } else {
    text = fmt::format("diagnosis: {} {}\n", diagnosis.findings.size(), diagnosis.findings.size() == 1 ? "finding" : "findings");
    for (const Finding& finding : diagnosis.findings) text += findingText(diagnosis, finding, length);
  }
  std::vector<std::string> possible;
  for (const Finding& each : diagnosis.possibilities) {
    possible.push_back(fmt::format("possible: {} at {}, but it does not serve poses that the fit did not see: take more poses", each.effect,
                                   each.location));
  }
  text += listText(possible, "  ", length == TextLength::kWhole ? possible.size() : kShownOnScreen);
  text += remains(diagnosis);
  text += ladder(diagnosis, length);
  if (diagnosis.remaining_significant) {
    text += fmt::format("  still there: structure at {}, driven by {}\n", diagnosis.remaining_location, diagnosis.remaining_driver);
  }
  if (diagnosis.gap_remains) text += "  " + gapRemainsText(diagnosis) + "\n";
  if (diagnosis.arm_beyond_tolerance > 2.0) {
    text += fmt::format("  the arm is {:.1f} times farther from its nominal geometry than the tolerances allow: check robot and options\n",
                        diagnosis.arm_beyond_tolerance);
  }
  return text + (length == TextLength::kWhole ? untestedText(diagnosis) : untestedNames(diagnosis));
}

std::string explainEffect(const Diagnosis& diagnosis, const std::string& effect) {
  const EffectKind& kind = effectKind(effect);
  std::string text = fmt::format("{}: {}\n", kind.name, kind.meaning);
  for (const Finding& finding : diagnosis.findings) {
    if (finding.effect == effect) text += fmt::format("  found at {} ({})\n", finding.location, sizes(finding));
  }
  for (const Explained& each : diagnosis.explained) {
    if (each.effect != effect) continue;
    text += fmt::format(
        "  {} driven by {}: log odds {:.1f}, takes {:.1f} off chi-square, probability {:.3f}; smallest that would be seen {:.2g} {}\n",
        each.location, each.driver, each.log_evidence, each.chi_square, each.probability, each.smallest, each.unit);
  }
  for (const NotTestable& each : diagnosis.not_testable) {
    if (each.effect == effect) text += fmt::format("  {}: not testable, {}\n", each.location, each.why);
  }
  return text;
}

}  // namespace poecal
