#include "withheld/figures.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace withheld {

Cases select(const Cases& cases, const Test& test) {
  Cases selected;
  std::copy_if(cases.begin(), cases.end(), std::back_inserter(selected), [&](const Scored* scored) { return test(*scored); });
  return selected;
}

Cases select(const std::vector<Scored>& cases, const Test& test) {
  Cases selected;
  for (const Scored& scored : cases) {
    if (test(scored)) selected.push_back(&scored);
  }
  return selected;
}

Cases ofSet(const std::vector<Scored>& cases, const std::string& set) {
  return select(cases, [&](const Scored& scored) { return scored.truth.set == set; });
}

std::size_t countOf(const Cases& cases, const Test& test) {
  return static_cast<std::size_t>(std::count_if(cases.begin(), cases.end(), [&](const Scored* scored) { return test(*scored); }));
}

double leastS(const Scored& scored) {
  double least = INFINITY;
  for (const TrueEffect& effect : scored.truth.effects) least = std::min(least, effect.S);
  return least;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

std::optional<double> predictedShare(const Scored& scored) {
  if (!(scored.before_px > 0.0) || !(scored.after_px > 0.0)) return std::nullopt;
  return 1.0 - scored.after_px / scored.before_px;
}

bool isRight(const TrueEffect& effect, const Fate& fate) { return effect.listed ? fate.right : fate.unknown_there; }

bool allRight(const Scored& s) {
  for (std::size_t i = 0; i < s.verdict.fates.size(); ++i) {
    if (!isRight(s.truth.effects[i], s.verdict.fates[i])) return false;
  }
  return true;
}
bool allInClass(const Scored& s) {
  return std::all_of(s.verdict.fates.begin(), s.verdict.fates.end(), [](const Fate& fate) { return fate.in_class; });
}
bool allAmong(const Scored& s) {
  return std::all_of(s.verdict.fates.begin(), s.verdict.fates.end(), [](const Fate& fate) { return fate.among; });
}
bool isReal(const Scored& s) { return !s.truth.recording.empty(); }
bool anyFinding(const Scored& s) { return s.verdict.findings > 0; }
bool noFinding(const Scored& s) { return s.verdict.findings == 0; }
bool wrongName(const Scored& s) { return s.verdict.wrong_names > 0; }
bool extra(const Scored& s) { return s.verdict.extras > 0; }
bool falseExtra(const Scored& s) { return extra(s) || wrongName(s); }

void Figures::add(const std::string& set, const std::string& question, const Cases& cases, const Test& test, const std::string& wanted) {
  if (!cases.empty()) text_ += fmt::format("| {} | {} | {} | {} |\n", set, question, share(countOf(cases, test), cases.size()), wanted);
}

std::string Figures::text() const {
  return text_.empty() ? "" : "| set | question | share (cases; Wilson 95 %) | wanted |\n|---|---|---|---|\n" + text_;
}

void addSingles(Figures& figures, const std::vector<Scored>& cases, const std::string& set) {
  struct Bin {
    double low, high;
    const char *name, *right, *wrong;
  };
  for (const Bin& bin : {Bin{5, 8, "S 5 to 8", ">= 85 %", ""}, Bin{8, 12, "S 8 to 12", ">= 97 %", "<= 1 %"},
                         Bin{12, 1e9, "S above 12", ">= 99 %", "<= 1 %"}}) {
    const Cases inside = select(cases, [&](const Scored& s) { return s.truth.set == set && leastS(s) >= bin.low && leastS(s) < bin.high; });
    const auto asked = [&](const char* question) { return fmt::format("{}, {}", bin.name, question); };
    const bool tidy = set == "single";
    const char* wanted = tidy ? bin.right : ">= 95 %";
    figures.add(set, asked("right effect and place"), inside, allRight, wanted);
    // No diagnosis can tell what is so close: named together, they count as one.
    figures.add(set, asked("right, or less than 3.3 sigma from what is named and named beside it"), inside, allInClass, wanted);
    // Two hypotheses 4.7 sigma apart are mistaken for each other in 1 % of all cases; nearer ones no diagnosis can tell well.
    figures.add(set, asked("right, of those 4.7 sigma or more from any other"),
                select(inside, [](const Scored& s) { return s.truth.effects[0].left_by_nearest >= 4.7; }), allRight, "");
    figures.add(set, asked("true one among finding and alternatives"), inside, allAmong, ">= 95 %");
    figures.add(set, asked("wrongly named"), inside, wrongName, tidy ? bin.wrong : "");
    figures.add(
        set, asked("called unknown, right place"), inside, [](const Scored& s) { return s.verdict.fates[0].unknown_there && !allRight(s); },
        "");
    figures.add(set, asked("missed"), inside, noFinding, "");
    figures.add(
        set, asked("no second finding"), inside, [](const Scored& s) { return !extra(s); }, ">= 98 %");
  }
}

}  // namespace withheld
