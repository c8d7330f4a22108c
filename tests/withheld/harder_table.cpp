#include <cmath>

#include <fmt/format.h>

#include "withheld/figures.hpp"

namespace withheld {
namespace {

const char* const kScatter = "joint_scatter";

/// Scatter of a joint that has none, said to be sure.
bool sureScatter(const Scored& s) {
  constexpr double kSure = 0.99;
  for (const Finding& finding : s.answer.findings) {
    if (finding.effect == kScatter && finding.probability >= kSure) return true;
  }
  return false;
}

bool oneFinding(const Scored& s) { return s.verdict.findings == 1; }

Test predicts(double share) {
  return [share](const Scored& s) { return predictedShare(s).value_or(0.0) >= share; };
}

/// Findings that are neither of the two, by name or as unknown in place.
bool otherFinding(const Scored& s) {
  for (const Finding& finding : s.answer.findings) {
    bool of_some = false;
    for (const TrueEffect& effect : s.truth.effects) {
      const bool unknown_there = finding.effect == "unknown" && finding.location == effect.location;
      bool beside = false;
      for (const Named& other : finding.alternatives) beside = beside || effect.is(other.place());
      of_some = of_some || effect.is(finding.place()) || unknown_there || beside;
    }
    if (!of_some) return true;
  }
  return false;
}

void addUnlisted(Figures& figures, const std::vector<Scored>& cases, const std::string& set, const char* wanted, double share) {
  const Cases all = ofSet(cases, set);
  figures.add(set, "unknown in its place", all, allRight, wanted);
  figures.add(set, "sure scatter", all, sureScatter, "none");
  figures.add(
      set, "scatter, not sure, in its place", all,
      [](const Scored& s) {
        return !allRight(s) && !sureScatter(s) && s.verdict.fates[0].right_place && s.answer.findings[0].effect == kScatter;
      },
      "");
  figures.add(set, "wrongly named", all, wrongName, "");
  figures.add(set, "more than one finding", all, extra, "");
  figures.add(set, fmt::format("{:.0f} % or more of it predicted on unseen poses", 100.0 * share), all, predicts(share), "");
}

}  // namespace

void addHarder(Figures& figures, const std::vector<Scored>& cases) {
  const Cases half = ofSet(cases, "half");
  figures.add(
      "half", "listed one right", half, [](const Scored& s) { return s.verdict.fates[0].right; }, ">= 92 %");
  figures.add(
      "half", "listed one right, or one of a class that is named together", half,
      [](const Scored& s) { return s.verdict.fates[0].in_class; }, ">= 92 %");
  figures.add(
      "half", "unlisted one unknown in its place", half, [](const Scored& s) { return s.verdict.fates[1].unknown_there; }, ">= 85 %");
  figures.add("half", "another finding", half, otherFinding, "<= 5 %");
  addUnlisted(figures, cases, "waves", ">= 97 %", 0.8);
  addUnlisted(figures, cases, "field-80", ">= 92 %", 0.4);
  addUnlisted(figures, cases, "field-300", ">= 92 %", 0.6);
  const Cases fast = ofSet(cases, "fast");
  figures.add(
      "fast", "unknown, or a name of its joint, in its place", fast,
      [](const Scored& s) {
        return s.verdict.fates[0].right_place && (s.answer.findings[0].effect != kScatter || s.verdict.fates[0].unknown_there);
      },
      ">= 92 %");
  figures.add("fast", "one finding", fast, oneFinding, "");
  figures.add("fast", "sure scatter", fast, sureScatter, "");
  figures.add("fast", "missed", fast, noFinding, "");
  const Cases large = ofSet(cases, "large");
  figures.add("large", "right effect and place", large, allRight, ">= 97 %");
  figures.add("large", "right, or one of a class that is named together", large, allInClass, ">= 97 %");
  figures.add("large", "more than one finding", large, extra, "");
  addSingles(figures, cases, "small");
  addSingles(figures, cases, "in-hand");
  const Cases triple = ofSet(cases, "triple");
  figures.add("triple", "all three right", triple, allRight, "");
  figures.add("triple", "all three right, or of a class that is named together", triple, allInClass, "");
  figures.add("triple", "false extra", triple, falseExtra, "<= 3 %");
  const Cases bare = ofSet(cases, "bare");
  figures.add("bare", "right effect and place", bare, allRight, "");
  figures.add(
      "bare", "true one, or its class, among finding and alternatives", bare, [](const Scored& s) { return allAmong(s) || allInClass(s); },
      ">= 95 %");
  figures.add("bare", "missed", bare, noFinding, "");
  figures.add("bare", "more than one finding", bare, extra, "");
}

}  // namespace withheld
