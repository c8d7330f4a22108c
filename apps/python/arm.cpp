// The arm: joints, forward kinematics, and its files.
#include "poecal/robot/arm.hpp"
#include "binding.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/robot/robot_file.hpp"

namespace poecal::python {
namespace {

void bindPoses(py::module_& module) {
  module.def("expSe3", expSe3, py::arg("xi"), "exp of the twist (w; v) [rad; m].");
  module.def("logSe3", logSe3, py::arg("T"), "Twist (w; v) with |w| <= pi whose exponential is T.");
  module.def("poseFromQuaternion", poseFromQuaternion, py::arg("position"), py::arg("quaternion_xyzw"),
             "Pose from a translation and a quaternion (x, y, z, w) of any length but zero.");
  module.def("quaternionXyzw", quaternionXyzw, py::arg("T"), "Unit quaternion (x, y, z, w) of a pose's rotation, w >= 0.");
  module.def("rotationAngle", rotationAngle, py::arg("R"), "Angle of a rotation [rad], 0..pi.");
}

void bindJoints(py::module_& module) {
  py::enum_<JointType>(module, "JointType").value("kRevolute", JointType::kRevolute).value("kPrismatic", JointType::kPrismatic);
  Struct<JointLimits>(module, "JointLimits", "Range of a joint reading [rad] or [m].")
      .made()
      .member("lower", &JointLimits::lower)
      .member("upper", &JointLimits::upper);
  Struct<Joint>(module, "Joint", "One joint of the arm at q = 0, in base: its twist xi (w; v) and a point of its axis, the anchor.")
      .made()
      .member("name", &Joint::name)
      .member("type", &Joint::type)
      .member("xi", &Joint::xi)
      .member("anchor", &Joint::anchor)
      .member("limits", &Joint::limits)
      .member("largest_speed", &Joint::largest_speed)
      .def("axis", &Joint::axis, "Unit direction of the axis in base.")
      .def_static("revolute", &Joint::revolute, py::arg("name"), py::arg("axis"), py::arg("point"))
      .def_static("prismatic", &Joint::prismatic, py::arg("name"), py::arg("axis"), py::arg("point") = Eigen::Vector3d(0.0, 0.0, 0.0));
  Struct<LinkMass>(module, "LinkMass", "The body that a joint moves: mass [kg] and centre of mass in base at q = 0 [m].")
      .made()
      .member("mass", &LinkMass::mass)
      .member("com", &LinkMass::com);
  Struct<AxisOffset>(module, "AxisOffset", "The difference between two positions of one axis.")
      .result("tilt", &AxisOffset::tilt)
      .result("shift", &AxisOffset::shift);
  module.def("axisOffset", axisOffset, py::arg("from_"), py::arg("to"), "Angle [rad] between two axes, and distance [m].");
}

void bindFiles(py::module_& module) {
  module.def("readRobotYaml", readRobotYaml, py::arg("file"), "Reads robot.yaml.");
  module.def("robotYaml", robotYaml, py::arg("arm"), "Text of robot.yaml.");
  module.def("readUrdf", readUrdf, py::arg("file"), py::arg("base_link"), py::arg("tip_link"),
             "Reads the chain base_link .. tip_link of a URDF.");
  module.def("readArm", readArm, py::arg("file"), py::arg("base_link") = "", py::arg("tip_link") = "",
             "Reads robot.yaml or a URDF, whose links must then be named.");
  module.def("correctedUrdf", correctedUrdf, py::arg("urdf"), py::arg("base_link"), py::arg("tip_link"), py::arg("arm"),
             "Text of the URDF with the geometry of `arm`; everything else in the file stays.");
}

}  // namespace

void bindArm(py::module_& module) {
  bindPoses(module);
  bindJoints(module);
  Struct<Arm>(module, "Arm", "T_base_flange(q) = exp(xi_1 q_1) ... exp(xi_n q_n) exp(gamma).")
      .made()
      .member("name", &Arm::name)
      .member("joints", &Arm::joints)
      .member("gamma", &Arm::gamma)
      .member("links", &Arm::links)
      .def("jointCount", &Arm::jointCount);
  module.def(
      "forwardKinematics",
      [](const Arm& arm, const Array& q) { return posesOf(q, [&](const Eigen::VectorXd& one) { return forwardKinematics(arm, one); }); },
      py::arg("arm"), py::arg("q"), "T_base_flange(q): 4 x 4 of n readings [rad] or [m], N x 4 x 4 of N x n.");
  bindFiles(module);
}

}  // namespace poecal::python
