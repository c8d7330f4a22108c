// Counting cases: which of them, what is asked of each, and the rows of a table.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "withheld/tables.hpp"

namespace withheld {

using Cases = std::vector<const Scored*>;
using Test = std::function<bool(const Scored&)>;

Cases select(const Cases& cases, const Test& test);
Cases select(const std::vector<Scored>& cases, const Test& test);
Cases ofSet(const std::vector<Scored>& cases, const std::string& set);
std::size_t countOf(const Cases& cases, const Test& test);

/// Least of the S of a case's effects.
double leastS(const Scored& scored);
double quantile(std::vector<double> values, double q);
/// Share of the error on unseen corners that went away with the findings; nothing where it was not measured.
std::optional<double> predictedShare(const Scored& scored);

/// A listed effect is right under its name, an unlisted one as unknown in its place.
bool isRight(const TrueEffect& effect, const Fate& fate);
bool allRight(const Scored& s);
/// Every effect is right, or told as one of a class that no diagnosis tells apart.
bool allInClass(const Scored& s);
/// Every effect is right, or among the alternatives of a finding.
bool allAmong(const Scored& s);
/// A recording has findings of its own, of which nobody knows the truth.
bool isReal(const Scored& s);
bool anyFinding(const Scored& s);
bool noFinding(const Scored& s);
bool wrongName(const Scored& s);
bool extra(const Scored& s);
/// A finding beyond those that are hidden, or one of another name.
bool falseExtra(const Scored& s);

/// A table whose rows are what was asked, what came out and what is wanted.
class Figures {
 public:
  /// @param wanted  empty where nothing is
  void add(const std::string& set, const std::string& question, const Cases& cases, const Test& test, const std::string& wanted);
  std::string text() const;

 private:
  std::string text_;
};

/// Rows of a set with one listed effect a case, by S.
void addSingles(Figures& figures, const std::vector<Scored>& cases, const std::string& set);
/// Rows of the sets of harder_sets.hpp.
void addHarder(Figures& figures, const std::vector<Scored>& cases);

}  // namespace withheld
