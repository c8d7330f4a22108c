#include "withheld/recording.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <Eigen/Dense>
#include <unsupported/Eigen/KroneckerProduct>
#include <yaml-cpp/yaml.h>

namespace withheld {
namespace {

constexpr int kRounds = 8;
constexpr double kFar = 4.0;  // sigma

Vector vectorOf(const YAML::Node& node) { return {node[0].as<double>(), node[1].as<double>(), node[2].as<double>()}; }

/// A frame at a point whose z is an axis.
Frame frameAlong(const Vector& axis, const Vector& point) {
  const Vector side = axis * (std::abs(axis.z()) > 0.9 ? Vector(1.0, 0.0, 0.0) : Vector(0.0, 0.0, 1.0));
  const Vector x = side / side.Norm();
  return {Rotation(x, axis * x, axis), point};
}

Arm readArm(const std::filesystem::path& file) {
  const YAML::Node yaml = YAML::LoadFile(file.string());
  Arm arm;
  arm.name = yaml["name"].as<std::string>();
  Frame T_base_here = Frame::Identity();
  for (const YAML::Node& node : yaml["joints"]) {
    if (node["type"].as<std::string>() != "revolute") throw std::runtime_error(file.string() + ": expected revolute joints");
    const Frame T_base_joint = frameAlong(vectorOf(node["axis"]), vectorOf(node["point"]));
    arm.joints.push_back({false, T_base_here.Inverse() * T_base_joint, -KDL::PI, KDL::PI});
    T_base_here = T_base_joint;
  }
  arm.bodies.resize(arm.size());
  const YAML::Node quaternion = yaml["flange"]["quaternion_xyzw"];
  const Rotation turned =
      Rotation::Quaternion(quaternion[0].as<double>(), quaternion[1].as<double>(), quaternion[2].as<double>(), quaternion[3].as<double>());
  arm.T_last_flange = T_base_here.Inverse() * Frame(turned, vectorOf(yaml["flange"]["position"]));
  return arm;
}

/// What stands after the first `count` cells of a line.
std::string after(const std::string& line, std::size_t count) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    at = line.find(',', at);
    if (at == std::string::npos) throw std::runtime_error("expected more than " + std::to_string(count) + " cells: " + line);
    ++at;
  }
  return line.substr(at);
}

std::vector<double> cellsOf(const std::string& line) {
  std::vector<double> values;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) values.push_back(std::stod(cell));
  return values;
}

void readPoses(const std::filesystem::path& file, Recording& recording) {
  std::ifstream in(file);
  const std::size_t n = recording.cell.arm.size();
  std::string line;
  if (!std::getline(in, line)) throw std::runtime_error("cannot read " + file.string());
  recording.head = after(line, n);
  if (recording.head.rfind("x,y,z,qx,qy,qz,qw", 0) != 0) throw std::runtime_error(file.string() + ": expected q1..qn,x,y,z,qx,qy,qz,qw");
  while (std::getline(in, line)) {
    const std::vector<double> cells = cellsOf(line);
    Shot shot;
    shot.pose = static_cast<int>(recording.shots.size());
    shot.q = Eigen::Map<const Eigen::VectorXd>(cells.data(), static_cast<Eigen::Index>(n));
    recording.shots.push_back(shot);
    const double* pose = cells.data() + n;
    recording.poses.emplace_back(Rotation::Quaternion(pose[3], pose[4], pose[5], pose[6]), Vector(pose[0], pose[1], pose[2]));
    recording.rests.push_back(after(line, n));
  }
}

Eigen::Matrix3d matrixOf(const Rotation& R) {
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) matrix(i, j) = R(i, j);
  }
  return matrix;
}
Eigen::Vector3d vectorOf(const Vector& v) { return {v.x(), v.y(), v.z()}; }

Rotation nearestRotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
  return {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
}

/// Where instrument and tool are. With R_m = R_Z R_f R_X at every shot, vec(R_Z) and vec(R_X^T) are the first singular vectors of the sum
/// of R_f (x) R_m; then t_m = R_Z (R_f t_X + t_f) + t_Z. Shah, Solving the robot-world/hand-eye calibration problem using the Kronecker
/// product, J. Mechanisms Robotics 5 (2013).
void placeInstrument(Recording& recording) {
  Cell plain = recording.cell;
  plain.T_camera_mount = plain.T_mount_target = Frame::Identity();
  std::vector<Frame> flanges;
  Eigen::Matrix<double, 9, 9> sum = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < recording.shots.size(); ++i) {
    flanges.push_back(targetInCamera(plain, flawless(plain, recording.shots[i])));
    sum += Eigen::kroneckerProduct(matrixOf(flanges[i].M), matrixOf(recording.poses[i].M));
  }
  const Eigen::JacobiSVD<Eigen::Matrix<double, 9, 9>> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d Z = svd.matrixU().col(0).reshaped(3, 3), X = svd.matrixV().col(0).reshaped(3, 3).transpose();
  const double sign = Z.determinant() < 0.0 ? -1.0 : 1.0;
  const Rotation R_Z = nearestRotation(sign * Z), R_X = nearestRotation(sign * X);

  const auto rows = 3 * static_cast<Eigen::Index>(flanges.size());
  Eigen::MatrixXd A(rows, 6);
  Eigen::VectorXd b(rows);
  for (std::size_t i = 0; i < flanges.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    A.middleRows<3>(row) << matrixOf(R_Z * flanges[i].M), Eigen::Matrix3d::Identity();
    b.segment<3>(row) = vectorOf(recording.poses[i].p - R_Z * flanges[i].p);
  }
  const Eigen::VectorXd t = A.completeOrthogonalDecomposition().solve(b);
  recording.cell.T_mount_target = Frame(R_X, Vector(t[0], t[1], t[2]));
  recording.cell.T_camera_mount = Frame(R_Z, Vector(t[3], t[4], t[5]));
}

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// 1 sigma of a normal distribution from the median of what is left, less what the fit took away.
PoseNoise scatterOf(const Eigen::VectorXd& rest, Eigen::Index rank) {
  constexpr double kSigmaOfMedian = 1.4826;
  std::vector<double> turns, shifts;
  for (Eigen::Index i = 0; i < rest.size(); ++i) (i % 6 < 3 ? turns : shifts).push_back(std::abs(rest[i]));
  const double freedom = static_cast<double>(rest.size()) / static_cast<double>(rest.size() - rank);
  return {kSigmaOfMedian * medianOf(turns) * std::sqrt(freedom), kSigmaOfMedian * medianOf(shifts) * std::sqrt(freedom)};
}

Frame motionOf(const Eigen::VectorXd& numbers, Eigen::Index first) {
  const auto at = [&](Eigen::Index i) { return numbers[first + i]; };
  return motion(Vector(at(0), at(1), at(2)), Vector(at(3), at(4), at(5)));
}

/// Moves a cell by the numbers of geometryColumns.
void moveBy(Cell& cell, const Eigen::VectorXd& numbers) {
  const auto n = static_cast<Eigen::Index>(cell.arm.size());
  for (Eigen::Index k = 0; k < n; ++k) moveAxis(cell.arm, static_cast<std::size_t>(k), motionOf(numbers, 6 * k));
  cell.T_camera_mount = motionOf(numbers, 6 * n) * cell.T_camera_mount;
  cell.T_mount_target = cell.T_mount_target * motionOf(numbers, 6 * n + 6);
}

}  // namespace

Recording readRecording(const std::filesystem::path& folder) {
  Recording recording;
  recording.cell.arm = readArm(folder / "robot.yaml");
  readPoses(folder / "poses.csv", recording);
  return recording;
}

Observe observePoses(const std::vector<Frame>& poses) {
  return [poses](const Cell& cell, const std::vector<Shot>& shots, const std::vector<Flaw>& flaws) {
    Eigen::VectorXd numbers(6 * static_cast<Eigen::Index>(shots.size()));
    for (std::size_t i = 0; i < shots.size(); ++i) {
      const Frame off = poses[i].Inverse() * targetInCamera(cell, stateAt(cell, shots[i], flaws));
      numbers.segment<6>(6 * static_cast<Eigen::Index>(i)) << vectorOf(off.M.GetRot()), vectorOf(off.p);
    }
    return numbers;
  };
}

std::vector<Eigen::MatrixXd> poseFactors(std::size_t shots, const PoseNoise& noise) {
  Eigen::VectorXd sigmas(6);
  sigmas << noise.rotation, noise.rotation, noise.rotation, noise.position, noise.position, noise.position;
  return std::vector<Eigen::MatrixXd>(shots, sigmas.asDiagonal());
}

PoseNoise fit(Recording& recording) {
  placeInstrument(recording);
  const Observe observe = observePoses(recording.poses);
  PoseNoise noise;
  Eigen::Index rank = 0;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Eigen::MatrixXd> factors = poseFactors(recording.shots.size(), noise);
    Eigen::VectorXd rest = whiten(observe(recording.cell, recording.shots, {}), factors);
    Eigen::MatrixXd columns = whiten(geometryColumns(recording.cell, recording.shots, false, observe), factors);
    for (Eigen::Index shot = 0; round > 1 && shot < rest.size(); shot += 6) {
      if (rest.segment<6>(shot).norm() < kFar * std::sqrt(6.0)) continue;
      rest.segment<6>(shot).setZero();
      columns.middleRows<6>(shot).setZero();
    }
    const Eigen::VectorXd scales = columnScales(columns);
    const Solution solution = solveSmallest(columns * scales.asDiagonal(), rest);
    rank = solution.rank;
    moveBy(recording.cell, -scales.cwiseProduct(solution.x));
    noise = scatterOf(observe(recording.cell, recording.shots, {}), rank);
  }
  return noise;
}

}  // namespace withheld
