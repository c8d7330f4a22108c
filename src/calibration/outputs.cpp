#include "poecal/calibration/outputs.hpp"

#include <algorithm>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/detector.hpp"

namespace poecal {

void requireOutputs(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs) {
  std::set<std::filesystem::path> places;
  for (const std::filesystem::path& output : outputs) {
    std::error_code not_there;
    if (!places.insert(std::filesystem::weakly_canonical(output, not_there)).second) {
      throw InvalidArgument(fmt::format("{} is named for two results, expected a place for each", output.string()));
    }
    const bool is_input =
        std::any_of(inputs.begin(), inputs.end(), [&](const auto& input) { return std::filesystem::equivalent(input, output, not_there); });
    if (is_input) throw InvalidArgument(fmt::format("{} is an input itself, expected another place for the result", output.string()));
    requireReplaceable(output);
  }
}

std::vector<std::filesystem::path> reportFiles(const std::filesystem::path& out) { return {out / "report.json", out / "report.html"}; }

std::vector<std::filesystem::path> filesOf(const Capture& capture, bool detections) {
  std::vector<std::filesystem::path> files = capture.files;
  if (detections && !capture.detections_file.empty()) files.push_back(capture.detections_file);
  for (const Sample& sample : capture.table.samples) files.push_back(capture.folder / sample.image);
  if (capture.intrinsics_folder.empty()) return files;
  const std::vector<std::filesystem::path> board = filesOfBoard(capture.intrinsics_folder);
  files.insert(files.end(), board.begin(), board.end());
  return files;
}

std::vector<std::filesystem::path> filesOfBoard(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files{folder / "target.yaml"};
  for (const std::string& picture : listPictures(folder)) files.push_back(folder / picture);
  return files;
}

}  // namespace poecal
