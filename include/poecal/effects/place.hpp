// Where an effect enters the cell and what it follows: each with its one name in files.
#pragma once

#include <compare>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace poecal {

/// Kinds of places; `joint:K` and `link:K` count from 1.
enum class PlaceKind {
  kJoint,
  kLink,
  kBase,
  kCameraMount,
  kCameraLens,
  kCameraShutter,
  kTargetShape,
  kTargetMount,
  kTiming,
  kDetector,
  kSamples
};

/// Name as in model.yaml: "joint", "camera.mount", ...; kJoint and kLink are followed by ":K".
const char* placeName(PlaceKind kind);
/// Whether there is one place of the kind for each joint.
bool isNumbered(PlaceKind kind);

/// A place in the cell.
struct Place {
  PlaceKind kind = PlaceKind::kJoint;
  std::size_t index = 0;  ///< of the joint or link, from 0; 0 where the kind has none

  /// "joint:3", "camera.lens", ...
  std::string name() const;
  /// Nothing where `name` is no place's.
  static std::optional<Place> of(const std::string& name);
  auto operator<=>(const Place&) const = default;
};

/// Kinds of drivers.
enum class DriverKind {
  kReading,      ///< q3
  kReadings,     ///< q1,q3,q4
  kTorque,       ///< tau3: gravity's torque about a joint
  kDirection,    ///< dir3: side from which a joint came to rest
  kVelocity,     ///< dq
  kGravity,      ///< gravity
  kStamp,        ///< stamp
  kTemperature,  ///< temperature
  kPixel,        ///< pixel
  kColumn,       ///< a further column of the samples, by its name
  kNone          ///< none
};

/// What an effect follows.
class Driver {
 public:
  Driver() = default;
  /// By its name in files; any word that is no other driver's is a column's.
  explicit Driver(std::string name);
  const std::string& name() const { return name_; }
  DriverKind kind() const { return kind_; }
  /// Index from 0 of the joint, of kReading, kTorque and kDirection; 0 of others.
  std::size_t joint() const { return joint_; }
  /// Indices from 0 of the joints of kReadings, as named; empty of others.
  const std::vector<std::size_t>& joints() const { return joints_; }
  /// Whether readings of joints alone drive it.
  bool isPosture() const { return kind_ == DriverKind::kReading || kind_ == DriverKind::kReadings; }
  bool operator==(const Driver& other) const { return name_ == other.name_; }
  auto operator<=>(const Driver& other) const { return name_ <=> other.name_; }

 private:
  std::string name_;
  DriverKind kind_ = DriverKind::kNone;
  std::size_t joint_ = 0;
  std::vector<std::size_t> joints_;
};

}  // namespace poecal
