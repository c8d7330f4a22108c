#include "poecal/camera/camera.hpp"

#include <cassert>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include "camera/lens_model.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

std::optional<Eigen::Vector2d> distort(const Camera& camera, const Eigen::Vector3d& p_camera, DistortionJacobians* jacobians) {
  assert(camera.distortion.size() <= distortionCount(camera.model));
  return lensModel(camera.model).distort(camera.distortion, p_camera, jacobians);
}

/// Two unit vectors across a unit ray.
Eigen::Matrix<double, 3, 2> tangentBasis(const Eigen::Vector3d& ray) {
  Eigen::Matrix<double, 3, 2> E;
  E.col(0) = ray.unitOrthogonal();
  E.col(1) = ray.cross(E.col(0));
  return E;
}

/// Where a ray is seen, and how that moves with it.
struct Aim {
  Eigen::Vector3d ray;
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, 3> J_px_ray;
};

std::optional<Aim> aim(const Camera& camera, const Eigen::Vector3d& ray) {
  DistortionJacobians jacobians;
  const std::optional<Eigen::Vector2d> m = distort(camera, ray, &jacobians);
  if (!m) return std::nullopt;
  const Eigen::Array2d f(camera.fx, camera.fy);
  return Aim{ray, {camera.fx * m->x() + camera.cx, camera.fy * m->y() + camera.cy}, jacobians.J_m_p.array().colwise() * f};
}

/// One Newton step on the sphere of rays, halved until it lessens the distance to `px`. @return whether it did.
bool stepTowards(const Camera& camera, const Eigen::Vector2d& px, Aim& at) {
  constexpr int kMaxHalvings = 20;
  const Eigen::Vector2d error = px - at.px;
  const Eigen::Matrix<double, 3, 2> E = tangentBasis(at.ray);
  Eigen::Vector3d step = E * (Eigen::Matrix2d(at.J_px_ray * E).inverse() * error);
  if (!step.allFinite()) return false;
  for (int halving = 0; halving < kMaxHalvings; ++halving, step *= 0.5) {
    const std::optional<Aim> trial = aim(camera, (at.ray + step).normalized());
    if (trial && (px - trial->px).norm() < error.norm()) {
      at = *trial;
      return true;
    }
  }
  return false;
}

/// The ray that is seen at `px`, by Newton's method from `start`; nothing where it does not get there.
std::optional<Eigen::Vector3d> solveRay(const Camera& camera, const Eigen::Vector2d& px, const Eigen::Vector3d& start) {
  constexpr double kGoal_px = 1e-11;    // Newton's method gets here wherever rounding allows
  constexpr double kPromise_px = 1e-9;  // what the header says
  constexpr int kMaxIterations = 30;
  std::optional<Aim> at = aim(camera, start);
  if (!at) return std::nullopt;
  for (int iteration = 0; iteration < kMaxIterations && (px - at->px).norm() > kGoal_px; ++iteration) {
    if (!stepTowards(camera, px, *at)) break;
  }
  if (!((px - at->px).norm() < kPromise_px)) return std::nullopt;
  return at->ray;
}

}  // namespace

Eigen::VectorXd Camera::parameters() const {
  Eigen::VectorXd values(parameterCount());
  values << fx, fy, cx, cy, distortion;
  return values;
}

void Camera::setParameters(const Eigen::VectorXd& parameters) {
  if (parameters.size() != parameterCount()) {
    throw InvalidArgument(fmt::format("{} camera parameters, expected {}", parameters.size(), parameterCount()));
  }
  fx = parameters(0);
  fy = parameters(1);
  cx = parameters(2);
  cy = parameters(3);
  distortion = parameters.tail(distortion.size());
}

std::vector<std::string> Camera::parameterNames() const {
  std::vector<std::string> names{"fx", "fy", "cx", "cy"};
  for (const Coefficient& coefficient : lensModel(model).coefficients) names.emplace_back(coefficient.name);
  names.resize(static_cast<std::size_t>(parameterCount()));
  return names;
}

std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& p_camera) {
  const std::optional<Eigen::Vector2d> m = distort(camera, p_camera, nullptr);
  if (!m) return std::nullopt;
  return Eigen::Vector2d(camera.fx * m->x() + camera.cx, camera.fy * m->y() + camera.cy);
}

std::optional<Projection> projectWithJacobians(const Camera& camera, const Eigen::Vector3d& p_camera) {
  DistortionJacobians jacobians;
  const std::optional<Eigen::Vector2d> m = distort(camera, p_camera, &jacobians);
  if (!m) return std::nullopt;
  const Eigen::Array2d f(camera.fx, camera.fy);
  Projection projection;
  projection.px << camera.fx * m->x() + camera.cx, camera.fy * m->y() + camera.cy;
  projection.J_px_p = jacobians.J_m_p.array().colwise() * f;
  projection.J_px_parameters.resize(2, camera.parameterCount());
  projection.J_px_parameters.leftCols<4>() << m->x(), 0.0, 1.0, 0.0,  //
      0.0, m->y(), 0.0, 1.0;
  const Eigen::Index count = camera.distortion.size();
  projection.J_px_parameters.rightCols(count) = jacobians.J_m_k.leftCols(count).array().colwise() * f;
  return projection;
}

std::optional<Eigen::Vector3d> unproject(const Camera& camera, const Eigen::Vector2d& px) {
  const Eigen::Vector2d m((px.x() - camera.cx) / camera.fx, (px.y() - camera.cy) / camera.fy);
  const double radius = m.norm();
  if (!std::isfinite(radius)) return std::nullopt;
  if (radius == 0.0) return Eigen::Vector3d(0.0, 0.0, 1.0);
  // Most lenses bend rays by little, and any point found lies where the profile still grows, so it is the one. For the others: the radial
  // inverse is all of the equidistant model and nearly all of the pinhole ones, at twenty times the price.
  if (const auto ray = solveRay(camera, px, Eigen::Vector3d(m.x(), m.y(), 1.0).normalized())) return ray;
  const std::optional<Eigen::Vector3d> start = lensModel(camera.model).rayOfRadius(camera.distortion, m / radius, radius);
  return start ? solveRay(camera, px, *start) : std::nullopt;
}

const char* distortionModelName(DistortionModel model) { return lensModel(model).name; }

std::optional<DistortionModel> findDistortionModel(const std::string& name) {
  for (const DistortionModel model : kDistortionModels) {
    if (name == distortionModelName(model)) return model;
  }
  return std::nullopt;
}

int distortionCount(DistortionModel model) { return static_cast<int>(lensModel(model).coefficients.size()); }

}  // namespace poecal
