#include "camera/board_bundle.hpp"

#include <cassert>
#include <cmath>

#include <Eigen/Cholesky>

#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

/// Normal equations of one picture's pose, and their coupling to the camera.
struct ViewEquations {
  Matrix6d H_pose = Matrix6d::Zero();
  Vector6d g_pose = Vector6d::Zero();
  Eigen::MatrixXd H_camera_pose;  ///< free parameters x 6
  Eigen::MatrixXd H_camera;       ///< this picture's share
  Eigen::VectorXd g_camera;
};

/// J^T J and J^T r of the whole problem, in blocks.
struct Equations {
  double squared_error = 0.0;
  Eigen::MatrixXd H_camera;
  Eigen::VectorXd g_camera;
  std::vector<ViewEquations> views;
};

struct Step {
  Eigen::VectorXd camera;
  std::vector<Vector6d> poses;
  double predicted_decrease = 0.0;  ///< of the squared error, by the linearised problem
};

/// What is minimised.
struct Problem {
  const std::vector<const BoardView*>& views;
  const std::vector<int>& free;
  const CornerWeights& weights;

  double weight(std::size_t view, Eigen::Index corner) const { return weights.empty() ? 1.0 : weights[view](corner); }
};

std::optional<Equations> linearise(const Problem& problem, const BoardBundle& at) {
  const std::vector<const BoardView*>& views = problem.views;
  const std::vector<int>& free = problem.free;
  const auto count = static_cast<Eigen::Index>(free.size());
  Equations equations;
  equations.H_camera.setZero(count, count);
  equations.g_camera.setZero(count);
  equations.views.resize(views.size());
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, Camera::kMaxParameters> J_camera(2, count);
  Eigen::Matrix<double, 2, 6> J_pose;
  for (std::size_t v = 0; v < views.size(); ++v) {
    ViewEquations& view = equations.views[v];
    view.H_camera_pose.setZero(count, 6);
    view.H_camera.setZero(count, count);
    view.g_camera.setZero(count);
    for (Eigen::Index i = 0; i < views[v]->points.cols(); ++i) {
      const Eigen::Vector3d p_camera = at.T_camera_target[v] * views[v]->points.col(i);
      const std::optional<Projection> projection = projectWithJacobians(at.camera, p_camera);
      if (!projection) return std::nullopt;
      const double root = std::sqrt(problem.weight(v, i));
      const Eigen::Vector2d r = root * (projection->px - views[v]->pixels.col(i));
      J_pose << -projection->J_px_p * hat(p_camera), projection->J_px_p;
      J_pose *= root;
      for (Eigen::Index k = 0; k < count; ++k) J_camera.col(k) = root * projection->J_px_parameters.col(free[static_cast<std::size_t>(k)]);
      equations.squared_error += r.squaredNorm();
      view.H_camera.noalias() += J_camera.transpose() * J_camera;
      view.g_camera.noalias() += J_camera.transpose() * r;
      view.H_camera_pose.noalias() += J_camera.transpose() * J_pose;
      view.H_pose.noalias() += J_pose.transpose() * J_pose;
      view.g_pose.noalias() += J_pose.transpose() * r;
    }
    equations.H_camera += view.H_camera;
    equations.g_camera += view.g_camera;
  }
  if (!std::isfinite(equations.squared_error)) return std::nullopt;
  return equations;
}

/// Diagonal that Marquardt's damping adds per unit of lambda. The floor keeps a parameter that no residual feels where it is.
Eigen::VectorXd dampingOf(const Eigen::MatrixXd& H) { return H.diagonal().cwiseMax(1e-12); }

/// Eliminates the poses: solves (H + lambda D) step = -g by the Schur complement over their 6 x 6 blocks.
Step solveDamped(const Equations& equations, double lambda) {
  const std::size_t view_count = equations.views.size();
  const Eigen::VectorXd damping = dampingOf(equations.H_camera);
  Eigen::MatrixXd S = equations.H_camera;
  S.diagonal() += lambda * damping;
  Eigen::VectorXd g = equations.g_camera;
  std::vector<Eigen::LDLT<Matrix6d>> factors(view_count);
  for (std::size_t v = 0; v < view_count; ++v) {
    const ViewEquations& view = equations.views[v];
    Matrix6d H = view.H_pose;
    H.diagonal() += lambda * dampingOf(view.H_pose);
    factors[v].compute(H);
    S.noalias() -= view.H_camera_pose * factors[v].solve(view.H_camera_pose.transpose());
    g.noalias() -= view.H_camera_pose * factors[v].solve(view.g_pose);
  }
  Step step;
  step.camera = S.size() > 0 ? Eigen::VectorXd(-S.ldlt().solve(g)) : Eigen::VectorXd();
  // The decrease of |r|^2 that the linearisation promises is -g^T step + lambda step^T D step, for a step that solves the damped system.
  step.predicted_decrease = -equations.g_camera.dot(step.camera) + lambda * step.camera.cwiseAbs2().dot(damping);
  for (std::size_t v = 0; v < view_count; ++v) {
    const ViewEquations& view = equations.views[v];
    const Vector6d pose = -factors[v].solve(view.g_pose + view.H_camera_pose.transpose() * step.camera);
    step.predicted_decrease += -view.g_pose.dot(pose) + lambda * pose.cwiseAbs2().dot(dampingOf(view.H_pose));
    step.poses.push_back(pose);
  }
  return step;
}

BoardBundle moved(const BoardBundle& from, const Step& step, const std::vector<int>& free) {
  BoardBundle to = from;
  Eigen::VectorXd parameters = from.camera.parameters();
  for (std::size_t k = 0; k < free.size(); ++k) parameters(free[k]) += step.camera(static_cast<Eigen::Index>(k));
  to.camera.setParameters(parameters);
  for (std::size_t v = 0; v < step.poses.size(); ++v) to.T_camera_target[v] = expSe3(step.poses[v]) * from.T_camera_target[v];
  return to;
}

/// The camera's information from one picture, its pose marginalised.
Eigen::MatrixXd schurComplement(const ViewEquations& view) {
  const Eigen::MatrixXd S = view.H_camera - view.H_camera_pose * view.H_pose.ldlt().solve(view.H_camera_pose.transpose());
  return 0.5 * (S + S.transpose());
}

void setInformation(const Equations& equations, BoardBundleFit& fit) {
  const Eigen::Index count = equations.H_camera.rows();
  fit.information.setZero(count, count);
  std::vector<Eigen::MatrixXd> parts;
  for (const ViewEquations& view : equations.views) {
    parts.push_back(schurComplement(view));
    fit.information += parts.back();
  }
  if (count == 0) return;
  const Eigen::LDLT<Eigen::MatrixXd> information(fit.information);
  double pulled = 0.0, expected = 0.0;
  for (std::size_t v = 0; v < parts.size(); ++v) {
    const ViewEquations& view = equations.views[v];
    const Eigen::VectorXd g = view.g_camera - view.H_camera_pose * view.H_pose.ldlt().solve(view.g_pose);
    const Eigen::MatrixXd share = information.solve(parts[v]);
    pulled += g.dot(information.solve(g));
    expected += share.trace() - share.cwiseProduct(share.transpose()).sum();
  }
  if (expected > 0.0 && std::isfinite(pulled / expected)) fit.pull = pulled / expected;
}

}  // namespace

std::optional<Eigen::Matrix2Xd> boardResiduals(const Camera& camera, const Eigen::Isometry3d& T_camera_target, const BoardView& view) {
  Eigen::Matrix2Xd residuals(2, view.points.cols());
  for (Eigen::Index i = 0; i < view.points.cols(); ++i) {
    const std::optional<Eigen::Vector2d> px = project(camera, T_camera_target * view.points.col(i));
    if (!px) return std::nullopt;
    residuals.col(i) = *px - view.pixels.col(i);
  }
  return residuals;
}

std::optional<BoardBundleFit> fitBoardBundle(const std::vector<const BoardView*>& views, const BoardBundle& start,
                                             const std::vector<int>& free, int max_iterations, const CornerWeights& weights) {
  assert(views.size() == start.T_camera_target.size());
  assert(weights.empty() || weights.size() == views.size());
  // A promised decrease below the rounding of the sum itself (its square root: 1e-6 of a residual's effect on a parameter), or below
  // the rounding of pixels where the data are exact.
  constexpr double kRelativeDecrease = 1e-14;
  constexpr double kRounding_px = 1e-12;
  constexpr double kMaxLambda = 1e12;
  double point_count = 0.0;
  for (const BoardView* view : views) point_count += static_cast<double>(view->points.cols());

  const Problem problem{views, free, weights};
  BoardBundleFit fit;
  fit.estimate = start;
  std::optional<Equations> equations = linearise(problem, start);
  if (!equations) return std::nullopt;
  double lambda = 1e-3;
  for (int iteration = 0; iteration < max_iterations && !fit.converged; ++iteration) {
    const Step step = solveDamped(*equations, lambda);
    const double negligible = kRelativeDecrease * equations->squared_error + kRounding_px * kRounding_px * point_count;
    fit.converged = step.predicted_decrease <= negligible;
    BoardBundle trial = moved(fit.estimate, step, free);
    std::optional<Equations> at_trial = linearise(problem, trial);
    if (at_trial && at_trial->squared_error <= equations->squared_error) {
      fit.estimate = std::move(trial);
      equations = std::move(at_trial);
      lambda = std::max(lambda * 0.1, 1e-12);
    } else {
      lambda *= 10.0;
      if (lambda > kMaxLambda) break;
    }
  }
  fit.squared_error = equations->squared_error;
  setInformation(*equations, fit);
  return fit;
}

}  // namespace poecal
