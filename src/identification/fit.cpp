#include "identification/fit.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "identification/gao.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

std::vector<Observation> selected(const std::vector<Observation>& all, const std::vector<std::size_t>& subset) {
  std::vector<Observation> some;
  some.reserve(subset.size());
  for (const std::size_t k : subset) some.push_back(all[k]);
  return some;
}

MethodFit fitGao(const Cell& registered, const std::vector<Observation>& flange, double length_unit) {
  std::vector<Eigen::VectorXd> q;
  std::vector<Eigen::Isometry3d> poses;
  for (const Observation& observation : flange) {
    if (observation.pose->position_only) throw InvalidArgument("gao needs whole poses; positions alone go with weighted or bundle");
    if (observation.pose->whitening.isZero(0.0)) continue;  // its corners gave no pose
    q.push_back(observation.q);
    poses.push_back(observation.pose->T_camera_target);
  }
  const GaoResult result = gao(*registered.arm, q, poses, {.length_unit = length_unit});
  MethodFit fit;
  fit.cell = registered;
  fit.cell.arm = result.arm;
  fit.free = {.twists = true, .gamma = true};
  fit.gao_residuals = result.residuals;
  fit.converged = result.converged;
  fit.covariance = result.covariance;
  fit.parameter_names = twistParameterNames(result.arm);
  const int twists = static_cast<int>(fit.parameter_names.size());
  for (const char* name :
       {"Gamma rotation x", "Gamma rotation y", "Gamma rotation z", "Gamma translation x", "Gamma translation y", "Gamma translation z"}) {
    fit.parameter_names.emplace_back(name);
  }
  fit.twist_deviation = twistDeviations(result.arm, Eigen::VectorXd::Zero(twists), result.arm, result.covariance);
  fit.gamma_deviation = result.covariance.diagonal().tail<6>().cwiseSqrt();
  fit.adjustment.rank = result.rank;
  fit.adjustment.condition_number = result.condition_number;
  return fit;
}

}  // namespace

std::vector<Vector6d> twistDeviations(const Arm& nominal, const Eigen::VectorXd& beta, const Arm& arm, const Eigen::MatrixXd& covariance) {
  std::vector<Vector6d> deviations;
  int column = 0;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    const Matrix6Xd B = twistBasis(nominal.joints[k]);
    const auto count = B.cols();
    const Vector6d eta = B * beta.segment(column, count);
    const Matrix6Xd D = -adjointOfTwist(arm.joints[k].xi) * leftJacobianSe3(eta) * B;
    const Matrix6d Sigma = D * covariance.block(column, column, count, count) * D.transpose();
    deviations.push_back(Sigma.diagonal().cwiseMax(0.0).cwiseSqrt());
    column += static_cast<int>(count);
  }
  return deviations;
}

bool statesDeviations(const Camera& camera) {
  return camera.standard_deviation.size() >= 4 && camera.standard_deviation.head<4>().allFinite();
}

Eigen::VectorXd cameraPrior(const Camera& camera) {
  if (statesDeviations(camera)) return camera.standard_deviation;
  const std::vector<std::string> names = camera.parameterNames();
  Eigen::VectorXd sigma(camera.parameterCount());
  sigma << 0.03 * camera.fx, 0.03 * camera.fy, 0.03 * camera.width, 0.03 * camera.width,
      Eigen::VectorXd::Constant(camera.distortion.size(), 0.5);
  for (std::size_t k = 4; k < names.size(); ++k) {
    if (names[k].starts_with('p')) sigma(static_cast<Eigen::Index>(k)) = 0.02;
  }
  return sigma;
}

FlangePoses flangePoses(const Cell& registered, const std::vector<Observation>& observations,
                        const std::vector<RegisteredSample>* samples) {
  FlangePoses flange;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    Observation measured;
    measured.sample = observations[k].sample;
    measured.q = observations[k].q;
    PoseMeasurement pose;
    if (samples != nullptr) {
      const RegisteredSample& sample = (*samples)[k];
      if (sample.has_pose) {
        pose.T_camera_target = sample.T_base_flange;
        pose.whitening = sample.covariance.llt().matrixL().solve(Matrix6d::Identity());
      } else {
        pose.whitening.setZero();  // no pose, no say
      }
    } else {
      // e in the instrument's axes about the tool -> e in base about the flange.
      const PoseMeasurement& given = *observations[k].pose;
      if (given.position_only) throw InvalidArgument("weighted and gao need whole poses; positions alone go with bundle");
      const Eigen::Isometry3d T_base_flange = registered.registration.baseFlange(given.T_camera_target);
      const Eigen::Matrix3d R_camera_base = registered.registration.cameraBase(T_base_flange).linear();
      const Eigen::Vector3d lever = R_camera_base * T_base_flange.translation() -
                                    (given.T_camera_target.translation() - registered.registration.cameraBase(T_base_flange).translation());
      // p_tool = p_flange - lever, so that e_tool = [R 0; hat(lever) R, R] e_flange to first order.
      Matrix6d D = Matrix6d::Zero();
      D.topLeftCorner<3, 3>() = R_camera_base;
      D.bottomRightCorner<3, 3>() = R_camera_base;
      D.bottomLeftCorner<3, 3>() = hat(lever) * R_camera_base;
      pose.T_camera_target = T_base_flange;
      pose.whitening = given.whitening * D;
    }
    measured.pose = pose;
    flange.observations.push_back(std::move(measured));
  }
  return flange;
}

ArmBelief armBelief(const Cell& nominal, const IdentifyOptions& options) {
  if (options.tolerance_position <= 0.0 && options.tolerance_rotation <= 0.0) return {};
  constexpr double kAnywhere = 1.0;  // [m], [rad]
  const Registration& registration = nominal.registration;
  const std::optional<KnownTransform>& base = registration.setup == Setup::kEyeToHand ? registration.known_near : registration.known_far;
  const bool known = base && base->sigma.array().isFinite().any();
  const bool held = options.registered || options.method != Method::kBundle;
  return {TwistPrior(*nominal.arm, options.tolerance_position > 0.0 ? options.tolerance_position : kAnywhere,
                     options.tolerance_rotation > 0.0 ? options.tolerance_rotation : kAnywhere, known || held)};
}

MethodFit fitMethod(const Cell& registered, const std::vector<Observation>& observations, const FlangePoses& flange,
                    const std::vector<std::size_t>& subset, const IdentifyOptions& options, const ArmBelief& belief, bool camera_free) {
  if (options.method == Method::kGao) return fitGao(registered, selected(flange.observations, subset), options.gao_length_unit);
  MethodFit fit;
  AdjustmentOptions adjustment;
  adjustment.twists = belief.twists;
  adjustment.tolerance = belief.tolerance;
  adjustment.robust = options.robust;
  adjustment.far_position = kFarPosition;
  const bool flange_poses = options.method == Method::kWeighted;
  fit.start = registered;
  if (flange_poses) {
    fit.start.camera.reset();
    fit.start.registration = Registration{};
  }
  const bool transforms_held = flange_poses || options.registered;
  adjustment.free = {.twists = true,
                     .gamma = transforms_held,
                     .near = !transforms_held,
                     .far = !transforms_held,
                     .intrinsics = camera_free && !flange_poses};
  if (adjustment.free.intrinsics) adjustment.camera_prior_sigma = cameraPrior(*registered.camera);
  fit.free = adjustment.free;
  fit.adjustment = adjust(fit.start, selected(flange_poses ? flange.observations : observations, subset), adjustment);
  fit.cell = registered;
  fit.cell.arm = fit.adjustment.cell.arm;
  if (!flange_poses) {
    fit.cell.registration = fit.adjustment.cell.registration;
    fit.cell.camera = fit.adjustment.cell.camera;
  }
  fit.converged = fit.adjustment.status == AdjustmentStatus::kConverged;
  fit.covariance = fit.adjustment.covariance;
  fit.parameter_names = fit.adjustment.names;
  fit.twist_deviation = twistDeviations(*registered.arm, fit.adjustment.beta, *fit.cell.arm, fit.covariance);
  const auto twists = fit.adjustment.beta.size();
  if (fit.free.gamma) fit.gamma_deviation = fit.covariance.diagonal().segment<6>(twists).cwiseSqrt();
  return fit;
}

}  // namespace poecal
