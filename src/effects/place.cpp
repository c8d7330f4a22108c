#include "poecal/effects/place.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "core/numbered.hpp"

namespace poecal {
namespace {

/// Index from 0 of "q3" for the prefix "q"; nothing where `word` is no such word.
std::optional<std::size_t> indexAfter(std::string_view word, std::string_view prefix) {
  const int number = numberAfter(word, prefix).value_or(0);
  return number > 0 ? std::optional(static_cast<std::size_t>(number - 1)) : std::nullopt;
}

/// Of "q1,q3,q4"; none where `name` is no such list.
std::vector<std::size_t> jointsIn(std::string_view name) {
  std::vector<std::size_t> joints;
  if (name.find(',') == std::string_view::npos) return joints;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find(',', begin), name.size());
    const std::optional<std::size_t> joint = indexAfter(name.substr(begin, end - begin), "q");
    if (!joint) return {};
    joints.push_back(*joint);
    begin = end + 1;
  }
  return joints;
}

constexpr std::array<std::pair<const char*, DriverKind>, 6> kWords = {{{"dq", DriverKind::kVelocity},
                                                                       {"gravity", DriverKind::kGravity},
                                                                       {"stamp", DriverKind::kStamp},
                                                                       {"temperature", DriverKind::kTemperature},
                                                                       {"pixel", DriverKind::kPixel},
                                                                       {"none", DriverKind::kNone}}};
constexpr std::array<std::pair<const char*, DriverKind>, 3> kNumbered = {
    {{"q", DriverKind::kReading}, {"tau", DriverKind::kTorque}, {"dir", DriverKind::kDirection}}};

}  // namespace

const char* placeName(PlaceKind kind) {
  switch (kind) {
    case PlaceKind::kJoint:
      return "joint";
    case PlaceKind::kLink:
      return "link";
    case PlaceKind::kBase:
      return "base";
    case PlaceKind::kCameraMount:
      return "camera.mount";
    case PlaceKind::kCameraLens:
      return "camera.lens";
    case PlaceKind::kCameraShutter:
      return "camera.shutter";
    case PlaceKind::kTargetShape:
      return "target.shape";
    case PlaceKind::kTargetMount:
      return "target.mount";
    case PlaceKind::kTiming:
      return "timing";
    case PlaceKind::kDetector:
      return "detector";
    case PlaceKind::kSamples:
      return "samples";
  }
  return "";
}

bool isNumbered(PlaceKind kind) { return kind == PlaceKind::kJoint || kind == PlaceKind::kLink; }

std::string Place::name() const { return isNumbered(kind) ? fmt::format("{}:{}", placeName(kind), index + 1) : placeName(kind); }

std::optional<Place> Place::of(const std::string& name) {
  for (int number = 0; number <= static_cast<int>(PlaceKind::kSamples); ++number) {
    const auto kind = static_cast<PlaceKind>(number);
    if (!isNumbered(kind) && name == placeName(kind)) return Place{kind, 0};
    if (!isNumbered(kind)) continue;
    if (const auto index = indexAfter(name, std::string(placeName(kind)) + ":")) return Place{kind, *index};
  }
  return {};
}

Driver::Driver(std::string name) : name_(std::move(name)) {
  if (name_.empty()) return;
  for (const auto& [word, kind] : kWords) {
    if (name_ != word) continue;
    kind_ = kind;
    return;
  }
  for (const auto& [prefix, kind] : kNumbered) {
    const std::optional<std::size_t> index = indexAfter(name_, prefix);
    if (!index) continue;
    kind_ = kind;
    joint_ = *index;
    return;
  }
  joints_ = jointsIn(name_);
  kind_ = joints_.empty() ? DriverKind::kColumn : DriverKind::kReadings;
}

}  // namespace poecal
