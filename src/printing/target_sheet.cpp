#include "poecal/printing/target_sheet.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/core/error.hpp"
#include "printing/sheet_drawing.hpp"
#include "printing/sheet_layout.hpp"

namespace poecal {
namespace {

struct NamedPaper {
  const char* name;
  double width, height;  // [m]
};

constexpr NamedPaper kPapers[] = {{"a4", 0.210, 0.297}, {"a3", 0.297, 0.420},       {"a2", 0.420, 0.594},      {"a1", 0.594, 0.841},
                                  {"a0", 0.841, 1.189}, {"letter", 0.2159, 0.2794}, {"legal", 0.2159, 0.3556}, {"tabloid", 0.2794, 0.4318}};

std::string mm(double metres) { return fmt::format("{:.6g} mm", 1e3 * metres); }

/// What is on the page, for whoever finds it in a drawer.
std::string nameOf(const Target& target, const SheetPage& page) {
  switch (target.type) {
    case TargetType::kAprilTag: {
      const auto tag =
          std::find_if(target.tags.begin(), target.tags.end(), [&](const TargetTag& one) { return one.id == page.tags.front(); });
      return fmt::format("{} id {}, size {} between the corners that the detector reports", target.family, fmt::join(page.tags, ", "),
                         mm(tag->size));
    }
    case TargetType::kAprilGrid:
      return fmt::format("aprilgrid {} of {} x {}, first id {}, tagSize {}, tagSpacing {:.6g}", target.family, target.cols, target.rows,
                         target.first_id, mm(target.tags.front().size), target.tag_spacing);
    case TargetType::kCharuco:
      return fmt::format("charuco {} of {} x {} squares, square {}, marker {}", target.dictionary, target.cols, target.rows,
                         mm(target.square), mm(target.marker));
    case TargetType::kChessboard:
      return fmt::format("chessboard of {} x {} inner corners, square {}", target.cols, target.rows, mm(target.square));
    case TargetType::kPoints:
      break;
  }
  return "";
}

}  // namespace

Paper paperNamed(const std::string& name) {
  std::vector<std::string> names;
  for (const NamedPaper& paper : kPapers) {
    if (name == paper.name) return {name, paper.width, paper.height};
    names.emplace_back(paper.name);
  }
  const std::size_t cross = name.find('x');
  double width = 0.0, height = 0.0;
  const char *begin = name.data(), *end = begin + name.size();
  const bool numbers = cross != std::string::npos && std::from_chars(begin, begin + cross, width).ptr == begin + cross &&
                       std::from_chars(begin + cross + 1, end, height).ptr == end;
  constexpr double kSmallest = 60.0, kLargest = 5000.0;  // [mm]: room for a ruler; what plotters take
  if (!numbers || !(std::min(width, height) >= kSmallest && std::max(width, height) <= kLargest)) {
    throw InvalidArgument(fmt::format("paper '{}', expected {} or WIDTHxHEIGHT in mm, from 60 to 5000", name, fmt::join(names, ", ")));
  }
  return {name, 1e-3 * width, 1e-3 * height};
}

std::string tooSmallToPrint(const Target& target) {
  const auto judge = [](const std::string& part, double edge) {
    return edge > 0.0 && edge < kLeastPrinted
               ? fmt::format("{} of {} cannot be printed, expected {} or more; is its size in metres?", part, mm(edge), mm(kLeastPrinted))
               : "";
  };
  for (const TargetTag& tag : target.tags) {
    const std::string small = judge(fmt::format("tag {}", tag.id), tag.size);
    if (!small.empty()) return small;
  }
  const std::string marker = judge("a marker", target.marker);
  return marker.empty() ? judge("a square", target.square) : marker;
}

TargetSheet drawTargetSheet(const Target& target, const Paper& paper) {
  if (const std::string small = tooSmallToPrint(target); !small.empty()) throw InvalidArgument(small);
  std::vector<DrawnPage> drawn;
  for (InkedPlane& plane : inkedPlanes(target)) {
    SheetPage page = layOut(plane, paper);
    const std::string ruler = mm(page.ruler);
    std::vector<std::string> lines{
        nameOf(target, page),
        fmt::format("Print at 100 % (actual size, no fit to page). Then measure both lines: each must be {} long.", ruler),
        fmt::format("Both equal but not {}: multiply every length in target.yaml by measured / {}. Not equal: print again.", ruler, ruler)};
    drawn.push_back({.page = std::move(page), .plane = std::move(plane), .lines = std::move(lines)});
  }
  TargetSheet sheet{.pdf = pdfOf(drawn), .pages = {}};
  for (DrawnPage& one : drawn) {
    one.page.svg = svgOf(one);
    sheet.pages.push_back(std::move(one.page));
  }
  return sheet;
}

}  // namespace poecal
