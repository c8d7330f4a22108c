#include "target/names.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

constexpr IdSet kFamilies[] = {
    {"tag36h11", 587},         {"tag36h10", 2320},         {"tag25h9", 35},
    {"tag16h5", 30},           {"tagCircle21h7", 38},      {"tagCircle49h12", 65535},
    {"tagCustom48h12", 42211}, {"tagStandard41h12", 2115}, {"tagStandard52h13", 48714},
};

constexpr IdSet kDictionaries[] = {
    {"DICT_4X4_50", 50},           {"DICT_4X4_100", 100},      {"DICT_4X4_250", 250},      {"DICT_4X4_1000", 1000},
    {"DICT_5X5_50", 50},           {"DICT_5X5_100", 100},      {"DICT_5X5_250", 250},      {"DICT_5X5_1000", 1000},
    {"DICT_6X6_50", 50},           {"DICT_6X6_100", 100},      {"DICT_6X6_250", 250},      {"DICT_6X6_1000", 1000},
    {"DICT_7X7_50", 50},           {"DICT_7X7_100", 100},      {"DICT_7X7_250", 250},      {"DICT_7X7_1000", 1000},
    {"DICT_ARUCO_ORIGINAL", 1024}, {"DICT_APRILTAG_16h5", 30}, {"DICT_APRILTAG_25h9", 35}, {"DICT_APRILTAG_36h10", 2320},
    {"DICT_APRILTAG_36h11", 587},
};

}  // namespace

std::span<const IdSet> tagFamilies() { return kFamilies; }
std::span<const IdSet> markerDictionaries() { return kDictionaries; }

const IdSet& findIdSet(std::span<const IdSet> sets, const std::string& name, const char* kind) {
  const auto found = std::find_if(sets.begin(), sets.end(), [&](const IdSet& set) { return set.name == name; });
  if (found != sets.end()) return *found;
  std::vector<std::string_view> names;
  for (const IdSet& set : sets) names.push_back(set.name);
  throw InvalidArgument(fmt::format("{} '{}' is not known, expected one of: {}", kind, name, fmt::join(names, ", ")));
}

bool mayHaveWideBorder(const std::string& family) {
  return family == "tag36h11" || family == "tag36h10" || family == "tag25h9" || family == "tag16h5";
}

}  // namespace poecal
