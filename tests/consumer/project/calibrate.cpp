// Calibrates and diagnoses a cell from memory, without a file: the README's example.
#include <cstdio>

#include <poecal/calibration/calibrate.hpp>

#include "shots.hpp"

int main() {
  using Eigen::Vector3d;
  const Vector3d y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  poecal::Cell nominal;
  nominal.arm.emplace();  // as drawn: each axis by a direction and a point, then the flange at zero
  nominal.arm->joints = {poecal::Joint::revolute("base", z, {0.0, 0.0, 0.0}), poecal::Joint::revolute("shoulder", y, {0.05, 0.0, 0.35}),
                         poecal::Joint::revolute("elbow", y, {0.05, 0.0, 0.75})};
  nominal.arm->gamma << 0.0, 0.0, 0.0, 0.45, 0.0, 0.8;
  nominal.camera = plainCamera();

  poecal::Measurements measurements;
  measurements.target = poecal::apriltagTarget("tag36h11", {{.id = 1, .size = 0.08}});
  for (const Shot& shot : takeShots(measurements.target)) {
    poecal::Sample sample;
    sample.q = shot.q;      // joint readings [rad]
    sample.dir = shot.dir;  // from which side each joint came, where that is known
    measurements.addPicture(sample, shot.corners);
  }

  const poecal::Calibration calibration = poecal::calibrate(nominal, measurements);
  for (const poecal::Joint& joint : calibration.model->cell.arm->joints) {
    std::printf("%-8s axis %8.5f %8.5f %8.5f\n", joint.name.c_str(), joint.xi(0), joint.xi(1), joint.xi(2));
  }
  if (!calibration.diagnosis) return std::printf("no diagnosis: %s\n", calibration.no_diagnosis.c_str()), 1;
  for (const poecal::Finding& finding : calibration.diagnosis->findings) {
    std::printf("%s at %s, probability %.2f\n", finding.effect.c_str(), finding.location.c_str(), finding.probability);
  }
  return calibration.diagnosis->findings.empty() ? 2 : 0;
}
