// Choosing the effects of a case so that they leave as much as is wanted.
#pragma once

#include <functional>
#include <optional>

#include "withheld/case.hpp"

namespace withheld {

/// Scales a flaw until it leaves S. @return false where no credible size does.
bool scaleTo(double S, const Leftover& leftover, Flaw& flaw);

/// Names of the listed kinds that a single effect is drawn from.
const std::vector<std::string>& listedNames();

/// What a kind needs of the capture.
struct KindNeeds {
  bool stamp = false, dir = false, dq = false, several_tags = false;
};
KindNeeds needsOf(const std::string& effect);

/// A flaw of the kind at a random place, leaving S; nothing where the cell has no such place.
std::optional<Hidden> chooseListed(const Case& made, const Leftover& leftover, const std::string& effect, double S, Chance& chance);

/// Two hypotheses so many sigma apart are mistaken for each other in 5 % of all cases: nearer ones are a class, to be named together.
constexpr double kTellable = 3.3;

/// Fills aliases, close and nearest of a hidden effect from every listed effect that the cell can have; where no masses are told, gravity's
/// effects are those of an arm of any masses.
void compareWithListed(const Case& made, const Leftover& leftover, Hidden& hidden);

/// One that the table does not have and that no listed one explains.
/// @param draw  a flaw of usual size
std::optional<Hidden> chooseStrange(const Case& made, const Leftover& leftover, double S, const std::function<Flaw()>& draw);

}  // namespace withheld
