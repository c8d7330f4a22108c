#include "poecal/effects/sample_context.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "poecal/cell/ports.hpp"
#include "poecal/robot/gravity.hpp"

namespace poecal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kSecondsInAnHour = 3600.0;

/// Gravity's load on the arm where its chain has it.
void addGravity(const CaptureContext& capture, SampleContext& context) {
  const Arm& arm = *capture.cell.arm;
  const auto n = static_cast<Eigen::Index>(arm.joints.size());
  const ArmChain& chain = context.chain;
  context.joint_twists = spaceJacobian(arm, chain);
  const double payload = context.sample.payload.value_or(0.0);
  context.wrench_by_masses.resize(6, 4 * n + 1);
  context.wrench_by_masses.leftCols(4 * n) = gravityRegressor(arm, chain, capture.gravity);
  // A known mass at the flange's origin.
  context.wrench_by_masses.rightCols<1>() << chain.T_base_flange.translation().cross(payload * capture.gravity), payload * capture.gravity;
  if (arm.links.empty()) {
    context.torque = Eigen::VectorXd::Constant(n, kNaN);
    context.moment_body = Eigen::Matrix3Xd::Constant(3, n, kNaN);
    context.base_moment.setConstant(kNaN);
    return;
  }
  const GravityLoad load = gravityLoad(arm, chain, capture.gravity, payload);
  context.torque = load.torque;
  context.base_moment = load.base.head<3>();
  context.moment_body.resize(3, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    context.moment_body.col(k) = chain.P[static_cast<std::size_t>(k) + 1].linear().transpose() * load.carried.col(k).head<3>();
  }
}

/// The chain of an arm at the same readings as that of another arm. Joints that are the same in both keep their motion.
ArmChain movedChain(const Arm& arm, const Arm& other, const ArmChain& chain, const Eigen::VectorXd& q) {
  ArmChain moved;
  moved.P.reserve(chain.P.size());
  moved.P.push_back(chain.P.front());
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();  // of all bodies beyond the last joint that differs
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    if (arm.joints[k].xi == other.joints[k].xi) {
      moved.P.push_back(motion * chain.P[k + 1]);
      continue;
    }
    moved.P.push_back(moved.P.back() * expSe3(arm.joints[k].xi * q(static_cast<Eigen::Index>(k))));
    motion = moved.P.back() * chain.P[k + 1].inverse();
  }
  moved.T_base_flange = arm.gamma == other.gamma ? motion * chain.T_base_flange : moved.P.back() * expSe3(arm.gamma);
  return moved;
}

/// Motion of the corner where the edges from `before` and to `after` meet, when both move out by 1 px, away from `center`.
Eigen::Vector2d outwardAt(const Eigen::Vector2d& before, const Eigen::Vector2d& corner, const Eigen::Vector2d& after,
                          const Eigen::Vector2d& center) {
  Eigen::Matrix2d normals;
  int row = 0;
  for (const Eigen::Vector2d& other : {before, after}) {
    const Eigen::Vector2d along = (corner - other).normalized();
    const Eigen::Vector2d normal(along.y(), -along.x());
    normals.row(row++) = normal.dot(corner - center) > 0.0 ? normal : Eigen::Vector2d(-normal);
  }
  return normals.inverse() * Eigen::Vector2d::Ones();
}

/// Motion of a tag's corner when both its edges move out by 1 px; zero where the point is no corner of a tag, or a part of it has no pixel.
Eigen::Vector2d outwardOf(const CaptureContext& capture, const Eigen::Isometry3d& T_camera_target, PointId id) {
  constexpr int kCorners = 4;
  const Eigen::Vector2d none = Eigen::Vector2d::Zero();
  if (!capture.target.hasTags()) return none;
  std::array<Eigen::Vector2d, kCorners> px;
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  for (int corner = 0; corner < kCorners; ++corner) {
    const TargetPoint* point = capture.target.find({id.tag, corner});
    const auto pixel = point == nullptr ? std::nullopt : project(*capture.cell.camera, T_camera_target * point->p_target);
    if (!pixel) return none;
    px[static_cast<std::size_t>(corner)] = *pixel;
    center += *pixel / kCorners;
  }
  const auto at = [&px](int corner) { return px[static_cast<std::size_t>((corner + kCorners) % kCorners)]; };
  return outwardAt(at(id.corner - 1), at(id.corner), at(id.corner + 1), center);
}

void addPoints(const CaptureContext& capture, const std::vector<TargetPoint>& points, SampleContext& context) {
  if (!capture.cell.camera) {
    for (const TargetPoint& point : points) {
      context.points.push_back({.id = point.id, .p_target = point.p_target, .px = Eigen::Vector2d::Constant(kNaN)});
    }
    return;
  }
  const Eigen::Isometry3d T_base_flange = context.chain.P.empty() ? capture.cell.baseFlange(context.sample) : context.chain.T_base_flange;
  const Eigen::Isometry3d T_camera_target = capture.cell.registration.cameraTarget(T_base_flange);
  Eigen::VectorXd velocity = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(points.size()));
  if (context.sample.dq.size() > 0 && capture.cell.arm) {
    Disturbance motion;
    motion.joints = context.sample.dq;
    velocity = portJacobian(capture.cell, context.sample, points).along(motion);
  }
  context.points.reserve(points.size());
  for (std::size_t j = 0; j < points.size(); ++j) {
    PointContext point{.id = points[j].id,
                       .p_target = points[j].p_target,
                       .px = project(*capture.cell.camera, T_camera_target * points[j].p_target).value_or(Eigen::Vector2d::Constant(kNaN))};
    point.px_velocity = velocity.segment<2>(2 * static_cast<Eigen::Index>(j));
    point.px_outward = outwardOf(capture, T_camera_target, point.id);
    context.points.push_back(point);
  }
}

}  // namespace

double SampleContext::elapsed(DriverKind driver, double reference) const {
  const auto since = [reference](double first) { return std::isnan(reference) ? first : reference; };
  if (driver == DriverKind::kStamp) return (sample.stamp.value_or(kNaN) - since(capture->first_stamp)) / kSecondsInAnHour;
  if (driver == DriverKind::kTemperature) return sample.temperature.value_or(kNaN) - since(capture->first_temperature);
  return kNaN;
}

double SampleContext::torqueByMasses(std::size_t k, Eigen::Index c) const {
  if (c < 4 * static_cast<Eigen::Index>(k)) return 0.0;
  return joint_twists.col(static_cast<Eigen::Index>(k)).dot(wrench_by_masses.col(c));
}

Eigen::Vector3d SampleContext::momentByMasses(std::size_t k, Eigen::Index c) const {
  if (c < 4 * static_cast<Eigen::Index>(k)) return Eigen::Vector3d::Zero();
  return momentOf(wrench_by_masses.col(c), k);
}

Eigen::Vector3d SampleContext::momentOf(const Vector6d& wrench, std::size_t k) const {
  const Eigen::Vector3d anchor_base = chain.P[k] * capture->cell.arm->joints[k].anchor;
  return chain.P[k + 1].linear().transpose() * (wrench.head<3>() - anchor_base.cross(wrench.tail<3>()));
}

SampleContext SampleContext::readingsOn(const std::shared_ptr<const CaptureContext>& other) const {
  SampleContext moved;
  moved.capture = other;
  moved.number = number;
  moved.sample = sample;
  return moved;
}

SampleContext SampleContext::loadOf(const std::shared_ptr<const CaptureContext>& other) const {
  SampleContext moved = readingsOn(other);
  if (chain.P.empty()) return moved;
  moved.chain = movedChain(*other->cell.arm, *capture->cell.arm, chain, sample.q);
  addGravity(*other, moved);
  return moved;
}

std::shared_ptr<const CaptureContext> makeCaptureContext(const Cell& cell, const Target& target, const Eigen::Vector3d& gravity,
                                                         const std::vector<Sample>& samples,
                                                         const std::vector<std::string>& other_columns) {
  auto capture = std::make_shared<CaptureContext>();
  capture->cell = cell;
  capture->target = target;
  capture->gravity = gravity;
  capture->other_columns = other_columns;
  for (const TargetPoint& point : target.points) capture->center_target += point.p_target / static_cast<double>(target.points.size());
  capture->first_stamp = std::numeric_limits<double>::infinity();
  capture->last_stamp = -capture->first_stamp;
  capture->first_temperature = kNaN;
  for (const Sample& sample : samples) {
    if (sample.stamp) {
      capture->first_stamp = std::min(capture->first_stamp, *sample.stamp);
      capture->last_stamp = std::max(capture->last_stamp, *sample.stamp);
    }
    if (sample.temperature && std::isnan(capture->first_temperature)) capture->first_temperature = *sample.temperature;
  }
  return capture;
}

SampleContext makeSampleContext(const std::shared_ptr<const CaptureContext>& capture, const Sample& sample, std::size_t number,
                                const std::vector<TargetPoint>& points) {
  SampleContext context;
  context.capture = capture;
  context.number = number;
  context.sample = sample;
  if (capture->cell.arm && sample.q.size() > 0) {
    context.chain = forwardChain(*capture->cell.arm, sample.q);
    addGravity(*capture, context);
  }
  addPoints(*capture, points, context);
  return context;
}

}  // namespace poecal
