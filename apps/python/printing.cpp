// Targets on paper at true scale.
#include "binding.hpp"
#include "poecal/printing/target_sheet.hpp"

namespace poecal::python {

void bindPrinting(py::module_& module) {
  Struct<Paper>(module, "Paper", "A sheet of paper, either way up [m].")
      .made()
      .member("name", &Paper::name)
      .member("width", &Paper::width)
      .member("height", &Paper::height);
  Struct<SheetPage>(module, "SheetPage",
                    "One page [m]. Its frame: origin in the top-left corner, x right, y down, z into the paper; the SVG is in millimetres.")
      .result("svg", &SheetPage::svg)
      .result("width", &SheetPage::width)
      .result("height", &SheetPage::height)
      .result("tags", &SheetPage::tags)
      .result("T_page_target", &SheetPage::T_page_target)
      .result("ruler", &SheetPage::ruler)
      .result("ruler_corner", &SheetPage::ruler_corner);
  Struct<TargetSheet>(module, "TargetSheet", "A target to print: all pages as one PDF, and each by itself.")
      .result("pages", &TargetSheet::pages)
      .def_property_readonly("pdf", [](const TargetSheet& sheet) { return py::bytes(sheet.pdf); });
  module.def("paperNamed", paperNamed, py::arg("name"),
             "\"a4\" .. \"a0\", \"letter\", \"legal\", \"tabloid\", or WIDTHxHEIGHT in millimetres.");
  module.def("drawTargetSheet", drawTargetSheet, py::arg("target"), py::arg("paper"), Unlocked(),
             "Draws a target in its size with two rulers; the same target and paper give the same bytes.");
}

}  // namespace poecal::python
