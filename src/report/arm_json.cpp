// The arm in space at some of the samples: axes, camera, target and errors.
#include <algorithm>

#include "report/numbers.hpp"
#include "report/sections.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPostures = 300;
constexpr int kDigits = 5;  // of a metre: a hundredth of a millimetre

/// Points one after the other, x y z of each.
class PointList {
 public:
  void add(const Eigen::Vector3d& p) {
    for (const double c : p) json_.push_back(rounded(c, kDigits));
  }
  const Json& json() const { return json_; }

 private:
  Json json_ = Json::array();
};

/// A point and the direction of each axis, then the flange, in base.
Json axesJson(const Arm& arm, const Eigen::VectorXd& q) {
  const ArmChain chain = forwardChain(arm, q);
  PointList points, directions;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    points.add(chain.P[k] * arm.joints[k].anchor);
    directions.add(chain.P[k].linear() * arm.joints[k].axis());
  }
  points.add(chain.T_base_flange.translation());
  return {{"points", points.json()}, {"axes", directions.json()}};
}

/// The rectangle around the target's points in their x and y, in base.
Json targetJson(const Target& target, const Eigen::Isometry3d& T_base_target) {
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
  for (std::size_t j = 0; j < target.points.size(); ++j) {
    const Eigen::Vector3d& p = target.points[j].p_target;
    low = j == 0 ? p : Eigen::Vector3d(low.cwiseMin(p));
    high = j == 0 ? p : Eigen::Vector3d(high.cwiseMax(p));
  }
  const double z = 0.5 * (low.z() + high.z());
  PointList corners;
  for (const auto& [x, y] :
       {std::pair(low.x(), low.y()), std::pair(high.x(), low.y()), std::pair(high.x(), high.y()), std::pair(low.x(), high.y())}) {
    corners.add(T_base_target * Eigen::Vector3d(x, y, z));
  }
  return corners.json();
}

/// Where the target is before the camera by a stage less where the last stage has it, in base [mm].
Json missJson(const ReportSource& source, const Observation& observation, const Eigen::Isometry3d& T_base_camera) {
  const Eigen::Vector3d last = source.at[source.models.after].cameraTarget(observation).translation();
  PointList misses;
  for (const StageAt& stage : source.at) {
    const Eigen::Vector3d d_camera = stage.cameraTarget(observation).translation() - last;
    misses.add(1e3 * (T_base_camera.linear() * d_camera));
  }
  return misses.json();
}

Json postureJson(const ReportSource& source, std::size_t number) {
  const Observation& observation = source.measurements.observations[source.shown[number]];
  const Sample& sample = source.measurements.samples[observation.sample];
  const Cell& cell = source.models.stages[source.models.after].cell;
  const Eigen::Isometry3d T_base_flange = source.at[source.models.after].baseFlange(observation);
  const Eigen::Isometry3d T_base_camera = cell.registration.cameraBase(T_base_flange).inverse();
  const Eigen::Isometry3d T_base_target = T_base_camera * source.at[source.models.after].cameraTarget(observation);
  PointList camera;
  for (const Eigen::Vector3d& p : {Eigen::Vector3d::Zero().eval(), Eigen::Vector3d::UnitX().eval(), Eigen::Vector3d::UnitY().eval(),
                                   Eigen::Vector3d::UnitZ().eval()}) {
    camera.add(p.isZero() ? Eigen::Vector3d(T_base_camera.translation()) : Eigen::Vector3d(T_base_camera.linear() * p));
  }
  return {{"row", number},
          {"nominal", axesJson(source.identification.nominal, sample.q)},
          {"identified", axesJson(*cell.arm, sample.q)},
          {"camera", camera.json()},
          {"target", targetJson(source.measurements.target, T_base_target)},
          {"miss", missJson(source, observation, T_base_camera)}};
}

}  // namespace

nlohmann::ordered_json armJson(const ReportSource& source) {
  const std::size_t step = std::max<std::size_t>(1, (source.shown.size() + kMostPostures - 1) / kMostPostures);
  Json postures = Json::array();
  for (std::size_t number = 0; number < source.shown.size(); number += step) postures.push_back(postureJson(source, number));
  const Arm& arm = source.identification.nominal;
  Json joints = Json::array();
  for (const Joint& joint : arm.joints) {
    Json json{{"name", joint.name}, {"type", joint.type == JointType::kRevolute ? "revolute" : "prismatic"}};
    if (joint.limits) json["limits"] = {rounded(joint.limits->lower), rounded(joint.limits->upper)};
    joints.push_back(json);
  }
  return {{"joints", joints}, {"postures", postures}};
}

}  // namespace poecal
