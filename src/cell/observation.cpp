#include "poecal/cell/observation.hpp"

#include <cmath>
#include <string>
#include <unordered_map>

namespace poecal {

Vector6d poseDifference(const Eigen::Isometry3d& T_measured, const Eigen::Isometry3d& T_model) {
  Vector6d e;
  e << logSo3(T_measured.linear() * T_model.linear().transpose()), T_measured.translation() - T_model.translation();
  return e;
}

Observation cornerObservation(const Sample& sample, const std::vector<Corner>& corners, const Target& target) {
  Observation observation;
  observation.q = sample.q;
  observation.T_base_flange = sample.T_base_flange;
  for (const Corner& corner : corners) {
    const TargetPoint* point = target.find(corner.id);
    if (point == nullptr) continue;
    const double sigma = std::isfinite(corner.sigma) && corner.sigma > 0.0 ? corner.sigma : 1.0;
    observation.corners.push_back({corner.id, point->p_target, corner.px, sigma});
  }
  return observation;
}

std::vector<Observation> cornerObservations(const SampleTable& table, const Detections& detections, const Target& target) {
  std::unordered_map<std::string, const ImageCorners*> by_image;
  for (const ImageCorners& entry : detections.images) by_image.emplace(entry.image, &entry);
  std::vector<Observation> observations;
  for (std::size_t k = 0; k < table.samples.size(); ++k) {
    const Sample& sample = table.samples[k];
    const auto found = by_image.find(sample.image);
    if (found == by_image.end()) continue;
    Observation observation = cornerObservation(sample, found->second->corners, target);
    observation.sample = k;
    if (!observation.corners.empty()) observations.push_back(std::move(observation));
  }
  return observations;
}

Observation poseObservation(const MeasuredPose& measured, double sigma_position, double sigma_rotation) {
  PoseMeasurement pose;
  pose.T_camera_target = measured.T_instrument_tool;
  pose.position_only = measured.position_only;
  Vector6d weight;
  weight << Eigen::Vector3d::Constant(1.0 / measured.sigma_rotation.value_or(sigma_rotation)),
      Eigen::Vector3d::Constant(1.0 / measured.sigma_position.value_or(sigma_position));
  if (pose.position_only) weight.head<3>().setZero();
  pose.whitening = weight.asDiagonal();
  Observation observation;
  observation.q = measured.sample.q;
  observation.pose = pose;
  return observation;
}

std::vector<Observation> poseObservations(const PoseTable& table, double sigma_position, double sigma_rotation) {
  std::vector<Observation> observations;
  for (std::size_t k = 0; k < table.poses.size(); ++k) {
    observations.push_back(poseObservation(table.poses[k], sigma_position, sigma_rotation));
    observations.back().sample = k;
  }
  return observations;
}

}  // namespace poecal
