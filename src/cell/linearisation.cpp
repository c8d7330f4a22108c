#include "cell/linearisation.hpp"

#include <limits>

#include <fmt/format.h>

#include "cell/transform_names.hpp"
#include "poecal/core/error.hpp"

namespace poecal {

ParameterLayout::ParameterLayout(const Cell& cell, const FreeParameters& free) {
  if ((free.twists || free.gamma) && !cell.arm) throw InvalidArgument("the arm cannot be adjusted where only flange poses are known");
  if (free.intrinsics && !cell.camera) throw InvalidArgument("intrinsics cannot be adjusted without a camera");
  const auto block = [this](int size) {
    const int begin = total;
    total += size;
    return begin;
  };
  if (free.twists) twists = twistParameterCount(*cell.arm);
  block(twists);
  if (free.gamma) gamma = block(6);
  if (free.near) near = block(6);
  if (free.far) far = block(6);
  pose_parameters = total;
  if (free.intrinsics) intrinsics = block(cell.camera->parameterCount());
}

std::vector<std::string> parameterNames(const Cell& cell, const FreeParameters& free) {
  std::vector<std::string> names;
  const auto pose = [&names](const std::string& what) {
    for (const char* part : {"rotation", "translation"}) {
      for (const char axis : {'x', 'y', 'z'}) names.push_back(fmt::format("{} {} {}", what, part, axis));
    }
  };
  if (free.twists) names = twistParameterNames(*cell.arm);
  if (free.gamma) pose("Gamma");
  if (free.near) pose(nearName(cell.registration));
  if (free.far) pose(farName(cell.registration));
  if (free.intrinsics) {
    for (const std::string& name : cell.camera->parameterNames()) names.push_back(name);
  }
  return names;
}

CellState::CellState(const Cell& nominal, const FreeParameters& free) : cell(nominal), reference(nominal.arm) {
  if (free.twists && nominal.arm) beta = Eigen::VectorXd::Zero(twistParameterCount(*nominal.arm));
}

CellState CellState::moved(const ParameterLayout& layout, const Eigen::VectorXd& step) const {
  CellState next = *this;
  if (layout.gamma >= 0) next.reference->gamma = logSe3(expSe3(step.segment<6>(layout.gamma)) * expSe3(reference->gamma));
  if (layout.twists > 0) next.beta += step.head(layout.twists);
  if (layout.gamma >= 0 || layout.twists > 0) {
    next.cell.arm = next.beta.size() > 0 ? displaceTwists(*next.reference, next.beta) : *next.reference;
  }
  Registration& registration = next.cell.registration;
  if (layout.near >= 0) registration.T_camera_near = expSe3(step.segment<6>(layout.near)) * registration.T_camera_near;
  if (layout.far >= 0) registration.T_far_target = expSe3(step.segment<6>(layout.far)) * registration.T_far_target;
  if (layout.intrinsics >= 0) {
    Camera& camera = *next.cell.camera;
    camera.setParameters(camera.parameters() + step.tail(camera.parameterCount()));
  }
  return next;
}

Eigen::VectorXd priorSigma(const ParameterLayout& layout, const AdjustmentOptions& options, const Cell& start) {
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(layout.total, std::numeric_limits<double>::infinity());
  if (layout.far >= 0 && options.far_position > 0.0) sigma.segment<3>(layout.far + 3).setConstant(options.far_position);
  const Registration& registration = start.registration;
  if (layout.near >= 0 && registration.known_near) sigma.segment<6>(layout.near) = registration.known_near->sigma;
  if (layout.far >= 0 && registration.known_far) sigma.segment<6>(layout.far) = registration.known_far->sigma;
  if (layout.intrinsics >= 0) {
    for (int k = 0; k < options.camera_prior_sigma.size(); ++k) {
      if (options.camera_prior_sigma(k) > 0.0) sigma(layout.intrinsics + k) = options.camera_prior_sigma(k);
    }
  }
  return sigma;
}

Eigen::VectorXd priorDeviation(const CellState& state, const ParameterLayout& layout, const Cell& start) {
  Eigen::VectorXd deviation = Eigen::VectorXd::Zero(layout.total);
  deviation.head(layout.twists) = state.beta.head(layout.twists);
  const Registration& now = state.cell.registration;
  const Registration& before = start.registration;
  if (layout.near >= 0 && before.known_near) deviation.segment<6>(layout.near) = logSe3(now.T_camera_near * before.known_near->T.inverse());
  if (layout.far >= 0) {
    if (before.known_far) {
      deviation.segment<6>(layout.far) = logSe3(now.T_far_target * before.known_far->T.inverse());
    } else {
      deviation.segment<3>(layout.far + 3) = farMotion(state.cell, start);
    }
  }
  if (layout.intrinsics >= 0) {
    const Eigen::VectorXd stated = start.camera->parameters();
    deviation.tail(stated.size()) = state.cell.camera->parameters() - stated;
  }
  return deviation;
}

Eigen::Isometry3d modelFlange(const Cell& cell, const Observation& observation) {
  if (cell.arm) return forwardKinematics(*cell.arm, observation.q);
  if (!observation.T_base_flange) throw InvalidArgument("an observation without joints needs the controller's flange pose");
  return *observation.T_base_flange;
}

Eigen::Isometry3d modelTarget(const Cell& cell, const Observation& observation) {
  return cell.registration.cameraTarget(modelFlange(cell, observation));
}

namespace {

void evaluateCorner(const Camera& camera, const CornerMeasurement& corner, const Eigen::Isometry3d& T_camera_target, int unit,
                    bool intrinsics, SampleRows& rows) {
  const Eigen::Vector3d p_camera = T_camera_target * corner.p_target;
  const std::optional<Projection> projection = projectWithJacobians(camera, p_camera);
  rows.valid[static_cast<std::size_t>(unit)] = projection.has_value();
  const int row = 2 * unit;
  if (!projection) {
    rows.r.segment<2>(row).setZero();
    rows.H.middleRows<2>(row).setZero();
    if (intrinsics) rows.K.middleRows<2>(row).setZero();
    return;
  }
  const double weight = 1.0 / corner.sigma_px;
  rows.r.segment<2>(row) = weight * (corner.px - projection->px);
  rows.H.block<2, 3>(row, 0) = -weight * projection->J_px_p * hat(p_camera);
  rows.H.block<2, 3>(row, 3) = weight * projection->J_px_p;
  if (intrinsics) rows.K.middleRows<2>(row) = weight * projection->J_px_parameters;
}

void evaluatePoseUnit(const PoseMeasurement& pose, const Eigen::Isometry3d& T_camera_target, SampleRows& rows) {
  const Vector6d e = poseDifference(pose.T_camera_target, T_camera_target);
  Matrix6d D = Matrix6d::Zero();
  D.topLeftCorner<3, 3>() = leftJacobianInverseSo3(-e.head<3>());
  D.bottomLeftCorner<3, 3>() = -hat(T_camera_target.translation());
  D.bottomRightCorner<3, 3>().setIdentity();
  const int skipped = pose.position_only ? 3 : 0;
  rows.r = (pose.whitening * e).tail(6 - skipped);
  rows.H = (pose.whitening * D).bottomRows(6 - skipped);
  rows.valid[0] = !pose.whitening.isZero(0.0);  // a pose of no weight is none
}

}  // namespace

void evaluateRows(const Cell& cell, const Observation& observation, const Eigen::Isometry3d& T_camera_target, bool intrinsics,
                  SampleRows& rows) {
  const int units = observation.unitCount();
  rows.unit_size = observation.unitSize();
  rows.valid.assign(static_cast<std::size_t>(units), false);
  rows.r.resize(units * rows.unit_size);
  rows.H.resize(units * rows.unit_size, 6);
  rows.K.resize(units * rows.unit_size, intrinsics ? cell.camera->parameterCount() : 0);
  if (observation.pose) {
    evaluatePoseUnit(*observation.pose, T_camera_target, rows);
    rows.K.setZero();
    return;
  }
  if (!cell.camera) throw InvalidArgument("corners need a camera");
  for (int unit = 0; unit < units; ++unit) {
    evaluateCorner(*cell.camera, observation.corners[static_cast<std::size_t>(unit)], T_camera_target, unit, intrinsics, rows);
  }
}

PoseDerivative evaluatePose(const CellState& state, const ParameterLayout& layout, const Observation& observation) {
  if (state.cell.arm) return evaluatePose(state, layout, observation, forwardChain(*state.cell.arm, observation.q));
  return evaluatePose(state, layout, observation, ArmChain{.P = {}, .T_base_flange = modelFlange(state.cell, observation)});
}

PoseDerivative evaluatePose(const CellState& state, const ParameterLayout& layout, const Observation& observation, const ArmChain& chain) {
  return evaluatePose(state, layout, state.cell.registration, chain, observation.q);
}

PoseDerivative evaluatePose(const CellState& state, const ParameterLayout& layout, const Registration& registration, const ArmChain& chain,
                            const Eigen::VectorXd& q) {
  PoseDerivative derivative;
  derivative.M.resize(6, layout.pose_parameters);
  derivative.T_camera_target = registration.cameraTarget(chain.T_base_flange);
  // A left perturbation of T_base_flange in base is one of T_camera_target in camera: by Ad(T_camera_base), and turned round in hand,
  // where the arm enters as its inverse.
  const double sign = registration.setup == Setup::kEyeToHand ? 1.0 : -1.0;
  const Eigen::Isometry3d T_camera_base = registration.cameraBase(chain.T_base_flange);
  if (layout.twists > 0 || layout.gamma >= 0) {
    const Matrix6d A = sign * adjoint(T_camera_base);
    if (layout.twists > 0) {
      derivative.M.leftCols(layout.twists).noalias() = A * twistJacobian(*state.reference, state.beta, *state.cell.arm, chain, q);
    }
    if (layout.gamma >= 0) derivative.M.middleCols<6>(layout.gamma).noalias() = A * adjoint(chain.P.back());
  }
  if (layout.near >= 0) derivative.M.middleCols<6>(layout.near).setIdentity();
  if (layout.far >= 0) {
    // What disturbs the far frame stands before its transform.
    const Eigen::Isometry3d T_camera_far = derivative.T_camera_target * state.cell.registration.T_far_target.inverse();
    derivative.M.middleCols<6>(layout.far) = adjoint(T_camera_far);
  }
  return derivative;
}

}  // namespace poecal
