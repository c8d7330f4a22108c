// Diagnoses of a recording of others into which an effect was brought.
#include <cmath>

#include <gmock/gmock.h>

#include "poecal/diagnosis/diagnose.hpp"
#include "poecal/identification/identify.hpp"
#include "poecal/robot/robot_file.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

// The recording's own gap is what gravity does to an arm whose masses are not stated. Alone, that goes far enough to stand in for the
// eccentric joint: a search that judges each finding where the fit without it ends gives the joint up, finds it again, and so for ever.
TEST(DiagnoseReal, AnEccentricJointIsNamedBesideTheRecordingsOwnGap) {
  POECAL_REQUIRE_REAL("franka-board");
  const std::filesystem::path folder = test::realFolder() / "franka-board";
  Cell cell;
  cell.arm = readRobotYaml(folder / "robot.yaml");
  PoseTable table = readPoses(folder / "poses.csv", *cell.arm);
  constexpr double kCosine = -3.4e-3, kSine = -4.8e-3;  // [rad]
  for (MeasuredPose& pose : table.poses) {
    double& q1 = pose.sample.q(0);
    q1 -= kCosine * std::cos(q1) + kSine * std::sin(q1);
  }
  const Measurements measurements = measurementsOf(table);
  const Diagnosis diagnosis = diagnose(identify(cell, measurements), measurements);
  std::vector<std::string> named;
  for (const Finding& finding : diagnosis.findings) named.push_back(finding.effect + "@" + finding.location);
  ASSERT_THAT(named, ::testing::Contains("joint_eccentricity@joint:1"));
  EXPECT_THAT(named, ::testing::AnyOf(::testing::Contains("base_compliance@base"), ::testing::Contains("link_bending@link:1")));
}

}  // namespace
}  // namespace poecal
