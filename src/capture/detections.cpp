#include "poecal/capture/detections.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

/// What the target has, for a message about a corner that it has not.
std::string describePoints(const Target& target) {
  if (target.type == TargetType::kCharuco || target.type == TargetType::kChessboard) {
    return fmt::format("a {} with tag -1 and corners 0 to {}", target.type == TargetType::kCharuco ? "charuco board" : "chessboard",
                       target.points.back().id.corner);
  }
  constexpr std::size_t kShown = 20;
  std::set<int> ids;
  for (const TargetPoint& point : target.points) ids.insert(point.id.tag);
  std::vector<int> shown(ids.begin(), ids.end());
  const bool cut = shown.size() > kShown;
  if (cut) shown.resize(kShown);
  const bool points = target.type == TargetType::kPoints;
  return fmt::format("{} {}{} with {}", points ? "points" : "tags", fmt::join(shown, ", "), cut ? ", ..." : "",
                     points ? "corner 0" : "corners 0 to 3");
}

}  // namespace

const ImageCorners* Detections::find(const std::string& image) const {
  const auto found = std::find_if(images.begin(), images.end(), [&](const ImageCorners& entry) { return entry.image == image; });
  return found != images.end() ? &*found : nullptr;
}

Detections readDetections(const std::filesystem::path& file, const Target& target, const Target* also_in_view) {
  const CsvTable csv = CsvTable::read(file);
  const std::size_t image = csv.column("image"), tag = csv.column("tag"), corner = csv.column("corner");
  const std::size_t u = csv.column("u"), v = csv.column("v");
  const auto sigma = csv.findColumn("sigma");
  Detections detections;
  std::map<std::string, std::size_t> entry_of_image;
  std::map<std::pair<std::string, PointId>, int> line_of_corner;
  for (std::size_t row = 0; row < csv.rowCount(); ++row) {
    const int line = csv.line(row);
    const std::string& name = csv.text(row, image);
    if (name.empty()) throw FileError(file, line, "the image is empty, expected its path");
    Corner entry;
    entry.id = {static_cast<int>(csv.integer(row, tag)), static_cast<int>(csv.integer(row, corner))};
    entry.px = {csv.number(row, u), csv.number(row, v)};
    if (sigma && !csv.text(row, *sigma).empty()) {
      entry.sigma = csv.number(row, *sigma);
      if (!(entry.sigma > 0.0)) throw FileError(file, line, fmt::format("sigma is {}, expected a positive number of pixels", entry.sigma));
    }
    const auto [earlier, fresh] = line_of_corner.emplace(std::pair(name, entry.id), line);
    if (!fresh) {
      throw FileError(
          file, line,
          fmt::format("corner {} of tag {} in '{}' is in line {} already", entry.id.corner, entry.id.tag, name, earlier->second));
    }
    const bool others = also_in_view != nullptr && also_in_view->find(entry.id) != nullptr;
    if (target.find(entry.id) == nullptr && !others) {
      throw FileError(
          file, line,
          fmt::format("corner {} of tag {} is not in the target, expected {}", entry.id.corner, entry.id.tag, describePoints(target)));
    }
    const std::size_t index = entry_of_image.emplace(name, detections.images.size()).first->second;
    if (index == detections.images.size()) detections.images.push_back({name, {}});
    if (!others) detections.images[index].corners.push_back(entry);
  }
  for (ImageCorners& entry : detections.images) {
    std::sort(entry.corners.begin(), entry.corners.end(), [](const Corner& a, const Corner& b) { return a.id < b.id; });
  }
  return detections;
}

std::string detectionsCsv(const Detections& detections) {
  const bool sigma = std::any_of(detections.images.begin(), detections.images.end(), [](const ImageCorners& entry) {
    return std::any_of(entry.corners.begin(), entry.corners.end(), [](const Corner& corner) { return !std::isnan(corner.sigma); });
  });
  std::vector<std::string> header{"image", "tag", "corner", "u", "v"};
  if (sigma) header.push_back("sigma");
  CsvWriter writer(header);
  for (const ImageCorners& entry : detections.images) {
    for (const Corner& corner : entry.corners) {
      writer.cell(entry.image).cell(corner.id.tag).cell(corner.id.corner).cell(corner.px.x()).cell(corner.px.y());
      if (sigma && std::isnan(corner.sigma)) writer.cell(std::string());
      if (sigma && !std::isnan(corner.sigma)) writer.cell(corner.sigma);
      writer.endRow();
    }
  }
  return writer.str();
}

}  // namespace poecal
