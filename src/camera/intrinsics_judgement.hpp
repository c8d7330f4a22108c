// How well the pictures determine a camera: covariance, and the sentences that warn.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "camera/board_bundle.hpp"

namespace poecal {

/// Covariance of the parameters for noise of 1 px from their information. Rows and columns of parameters that take part in a direction
/// without information are NaN.
Eigen::MatrixXd unitCovariance(const Eigen::MatrixXd& information);

/// @throws InsufficientData where fx, fy, cx or cy is open, or known to no better than a tenth of the focal length.
/// @param information  of the free parameters for noise of 1 px, those four first. @param sigma_px  of the corners.
void requireDetermined(const Camera& camera, const Eigen::MatrixXd& information, double sigma_px);

/// One sentence for the coefficients that are held, one per coefficient less certain than any lens deviates, and one for each of the others
/// that is correlated beyond 0.99 with another parameter.
std::vector<std::string> coefficientWarnings(const IntrinsicsFit& fit);

/// Says where fy / fx differs from 1 by more than 0.02 and five standard deviations; empty where not.
std::string stretchWarning(const IntrinsicsFit& fit);

/// @param covariance  of camera.parameters().
ProjectionUncertainty projectionUncertainty(const Camera& camera, const Eigen::MatrixXd& covariance);

/// Largest angle between the planes of two boards [rad]; pi / 2 where some board is not flat (it needs no tilting).
double tiltSpread(const std::vector<const BoardView*>& views, const std::vector<Eigen::Isometry3d>& T_camera_target);

}  // namespace poecal
