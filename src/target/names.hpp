// Names that target.yaml may use for tag families and marker dictionaries, with the number of ids that each has.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace poecal {

/// A tag family of AprilTag or a marker dictionary of OpenCV; its ids are 0 .. count - 1.
struct IdSet {
  std::string_view name;
  int count = 0;
};

std::span<const IdSet> tagFamilies();
std::span<const IdSet> markerDictionaries();

/// The family or dictionary of that name. @param kind  what it is called in the message.
/// @throws InvalidArgument that lists the known names.
const IdSet& findIdSet(std::span<const IdSet> sets, const std::string& name, const char* kind);

/// Whether tags of that family are drawn with a black border of two cells too (Kalibr's boards): the families of AprilTag 2.
bool mayHaveWideBorder(const std::string& family);

}  // namespace poecal
