#include "poecal/capture/image_names.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

std::string counted(std::size_t count, const char* thing) { return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s"); }

}  // namespace

std::string imageName(const std::string& text) {
  std::string slashes = text;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  return std::filesystem::path(slashes).lexically_normal().generic_string();
}

std::vector<std::string> checkImagesMeet(const SampleTable& table, const Detections& detections,
                                         const std::filesystem::path& detections_file) {
  std::set<std::string> rows, with_corners;
  for (const Sample& sample : table.samples) rows.insert(sample.image);
  std::vector<std::string> without_row;
  for (const ImageCorners& image : detections.images) {
    if (image.corners.empty()) continue;
    with_corners.insert(image.image);
    if (!rows.contains(image.image)) without_row.push_back(image.image);
  }
  if (without_row.empty()) return {};
  std::vector<const Sample*> without_corners;
  for (const Sample& sample : table.samples) {
    if (!with_corners.contains(sample.image)) without_corners.push_back(&sample);
  }
  const std::string detections_name = detections_file.filename().string(), samples_name = table.file.filename().string();
  if (without_corners.size() == table.samples.size()) {
    const Sample& first = table.samples.front();
    throw FileError(table.file, first.line,
                    fmt::format("'{}' is not in {} (which has '{}'), expected the same names of pictures in both", first.image,
                                detections_name, without_row.front()));
  }
  std::string warning = fmt::format("{} of {} without a row in {} (the first: '{}')", counted(without_row.size(), "picture"),
                                    detections_name, samples_name, without_row.front());
  if (!without_corners.empty()) {
    warning += fmt::format(", {} of {} without corners (the first: line {}, '{}')", counted(without_corners.size(), "row"), samples_name,
                           without_corners.front()->line, without_corners.front()->image);
  }
  return {warning};
}

}  // namespace poecal
