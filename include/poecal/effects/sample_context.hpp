// What effects may use of a sample: its readings, the load of gravity on the arm, and where its points are in the picture.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "poecal/capture/capture.hpp"
#include "poecal/cell/cell.hpp"
#include "poecal/effects/place.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

/// One point of the target in one sample. NaN where the undisturbed cell has no pixel for it.
struct PointContext {
  PointId id;
  Eigen::Vector3d p_target = Eigen::Vector3d::Zero();
  Eigen::Vector2d px = Eigen::Vector2d::Zero();           ///< of the undisturbed cell
  Eigen::Vector2d px_velocity = Eigen::Vector2d::Zero();  ///< by the joint velocities [px/s]; zero where none are known
  /// Motion of the corner when both edges that meet there move out by 1 px; zero where the point is no corner of a tag.
  Eigen::Vector2d px_outward = Eigen::Vector2d::Zero();
};

/// What all samples of a capture have in common.
struct CaptureContext {
  Cell cell;  ///< undisturbed: nominal or identified
  Target target;
  Eigen::Vector3d center_target = Eigen::Vector3d::Zero();  ///< mean of the target's points [m]
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};
  double first_stamp = 0.0, last_stamp = 0.0;  ///< [s]
  double first_temperature = 0.0;              ///< [degrees Celsius]
  std::vector<std::string> other_columns;      ///< names of the samples' further columns
};

/// One sample with what effects need of it.
struct SampleContext {
  std::shared_ptr<const CaptureContext> capture;
  std::size_t number = 0;  ///< of the sample in its table
  Sample sample;
  /// Gravity torques (n) and, about each joint's anchor, in the frame of body k, the moment that joint k carries (3 x n) [N m]; NaN where
  /// the arm's masses are not known. Empty without an arm.
  Eigen::VectorXd torque;
  Eigen::Matrix3Xd moment_body;
  /// Moment of gravity on the whole arm about the origin of base, in base [N m]; NaN likewise.
  Eigen::Vector3d base_moment = Eigen::Vector3d::Zero();
  /// Gravity's wrench (moment about the origin of base; force) by each body's (m, m com), and last by the sample's payload: 6 x (4n + 1).
  Matrix6Xd wrench_by_masses;
  ArmChain chain;          ///< of the arm; empty without one
  Matrix6Xd joint_twists;  ///< spaceJacobian there
  std::vector<PointContext> points;

  /// Hours since a stamp, or kelvin above a temperature, by what drives the effect (kStamp, kTemperature); NaN where the sample has no
  /// such value. @param reference  NaN: the first of the capture.
  double elapsed(DriverKind driver, double reference) const;

  /// The same sample on the arm of another context of its capture, without load and points.
  SampleContext readingsOn(const std::shared_ptr<const CaptureContext>& other) const;
  /// The same with gravity's load as that arm takes it: makeSampleContext() for arms that differ in a few joints, which costs less.
  SampleContext loadOf(const std::shared_ptr<const CaptureContext>& other) const;

  /// Column c of the wrench above as joint k (from 0) takes it: its torque, and the moment that it carries about its anchor, in the frame
  /// of body k. Zero for bodies before the joint.
  double torqueByMasses(std::size_t k, Eigen::Index c) const;
  Eigen::Vector3d momentByMasses(std::size_t k, Eigen::Index c) const;
  /// Moment of a wrench (moment about the origin of base; force) about the anchor of joint k, in the frame of body k.
  Eigen::Vector3d momentOf(const Vector6d& wrench, std::size_t k) const;
};

/// The common part. @param samples  for the first and last stamp and the first temperature. @param other_columns  names of their further
/// columns.
std::shared_ptr<const CaptureContext> makeCaptureContext(const Cell& cell, const Target& target, const Eigen::Vector3d& gravity,
                                                         const std::vector<Sample>& samples,
                                                         const std::vector<std::string>& other_columns = {});

/// @param points  those of the sample whose pixels are wanted, in the order of the disturbance's points and pixels.
SampleContext makeSampleContext(const std::shared_ptr<const CaptureContext>& capture, const Sample& sample, std::size_t number,
                                const std::vector<TargetPoint>& points);

}  // namespace poecal
