// Runs the program under test on a case, as a user would.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace withheld {

/// Runs a program and waits. What it says goes to `log`.
struct Run {
  int status = -1;       ///< exit status; -1 where it did not exit by itself
  double seconds = 0.0;  ///< of processor time
};
Run runProgram(const std::vector<std::string>& arguments, const std::filesystem::path& log);

/// `poecal diagnose capture --out out`, for a case of measured poses `poecal diagnose --robot poses/robot.yaml --poses poses/poses.csv
/// --out out`, unless its answer is there; processor time is kept in out/seconds. Where there are poses to predict and identify_too, also
/// `poecal identify capture --out identified` with the lens held where it is given without deviations: the geometric model that stands
/// before the findings.
/// @return whether there is an answer
bool diagnose(const std::string& poecal, const std::filesystem::path& folder, bool identify_too = true);

/// Processor time of a step done earlier; nothing where it is not known.
std::optional<double> secondsOf(const std::filesystem::path& out);

/// Root mean square, over the corners of the poses that poecal was not shown, of the distance from where the model has them [px].
/// Nothing where the model predicts none of them, or there are none.
std::optional<double> rmsOnUnseen(const std::string& poecal, const std::filesystem::path& folder, const std::string& out);

}  // namespace withheld
