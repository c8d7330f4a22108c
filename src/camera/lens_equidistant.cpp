// equidistant: the angle from the axis, bent by an odd polynomial.
#include <array>
#include <cassert>
#include <cmath>

#include "camera/bisection.hpp"
#include "camera/growth.hpp"
#include "camera/lens_model.hpp"

namespace poecal {
namespace {

constexpr Coefficient kCoefficients[] = {{"k1", 1.0}, {"k2", 1.0}, {"k3", 1.0}, {"k4", 1.0}};

std::array<double, 4> coefficients(const Eigen::VectorXd& k) {
  assert(k.size() <= 4);
  std::array<double, 4> c{};
  for (Eigen::Index i = 0; i < k.size(); ++i) c[static_cast<std::size_t>(i)] = k(i);
  return c;
}

/// d theta_d / d theta as a polynomial of theta^2.
std::array<double, 5> slopeCoefficients(const std::array<double, 4>& c) { return {1.0, 3.0 * c[0], 5.0 * c[1], 7.0 * c[2], 9.0 * c[3]}; }

double bentAngle(const std::array<double, 4>& c, double theta) {
  const double s = theta * theta;
  return theta * (1.0 + s * (c[0] + s * (c[1] + s * (c[2] + s * c[3]))));
}

}  // namespace

std::optional<Eigen::Vector2d> distortEquidistant(const Eigen::VectorXd& k, const Eigen::Vector3d& p_camera,
                                                  DistortionJacobians* jacobians) {
  const Eigen::Vector2d xy = p_camera.head<2>();
  const double z = p_camera.z();
  const double r = std::hypot(xy.x(), xy.y());
  if (r == 0.0 && !(z > 0.0)) return std::nullopt;
  const double theta = std::atan2(r, z);
  const double s = theta * theta;
  const std::array<double, 4> c = coefficients(k);
  const std::array<double, 5> slope = slopeCoefficients(c);
  if (!positiveUpTo(slope, s)) return std::nullopt;

  const double theta_d = bentAngle(c, theta);
  const Eigen::Vector2d u = r > 0.0 ? Eigen::Vector2d(xy / r) : Eigen::Vector2d(1.0, 0.0);  // on the axis any direction does
  if (jacobians != nullptr) {
    // Along u the point moves by the profile's slope, across it by theta_d / r, which tends to 1 / z on the axis.
    const double square = r * r + z * z;
    const double by_theta = slope[0] + s * (slope[1] + s * (slope[2] + s * (slope[3] + s * slope[4])));
    const double along = by_theta * z / square;
    const double across = r > 0.0 ? theta_d / r : 1.0 / z;
    jacobians->J_m_p.leftCols<2>() = across * Eigen::Matrix2d::Identity() + (along - across) * u * u.transpose();
    jacobians->J_m_p.col(2) = -by_theta * r / square * u;
    double power = theta;
    for (Eigen::Index i = 0; i < 4; ++i) jacobians->J_m_k.col(i) = (power *= s) * u;
  }
  return Eigen::Vector2d(theta_d * u);
}

std::optional<Eigen::Vector3d> rayOfRadiusEquidistant(const Eigen::VectorXd& k, const Eigen::Vector2d& unit, double radius) {
  const std::array<double, 4> c = coefficients(k);
  const std::array<double, 5> slope = slopeCoefficients(c);
  const auto profile = [&](double theta) -> std::optional<double> {
    if (!positiveUpTo(slope, theta * theta)) return std::nullopt;
    return bentAngle(c, theta);
  };
  const std::optional<double> theta = invertGrowing(profile, radius, M_PI);
  if (!theta) return std::nullopt;
  return Eigen::Vector3d(std::sin(*theta) * unit.x(), std::sin(*theta) * unit.y(), std::cos(*theta));
}

constinit const LensModel kEquidistantLens{DistortionModel::kEquidistant, "equidistant", kCoefficients, distortEquidistant,
                                           rayOfRadiusEquidistant};

}  // namespace poecal
