#include "withheld/tables.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "withheld/figures.hpp"
#include "withheld/injected_table.hpp"

namespace withheld {
namespace {

std::string figuresOf(const std::vector<Scored>& cases) {
  Figures figures;
  addSingles(figures, cases, "single");
  figures.add("clean", "any finding", ofSet(cases, "clean"), anyFinding, "<= 1 %");
  figures.add("untidy", "any finding but wild rows", ofSet(cases, "untidy"), anyFinding, "<= 2 %");
  addSingles(figures, cases, "untidy-single");
  addSingles(figures, cases, "rendered");
  const Cases pairs = ofSet(cases, "pairs");
  figures.add("pairs", "both right", pairs, allRight, ">= 92 %");
  figures.add(
      "pairs", "at least one right", pairs, [](const Scored& s) { return s.verdict.fates[0].right || s.verdict.fates[1].right; }, "");
  figures.add("pairs", "false extra", pairs, falseExtra, "<= 3 %");
  const Cases outside = ofSet(cases, "outside");
  figures.add(
      "outside", "unknown at the right place", outside, [](const Scored& s) { return s.verdict.fates[0].unknown_there; }, ">= 92 %");
  figures.add(
      "outside", "and the right driver", outside, [](const Scored& s) { return s.verdict.fates[0].unknown_driver; }, ">= 85 %");
  figures.add("outside", "wrongly named", outside, wrongName, "<= 3 %");
  figures.add("outside", "second finding", outside, extra, "none");
  figures.add("outside", "missed", outside, noFinding, "");
  const Cases scatter = ofSet(cases, "scatter");
  figures.add("scatter", "joint_scatter at the right joint", scatter, allRight, ">= 92 %");
  figures.add("scatter", "wrongly named", scatter, wrongName, "");
  const Cases scale = ofSet(cases, "scale");
  figures.add("scale", "target_scale", scale, allRight, ">= 95 %");
  constexpr double kSizeWithin = 0.003;
  figures.add(
      "scale", "and its size within 0.3 %", scale,
      [](const Scored& s) {
        return std::any_of(s.answer.findings.begin(), s.answer.findings.end(), [&](const Finding& f) {
          return f.effect == "target_scale" && f.size && std::abs(*f.size - s.truth.effects[0].size) <= kSizeWithin;
        });
      },
      ">= 95 %");
  figures.add("scale", "a finding of another name", scale, wrongName, "");
  const Cases silent = ofSet(cases, "unobservable");
  figures.add("unobservable", "nothing claimed", silent, noFinding, "100 %");
  figures.add(
      "unobservable", "listed as not testable", silent, [](const Scored& s) { return s.verdict.silent_listed; }, "100 %");
  addHarder(figures, cases);
  return figures.text();
}

std::string byEffect(const std::vector<Scored>& cases, const std::string& set) {
  struct Row {
    std::size_t right = 0, above = 0, right_above = 0, driver = 0, of = 0;
    std::map<std::string, int> instead;
  };
  constexpr double kClear = 8.0;
  std::map<std::string, Row> rows;
  for (const Scored* scored : ofSet(cases, set)) {
    const TrueEffect& effect = scored->truth.effects[0];
    const Fate& fate = scored->verdict.fates[0];
    const bool right = isRight(effect, fate);
    Row& row = rows[effect.effect];
    ++row.of;
    row.right += right ? 1 : 0;
    row.driver += (effect.listed ? fate.right_driver : fate.unknown_driver) ? 1 : 0;
    row.above += effect.S >= kClear ? 1 : 0;
    row.right_above += effect.S >= kClear && right ? 1 : 0;
    if (!right) {
      const std::string said = scored->verdict.said.empty() ? "nothing" : scored->verdict.said.front();
      ++row.instead[said.substr(0, said.find('@')) + (fate.right_place ? " there" : "")];
    }
  }
  if (rows.empty()) return "";
  std::string text =
      fmt::format("\n{}, effect by effect:\n\n| effect | right | S >= 8 | right driver | said instead |\n|---|---|---|---|---|\n", set);
  for (const auto& [effect, row] : rows) {
    std::vector<std::string> instead;
    for (const auto& [said, count] : row.instead) instead.push_back(fmt::format("{} {}", count, said));
    text += fmt::format("| {} | {}/{} | {}/{} | {}/{} | {} |\n", effect, row.right, row.of, row.right_above, row.above, row.driver, row.of,
                        fmt::join(instead, ", "));
  }
  return text;
}

/// Expected calibration error: |stated - true share| over ten bins, weighted by how many statements each has.
std::string calibration(const std::vector<Scored>& cases) {
  struct Bin {
    double stated = 0.0, true_ = 0.0;
    std::size_t of = 0;
  };
  std::vector<Bin> bins(10);
  std::size_t all = 0;
  for (const Scored& scored : cases) {
    if (isReal(scored)) continue;
    for (const Stated& stated : scored.verdict.stated) {
      Bin& bin = bins[std::min<std::size_t>(9, static_cast<std::size_t>(std::max(0.0, stated.probability * 10.0)))];
      bin.stated += stated.probability;
      bin.true_ += stated.true_ ? 1.0 : 0.0;
      ++bin.of;
      ++all;
    }
  }
  if (all == 0) return "";
  std::string text = "\n| stated probability, mean | true | statements |\n|---|---|---|\n";
  double error = 0.0;
  for (const Bin& bin : bins) {
    if (bin.of == 0) continue;
    const auto of = static_cast<double>(bin.of);
    text += fmt::format("| {:.3f} | {:.3f} | {} |\n", bin.stated / of, bin.true_ / of, bin.of);
    error += std::abs(bin.stated - bin.true_) / static_cast<double>(all);
  }
  return text + fmt::format("\nExpected calibration error {:.3f} (wanted <= 0.05).\n", error);
}

/// One row: how much of the error on unseen corners is predicted.
std::string predictedRow(const std::string& set, const Cases& cases) {
  std::vector<double> shares;
  for (const Scored* s : cases) {
    if (const std::optional<double> share = predictedShare(*s)) shares.push_back(*share);
  }
  if (shares.empty()) return "";
  return fmt::format("\n{}: {:.0f} % of the error on unseen corners is predicted (median; quartiles {:.0f} and {:.0f} %, {} cases).\n", set,
                     100.0 * quantile(shares, 0.5), 100.0 * quantile(shares, 0.25), 100.0 * quantile(shares, 0.75), shares.size());
}

/// One row: how often the claimed interval holds, and what is left over what a fit leaves that is told.
std::string shrinkageRow(const std::string& name, const Cases& cases) {
  std::vector<double> differences, beyond_oracle;
  std::size_t inside = 0, near_oracle = 0;
  constexpr double kClear = 12.0, kBeyondOracle = 1.1;
  for (const Scored* s : cases) {
    if (s->before_px <= 0.0 || s->after_px <= 0.0) continue;
    if (s->answer.shrinkage && anyFinding(*s)) {
      const double measured = 1.0 - s->after_px / s->before_px;
      differences.push_back(std::abs(*s->answer.shrinkage - measured));
      inside += measured >= s->answer.shrinkage_low && measured <= s->answer.shrinkage_high ? 1 : 0;
    }
    if (s->truth.oracle_px && !s->truth.effects.empty() && leastS(*s) >= kClear && allRight(*s)) {
      beyond_oracle.push_back(s->after_px / *s->truth.oracle_px);
      near_oracle += beyond_oracle.back() <= kBeyondOracle ? 1 : 0;
    }
  }
  if (differences.empty()) return "";
  const std::string told = beyond_oracle.empty() ? "| |"
                                                 : fmt::format("{:.2f}; {:.2f} | {} |", quantile(beyond_oracle, 0.5),
                                                               quantile(beyond_oracle, 0.9), share(near_oracle, beyond_oracle.size()));
  return fmt::format("| {} | {} | {:.3f} | {}\n", name, share(inside, differences.size()), quantile(differences, 0.5), told);
}

std::string shrinkage(const std::vector<Scored>& cases) {
  const auto listedAlone = [](const Scored& s) {
    return std::all_of(s.truth.effects.begin(), s.truth.effects.end(), [](const TrueEffect& effect) { return effect.listed; });
  };
  const Cases scatter = ofSet(cases, "scatter"), half = ofSet(cases, "half");
  const Cases unlisted = select(cases, [&](const Scored& s) { return !listedAlone(s) && s.truth.set != "half"; });
  const Cases listed = select(cases, [&](const Scored& s) { return listedAlone(s) && s.truth.set != "scatter"; });
  const std::string rows = shrinkageRow("all", select(cases, [](const Scored&) { return true; })) + shrinkageRow("listed effects", listed) +
                           shrinkageRow("effects that are not listed", unlisted) + shrinkageRow("listed beside unlisted", half) +
                           shrinkageRow("joints that scatter", scatter) + predictedRow("waves", ofSet(cases, "waves")) +
                           predictedRow("field-80", ofSet(cases, "field-80")) + predictedRow("field-300", ofSet(cases, "field-300"));
  if (rows.empty()) return "";
  return "\nShrinkage claimed against measured on corners never shown (wanted: inside >= 90 %), and what is left over what a fit leaves\n"
         "that is told the effect (S above 12).\n\n"
         "| cases | inside the interval | median difference | over the told fit: median; 90 % below | within 10 % |\n"
         "|---|---|---|---|---|\n" +
         rows;
}

std::string times(const std::vector<Scored>& cases) {
  std::vector<double> seconds, fits, at80;
  for (const Scored& s : cases) {
    if (s.seconds <= 0.0 || s.truth.set == "rendered" || isReal(s)) continue;  // of pictures most goes into finding corners
    seconds.push_back(s.seconds);
    if (s.identify_seconds > 0.0) fits.push_back(s.seconds / s.identify_seconds);
    if (s.truth.shots >= 70 && s.truth.shots <= 90) at80.push_back(s.seconds);
  }
  if (seconds.empty()) return "";
  return fmt::format(
      "\nProcessor time of a case: median {:.2f} s, longest {:.2f} s; of 70 to 90 poses median {:.2f} s;\n"
      "in runs of `identify` median {:.1f}, most {:.1f}.\n",
      quantile(seconds, 0.5), quantile(seconds, 1.0), quantile(at80, 0.5), quantile(fits, 0.5), quantile(fits, 1.0));
}

/// What simple diagnoses would have said, beside what poecal says, of the cases that they were asked of.
std::string comparison(const std::vector<Scored>& cases) {
  std::map<std::string, std::vector<Scored>> by_program;
  for (const Scored& scored : cases) {
    if (scored.truth.baselines.empty()) continue;
    by_program["poecal"].push_back(scored);
    for (const auto& [name, places] : scored.truth.baselines) {
      Answer answer;
      for (const std::string& place : places) {
        Finding finding;
        finding.effect = place.substr(0, place.find('@'));
        finding.location = place.substr(place.find('@') + 1);
        answer.findings.push_back(finding);
      }
      by_program[name].push_back({scored.truth, judge(scored.truth, answer), answer, true});
    }
  }
  if (by_program.empty()) return "";
  std::string text =
      "\n| diagnosis | single, S 5 to 8: right | 8 to 12 | above 12 | above 8, and nothing else | clean: alarm | pairs: both right | "
      "outside: "
      "wrongly named |\n|---|---|---|---|---|---|---|---|\n";
  for (const auto& [name, scored] : by_program) {
    const auto singles = [&scored](double low, double high) {
      return select(scored, [=](const Scored& s) { return s.truth.set == "single" && leastS(s) >= low && leastS(s) < high; });
    };
    const auto shareOf = [](const Cases& some, const Test& test) {
      return some.empty() ? std::string("-")
                          : fmt::format("{:.1f} %", 100.0 * static_cast<double>(countOf(some, test)) / static_cast<double>(some.size()));
    };
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", name, shareOf(singles(5.0, 8.0), allRight),
                        shareOf(singles(8.0, 12.0), allRight), shareOf(singles(12.0, INFINITY), allRight),
                        shareOf(singles(8.0, INFINITY), [](const Scored& s) { return allRight(s) && !extra(s); }),
                        shareOf(ofSet(scored, "clean"), anyFinding), shareOf(ofSet(scored, "pairs"), allRight),
                        shareOf(ofSet(scored, "outside"), wrongName));
  }
  return text;
}

/// Every case whose answer is not what it should be, for whoever wants to look at it.
std::string wrongAnswers(const std::vector<Scored>& cases) {
  std::string text;
  for (const Scored& s : cases) {
    if (isReal(s)) continue;
    if (s.answered && s.verdict.extras == 0 && s.verdict.wrong_names == 0 && allRight(s)) continue;
    std::vector<std::string> is;
    for (const TrueEffect& effect : s.truth.effects) {
      is.push_back(fmt::format("{} ({}, S {:.1f})", placeName(effect.effect, effect.location), effect.driver, effect.S));
    }
    text += fmt::format("| {} | {} | {} |\n", (s.truth.folder.parent_path().filename() / s.truth.folder.filename()).string(),
                        is.empty() ? "nothing" : fmt::format("{}", fmt::join(is, ", ")),
                        !s.answered              ? "no answer"
                        : s.verdict.said.empty() ? "nothing"
                                                 : fmt::format("{}", fmt::join(s.verdict.said, ", ")));
  }
  return text.empty() ? "" : "\n| case | is | said |\n|---|---|---|\n" + text;
}

}  // namespace

Interval wilson(std::size_t hits, std::size_t of) {
  if (of == 0) return {};
  const double z = 1.959964, n = static_cast<double>(of), p = static_cast<double>(hits) / n;
  const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

std::string share(std::size_t hits, std::size_t of) {
  const Interval interval = wilson(hits, of);
  return fmt::format("{:.1f} % ({}/{}; {:.1f} to {:.1f})", of ? 100.0 * static_cast<double>(hits) / static_cast<double>(of) : 0.0, hits, of,
                     100.0 * interval.low, 100.0 * interval.high);
}

std::string tables(const std::vector<Scored>& cases) {
  const auto unanswered = static_cast<std::size_t>(std::count_if(cases.begin(), cases.end(), [](const Scored& s) { return !s.answered; }));
  std::string text = fmt::format("{} cases, {} without an answer.\n\n", cases.size(), unanswered);
  return text + figuresOf(cases) + calibration(cases) + comparison(cases) + shrinkage(cases) + times(cases) + byEffect(cases, "single") +
         byEffect(cases, "untidy-single") + byEffect(cases, "rendered") + byEffect(cases, "outside") + byEffect(cases, "fast") +
         wrongAnswers(cases) + injected(cases);
}

}  // namespace withheld
