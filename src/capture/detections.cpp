#include "poecal/capture/detections.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/capture/image_names.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"

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

/// The least and the largest coordinate that a corner in a picture of that width (or height) may have.
std::pair<double, double> rangeOf(int side) {
  constexpr double kSlack = 0.01;  // of the side: a fitted corner may lie a little beyond the border
  return {-0.5 - kSlack * side, side - 0.5 + kSlack * side};
}

/// Coordinate u or v of a corner.
double coordinateOf(const CsvTable& csv, std::size_t row, std::size_t column, int side) {
  constexpr double kLargest = 1e6;  // [px] of any picture
  const double value = csv.number(row, column);
  const auto [lower, upper] = side > 0 ? rangeOf(side) : std::pair(-kLargest, kLargest);
  if (value >= lower && value <= upper) return value;
  const std::string expected = side > 0 ? fmt::format("-0.5 to {} (a picture of {} px)", side - 0.5, side) : "a place in a picture";
  throw FileError(csv.file(), csv.line(row), fmt::format("{} is {}, expected {}", csv.header()[column], formatNumber(value), expected));
}

/// A number of a tag or a corner; what no int holds is the largest one, which no target has.
int idOf(const CsvTable& csv, std::size_t row, std::size_t column) {
  constexpr long kLargest = std::numeric_limits<int>::max();
  return static_cast<int>(std::clamp(csv.integer(row, column), -kLargest, kLargest));
}

double sigmaOf(const CsvTable& csv, std::size_t row, std::size_t column) {
  constexpr double kSmallest = 1e-12, kLargest = 1e6;  // [px]; beyond these weights are no numbers
  const double sigma = csv.number(row, column);
  if (sigma >= kSmallest && sigma <= kLargest) return sigma;
  throw FileError(csv.file(), csv.line(row), fmt::format("sigma is {}, expected a positive number of pixels", formatNumber(sigma)));
}

}  // namespace

const ImageCorners* Detections::find(const std::string& image) const {
  const auto found = std::find_if(images.begin(), images.end(), [&](const ImageCorners& entry) { return entry.image == image; });
  return found != images.end() ? &*found : nullptr;
}

Detections readDetections(const std::filesystem::path& file, const Target& target, const Target* also_in_view,
                          const std::optional<ImageSize>& size) {
  const CsvTable csv = CsvTable::read(file);
  const std::size_t image = csv.column("image"), tag = csv.column("tag"), corner = csv.column("corner");
  const std::size_t u = csv.column("u"), v = csv.column("v");
  const auto sigma = csv.findColumn("sigma");
  Detections detections;
  std::map<std::string, std::size_t> entry_of_image;
  std::map<std::pair<std::string, PointId>, int> line_of_corner;
  for (std::size_t row = 0; row < csv.rowCount(); ++row) {
    const int line = csv.line(row);
    const std::string name = imageName(csv.text(row, image));
    if (name.empty()) throw FileError(file, line, "the image is empty, expected its path");
    Corner entry;
    entry.id = {idOf(csv, row, tag), idOf(csv, row, corner)};
    entry.px = {coordinateOf(csv, row, u, size ? size->width : 0), coordinateOf(csv, row, v, size ? size->height : 0)};
    if (sigma && !csv.text(row, *sigma).empty()) entry.sigma = sigmaOf(csv, row, *sigma);
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
    detections.images[index].corners.push_back(entry);
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
