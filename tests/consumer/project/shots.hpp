// What stands for a robot and a detector in the README's example: a simulated arm whose elbow has backlash.
#pragma once

#include <vector>

#include <Eigen/Core>

#include <poecal/camera/camera.hpp>
#include <poecal/capture/detections.hpp>
#include <poecal/target/target.hpp>

struct Shot {
  Eigen::VectorXd q, dir;
  std::vector<poecal::Corner> corners;
};

/// A lens without distortion.
poecal::Camera plainCamera();
std::vector<Shot> takeShots(const poecal::Target& target);
