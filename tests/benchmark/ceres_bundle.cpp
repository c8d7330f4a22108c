#include "benchmark/ceres_bundle.hpp"

#include <array>
#include <cmath>

#include <ceres/ceres.h>

#include "poecal/robot/arm.hpp"

namespace poecal::benchmarks {
namespace {

constexpr int kJoints = 6, kTwists = 4 * kJoints, kCamera = 9, kNumbers = 8;

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

template <typename T>
struct Transform {
  Eigen::Matrix<T, 3, 3> R;
  Vector3<T> p;

  Transform operator*(const Transform& other) const { return {R * other.R, R * other.p + p}; }
  Transform inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
};

template <typename T>
Transform<T> cast(const Eigen::Isometry3d& pose) {
  return {pose.linear().cast<T>(), pose.translation().cast<T>()};
}

/// Exponential of a twist (w; v). Its series near zero carries the derivatives there.
template <typename T>
Transform<T> exponential(const Eigen::Matrix<T, 6, 1>& xi) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const Vector3<T> w = xi.template head<3>();
  const T s = w.squaredNorm();
  T a, b, c;
  if (s < 1e-4) {
    a = 1.0 - s / 6.0 * (1.0 - s / 20.0);
    b = 0.5 - s / 24.0 * (1.0 - s / 30.0);
    c = 1.0 / 6.0 - s / 120.0 * (1.0 - s / 42.0);
  } else {
    const T angle = sqrt(s);
    a = sin(angle) / angle;
    b = (1.0 - cos(angle)) / s;
    c = (1.0 - a) / s;
  }
  Eigen::Matrix<T, 3, 3> W;
  W << T(0), -w.z(), w.y(), w.z(), T(0), -w.x(), -w.y(), w.x(), T(0);
  const Eigen::Matrix<T, 3, 3> W2 = W * W, I = Eigen::Matrix<T, 3, 3>::Identity();
  return {I + a * W + b * W2, (I + b * W + c * W2) * xi.template tail<3>()};
}

/// The corners of one picture. Joint k moves by exp(B beta_k) exp(xi_k q_k) exp(-B beta_k).
struct Picture {
  const Observation& observation;
  std::array<Matrix6Xd, kJoints> bases;
  std::array<Eigen::Isometry3d, kJoints> moved;  ///< exp(xi_k q_k), nominal
  Eigen::Isometry3d T_base_flange_zero, T_camera_near, T_far_target;

  Picture(const Cell& start, const Observation& seen)
      : observation(seen),
        T_base_flange_zero(expSe3(start.arm->gamma)),
        T_camera_near(start.registration.T_camera_near),
        T_far_target(start.registration.T_far_target) {
    for (std::size_t k = 0; k < kJoints; ++k) {
      bases[k] = twistBasis(start.arm->joints[k]);
      moved[k] = expSe3(start.arm->joints[k].xi * seen.q(static_cast<Eigen::Index>(k)));
    }
  }

  template <typename T>
  bool operator()(const T* beta, const T* near, const T* far, const T* camera, T* residuals) const {
    using Map6 = Eigen::Map<const Eigen::Matrix<T, 6, 1>>;
    Transform<T> T_camera_target = exponential<T>(Map6(near)) * cast<T>(T_camera_near);
    for (std::size_t k = 0; k < kJoints; ++k) {
      const Eigen::Matrix<T, 6, 1> eta = bases[k].cast<T>() * Eigen::Map<const Eigen::Matrix<T, 4, 1>>(beta + 4 * k);
      const Transform<T> displaced = exponential<T>(eta);
      T_camera_target = T_camera_target * displaced * cast<T>(moved[k]) * displaced.inverse();
    }
    T_camera_target = T_camera_target * cast<T>(T_base_flange_zero) * exponential<T>(Map6(far)) * cast<T>(T_far_target);
    const T &fx = camera[0], &fy = camera[1], &cx = camera[2], &cy = camera[3];
    const T &k1 = camera[4], &k2 = camera[5], &p1 = camera[6], &p2 = camera[7], &k3 = camera[8];
    for (std::size_t k = 0; k < observation.corners.size(); ++k) {
      const CornerMeasurement& corner = observation.corners[k];
      const Vector3<T> p = T_camera_target.R * corner.p_target.cast<T>() + T_camera_target.p;
      const T x = p.x() / p.z(), y = p.y() / p.z(), s = x * x + y * y;
      const T radial = 1.0 + s * (k1 + s * (k2 + s * k3));
      const T u = fx * (x * radial + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x)) + cx;
      const T v = fy * (y * radial + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y) + cy;
      residuals[2 * k] = (corner.px.x() - u) / corner.sigma_px;
      residuals[2 * k + 1] = (corner.px.y() - v) / corner.sigma_px;
    }
    return true;
  }
};

/// U (x - x0), the precision being U^T U.
struct Prior {
  Eigen::VectorXd x0;
  Eigen::MatrixXd root;

  template <typename T>
  bool operator()(T const* const* x, T* residuals) const {
    for (Eigen::Index i = 0; i < x0.size(); ++i) {
      residuals[i] = T(0.0);
      for (Eigen::Index k = i; k < x0.size(); ++k) residuals[i] += root(i, k) * (x[0][k] - x0(k));
    }
    return true;
  }
};

/// @param root  upper triangular.
void addPrior(ceres::Problem& problem, Eigen::VectorXd& parameters, const Eigen::MatrixXd& root) {
  auto* cost = new ceres::DynamicAutoDiffCostFunction<Prior, 16>(new Prior{parameters, root});
  cost->AddParameterBlock(static_cast<int>(parameters.size()));
  cost->SetNumResiduals(static_cast<int>(parameters.size()));
  problem.AddResidualBlock(cost, nullptr, parameters.data());
}

}  // namespace

CeresBundle solveWithCeres(const Cell& start, const std::vector<Observation>& observations, const AdjustmentOptions& options) {
  CeresBundle result;
  result.beta = Eigen::VectorXd::Zero(kTwists);
  result.camera = start.camera->parameters();
  Vector6d near = Vector6d::Zero(), far = Vector6d::Zero();
  ceres::Problem problem;
  for (const Observation& observation : observations) {
    auto* cost = new ceres::AutoDiffCostFunction<Picture, kNumbers, kTwists, 6, 6, kCamera>(new Picture(start, observation));
    problem.AddResidualBlock(cost, nullptr, result.beta.data(), near.data(), far.data(), result.camera.data());
  }
  addPrior(problem, result.beta, options.twists.precision.llt().matrixU());
  if (options.free.intrinsics) {
    addPrior(problem, result.camera, options.camera_prior_sigma.cwiseInverse().asDiagonal());
  } else {
    problem.SetParameterBlockConstant(result.camera.data());
  }
  ceres::Solver::Options solver;
  // The fastest of its solvers where few parameters enter every residual.
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.function_tolerance = 1e-18;
  solver.gradient_tolerance = 1e-15;
  solver.parameter_tolerance = 1e-15;
  solver.max_num_iterations = 100;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  result.converged = summary.IsSolutionUsable();
  result.iterations = static_cast<int>(summary.iterations.size());
  result.registration = start.registration;
  result.registration.T_camera_near = expSe3(near) * start.registration.T_camera_near;
  result.registration.T_far_target = expSe3(far) * start.registration.T_far_target;
  return result;
}

}  // namespace poecal::benchmarks
