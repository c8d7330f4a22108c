#include "poecal/identification/paper_experiment.hpp"

#include <cmath>

#include "poecal/core/random.hpp"
#include "poecal/core/statistics.hpp"

namespace poecal {
namespace {

enum Stream : std::uint64_t { kPoses, kTestPoses };

Eigen::VectorXd randomJoints(Rng& rng, int count) {
  Eigen::VectorXd q(count);
  for (double& value : q) value = rng.uniform(-M_PI, M_PI);
  return q;
}

Eigen::Vector3d uniformNoise(Rng& rng, double half_width) {
  Eigen::Vector3d noise;
  for (double& value : noise) value = rng.uniform(-half_width, half_width);
  return noise;
}

FlangeError flangeError(const Arm& arm, const Arm& actual, const Eigen::VectorXd& q) {
  const Vector6d e = poseDifference(forwardKinematics(actual, q), forwardKinematics(arm, q));
  return {e.tail<3>().norm(), e.head<3>().norm()};
}

std::vector<FlangeError> flangeErrors(const Arm& arm, const Arm& actual, const std::vector<Eigen::VectorXd>& joints) {
  std::vector<FlangeError> errors;
  for (const Eigen::VectorXd& q : joints) errors.push_back(flangeError(arm, actual, q));
  return errors;
}

FlangeError medianError(const std::vector<FlangeError>& errors) {
  std::vector<double> positions, rotations;
  for (const FlangeError& error : errors) {
    positions.push_back(error.position);
    rotations.push_back(error.rotation);
  }
  return {median(std::move(positions)), median(std::move(rotations))};
}

PaperFit fitPaper(const Arm& nominal, const Arm& actual, const PoseTable& table, Method method, const std::vector<Eigen::VectorXd>& test) {
  IdentifyOptions options;
  options.method = method;
  options.registered = true;
  options.hold_out_every = 0;  // the test poses judge
  options.tolerance_position = 0.0;
  options.tolerance_rotation = 0.0;
  options.gao_length_unit = 1e-3;  // the paper's millimetres
  Cell cell;
  cell.arm = nominal;
  Measurements measurements;
  for (const MeasuredPose& pose : table.poses) measurements.addPose(pose.sample, pose.T_instrument_tool, 1e-3, 1e-3);
  measurements.sigmas_stated = false;
  const Identification identification = identify(cell, measurements, options);
  PaperFit fit;
  fit.arm = *identification.model.cell.arm;
  fit.residuals = identification.gao_residuals;
  fit.test_poses = flangeErrors(fit.arm, actual, test);
  fit.error = medianError(fit.test_poses);
  return fit;
}

}  // namespace

PoseTable paperPoses(const Arm& actual, const PaperOptions& options, std::uint64_t seed) {
  Rng rng(seed, kPoses);
  PoseTable table;
  for (int k = 0; k < options.poses; ++k) {
    MeasuredPose pose;
    pose.sample.q = randomJoints(rng, actual.jointCount());
    pose.T_instrument_tool = forwardKinematics(actual, pose.sample.q);
    pose.T_instrument_tool.translation() += uniformNoise(rng, options.noise_position);
    pose.T_instrument_tool.linear() = expSo3(uniformNoise(rng, options.noise_rotation)) * pose.T_instrument_tool.linear();
    table.poses.push_back(std::move(pose));
  }
  return table;
}

std::vector<PaperSeed> paperExperiment(const Arm& nominal, const Arm& actual, const PaperOptions& options) {
  std::vector<PaperSeed> seeds;
  for (int k = 1; k <= options.seeds; ++k) {
    const auto seed = static_cast<std::uint64_t>(k);
    Rng rng(seed, kTestPoses);
    std::vector<Eigen::VectorXd> test;
    for (int i = 0; i < options.test_poses; ++i) test.push_back(randomJoints(rng, actual.jointCount()));
    const PoseTable table = paperPoses(actual, options, seed);
    PaperSeed result;
    result.nominal_test_poses = flangeErrors(nominal, actual, test);
    result.nominal = medianError(result.nominal_test_poses);
    result.gao = fitPaper(nominal, actual, table, Method::kGao, test);
    result.weighted = fitPaper(nominal, actual, table, Method::kWeighted, test);
    seeds.push_back(std::move(result));
  }
  return seeds;
}

}  // namespace poecal
