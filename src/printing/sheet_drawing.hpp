// The drawing of a page, once for PDF and once for SVG.
#pragma once

#include <string>
#include <vector>

#include "printing/sheet_layout.hpp"

namespace poecal {

/// A page with what is on it.
struct DrawnPage {
  SheetPage page;
  InkedPlane plane;
  std::vector<std::string> lines;  ///< of text, below
};

/// A PDF of all pages. @throws OutOfMemory where cairo has none left.
std::string pdfOf(const std::vector<DrawnPage>& pages);
/// One page as SVG, its lengths in millimetres.
std::string svgOf(const DrawnPage& page);

}  // namespace poecal
