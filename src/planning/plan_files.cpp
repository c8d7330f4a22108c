#include "poecal/planning/plan_files.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/yaml.hpp"
#include "geometry/pose_yaml.hpp"
#include "poecal/calibration/model_of_capture.hpp"
#include "poecal/calibration/results.hpp"
#include "poecal/cell/known_registration.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/robot/robot_file.hpp"

namespace poecal {
namespace {

/// Axes of a frame whose z points along `z`; x is across `up`, y as far down as it can.
Eigen::Matrix3d axesAlong(const Eigen::Vector3d& z, const char* what) {
  if (!(z.norm() > 1e-9)) throw InvalidArgument(fmt::format("{} names no direction, expected a vector with a length", what));
  Eigen::Matrix3d R;
  R.col(2) = z.normalized();
  const Eigen::Vector3d up = std::abs(R(2, 2)) < 0.99 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  R.col(0) = R.col(2).cross(up).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

Eigen::Isometry3d poseAt(const Eigen::Matrix3d& R, const Eigen::Vector3d& p) {
  Eigen::Isometry3d T(Eigen::Translation3d{p});
  T.linear() = R;
  return T;
}

Eigen::Vector3d centreOf(const Target& target) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const TargetPoint& point : target.points) sum += point.p_target;
  return sum / static_cast<double>(target.points.size());
}

/// Whether z of `target` points into its front face, as a tag's does, or out of it, as a grid's.
bool facesAlongMinusZ(const Target& target) {
  return target.type != TargetType::kAprilGrid && (target.tags.empty() || target.tags.front().T_target_tag.linear()(2, 2) >= 0.0);
}

Registration placesOf(const FirstCapture& first, const Target& target) {
  if (!first.registration.empty()) {
    Registration registration = readRegistration(first.registration);
    if (registration.setup != first.setup) {
      throw FileError(first.registration, 0,
                      fmt::format("is {}, expected {} as --setup says", setupName(registration.setup), setupName(first.setup)));
    }
    return registration;
  }
  if (!first.camera_at || !first.look_at) {
    throw InvalidArgument("a plan before the first picture needs --camera-at and --look-at, or --registration");
  }
  Registration registration;
  registration.setup = first.setup;
  registration.T_camera_near = poseAt(axesAlong(*first.look_at - *first.camera_at, "--look-at"), *first.camera_at).inverse();
  const Eigen::Vector3d z = facesAlongMinusZ(target) ? Eigen::Vector3d(-first.target_faces) : first.target_faces;
  const Eigen::Matrix3d R = axesAlong(z, "--target-faces");
  registration.T_far_target = poseAt(R, first.target_at - R * centreOf(target));
  return registration;
}

bool isFile(const std::filesystem::path& file) {
  std::error_code status;
  return std::filesystem::is_regular_file(file, status);
}

/// The capture with the camera and the corners that were found from it.
Capture openWithResults(const PlanSource& source, const std::filesystem::path& results) {
  Capture capture = openCapture(source.capture);
  if (!capture.camera) {
    const std::filesystem::path found = results / "camera.yaml";
    if (!isFile(found))
      throw FileError(found, 0, "is not there, expected the lens that the capture's intrinsics gave (--intrinsics names another)");
    capture.camera = readCamera(found);
  }
  if (capture.detections_file.empty()) capture.detections_file = results / "detections.csv";
  if (!isFile(capture.detections_file)) {
    throw FileError(capture.detections_file, 0,
                    "is not there, expected the corners that the model was found from (--detections names another file)");
  }
  return capture;
}

void takeNoise(const ResultSummary& summary, PlanningCell& cell) {
  std::vector<double> stated;
  for (const Observation& observation : cell.taken.observations) {
    for (const CornerMeasurement& corner : observation.corners) stated.push_back(corner.sigma_px);
  }
  if (cell.taken.sigmas_stated && !stated.empty()) cell.noise.corner = summary.noise_scale.value_or(1.0) * median(stated);
  if (summary.corner_sigma_px) cell.noise.corner = *summary.corner_sigma_px;
  cell.noise.tag = summary.tag_sigma_px.value_or(0.0);
  cell.noise.repeatability = summary.joint_repeatability.value_or(0.0);
  cell.arm_beyond_tolerance = summary.arm_beyond_tolerance.value_or(1.0);
}

/// Rows that belong to no model tell nothing.
void leaveOutBad(const ResultSummary& summary, PlanningCell& cell) {
  std::erase_if(cell.taken.observations, [&](const Observation& observation) {
    const std::string& image = cell.taken.samples[observation.sample].image;
    return std::find(summary.bad_images.begin(), summary.bad_images.end(), image) != summary.bad_images.end();
  });
}

void takeRivals(const ResultSummary& summary, PlanningCell& cell) {
  for (const FindingSummary& finding : summary.findings) {
    if (finding.alternatives.empty()) continue;
    Rivals rivals{.explanations = {{finding.effect, finding.location, finding.driver, finding.probability}},
                  .separate_with = finding.separate_with};
    for (const AlternativeCause& other : finding.alternatives)
      rivals.explanations.push_back({other.effect, other.location, other.driver, other.probability});
    cell.open.push_back(std::move(rivals));
  }
}

}  // namespace

PlanningCell readPlanningCell(const PlanSource& source) {
  PlanningCell cell;
  cell.model = readModel(source.model);
  if (!cell.model.cell.camera) {
    throw FileError(source.model, 0, "has no camera, expected a model from pictures: poses of an instrument cannot be planned");
  }
  const std::filesystem::path results = source.model.has_parent_path() ? source.model.parent_path() : std::filesystem::path(".");
  const Capture capture = openWithResults(source, results);
  if (!capture.arm || !capture.table.has_joints) {
    throw FileError(capture.table.file, 0, "has no joint readings (columns q1, q2, ...), expected them: a plan is one of joints");
  }
  requireModelOf(partsOf(capture), cell.model, source.model);
  cell.nominal.arm = capture.arm;
  cell.nominal.camera = capture.camera;
  cell.nominal.registration.setup = capture.setup;
  cell.target = capture.target;
  cell.robot_file = capture.robot_file;
  const Target* reference = capture.reference ? &*capture.reference : nullptr;
  cell.taken = measurementsOf(capture, readDetections(capture.detections_file, capture.target, reference,
                                                      ImageSize{capture.camera->width, capture.camera->height}));
  const ResultSummary summary = readResults(results);
  leaveOutBad(summary, cell);
  takeNoise(summary, cell);
  takeRivals(summary, cell);
  return cell;
}

PlanningCell firstCapture(const FirstCapture& first) {
  PlanningCell cell;
  cell.nominal.arm = readArm(first.robot, first.base_link, first.tip_link);
  cell.nominal.camera = readCamera(first.camera);
  cell.target = readTarget(first.target);
  cell.robot_file = first.robot;
  cell.nominal.registration = placesOf(first, cell.target);
  cell.model.cell = cell.nominal;
  cell.model.target = cell.target;
  cell.taken.setup = first.setup;
  cell.taken.target = cell.target;
  cell.noise.corner = first.corner_sigma;
  cell.rough_position = first.rough_position;
  cell.rough_rotation = first.rough_rotation;
  return cell;
}

}  // namespace poecal
