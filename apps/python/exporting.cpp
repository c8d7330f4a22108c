// A calibrated cell as others take it: parameters of Denavit and Hartenberg, ROS, a table of joints.
#include "binding.hpp"
#include "poecal/exporting/dh.hpp"
#include "poecal/exporting/for_ros.hpp"

namespace poecal::python {
namespace {

void bindDh(py::module_& module) {
  py::enum_<DhRule>(module, "DhRule", "Denavit and Hartenberg's rule, or Hayati's of nearly parallel axes.")
      .value("kDh", DhRule::kDh)
      .value("kHayati", DhRule::kHayati);
  Struct<DhRow>(module, "DhRow", "One joint: Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta) in [m] and [rad]; q is added at theta or d.")
      .made()
      .member("rule", &DhRow::rule)
      .member("a", &DhRow::a)
      .member("alpha", &DhRow::alpha)
      .member("d", &DhRow::d)
      .member("theta", &DhRow::theta)
      .member("beta", &DhRow::beta);
  Struct<DhTable>(module, "DhTable", "T_base_flange(q) = base A_1(q_1) ... A_n(q_n) tool.")
      .made()
      .member("base", &DhTable::base)
      .member("rows", &DhTable::rows)
      .member("tool", &DhTable::tool)
      .def("plain", &DhTable::plain, "Whether the rows alone describe the arm.");
  Struct<DhTables>(module, "DhTables", "The nominal arm and the calibrated one by the same rules and signs.")
      .made()
      .member("nominal", &DhTables::nominal)
      .member("calibrated", &DhTables::calibrated);
  module.def("dhTables", dhTables, py::arg("nominal"), py::arg("calibrated"), "Both arms by their parameters, which compare row by row.");
  module.def(
      "dhForward",
      [](const DhTable& table, const Arm& arm, const Array& q) {
        return posesOf(q, [&](const Eigen::VectorXd& one) { return dhForward(table, arm, one); });
      },
      py::arg("table"), py::arg("arm"), py::arg("q"),
      "T_base_flange(q) by the table: 4 x 4 of n readings [rad] or [m], N x 4 x 4 of N x n. `arm` says which joints slide.");
  module.def("dhYaml", dhYaml, py::arg("tables"), py::arg("arm"), "Text of dh.yaml.");
}

}  // namespace

void bindExporting(py::module_& module) {
  bindDh(module);
  Struct<FrameNames>(module, "FrameNames", "Names of the frames in what is written.")
      .made()
      .member("base", &FrameNames::base)
      .member("flange", &FrameNames::flange)
      .member("camera", &FrameNames::camera)
      .member("target", &FrameNames::target);
  module.def("frameNames", frameNames, py::arg("model"), "\"base\" and \"flange\", or the links of the model's URDF.");
  module.def("cameraInfoYaml", cameraInfoYaml, py::arg("model"), "Text of ROS's camera_info file.");
  module.def("transformsYaml", transformsYaml, py::arg("model"), py::arg("names"),
             "Text of the cell's two fixed transforms, both ways, for tf2.");
  module.def("jointTableCsv", jointTableCsv, py::arg("model"), py::arg("nominal"), "Text of a table with a row per joint.");
}

}  // namespace poecal::python
