// What plumb_bob, rational_polynomial and thin_prism share.
#include <array>
#include <cassert>
#include <cmath>

#include "camera/bisection.hpp"
#include "camera/distortion.hpp"
#include "camera/growth.hpp"

namespace poecal {
namespace {

/// The coefficients by their role, zeros for those that are not there. Those behind the eighth are for others to add.
struct Coefficients {
  std::array<double, 4> N{1.0, 0.0, 0.0, 0.0};  ///< 1 + k1 s + k2 s^2 + k3 s^3
  std::array<double, 4> D{1.0, 0.0, 0.0, 0.0};  ///< 1 + k4 s + k5 s^2 + k6 s^3
  double p1 = 0.0, p2 = 0.0;
  bool rational = false;

  explicit Coefficients(const Eigen::VectorXd& k) {
    assert(k.size() <= 12);
    const auto at = [&k](Eigen::Index i) { return i < k.size() ? k(i) : 0.0; };
    N = {1.0, at(0), at(1), at(4)};
    p1 = at(2), p2 = at(3);
    D = {1.0, at(5), at(6), at(7)};
    rational = k.size() > 5;
  }
};

double polynomial(const std::array<double, 4>& c, double s) { return c[0] + s * (c[1] + s * (c[2] + s * c[3])); }
double derivative(const std::array<double, 4>& c, double s) { return c[1] + s * (2.0 * c[2] + s * 3.0 * c[3]); }

/// Whether r N(r^2) / D(r^2) grows on all of [0, r], s = r^2: D^2 d/dr = N D + 2 s (N' D - N D') > 0, and D > 0.
bool growsUpTo(const Coefficients& c, double s) {
  if (!c.rational) return positiveUpTo(std::array<double, 4>{1.0, 3.0 * c.N[1], 5.0 * c.N[2], 7.0 * c.N[3]}, s);
  std::array<double, 7> slope{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) slope[i + j] += c.N[i] * c.D[j] * (1.0 + 2.0 * (static_cast<double>(i) - static_cast<double>(j)));
  }
  return positiveUpTo(c.D, s) && positiveUpTo(slope, s);
}

}  // namespace

std::optional<Eigen::Vector2d> distortPinhole(const Eigen::VectorXd& k, const Eigen::Vector3d& p_camera, DistortionJacobians* jacobians) {
  const double z = p_camera.z();
  if (!(z > 0.0)) return std::nullopt;
  const Eigen::Vector2d n = p_camera.head<2>() / z;
  const double x = n.x(), y = n.y(), s = n.squaredNorm();
  const Coefficients c(k);
  if (!std::isfinite(s) || !growsUpTo(c, s)) return std::nullopt;

  const double D = polynomial(c.D, s);
  const double L = polynomial(c.N, s) / D;
  const Eigen::Vector2d by_p1(2.0 * x * y, s + 2.0 * y * y);
  const Eigen::Vector2d by_p2(s + 2.0 * x * x, 2.0 * x * y);
  const Eigen::Vector2d m = L * n + c.p1 * by_p1 + c.p2 * by_p2;
  if (jacobians == nullptr) return m;

  const double L_s = (derivative(c.N, s) - L * derivative(c.D, s)) / D;
  Eigen::Matrix2d J_m_n = 2.0 * L_s * n * n.transpose();
  J_m_n.diagonal().array() += L;
  const double mixed = 2.0 * (c.p1 * x + c.p2 * y);
  J_m_n(0, 0) += 2.0 * c.p1 * y + 6.0 * c.p2 * x;
  J_m_n(0, 1) += mixed;
  J_m_n(1, 0) += mixed;
  J_m_n(1, 1) += 6.0 * c.p1 * y + 2.0 * c.p2 * x;
  jacobians->J_m_p.leftCols<2>() = J_m_n / z;
  jacobians->J_m_p.col(2) = -J_m_n * n / z;

  const Eigen::Vector2d by_k1 = n * (s / D);
  const Eigen::Vector2d by_k4 = -L * by_k1;
  jacobians->J_m_k.leftCols<8>() << by_k1, by_k1 * s, by_p1, by_p2, by_k1 * s * s, by_k4, by_k4 * s, by_k4 * s * s;
  return m;
}

std::optional<Eigen::Vector3d> rayOfRadiusPinhole(const Eigen::VectorXd& k, const Eigen::Vector2d& unit, double radius) {
  const Coefficients c(k);
  // Searched in u = atan(r), so that the whole half space is a bounded interval; 1e-6 rad short of 90 degrees.
  const auto profile = [&c](double u) -> std::optional<double> {
    const double r = std::tan(u), s = r * r;
    if (!growsUpTo(c, s)) return std::nullopt;
    return r * polynomial(c.N, s) / polynomial(c.D, s);
  };
  const std::optional<double> u = invertGrowing(profile, radius, M_PI_2 - 1e-6);
  if (!u) return std::nullopt;
  return Eigen::Vector3d(std::sin(*u) * unit.x(), std::sin(*u) * unit.y(), std::cos(*u));
}

}  // namespace poecal
