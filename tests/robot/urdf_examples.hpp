// The URDFs of the tests: what may be hard about reading or correcting one is in at least one of them.
#pragma once

#include <filesystem>
#include <ostream>
#include <string>

#include "poecal/core/text.hpp"

namespace poecal::test {

struct UrdfExample {
  const char* name;
  const char* base_link;
  const char* tip_link;

  std::filesystem::path file() const {
    return std::filesystem::path(POECAL_SOURCE_DIR) / "tests/robot/data" / (std::string(name) + ".urdf");
  }
  std::string text() const { return readTextFile(file()); }
};

// Without it GoogleTest prints, and CTest lists, the bytes of the pointers.
inline void PrintTo(const UrdfExample& value, std::ostream* out) { *out << value.name; }

/// Fixed joints before, inside and after the moving ones; a <joint> without <origin>; axes along no coordinate axis, negative, not unit.
inline constexpr UrdfExample kSixJoints = {"six_joints", "base_link", "tool0"};
/// The tip hangs directly on the last joint.
inline constexpr UrdfExample kSevenJoints = {"seven_joints", "link_0", "link_7"};
/// The same for a prismatic joint.
inline constexpr UrdfExample kScara = {"scara", "base", "quill"};

}  // namespace poecal::test
