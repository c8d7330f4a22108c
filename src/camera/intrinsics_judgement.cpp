#include "camera/intrinsics_judgement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "camera/intrinsics_start.hpp"
#include "camera/lens_model.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

Eigen::Vector3d boardNormal(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d scatter = centred * centred.transpose();
  return scatter.jacobiSvd(Eigen::ComputeFullU).matrixU().col(2);
}

}  // namespace

Eigen::MatrixXd unitCovariance(const Eigen::MatrixXd& information) {
  constexpr double kRounding = 1e-13;  // eigenvalues of a matrix of unit diagonal that rounding alone may have made
  constexpr double kTakesPart = 1e-6;  // squared share of a parameter in a direction of unit length
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Index count = information.rows();
  Eigen::VectorXd inverse_scale(count);
  for (Eigen::Index k = 0; k < count; ++k) inverse_scale(k) = information(k, k) > 0.0 ? 1.0 / std::sqrt(information(k, k)) : 0.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(inverse_scale.asDiagonal() * information * inverse_scale.asDiagonal());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd open = Eigen::VectorXd::Zero(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd direction = eigen.eigenvectors().col(k);
    if (eigen.eigenvalues()(k) > kRounding) {
      covariance += direction * direction.transpose() / eigen.eigenvalues()(k);
    } else {
      open += direction.cwiseAbs2();
    }
  }
  covariance = inverse_scale.asDiagonal() * covariance * inverse_scale.asDiagonal();
  for (Eigen::Index k = 0; k < count; ++k) {
    if (open(k) < kTakesPart) continue;
    covariance.row(k).setConstant(nan);
    covariance.col(k).setConstant(nan);
  }
  return covariance;
}

void requireDetermined(const Camera& camera, const Eigen::MatrixXd& information, double sigma_px) {
  constexpr double kLeastSigma_px = 0.01;  // exact corners must not hide that the next noisy ones would leave the parameter open
  constexpr double kShareOfFocalLength = 0.1;
  const std::vector<std::string> names = camera.parameterNames();
  const Eigen::MatrixXd covariance = unitCovariance(information);
  for (Eigen::Index k = 0; k < 4; ++k) {
    const double deviation = std::max(sigma_px, kLeastSigma_px) * std::sqrt(covariance(k, k));
    if (deviation <= kShareOfFocalLength * camera.fx) continue;
    throw InsufficientData(fmt::format(
        "the pictures leave {} open ({}): show the board at several different tilts of 20 to 50 degrees",
        names[static_cast<std::size_t>(k)],
        std::isfinite(deviation) ? fmt::format("{:.0f} +- {:.0f} px", camera.parameters()(k), deviation) : std::string("any value fits")));
  }
}

std::vector<std::string> coefficientWarnings(const IntrinsicsFit& fit) {
  constexpr double kCorrelation = 0.99;
  std::vector<std::string> warnings;
  const Camera& camera = fit.camera;
  const std::vector<std::string> names = camera.parameterNames();
  const Eigen::VectorXd values = camera.parameters();
  if (!fit.held.empty()) {
    warnings.push_back(
        fmt::format("the pictures leave {} open: any value fits, so they are held at 0; a model with fewer coefficients is enough",
                    fmt::join(fit.held, ", ")));
  }
  std::vector<Eigen::Index> determined;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const std::string& name = names[static_cast<std::size_t>(k)];
    const double deviation = camera.standard_deviation(k);
    if (std::find(fit.held.begin(), fit.held.end(), name) != fit.held.end()) continue;
    if (k >= 4 && !(deviation <= lensModel(camera.model).coefficients[static_cast<std::size_t>(k - 4)].plausible)) {
      warnings.push_back(fmt::format("{} = {:.3g} is not determined by the pictures, though 0 does not fit", name, values(k)));
    } else {
      determined.push_back(k);
    }
  }
  for (const Eigen::Index k : determined) {
    for (const Eigen::Index j : determined) {
      if (k < 4 || j >= k) continue;
      const double product = camera.standard_deviation(k) * camera.standard_deviation(j);
      if (!(product > 0.0)) continue;  // exact corners
      const double correlation = fit.covariance(k, j) / product;
      if (std::abs(correlation) <= kCorrelation) continue;
      warnings.push_back(fmt::format("{} and {} are determined only together (correlation {:.4f})", names[static_cast<std::size_t>(j)],
                                     names[static_cast<std::size_t>(k)], correlation));
    }
  }
  return warnings;
}

std::string stretchWarning(const IntrinsicsFit& fit) {
  constexpr double kSquare = 0.02, kSurely = 5.0;  // pixels of real cameras are square to a hundredth
  const double fx = fit.camera.fx, fy = fit.camera.fy;
  const Eigen::Vector2d slope(-1.0 / fx, 1.0 / fy);  // of log(fy / fx)
  const double sigma = std::sqrt(std::max(0.0, slope.dot(fit.covariance.topLeftCorner<2, 2>() * slope)));
  const double stretch = std::log(fy / fx);
  if (!(std::abs(stretch) > std::max(kSquare, kSurely * sigma))) return "";
  return fmt::format("fy is {:.3f} of fx, expected square pixels: were the pictures stretched, or are the board's squares not square?",
                     fy / fx);
}

ProjectionUncertainty projectionUncertainty(const Camera& camera, const Eigen::MatrixXd& covariance) {
  constexpr int kColumns = 12, kRows = 9;
  std::vector<Eigen::Matrix<double, 2, Eigen::Dynamic>> by_parameters;
  std::vector<Eigen::Matrix<double, 2, 3>> by_rotation;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const Eigen::Vector2d px((column + 0.5) / kColumns * camera.width - 0.5, (row + 0.5) / kRows * camera.height - 0.5);
      const std::optional<Eigen::Vector3d> ray = unproject(camera, px);
      const std::optional<Projection> projection = ray ? projectWithJacobians(camera, *ray) : std::nullopt;
      if (!projection) continue;  // the lens sees nothing there
      by_parameters.emplace_back(projection->J_px_parameters);
      by_rotation.emplace_back(-projection->J_px_p * hat(*ray));
    }
  }
  if (by_parameters.empty()) return {};
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, Eigen::Dynamic> g = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, covariance.rows());
  for (std::size_t k = 0; k < by_rotation.size(); ++k) {
    H += by_rotation[k].transpose() * by_rotation[k];
    g += by_rotation[k].transpose() * by_parameters[k];
  }
  const Eigen::Matrix<double, 3, Eigen::Dynamic> taken_back = H.ldlt().solve(g);
  std::vector<double> sigmas;
  for (std::size_t k = 0; k < by_rotation.size(); ++k) {
    const Eigen::Matrix<double, 2, Eigen::Dynamic> J = by_parameters[k] - by_rotation[k] * taken_back;
    const Eigen::Matrix2d of_pixel = J * covariance * J.transpose();
    const double half_trace = 0.5 * of_pixel.trace(), half_gap = 0.5 * (of_pixel(0, 0) - of_pixel(1, 1));
    sigmas.push_back(std::sqrt(std::max(0.0, half_trace + std::hypot(half_gap, of_pixel(0, 1)))));
  }
  return {median(sigmas), *std::max_element(sigmas.begin(), sigmas.end())};
}

double tiltSpread(const std::vector<const BoardView*>& views, const std::vector<Eigen::Isometry3d>& T_camera_target) {
  std::vector<Eigen::Vector3d> normals;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (!flat(views[v]->points)) return M_PI_2;
    normals.push_back(T_camera_target[v].linear() * boardNormal(views[v]->points));
  }
  double spread = 0.0;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    for (std::size_t w = 0; w < v; ++w) spread = std::max(spread, std::acos(std::min(1.0, std::abs(normals[v].dot(normals[w])))));
  }
  return spread;
}

}  // namespace poecal
