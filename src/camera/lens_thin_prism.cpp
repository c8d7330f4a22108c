// thin_prism: rational_polynomial with terms of lenses that are tilted against each other (OpenCV's CALIB_THIN_PRISM_MODEL).
#include <cassert>

#include "camera/lens_model.hpp"

namespace poecal {
namespace {

constexpr Coefficient kCoefficients[] = {{"k1", 10.0}, {"k2", 10.0}, {"p1", 0.1}, {"p2", 0.1}, {"k3", 10.0}, {"k4", 10.0},
                                         {"k5", 10.0}, {"k6", 10.0}, {"s1", 0.1}, {"s2", 0.1}, {"s3", 0.1},  {"s4", 0.1}};

}  // namespace

std::optional<Eigen::Vector2d> distortThinPrism(const Eigen::VectorXd& k, const Eigen::Vector3d& p_camera, DistortionJacobians* jacobians) {
  assert(k.size() <= 12);
  const std::optional<Eigen::Vector2d> m = distortPinhole(k, p_camera, jacobians);
  if (!m) return std::nullopt;
  const auto at = [&k](Eigen::Index i) { return i < k.size() ? k(i) : 0.0; };
  const Eigen::Vector2d linear(at(8), at(10)), square(at(9), at(11));
  const Eigen::Vector2d n = p_camera.head<2>() / p_camera.z();
  const double s = n.squaredNorm();
  if (jacobians != nullptr) {
    const Eigen::Matrix2d J_prism_n = 2.0 * (linear + 2.0 * s * square) * n.transpose();
    jacobians->J_m_p.leftCols<2>() += J_prism_n / p_camera.z();
    jacobians->J_m_p.col(2) -= J_prism_n * n / p_camera.z();
    jacobians->J_m_k.rightCols<4>() << s, s * s, 0.0, 0.0,  //
        0.0, 0.0, s, s * s;
  }
  return Eigen::Vector2d(*m + s * linear + s * s * square);
}

constinit const LensModel kThinPrismLens{DistortionModel::kThinPrism, "thin_prism", kCoefficients, distortThinPrism, rayOfRadiusPinhole};

}  // namespace poecal
