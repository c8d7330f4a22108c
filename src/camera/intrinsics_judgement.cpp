#include "camera/intrinsics_judgement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <fmt/format.h>

#include "camera/intrinsics_start.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

/// Beyond what a real lens has: a coefficient known no better than this is not known. Radial terms are of the order of 1 (those of the
/// rational model of 10), tangential ones of 0.01.
double plausibleSize(DistortionModel model, const std::string& coefficient) {
  if (coefficient[0] == 'p') return 0.1;
  return model == DistortionModel::kRationalPolynomial ? 10.0 : 1.0;
}

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
  const auto name = [&names](Eigen::Index k) -> const std::string& { return names[static_cast<std::size_t>(k)]; };
  std::vector<Eigen::Index> determined;
  for (Eigen::Index k = 4; k < values.size(); ++k) {
    const double deviation = camera.standard_deviation(k);
    if (std::isnan(deviation)) {
      warnings.push_back(fmt::format("the pictures leave {} open: any value fits; a model with fewer coefficients is enough", name(k)));
    } else if (deviation > plausibleSize(camera.model, name(k))) {
      warnings.push_back(fmt::format("{} = {:.3g} +- {:.3g} is not determined by the pictures", name(k), values(k), deviation));
    } else {
      determined.push_back(k);
    }
  }
  for (const Eigen::Index k : determined) {
    for (Eigen::Index j = 0; j < k; ++j) {
      if (j >= 4 && std::find(determined.begin(), determined.end(), j) == determined.end()) continue;
      const double product = camera.standard_deviation(k) * camera.standard_deviation(j);
      if (!(product > 0.0)) continue;  // exact corners
      const double correlation = fit.covariance(k, j) / product;
      if (std::abs(correlation) <= kCorrelation) continue;
      warnings.push_back(fmt::format("{} and {} are determined only together (correlation {:.4f})", name(j), name(k), correlation));
    }
  }
  return warnings;
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
