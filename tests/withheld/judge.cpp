#include "withheld/judge.hpp"

#include <algorithm>

namespace withheld {
namespace {

const char* const kUnknown = "unknown";

/// Its location, or that of one of its aliases.
bool isAt(const TrueEffect& effect, const std::string& location) {
  if (effect.location == location) return true;
  return std::any_of(effect.aliases.begin(), effect.aliases.end(),
                     [&](const std::string& alias) { return alias.ends_with("@" + location); });
}

/// Whether an effect is one of a finding's alternatives.
bool namesBeside(const Finding& finding, const TrueEffect& effect) {
  return std::any_of(finding.alternatives.begin(), finding.alternatives.end(),
                     [&](const Named& other) { return effect.is(other.place()); });
}

/// Whether a finding is of what can hardly be told from an effect, and says that it may be that.
bool namesItsClass(const Finding& finding, const TrueEffect& effect) {
  return std::find(effect.close.begin(), effect.close.end(), finding.place()) != effect.close.end() && namesBeside(finding, effect);
}

Fate fateOf(const TrueEffect& effect, const std::vector<Finding>& findings) {
  Fate fate;
  for (const Finding& finding : findings) {
    const bool right = effect.is(finding.place());
    const bool there = isAt(effect, finding.location);
    const bool unknown = there && finding.effect == kUnknown;
    fate.right = fate.right || right;
    fate.right_driver = fate.right_driver || (right && finding.driver == effect.driver);
    fate.right_place = fate.right_place || there;
    fate.unknown_there = fate.unknown_there || unknown;
    fate.unknown_driver = fate.unknown_driver || (unknown && finding.driver == effect.driver);
    fate.among = fate.among || right || namesBeside(finding, effect);
    fate.in_class = fate.in_class || right || namesItsClass(finding, effect);
  }
  return fate;
}

/// What was stated of a finding; a right one's aliases are the same statement.
double probabilityOf(const Finding& finding, const Truth& truth) {
  double probability = finding.probability;
  for (const TrueEffect& effect : truth.effects) {
    if (!effect.is(finding.place())) continue;
    for (const Named& other : finding.alternatives) probability += effect.is(other.place()) ? other.probability : 0.0;
  }
  return probability;
}

}  // namespace

Verdict judge(const Truth& truth, const Answer& answer) {
  std::vector<Finding> findings = answer.findings;
  if (!truth.wild.empty()) std::erase_if(findings, [](const Finding& finding) { return finding.effect == "bad_samples"; });

  Verdict verdict;
  verdict.findings = findings.size();
  for (const TrueEffect& effect : truth.effects) verdict.fates.push_back(fateOf(effect, findings));
  for (const Finding& finding : findings) {
    verdict.said.push_back(finding.place());
    const bool there =
        std::any_of(truth.effects.begin(), truth.effects.end(), [&](const TrueEffect& effect) { return effect.is(finding.place()); });
    const bool in_class =
        std::any_of(truth.effects.begin(), truth.effects.end(), [&](const TrueEffect& effect) { return namesItsClass(finding, effect); });
    if (!there && !in_class && finding.effect != kUnknown) ++verdict.wrong_names;
    if (finding.effect != kUnknown) verdict.stated.push_back({probabilityOf(finding, truth), there});
  }
  verdict.extras = findings.size() > truth.effects.size() ? findings.size() - truth.effects.size() : 0;
  for (const std::string& place : truth.silent) {
    const bool listed = std::find(answer.not_testable.begin(), answer.not_testable.end(), place) != answer.not_testable.end();
    verdict.silent_listed = verdict.silent_listed && listed;
  }
  return verdict;
}

}  // namespace withheld
