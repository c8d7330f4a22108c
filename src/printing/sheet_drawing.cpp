#include "printing/sheet_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <regex>

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <fmt/format.h>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

constexpr double kMm = 1e3;  // of a metre
constexpr double kPointsOfAMm = 72.0 / 25.4;
constexpr double kLine = 0.15, kText = 2.6;  // [mm]
constexpr double kSmallestText = 1.2;        // [mm]

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Pen = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

cairo_status_t append(void* text, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void check(cairo_status_t status) {
  if (status == CAIRO_STATUS_NO_MEMORY) throw OutOfMemory("to draw the target");
  if (status != CAIRO_STATUS_SUCCESS) throw InvalidArgument(fmt::format("the target cannot be drawn: {}", cairo_status_to_string(status)));
}

/// All rectangles as one path: filled one by one, seams would show where they touch.
void drawInk(cairo_t* pen, const DrawnPage& drawn) {
  const Eigen::Isometry3d T = drawn.page.T_page_target * drawn.plane.T_target_plane;
  for (const InkedPlane::Piece& piece : drawn.plane.pieces) {
    for (const Eigen::AlignedBox2d& box : piece.black) {
      const Eigen::Vector2d corners[] = {box.corner(Eigen::AlignedBox2d::BottomLeft), box.corner(Eigen::AlignedBox2d::BottomRight),
                                         box.corner(Eigen::AlignedBox2d::TopRight), box.corner(Eigen::AlignedBox2d::TopLeft)};
      for (const Eigen::Vector2d& corner : corners) {
        const Eigen::Vector2d p = piece.T_plane_piece * corner + T.translation().head<2>();
        cairo_line_to(pen, kMm * p.x(), kMm * p.y());
      }
      cairo_close_path(pen);
      cairo_new_sub_path(pen);
    }
  }
  cairo_fill(pen);
}

/// Where text of a size begins. Its left end, baseline [mm].
void drawText(cairo_t* pen, const std::string& text, double x, double y, double size) {
  cairo_set_font_size(pen, size);
  cairo_move_to(pen, x, y);
  cairo_show_text(pen, text.c_str());
}

/// One tick a millimetre, from (0, 0) to the right; ticks grow down.
void drawTicks(cairo_t* pen, int length) {
  for (int mm = 0; mm <= length; ++mm) {
    const double tick = mm == 0 || mm == length ? 5.0 : mm % 10 == 0 ? 3.5 : mm % 5 == 0 ? 2.5 : 1.5;
    cairo_move_to(pen, mm, 0.0);
    cairo_line_to(pen, mm, tick);
  }
  cairo_move_to(pen, 0.0, 0.0);
  cairo_line_to(pen, length, 0.0);
  cairo_stroke(pen);
}

void drawRulers(cairo_t* pen, const SheetPage& page) {
  const int length = static_cast<int>(std::lround(kMm * page.ruler));
  cairo_set_line_width(pen, kLine);
  cairo_save(pen);
  cairo_translate(pen, kMm * page.ruler_corner.x(), kMm * page.ruler_corner.y());
  drawTicks(pen, length);
  drawText(pen, fmt::format("{} mm", length), length + 1.0, 5.0, kText);
  const cairo_matrix_t up{0.0, -1.0, -1.0, 0.0, 0.0, 0.0};  // ticks grow to the left
  cairo_transform(pen, &up);
  drawTicks(pen, length);
  cairo_restore(pen);
}

void drawLines(cairo_t* pen, const DrawnPage& drawn) {
  const SheetPage& page = drawn.page;
  const double room = kMm * (page.width - page.ruler_corner.x() - kPaperEdge);
  double size = kText;
  cairo_set_font_size(pen, size);
  for (const std::string& line : drawn.lines) {
    cairo_text_extents_t extents;
    cairo_text_extents(pen, line.c_str(), &extents);
    size = std::min(size, kText * room / std::max(extents.x_advance, 1.0));
  }
  size = std::max(size, kSmallestText);
  const double top = kMm * (page.height - kPaperEdge - kTextStrip);
  for (std::size_t k = 0; k < drawn.lines.size(); ++k) {
    drawText(pen, drawn.lines[k], kMm * page.ruler_corner.x(), top + 1.35 * kText * static_cast<double>(k + 1), size);
  }
}

/// In millimetres from the page's top-left corner.
void drawPage(cairo_t* pen, const DrawnPage& drawn) {
  cairo_set_source_rgb(pen, 1.0, 1.0, 1.0);
  cairo_paint(pen);
  cairo_set_source_rgb(pen, 0.0, 0.0, 0.0);
  drawInk(pen, drawn);
  cairo_select_font_face(pen, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  drawRulers(pen, drawn.page);
  drawLines(pen, drawn);
  check(cairo_status(pen));
}

}  // namespace

std::string pdfOf(const std::vector<DrawnPage>& pages) {
  std::string text;
  const Surface surface(cairo_pdf_surface_create_for_stream(append, &text, 1.0, 1.0), cairo_surface_destroy);
  // A date would make two files of one target differ.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  for (const DrawnPage& drawn : pages) {
    cairo_pdf_surface_set_size(surface.get(), kMm * drawn.page.width * kPointsOfAMm, kMm * drawn.page.height * kPointsOfAMm);
    const Pen pen(cairo_create(surface.get()), cairo_destroy);
    cairo_scale(pen.get(), kPointsOfAMm, kPointsOfAMm);
    drawPage(pen.get(), drawn);
    cairo_show_page(pen.get());
  }
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
  return text;
}

std::string svgOf(const DrawnPage& drawn) {
  std::string text;
  {
    const Surface surface(cairo_svg_surface_create_for_stream(append, &text, kMm * drawn.page.width, kMm * drawn.page.height),
                          cairo_surface_destroy);
    cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_MM);
    const Pen pen(cairo_create(surface.get()), cairo_destroy);
    drawPage(pen.get(), drawn);
    cairo_surface_finish(surface.get());
    check(cairo_surface_status(surface.get()));
  }
  // Cairo numbers its surfaces from the start of the program.
  return std::regex_replace(text, std::regex("surface[0-9]+"), "surface");
}

}  // namespace poecal
