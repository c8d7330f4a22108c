// Where things are on a page.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "poecal/printing/target_sheet.hpp"

namespace poecal {

/// What is printed in one plane of a target.
struct InkedPlane {
  Eigen::Isometry3d T_target_plane = Eigen::Isometry3d::Identity();  ///< x right, y down, z into it
  /// Black rectangles, each turned about the plane's normal.
  struct Piece {
    Eigen::Isometry2d T_plane_piece = Eigen::Isometry2d::Identity();
    std::vector<Eigen::AlignedBox2d> black;  ///< [m]
  };
  std::vector<Piece> pieces;
  Eigen::AlignedBox2d clear;  ///< in the plane: nothing else may be printed here [m]
  std::vector<int> tags;      ///< ids; empty for boards
};

/// The planes of a target: one, or one for each tag where they do not share one. @throws InvalidArgument for single points.
std::vector<InkedPlane> inkedPlanes(const Target& target);

/// A page of the paper, the way up that holds the plane, without its drawing. @throws InvalidArgument where it holds it neither way.
SheetPage layOut(const InkedPlane& plane, const Paper& paper);

// Of a page [m].
constexpr double kPaperEdge = 5e-3;    ///< that printers leave white
constexpr double kRulerStrip = 10e-3;  ///< for one ruler with its ticks
constexpr double kRulerGap = 2e-3;     ///< of it: between the target's white margin and the ruler
constexpr double kTextStrip = 16e-3;   ///< below the ruler at the bottom

}  // namespace poecal
