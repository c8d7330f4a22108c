#include "planning/knowledge.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include "cell/sight.hpp"
#include "diagnosis/noise.hpp"
#include "identification/fit.hpp"
#include "poecal/capture/row_order.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

/// Beside the data nothing is believed of where camera and target are; this keeps few poses from leaving them open.
constexpr double kAnywhere = 1.0;  // [m], [rad]
/// Sizes of effects are as wide as a fit has them: nothing is drawn to zero.
constexpr double kWide = 10.0;

/// The nominal arm, moved to the model's by beta; gamma is the model's.
CellState stateOf(const PlanningCell& cell, const MeasuredCell& measured) {
  CellState state(measured.start, measured.free);
  state.cell = cell.model.cell;
  state.cell.arm->links = cell.nominal.arm->links;
  state.beta = twistDisplacement(*cell.nominal.arm, *cell.model.cell.arm);
  state.reference->gamma = cell.model.cell.arm->gamma;
  return state;
}

/// The corners that were taken, their deviations as the noise has them.
void addTaken(const PlanningCell& cell, MeasuredCell& measured) {
  std::vector<double> stated;
  for (const Observation& observation : cell.taken.observations) {
    for (const CornerMeasurement& corner : observation.corners) stated.push_back(corner.sigma_px);
  }
  if (stated.empty()) return;
  const double factor = cell.noise.corner / median(stated);
  measured.observations = cell.taken.observations;
  std::vector<Sample> samples = cell.taken.samples;
  standInByRowOrder(samples);
  for (Observation& observation : measured.observations) {
    measured.samples.push_back(samples[observation.sample]);
    for (CornerMeasurement& corner : observation.corners) corner.sigma_px *= factor;
  }
  measured.groups = cell.taken.poseGroups();
}

MeasuredCell measuredCell(const PlanningCell& cell) {
  MeasuredCell measured;
  measured.start = cell.nominal;
  measured.start.registration = cell.model.cell.registration;
  measured.start.arm->gamma = cell.model.cell.arm->gamma;
  measured.free = {.twists = true, .gamma = false, .near = true, .far = true, .intrinsics = statesDeviations(*cell.nominal.camera)};
  if (measured.free.intrinsics) measured.camera_sigma = cell.nominal.camera->standard_deviation;
  measured.target = cell.target;
  measured.gravity = cell.taken.gravity;
  measured.other_columns = cell.taken.other_columns;
  measured.twists =
      armBelief(measured.start, {.tolerance_position = cell.tolerance_position, .tolerance_rotation = cell.tolerance_rotation}).twists;
  if (measured.twists.empty()) measured.twists = TwistPrior(*cell.nominal.arm, kAnywhere, kAnywhere);
  addTaken(cell, measured);
  return measured;
}

}  // namespace

WhiteRows condensed(WhiteRows rows) {
  if (rows.rows() <= rows.cols()) return rows;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows);
  rows = qr.matrixQR().topRows(rows.cols()).triangularView<Eigen::Upper>();
  return rows;
}

Candidate modelCandidate(const AppliedEffect& applied) {
  Candidate candidate;
  candidate.effect = applied.effect;
  candidate.name = applied.effect.name();
  candidate.place = applied.effect.place();
  candidate.driver = applied.effect.driver();
  candidate.parameters = applied.parameters;
  std::vector<double> typical;
  const std::vector<EffectParameter>& parameters = applied.effect.parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].role != ParameterRole::kLinear) continue;
    candidate.linear.push_back(static_cast<Eigen::Index>(i));
    typical.push_back(std::max(parameters[i].typical, std::abs(applied.parameters(static_cast<Eigen::Index>(i)))));
    if (!(typical.back() > 0.0)) typical.back() = kAnywhere;
  }
  candidate.typical = Eigen::Map<Eigen::VectorXd>(typical.data(), static_cast<Eigen::Index>(typical.size()));
  return candidate;
}

Knowledge::Knowledge(const PlanningCell& cell, const std::vector<AppliedEffect>& effects, std::vector<FurtherColumns> further)
    : base_(measuredCell(cell)),
      state_{stateOf(cell, base_), {}},
      noise_(cell.noise),
      beyond_(cell.arm_beyond_tolerance),
      rough_position_(cell.rough_position > 0.0 ? cell.rough_position : kAnywhere),
      rough_rotation_(cell.rough_rotation > 0.0 ? cell.rough_rotation : kAnywhere) {
  for (const AppliedEffect& applied : effects) {
    if (applied.effect.kind().add_derivative == nullptr) continue;  // random: no prediction knows them
    state_.effects.push_back(applied);
    const Candidate candidate = modelCandidate(applied);
    further_.push_back({candidate, kWide * candidate.typical});
  }
  std::move(further.begin(), further.end(), std::back_inserter(further_));
}

Eigen::Index Knowledge::columns() const {
  Eigen::Index count = ParameterLayout(state_.cell.cell, base_.free).total;
  for (const FurtherColumns& further : further_) count += further.sigma.size();
  return count;
}

ColumnPrior Knowledge::prior() const {
  ColumnPrior prior = basePrior(base_, state_, beyond_);
  const ParameterLayout layout(state_.cell.cell, base_.free);
  Vector6d rough;
  rough << Eigen::Vector3d::Constant(rough_rotation_), Eigen::Vector3d::Constant(rough_position_);
  for (const int begin : {layout.near, layout.far}) prior.precision.diagonal().segment<6>(begin) += rough.cwiseAbs2().cwiseInverse();
  for (const FurtherColumns& further : further_) {
    prior = prior.joinedWith(ColumnPrior::independent(further.sigma, Eigen::VectorXd::Zero(further.sigma.size())));
  }
  return prior;
}

Eigen::MatrixXd Knowledge::columnsOfAll(const CaptureRows& rows) const {
  Eigen::MatrixXd all(rows.size(), columns());
  all.leftCols(rows.J.cols()) = rows.J;
  Eigen::Index column = rows.J.cols();
  for (const FurtherColumns& further : further_) {
    const Eigen::MatrixXd own = columnsOf(further.candidate, rows);
    // What a sample lacks, it cannot tell of.
    all.middleCols(column, own.cols()) = own.unaryExpr([](double x) { return std::isfinite(x) ? x : 0.0; });
    column += own.cols();
  }
  return all;
}

std::vector<WhiteRows> Knowledge::rows(const MeasuredCell& cell) const {
  if (cell.observations.empty()) return {};
  const CaptureRows rows = captureRows(cell, state_, {});
  const std::vector<NoiseComponent> components = noiseComponents(cell, rows);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(components.size()));
  for (std::size_t i = 0; i < components.size(); ++i) {
    const std::string& name = components[i].name;
    const double sigma = name == "corner" ? 1.0 : name == "tag" ? noise_.tag : noise_.repeatability;  // corners state theirs
    theta(static_cast<Eigen::Index>(i)) = sigma * sigma;
  }
  const Whitening whitening(rows, components, theta);
  const Eigen::MatrixXd X = columnsOfAll(rows);
  std::vector<WhiteRows> all;
  for (std::size_t g = 0; g < whitening.poses(); ++g) {
    Eigen::MatrixXd Xr(whitening.size(g), X.cols() + 1);
    Xr << X.middleRows(whitening.begin(g), whitening.size(g)), rows.r.segment(whitening.begin(g), whitening.size(g));
    all.push_back(whitening.applyTo(g, Xr));
  }
  return all;
}

std::vector<WhiteRows> Knowledge::taken() const { return rows(base_); }

std::vector<WhiteRows> Knowledge::expected(const std::vector<Sample>& samples) const {
  MeasuredCell cell = base_;
  cell.samples = samples;
  cell.observations.clear();
  cell.groups.clear();
  const Cell& model = state_.cell.cell;
  const std::vector<Disturbance> disturbances =
      disturbancesOf(state_.effects, model, cell.target, cell.gravity, samples, false, cell.other_columns);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    Observation observation;
    observation.sample = k;
    observation.q = samples[k].q;
    const auto px = disturbedCorners(model, samples[k], cell.target.points, disturbances[k]);
    for (const FaceSight& sight :
         sightOf(disturbedCamera(model, disturbances[k]), cell.target, disturbedTarget(model, samples[k], disturbances[k]))) {
      if (!sight.complete || !sight.readable() || !inPicture(*model.camera, sight.corners, 0.0)) continue;
      for (const Corner& corner : sight.corners) {
        const TargetPoint* point = cell.target.find(corner.id);
        const auto index = static_cast<std::size_t>(point - cell.target.points.data());
        if (px[index]) observation.corners.push_back({corner.id, point->p_target, *px[index], noise_.corner});
      }
    }
    cell.groups.push_back({k});
    cell.observations.push_back(std::move(observation));
  }
  return rows(cell);
}

std::vector<Eigen::MatrixXd> Knowledge::tool(const std::vector<Sample>& samples) const {
  MeasuredCell cell = base_;
  cell.samples = samples;
  cell.observations.clear();
  cell.groups.clear();
  for (std::size_t k = 0; k < samples.size(); ++k) {
    Observation observation;
    observation.sample = k;
    observation.q = samples[k].q;
    observation.pose.emplace().T_camera_target = cameraTarget(samples[k]);
    cell.groups.push_back({k});
    cell.observations.push_back(std::move(observation));
  }
  const CaptureRows rows = captureRows(cell, state_, {});
  const Eigen::MatrixXd X = columnsOfAll(rows);
  std::vector<Eigen::MatrixXd> tools;
  for (const ObservationRows& part : rows.observations) {
    Eigen::MatrixXd moves = X.middleRows(part.begin, part.size);
    if (state_.cell.cell.registration.setup == Setup::kEyeInHand) {
      // Of the camera before the target, which turns and moves the other way round: a left perturbation (w; v) of T_camera_target moves
      // the camera's origin by -v in the target's axes.
      moves.bottomRows<3>() += hat(part.ports.T_camera_target.translation()) * moves.topRows<3>();
    }
    tools.push_back(std::move(moves));
  }
  return tools;
}

Eigen::Isometry3d Knowledge::cameraTarget(const Sample& sample) const {
  const Cell& model = state_.cell.cell;
  const std::vector<Disturbance> disturbance =
      disturbancesOf(state_.effects, model, base_.target, base_.gravity, {sample}, false, base_.other_columns);
  return disturbedTarget(model, sample, disturbance.front());
}

Sample sampleToCome(const PlanningCell& cell, const Eigen::VectorXd& q) {
  constexpr double kSecondsBetweenRows = 10.0;
  Sample sample;
  std::vector<Sample> taken = cell.taken.samples;
  standInByRowOrder(taken);
  if (!taken.empty()) sample = taken.back();
  sample.image.clear();
  sample.pose.reset();
  sample.T_base_flange.reset();
  if (sample.stamp) *sample.stamp += kSecondsBetweenRows;
  sample.q = q;
  sample.dir = Eigen::VectorXd::Ones(q.size());
  if (sample.dq.size() > 0) sample.dq.setZero();
  return sample;
}

}  // namespace poecal
