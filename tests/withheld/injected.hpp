// The set `injected`: real recordings of others into which one effect is brought.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace withheld {

/// Name of the set, beside setNames().
inline constexpr const char* kInjectedSet = "injected";

/// Writes case `number` as FOLDER/NNNN/poses (robot.yaml, poses.csv) or FOLDER/NNNN/capture, and FOLDER/NNNN.truth.json. Recordings take
/// turns: franka-board, positioner, irb2400-charuco; the first case of each has nothing injected.
///
/// - Poses: logged angles are shifted so that the joint stands where it stood only if the effect is there. S is against what the
/// recording's
///   poses scatter by after the withheld world's own fit; aliases are of an arm of unknown masses. The positioner's rows are in order of
///   time: they get a stamp every half minute.
/// - Pictures: the board is said to be of another size, or the pictures are scaled or shifted as another lens would have them. S is not
/// known (0).
/// @throws std::runtime_error where `real` does not hold these recordings, std::filesystem::filesystem_error
void writeInjectedCase(const std::filesystem::path& real, std::uint64_t seed, std::uint64_t number, const std::string& folder);

}  // namespace withheld
