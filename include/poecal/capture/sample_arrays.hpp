// Samples held by columns, as programs of arrays have them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/capture/capture.hpp"

namespace poecal {

/// The columns of samples.csv, each with one row per sample. A column that is empty is not there.
struct SampleArrays {
  Eigen::MatrixXd q = {};                             ///< N x n joint readings [rad] or [m]
  std::vector<Eigen::Isometry3d> T_base_flange = {};  ///< as the controller reports it
  std::vector<std::string> image = {};
  std::vector<long> pose = {};
  Eigen::VectorXd stamp = {};        ///< [s]
  Eigen::VectorXd temperature = {};  ///< [degrees Celsius]
  Eigen::VectorXd payload = {};      ///< [kg]
  Eigen::MatrixXd dir = {};          ///< N x n: -1, 0, 1
  Eigen::MatrixXd dq = {};           ///< N x n [rad/s] or [m/s]
  std::map<std::string, Eigen::VectorXd> other = {};
};

/// The same as a table, whose samples have no line in a file.
/// @throws InvalidArgument, with the column's name: columns of different numbers of rows, `dir` or `dq` with another number of joints than
/// `q`, a `dir` other than -1, 0, 1, a number that is not finite (but for `other`), neither `q` nor `T_base_flange`.
SampleTable sampleTable(const SampleArrays& arrays);

}  // namespace poecal
