#include "printing/sheet_layout.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "simulation/pattern.hpp"

namespace poecal {
namespace {

/// Nothing else may be printed on the white of a target. A whole square is more than any finder asks for around a board.
Eigen::AlignedBox2d clearOf(const PrintedFace& face, const Target& target) {
  Eigen::AlignedBox2d ink, paper;
  for (const Eigen::AlignedBox2d& box : face.runs(Tile::kInk)) ink.extend(box);
  for (const Eigen::AlignedBox2d& box : face.runs(Tile::kPaper)) paper.extend(box);
  paper.extend(ink);
  if (target.hasTags()) return paper;
  const double margin = 0.25 * target.square;
  return {(ink.min().array() - margin).matrix(), (ink.max().array() + margin).matrix()};
}

/// The motion in the plane, where T keeps the plane z = 0 and its normal.
bool isInPlane(const Eigen::Isometry3d& T) {
  constexpr double kSame = 1e-6;  // [m], [1]: what paper never shows
  return std::abs(T.translation().z()) < kSame && (T.linear().col(2) - Eigen::Vector3d::UnitZ()).norm() < kSame;
}

Eigen::Isometry2d inPlane(const Eigen::Isometry3d& T) {
  Eigen::Isometry2d flat = Eigen::Isometry2d::Identity();
  flat.linear() = Eigen::Rotation2Dd(std::atan2(T.linear()(1, 0), T.linear()(0, 0))).toRotationMatrix();
  flat.translation() = T.translation().head<2>();
  return flat;
}

void add(InkedPlane& plane, const PrintedFace& face, const Eigen::AlignedBox2d& clear) {
  const Eigen::Isometry2d T = inPlane(plane.T_target_plane.inverse() * face.T_target_face());
  plane.pieces.push_back({T, face.runs(Tile::kInk)});
  for (const auto corner :
       {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::BottomRight, Eigen::AlignedBox2d::TopLeft, Eigen::AlignedBox2d::TopRight}) {
    plane.clear.extend(T * clear.corner(corner));
  }
}

/// What a plane needs of a page beside the strips and edges.
Eigen::Vector2d neededFor(const InkedPlane& plane) {
  return plane.clear.sizes() + Eigen::Vector2d(2.0 * kPaperEdge + kRulerStrip, 2.0 * kPaperEdge + kRulerStrip + kTextStrip);
}

bool holds(double width, double height, const Eigen::Vector2d& needed) {
  constexpr double kRounding = 1e-9;
  return width + kRounding >= needed.x() && height + kRounding >= needed.y();
}

std::string paperFor(const Eigen::Vector2d& needed) {
  for (const char* name : {"a4", "a3", "a2", "a1", "a0"}) {
    const Paper paper = paperNamed(name);
    if (holds(paper.width, paper.height, needed) || holds(paper.height, paper.width, needed)) return name;
  }
  const auto up = [](double metres) { return static_cast<int>(std::ceil(metres * 100.0 - 1e-9)) * 10; };
  return fmt::format("{}x{}", up(needed.x()), up(needed.y()));
}

}  // namespace

std::vector<InkedPlane> inkedPlanes(const Target& target) {
  std::vector<PrintedFace> faces = printedFaces(target);
  const Eigen::Isometry3d T_plane_target = faces.front().T_target_face().inverse();
  const bool one_plane =
      std::all_of(faces.begin(), faces.end(), [&](const PrintedFace& face) { return isInPlane(T_plane_target * face.T_target_face()); });
  std::vector<InkedPlane> planes;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (k == 0 || !one_plane) planes.push_back({.T_target_plane = faces[k].T_target_face(), .pieces = {}, .clear = {}, .tags = {}});
    add(planes.back(), faces[k], clearOf(faces[k], target));
    if (target.type == TargetType::kAprilTag) planes.back().tags.push_back(target.tags[k].id);
  }
  return planes;
}

SheetPage layOut(const InkedPlane& plane, const Paper& paper) {
  const Eigen::Vector2d needed = neededFor(plane);
  SheetPage page;
  page.width = std::min(paper.width, paper.height);
  page.height = std::max(paper.width, paper.height);
  if (!holds(page.width, page.height, needed)) std::swap(page.width, page.height);
  if (!holds(page.width, page.height, needed)) {
    throw InvalidArgument(
        fmt::format("the target needs {:.0f} x {:.0f} mm with its white margin and the rulers, {} has {:.0f} x {:.0f} mm; "
                    "--paper {} holds it",
                    1e3 * needed.x(), 1e3 * needed.y(), paper.name, 1e3 * paper.width, 1e3 * paper.height, paperFor(needed)));
  }
  const Eigen::Vector2d free(page.width - 2.0 * kPaperEdge - kRulerStrip, page.height - 2.0 * kPaperEdge - kRulerStrip - kTextStrip);
  const Eigen::Vector2d middle = Eigen::Vector2d(kPaperEdge + kRulerStrip, kPaperEdge) + 0.5 * free;
  Eigen::Isometry3d T_page_plane = Eigen::Isometry3d::Identity();
  T_page_plane.translation().head<2>() = middle - plane.clear.center();
  page.T_page_target = T_page_plane * plane.T_target_plane.inverse();
  page.tags = plane.tags;
  page.ruler = std::min(free.x(), free.y()) >= 0.1 ? 0.1 : std::min(free.x(), free.y()) >= 0.05 ? 0.05 : 0.02;
  page.ruler_corner = {kPaperEdge + kRulerStrip - kRulerGap, page.height - kPaperEdge - kTextStrip - kRulerStrip + kRulerGap};
  return page;
}

}  // namespace poecal
