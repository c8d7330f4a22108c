// The identifier of Gao, Wang and Jiang (2013), as printed but for what cannot work as printed.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "poecal/robot/arm.hpp"

namespace poecal {

struct GaoOptions {
  int max_iterations = 50;
  /// Unit of length of the translation rows [m]. Unweighted least squares depends on it: in the paper's millimetres rotations hardly count.
  double length_unit = 1.0;
};

struct GaoResult {
  Arm arm;
  std::vector<double>
      residuals;  ///< RMS of all entries of Y (rad and length units mixed, as the paper has it), before the first step and after each
  bool converged = false;
  int rank = 0;
  double condition_number = 0.0;  ///< of L with columns scaled to unit length
  /// Covariance of the last step's unknowns (twist directions, then Gamma): sandwich over poses, (L'L)^-1 (sum L_p' y_p y_p' L_p) (L'L)^-1,
  /// honest though the rows are unweighted and mixed.
  Eigen::MatrixXd covariance;
};

/// y = log(T_measured f(q)^-1) per pose (exact where eq. 22 has its first order), Y = L x (eq. 27) with eq. 21 in the minimal basis of each
/// joint (the paper's 6 (n + 1) columns have rank 4r + 2p + 6 only), x by QR with scaled columns, xi_i <- Ad(exp(d_eta_i)) xi_i, Gamma <-
/// Gamma + d_Gamma (eqs. 29, 30), until the RMS of Y stops falling.
GaoResult gao(const Arm& nominal, const std::vector<Eigen::VectorXd>& q, const std::vector<Eigen::Isometry3d>& T_base_flange,
              const GaoOptions& options);

}  // namespace poecal
