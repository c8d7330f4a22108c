// A cell and a sample that every effect can act on: all columns, masses, two tags in view.
#pragma once

#include <vector>

#include "poecal/effects/catalogue.hpp"
#include "support/arms.hpp"
#include "support/cameras.hpp"

namespace poecal::test {

struct RichCell {
  Cell cell;
  Target target;
  std::vector<Sample> samples;
  std::shared_ptr<const CaptureContext> capture;

  SampleContext context(std::size_t number) const { return makeSampleContext(capture, samples[number], number, target.points); }
};

/// @param joint_types  as randomArm. The targets lies about 1.5 m before the camera at the first sample and near there at the others.
inline RichCell richCell(Rng& rng, const std::string& joint_types = "RRRPRR") {
  RichCell rich;
  rich.cell.arm = randomArm(rng, joint_types);
  const int n = rich.cell.arm->jointCount();
  for (int k = 0; k < n; ++k) rich.cell.arm->links.push_back({rng.uniform(1.0, 5.0), uniformVector(rng, 3, 0.4)});
  rich.cell.camera = plumbBob(1280, 1024, {1100.0, 1110.0}, {640.0, 510.0}, {-0.08, 0.05, 1e-3, -7e-4, 0.01});
  TargetTag left{.id = 3, .size = 0.08}, right{.id = 9, .size = 0.06};
  left.T_target_tag.translation() << -0.06, 0.01, 0.0;
  right.T_target_tag.translation() << 0.07, -0.02, 0.01;
  rich.target = apriltagTarget("tag36h11", {left, right});
  const Eigen::VectorXd q = uniformVector(rng, n, 0.8);
  for (int row = 0; row < 4; ++row) {
    Sample sample;
    sample.q = q + (row == 0 ? Eigen::VectorXd(Eigen::VectorXd::Zero(n)) : uniformVector(rng, n, 0.03));
    sample.dir = uniformVector(rng, n, 1.0).cwiseSign();
    sample.dq = uniformVector(rng, n, 0.1);
    sample.stamp = 100.0 + 1800.0 * row;
    sample.temperature = 21.0 + 2.0 * row;
    rich.samples.push_back(sample);
  }
  Registration& registration = rich.cell.registration;
  registration.T_far_target = randomPose(rng, 1.0, 0.1);
  Eigen::Isometry3d T_camera_target = randomPose(rng, 0.4, 0.1);
  T_camera_target.translation().z() += 1.5;
  registration.T_camera_near = T_camera_target * registration.cameraTarget(forwardKinematics(*rich.cell.arm, q)).inverse();
  rich.capture = makeCaptureContext(rich.cell, rich.target, Eigen::Vector3d(0.5, -0.3, -9.8), rich.samples);
  return rich;
}

/// An effect by what a file says, at this cell.
inline AppliedEffect effectOf(const RichCell& rich, const std::string& name, const std::string& location,
                              const std::map<std::string, double>& parameters, const std::string& driver = "") {
  return makeEffect({.effect = name, .location = location, .parameters = parameters, .driver = driver}, rich.cell);
}

}  // namespace poecal::test
