// A target on paper at true scale: PDF and SVG, with rulers that show whether the printer kept it.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "poecal/target/target.hpp"

namespace poecal {

/// A sheet of paper, either way up.
struct Paper {
  std::string name;     ///< as --paper takes it
  double width = 0.0;   ///< [m]
  double height = 0.0;  ///< [m]
};

/// "a4" .. "a0", "letter", "legal", "tabloid", or WIDTHxHEIGHT in millimetres ("700x720"). @throws InvalidArgument for another name, with
/// those that there are, and for sheets under 60 mm or over 5 m.
Paper paperNamed(const std::string& name);

/// One page. Its frame: origin in the top-left corner, x right, y down, z into the paper.
struct SheetPage {
  std::string svg;        ///< in millimetres
  double width = 0.0;     ///< [m]
  double height = 0.0;    ///< [m]
  std::vector<int> tags;  ///< ids of an apriltag target's tags on it; empty for boards
  Eigen::Isometry3d T_page_target = Eigen::Isometry3d::Identity();
  double ruler = 0.0;                                      ///< length of both rulers [m]
  Eigen::Vector2d ruler_corner = Eigen::Vector2d::Zero();  ///< where both begin: one goes right, one up [m]
};

struct TargetSheet {
  std::string pdf;               ///< all pages
  std::vector<SheetPage> pages;  ///< one; where tags lie in several planes one for each tag
};

constexpr double kLeastPrinted = 2e-3;  ///< edge of a tag, square or marker [m]: below, a printer's dots make the cells

/// Why a target's smallest tag, square or marker is less than kLeastPrinted; empty where none is.
std::string tooSmallToPrint(const Target& target);

/// Draws a target in its size, black on white, with the white margin that its detector needs, two rulers and how to use them. The same
/// target and paper give the same bytes.
/// @throws InvalidArgument: a target of single points, one that is too small to be printed, or one that is larger than the paper; the
/// message names paper that is large enough.
TargetSheet drawTargetSheet(const Target& target, const Paper& paper);

}  // namespace poecal
