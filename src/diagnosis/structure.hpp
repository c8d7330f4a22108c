// What has no name in a search for effects: curves and waves, and how they stand beside names and beside joints that move at random.
#pragma once

#include "diagnosis/search_state.hpp"

namespace poecal {

/// Takes up an answer. Structure that was found beside a harmonic of the same angle is one cause with it: what stands for both takes the
/// place of both.
void takeUp(SearchState& search, const Ranking& ranking, std::size_t chosen);

/// A joint that moves at random is what is left when all that follows its pose is known: what can still be told beside it, or of which
/// there is more than it explains, comes first. @param without  the ranking in which it is the best.
/// @return whether there was any, which is taken in its place
bool takeStructureBeside(SearchState& search, const Ranking& without, const RankedAnswer& scatter);

/// A named effect that was taken last is not the cause where a curve at the same place still finds structure with it in, and explains as
/// much: it is the nearest shape that has a name. The curve then takes its place.
/// @param ranking, named  that it was taken from
void preferCurve(SearchState& search, const Ranking& ranking, std::size_t named);

/// Further waves at the joints at which there are some, and further frequencies of mounts that sway: with those in, the noise is less and
/// more of them show.
/// @return whether there were any
bool growStructure(SearchState& search);

/// A few waves of one angle each that were taken last, or a curve of time, may be several effects that have names: these are the answer
/// where they serve as well.
void splitIntoNames(SearchState& search);

/// Structure at a place of which effects that have a name are a part: with them in, what is left is less than it was, and explains the rows
/// at a lower price. They and the rest of the structure take its place. @return whether there were any
bool nameWhatHasAName(SearchState& search, std::size_t number);

}  // namespace poecal
