// What was measured of a cell, and what it is measured with: samples, camera, target, corners.
#include "poecal/cell/measurements.hpp"
#include "binding.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/capture/sample_arrays.hpp"
#include "poecal/cell/cell.hpp"

namespace poecal::python {
namespace {

void bindCamera(py::module_& module) {
  py::enum_<DistortionModel>(module, "DistortionModel")
      .value("kPlumbBob", DistortionModel::kPlumbBob)
      .value("kRationalPolynomial", DistortionModel::kRationalPolynomial)
      .value("kEquidistant", DistortionModel::kEquidistant)
      .value("kThinPrism", DistortionModel::kThinPrism);
  Struct<Camera>(module, "Camera", "Intrinsics. The centre of the top-left pixel is (0, 0).")
      .made()
      .member("name", &Camera::name)
      .member("width", &Camera::width)
      .member("height", &Camera::height)
      .member("model", &Camera::model)
      .member("fx", &Camera::fx)
      .member("fy", &Camera::fy)
      .member("cx", &Camera::cx)
      .member("cy", &Camera::cy)
      .member("distortion", &Camera::distortion)
      .member("standard_deviation", &Camera::standard_deviation)
      .member("remarks", &Camera::remarks)
      .def("parameters", &Camera::parameters, "fx fy cx cy, then the distortion coefficients.")
      .def("setParameters", &Camera::setParameters, py::arg("parameters"))
      .def("parameterNames", &Camera::parameterNames);
  module.def("readCamera", readCamera, py::arg("file"), "Reads a camera as ROS, OpenCV or Kalibr write it.");
  module.def("cameraYaml", cameraYaml, py::arg("camera"), "Text of camera.yaml.");
}

void bindTargetTypes(py::module_& module) {
  py::enum_<TargetType>(module, "TargetType")
      .value("kAprilTag", TargetType::kAprilTag)
      .value("kPoints", TargetType::kPoints)
      .value("kAprilGrid", TargetType::kAprilGrid)
      .value("kCharuco", TargetType::kCharuco)
      .value("kChessboard", TargetType::kChessboard);
  Struct<PointId>(module, "PointId", "Name of a point: tag id and corner 0..3; boards have tag -1 and the board's corner index.")
      .made()
      .member("tag", &PointId::tag)
      .member("corner", &PointId::corner)
      .def(
          "__eq__", [](const PointId& a, const PointId& b) { return a == b; }, py::arg("other"), py::is_operator())
      .def("__hash__", [](const PointId& id) { return py::hash(py::make_tuple(id.tag, id.corner)); });
  Struct<TargetPoint>(module, "TargetPoint", "A named point of the target [m].")
      .made()
      .member("id", &TargetPoint::id)
      .member("p_target", &TargetPoint::p_target);
  Struct<TargetTag>(module, "TargetTag", "A tag in the target; its size is the edge between the corners [m].")
      .made()
      .member("id", &TargetTag::id)
      .member("size", &TargetTag::size)
      .member("T_target_tag", &TargetTag::T_target_tag);
}

void bindTarget(py::module_& module) {
  bindTargetTypes(module);
  Struct<Target>(module, "Target", "What is looked at, as named points. Made by apriltagTarget() and its like.")
      .copied("type", &Target::type)
      .copied("family", &Target::family)
      .copied("tags", &Target::tags)
      .copied("cols", &Target::cols)
      .copied("rows", &Target::rows)
      .copied("square", &Target::square)
      .copied("marker", &Target::marker)
      .copied("points", &Target::points);
  module.def("apriltagTarget", apriltagTarget, py::arg("family"), py::arg("tags"));
  module.def("chessboardTarget", chessboardTarget, py::arg("cols"), py::arg("rows"), py::arg("square"));
  module.def("charucoTarget", charucoTarget, py::arg("cols"), py::arg("rows"), py::arg("square"), py::arg("marker"), py::arg("dictionary"));
  module.def("aprilgridTarget", aprilgridTarget, py::arg("family"), py::arg("cols"), py::arg("rows"), py::arg("tag_size"),
             py::arg("tag_spacing"), py::arg("first_id"), py::arg("border_bits") = 0);
  module.def("pointsTarget", pointsTarget, py::arg("points"));
  module.def("readTarget", readTarget, py::arg("file"), "Reads target.yaml.");
  module.def("targetYaml", targetYaml, py::arg("target"), "Text of target.yaml.");
}

SampleTable sampleTableOf(const Eigen::MatrixXd& q, const std::vector<Eigen::Isometry3d>& T_base_flange,
                          const std::vector<std::string>& image, const std::vector<long>& pose, const Eigen::VectorXd& stamp,
                          const Eigen::VectorXd& temperature, const Eigen::VectorXd& payload, const Eigen::MatrixXd& dir,
                          const Eigen::MatrixXd& dq, const std::map<std::string, Eigen::VectorXd>& other) {
  return sampleTable({q, T_base_flange, image, pose, stamp, temperature, payload, dir, dq, other});
}

void bindSamples(py::module_& module) {
  py::enum_<Setup>(module, "Setup", "Where the camera sits.").value("kEyeToHand", Setup::kEyeToHand).value("kEyeInHand", Setup::kEyeInHand);
  Struct<Sample>(module, "Sample", "One row of samples.csv; what it lacks is empty or None.")
      .made()
      .member("image", &Sample::image)
      .member("line", &Sample::line)
      .member("q", &Sample::q)
      .member("T_base_flange", &Sample::T_base_flange)
      .member("pose", &Sample::pose)
      .member("stamp", &Sample::stamp)
      .member("temperature", &Sample::temperature)
      .member("payload", &Sample::payload)
      .member("dir", &Sample::dir)
      .member("dq", &Sample::dq)
      .member("other", &Sample::other);
  Struct<SampleTable>(module, "SampleTable", "A table of samples, in the order taken.")
      .made()
      .member("file", &SampleTable::file)
      .member("samples", &SampleTable::samples)
      .member("other_columns", &SampleTable::other_columns)
      .member("has_joints", &SampleTable::has_joints)
      .member("has_flange_poses", &SampleTable::has_flange_poses);
  const Eigen::MatrixXd no_rows(0, 0);
  const Eigen::VectorXd no_values(0);
  const std::vector<Eigen::Isometry3d> no_poses;
  module.def("sampleTable", sampleTableOf, py::arg("q") = no_rows, py::kw_only(), py::arg("T_base_flange") = no_poses,
             py::arg("image") = std::vector<std::string>(), py::arg("pose") = std::vector<long>(), py::arg("stamp") = no_values,
             py::arg("temperature") = no_values, py::arg("payload") = no_values, py::arg("dir") = no_rows, py::arg("dq") = no_rows,
             py::arg("other") = std::map<std::string, Eigen::VectorXd>(),
             "A table from columns with one row per sample: the members of SampleArrays as keywords.");
  module.def("samplesCsv", samplesCsv, py::arg("table"), "Text of samples.csv.");
  module.def("readJointTable", readJointTable, py::arg("file"), py::arg("arm"), "Reads a table of joint readings for an arm.");
  module.def("readWantedPoses", readWantedPoses, py::arg("file"), py::arg("arm"), "Reads a table of poses that the flange should go to.");
}

void bindPoseTables(py::module_& module) {
  Struct<MeasuredPose>(module, "MeasuredPose",
                       "One row of poses.csv: a pose that an instrument measured, or a position alone; deviations in [m] and [rad].")
      .made()
      .member("sample", &MeasuredPose::sample)
      .member("T_instrument_tool", &MeasuredPose::T_instrument_tool)
      .member("position_only", &MeasuredPose::position_only)
      .member("sigma_position", &MeasuredPose::sigma_position)
      .member("sigma_rotation", &MeasuredPose::sigma_rotation);
  Struct<PoseTable>(module, "PoseTable", "A table of measured poses, in the order taken.")
      .made()
      .member("file", &PoseTable::file)
      .member("poses", &PoseTable::poses)
      .member("other_columns", &PoseTable::other_columns)
      .member("position_only", &PoseTable::position_only);
  module.def("readPoses", readPoses, py::arg("file"), py::arg("arm"), "Reads poses.csv for an arm.");
}

void bindCell(py::module_& module) {
  Struct<KnownTransform>(module, "KnownTransform",
                         "What is known of a constant transform: 1 sigma of its rotation and translation [rad; m].")
      .made()
      .member("T", &KnownTransform::T)
      .member("sigma", &KnownTransform::sigma);
  Struct<Registration>(module, "Registration", "The two constant transforms around the arm.")
      .made()
      .member("setup", &Registration::setup)
      .member("T_camera_near", &Registration::T_camera_near)
      .member("T_far_target", &Registration::T_far_target)
      .member("known_near", &Registration::known_near)
      .member("known_far", &Registration::known_far)
      .def("nearFrame", &Registration::nearFrame)
      .def("farFrame", &Registration::farFrame)
      .def("cameraTarget", &Registration::cameraTarget, py::arg("T_base_flange"))
      .def("baseFlange", &Registration::baseFlange, py::arg("T_camera_target"));
  Struct<Cell>(module, "Cell", "Everything that turns a joint reading into pixels.")
      .made()
      .member("arm", &Cell::arm)
      .member("camera", &Cell::camera)
      .member("registration", &Cell::registration);
  Struct<Corner>(module, "Corner", "One corner in a picture [px]; its sigma is NaN where not stated.")
      .made()
      .member("id", &Corner::id)
      .member("px", &Corner::px)
      .member("sigma", &Corner::sigma);
  module.def("predictCorners", predictCorners, py::arg("cell"), py::arg("target"), py::arg("T_base_flange"),
             "Pixels of the target's points that the camera can see.");
}

void bindObservations(py::module_& module) {
  Struct<CornerMeasurement>(module, "CornerMeasurement", "A named point of the target [m] seen at a pixel; sigma per axis [px].")
      .made()
      .member("id", &CornerMeasurement::id)
      .member("p_target", &CornerMeasurement::p_target)
      .member("px", &CornerMeasurement::px)
      .member("sigma_px", &CornerMeasurement::sigma_px);
  Struct<PoseMeasurement>(module, "PoseMeasurement",
                          "A measured pose; its residual (rotation [rad]; position [m] in camera) times `whitening` has unit covariance.")
      .made()
      .member("T_camera_target", &PoseMeasurement::T_camera_target)
      .member("whitening", &PoseMeasurement::whitening)
      .member("position_only", &PoseMeasurement::position_only);
  Struct<Observation>(module, "Observation", "All that one sample measured: corners, or a pose.")
      .made()
      .member("sample", &Observation::sample)
      .member("q", &Observation::q)
      .member("T_base_flange", &Observation::T_base_flange)
      .member("corners", &Observation::corners)
      .member("pose", &Observation::pose)
      .member("reference", &Observation::reference);
}

void bindMeasured(py::module_& module) {
  Struct<Measurements>(module, "Measurements", "All that was measured of a cell: either corners or poses.")
      .made()
      .member("setup", &Measurements::setup)
      .member("target", &Measurements::target)
      .member("samples", &Measurements::samples)
      .member("other_columns", &Measurements::other_columns)
      .member("observations", &Measurements::observations)
      .member("sigmas_stated", &Measurements::sigmas_stated)
      .member("groups", &Measurements::groups)
      .member("gravity", &Measurements::gravity)
      .def("addPicture", &Measurements::addPicture, py::arg("sample"), py::arg("corners"))
      .def("addPictures", &Measurements::addPictures, py::arg("table"), py::arg("px"), py::arg("sigma") = py::none(),
           "A picture for each row: px is N x m x 2, of target.points in their order, NaN for a point that is not seen.")
      .def("addPose", &Measurements::addPose, py::arg("sample"), py::arg("T_instrument_tool"), py::arg("sigma_position") = py::none(),
           py::arg("sigma_rotation") = py::none())
      .def("addPoses", &Measurements::addPoses, py::arg("table"), py::arg("T_instrument_tool"), py::arg("sigma_position") = py::none(),
           py::arg("sigma_rotation") = py::none(), "A pose for each row: N x 4 x 4, deviations in [m] and [rad].")
      .def("addPosition", &Measurements::addPosition, py::arg("sample"), py::arg("p_instrument"), py::arg("sigma_position") = py::none())
      .def("addPositions", &Measurements::addPositions, py::arg("table"), py::arg("p_instrument"), py::arg("sigma_position") = py::none(),
           "A position for each row: N x 3 [m].")
      .def("poseGroups", &Measurements::poseGroups);
  module.def("measurementsOf", py::overload_cast<const PoseTable&>(measurementsOf), py::arg("table"), "The poses of an instrument.");
}

void bindCapture(py::module_& module) {
  Struct<Capture>(module, "Capture", "capture.yaml with everything that it names but the pictures.")
      .result("folder", &Capture::folder)
      .result("name", &Capture::name)
      .result("setup", &Capture::setup)
      .result("camera", &Capture::camera)
      .result("target", &Capture::target)
      .result("gravity", &Capture::gravity)
      .result("table", &Capture::table)
      .result("arm", &Capture::arm);
  module.def("readCapture", readCapture, py::arg("folder"), "Reads a capture folder and checks what can be checked without pictures.");
}

}  // namespace

void bindMeasurements(py::module_& module) {
  bindCamera(module);
  bindTarget(module);
  bindSamples(module);
  bindPoseTables(module);
  bindCell(module);
  bindObservations(module);
  bindMeasured(module);
  bindCapture(module);
}

}  // namespace poecal::python
