// Matchers that compare shapes, fail on NaN and print the largest difference.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gmock/gmock.h>

namespace poecal::test {

/// Largest absolute difference; NaN if any entry is NaN.
template <typename A, typename B>
double largestDifference(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  if (a.size() == 0) return 0.0;
  return (a - b).cwiseAbs().template maxCoeff<Eigen::PropagateNaN>();
}

MATCHER_P2(MatrixIsNear, expected, tolerance, "") {
  if (arg.rows() != expected.rows() || arg.cols() != expected.cols()) {
    *result_listener << "shape " << arg.rows() << "x" << arg.cols() << ", expected " << expected.rows() << "x" << expected.cols();
    return false;
  }
  const double difference = largestDifference(arg, expected);
  *result_listener << "largest difference " << difference;
  return difference <= tolerance;
}

/// Compares matrices of any Eigen type to an absolute tolerance.
template <typename Matrix>
auto IsNear(const Matrix& expected, double tolerance) {
  return MatrixIsNear(typename Matrix::PlainObject(expected), tolerance);
}

/// Compares the 4 x 4 matrices of two poses.
inline auto PoseIsNear(const Eigen::Isometry3d& expected, double tolerance) {
  return ::testing::ResultOf([](const Eigen::Isometry3d& T) { return Eigen::Matrix4d(T.matrix()); },
                             MatrixIsNear(Eigen::Matrix4d(expected.matrix()), tolerance));
}

}  // namespace poecal::test
