#include "report/stage_models.hpp"

#include <cmath>
#include <limits>

#include "poecal/core/error.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {
namespace {

std::size_t indexIn(const Target& target, PointId id) { return static_cast<std::size_t>(target.find(id) - target.points.data()); }

Eigen::VectorXd poseNumbers(const Observation& observation, const Vector6d& e) {
  if (observation.pose->position_only) return e.tail<3>();
  return e;
}

}  // namespace

const Identification& reportedIdentification(const Calibration& calibration) {
  if (!calibration.identification) throw InvalidArgument("the arm was not identified: there is nothing to report");
  const Identification& identification = *calibration.identification;
  return calibration.diagnosis && identification.with_stated_camera ? *identification.with_stated_camera : identification;
}

StageModels stageModels(const Calibration& calibration) {
  const Identification& identification = reportedIdentification(calibration);
  StageModels models;
  // Poses of an instrument are registered in closed form.
  Cell registered = identification.start;
  registered.arm = identification.nominal;
  registered.registration = identification.closed_form;
  if (calibration.registration) registered = calibration.registration->cell;
  Cell nominal = registered;
  nominal.registration = identification.closed_form;
  models.stages.push_back({"nominal", nominal, {}});
  models.stages.push_back({"registered", registered, {}});
  models.stages.push_back({"identified", identification.model.cell, {}});
  models.before = models.after = 2;
  if (&identification != &*calibration.identification) {
    models.stages.push_back({"identified, lens re-fitted", calibration.identification->model.cell, {}});
    models.after = models.stages.size() - 1;
  }
  if (calibration.diagnosis && !calibration.diagnosis->findings.empty()) {
    models.stages.push_back({"with the findings", calibration.diagnosis->model.cell, calibration.diagnosis->model.effects});
    if (calibration.model_source == ModelSource::kDiagnosed) models.after = models.stages.size() - 1;
  }
  if (models.after == models.before) models.before = 1;
  return models;
}

StageAt::StageAt(const StageModel& stage, const Measurements& measurements) : stage_(stage), measurements_(measurements) {
  if (stage.effects.empty()) {
    disturbances_.resize(measurements.samples.size());
  } else {
    disturbances_ = disturbancesOf(stage.effects, stage.cell, measurements.target, measurements.gravity, measurements.samples, false,
                                   measurements.other_columns);
  }
}

Eigen::Isometry3d StageAt::cameraTarget(const Observation& observation) const {
  return disturbedTarget(stage_.cell, measurements_.samples[observation.sample], disturbances_[observation.sample]);
}

Eigen::Isometry3d StageAt::baseFlange(const Observation& observation) const {
  return disturbedFlange(stage_.cell, measurements_.samples[observation.sample], disturbances_[observation.sample]);
}

Eigen::VectorXd StageAt::residual(const Observation& observation) const {
  if (observation.pose) return poseNumbers(observation, poseDifference(observation.pose->T_camera_target, cameraTarget(observation)));
  const Sample& sample = measurements_.samples[observation.sample];
  const auto px = disturbedCorners(stage_.cell, sample, measurements_.target.points, disturbances_[observation.sample]);
  Eigen::VectorXd r(2 * static_cast<Eigen::Index>(observation.corners.size()));
  for (std::size_t j = 0; j < observation.corners.size(); ++j) {
    const CornerMeasurement& corner = observation.corners[j];
    const auto& model = px[indexIn(measurements_.target, corner.id)];
    const Eigen::Vector2d none = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    r.segment<2>(2 * static_cast<Eigen::Index>(j)) = model ? Eigen::Vector2d(corner.px - *model) : none;
  }
  return r;
}

MeasuredMotion::MeasuredMotion(const Cell& cell, const Sample& sample, const Observation& observation, const Target& target)
    : observation_(observation), target_(target) {
  if (observation.pose) {
    pose_ = posePortJacobian(cell, sample);
    joints_.resize(observation.unitSize(), pose_.joints.cols());
    for (Eigen::Index k = 0; k < pose_.joints.cols(); ++k) joints_.col(k) = alongPose(pose_.joints.col(k));
    weight_ = poseNumbers(observation, observation.pose->whitening.diagonal()).cwiseAbs2();
    return;
  }
  std::vector<TargetPoint> points;
  for (const CornerMeasurement& corner : observation.corners) points.push_back({corner.id, corner.p_target});
  corners_ = portJacobian(cell, sample, points);
  joints_ = corners_.J_px_pose * corners_.pose.joints;
  weight_.resize(joints_.rows());
  for (std::size_t j = 0; j < observation.corners.size(); ++j) {
    const double sigma = observation.corners[j].sigma_px;
    weight_.segment<2>(2 * static_cast<Eigen::Index>(j)).setConstant(corners_.valid[j] ? 1.0 / (sigma * sigma) : 0.0);
  }
}

Eigen::VectorXd MeasuredMotion::alongPose(const Vector6d& motion) const {
  Vector6d e = motion;
  const Eigen::Vector3d w = motion.head<3>();
  e.tail<3>() += w.cross(pose_.T_camera_target.translation());
  return poseNumbers(observation_, e);
}

Eigen::VectorXd MeasuredMotion::along(const Disturbance& disturbance) const {
  if (observation_.pose) return alongPose(pose_.along(disturbance));
  Disturbance seen = disturbance;
  seen.points.clear();
  seen.pixels.clear();
  for (const CornerMeasurement& corner : observation_.corners) {
    const std::size_t j = indexIn(target_, corner.id);
    if (!disturbance.points.empty()) seen.points.push_back(disturbance.points[j]);
    if (!disturbance.pixels.empty()) seen.pixels.push_back(disturbance.pixels[j]);
  }
  return corners_.along(seen);
}

Eigen::VectorXd MeasuredMotion::jointErrors(const Eigen::VectorXd& r) const {
  Eigen::VectorXd errors(joints_.cols());
  const Eigen::VectorXd known = r.array().isFinite().select(r, 0.0);
  for (Eigen::Index k = 0; k < joints_.cols(); ++k) {
    const Eigen::VectorXd weighted = weight_.cwiseProduct(joints_.col(k));
    const double information = weighted.dot(joints_.col(k));
    errors(k) = information > 0.0 ? weighted.dot(known) / information : std::numeric_limits<double>::quiet_NaN();
  }
  return errors;
}

}  // namespace poecal
