// What rows of one table say against each other, or against any arm.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"

namespace poecal {

/// How far two rows are from each other: the largest difference of their joint readings, or, where they have none, of their flange poses
/// [m], [rad]. 0 where there is nothing to compare.
double distanceOfRows(const Sample& a, const Sample& b);

/// Speed that a joint does not reach [rad/s], [m/s]: three times the limit that its robot file states, or what no arm is known to make.
/// @param joint  nullptr where it is not known.
double impossibleSpeed(const Joint* joint);

/// @param arm  nullptr where it is not known.
/// @throws FileError with the line: joint velocities or a payload that the arm cannot have.
void requirePossibleRows(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm* arm);

/// Of rows that are to be commanded or foretold.
/// @throws FileError as requirePossibleRows(); a turning joint without limits that is many turns from its zero.
void requireCommands(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm);

/// Of rows that were measured.
/// @throws FileError as requirePossibleRows(); rows of one pose that are far from each other; a joint without limits whose readings span
/// many turns.
void checkRows(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm* arm);

/// Stamps that no clock in seconds gives: not ascending, all equal, in another unit. One sentence each, with file and line.
std::vector<std::string> stampRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples);

/// Temperatures in another unit than degrees Celsius, in all rows or from one to the next. One sentence at most, with file and line.
std::vector<std::string> temperatureRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples);

/// Payloads that weigh more than the arm itself, where all its masses are stated and no joint slides: no such arm carries that. One
/// sentence at most, with file and line.
std::vector<std::string> payloadRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm);

/// Turning joints whose readings all lie within half a turn but for whole turns that some of them have more: counters that wrapped around.
/// One sentence each, with file and line of the first row whose turn is not that of the row before.
std::vector<std::string> turnRemarks(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm);

}  // namespace poecal
