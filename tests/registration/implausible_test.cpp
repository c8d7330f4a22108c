#include "poecal/registration/implausible.hpp"

#include <gmock/gmock.h>

#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::EndsWith;

TEST(Implausible, TheFileThatIsSuspectedIsNamedWithItsLine) {
  const test::TempFolder folder;
  folder.write("capture.yaml", "camera: lens.yaml\ntarget: tag.yaml\nintrinsics: no\n");
  folder.write("lens.yaml", "");
  folder.write("tag.yaml", "");
  Capture capture;
  capture.folder = folder.path();
  capture.robot_file = folder.path() / "arm.urdf";
  capture.table.file = folder.path() / "rows.csv";
  capture.table.samples.resize(3);
  capture.table.samples[2].line = 7;
  const auto text = [&](InputPart part) { return std::string(fileErrorOf(ImplausibleCapture("odd", part), capture).what()); };
  EXPECT_THAT(text(InputPart::kTarget), EndsWith("/tag.yaml: odd"));
  EXPECT_THAT(text(InputPart::kCamera), EndsWith("/lens.yaml: odd"));
  EXPECT_THAT(text(InputPart::kRobot), EndsWith("/arm.urdf: odd"));
  EXPECT_THAT(text(InputPart::kManifest), EndsWith("/capture.yaml: odd"));
  EXPECT_THAT(text(InputPart::kDetections), EndsWith("/tag.yaml: odd")) << "corners found in pictures: what they are looked for";
  EXPECT_THAT(text(InputPart::kSamples), EndsWith("/rows.csv:1: odd"));
  EXPECT_THAT(fileErrorOf(ImplausibleCapture("odd", InputPart::kSamples, 2), capture).what(), EndsWith("/rows.csv:7: odd"));
  EXPECT_EQ(fileErrorOf(ImplausibleInput("odd"), capture).exitStatus(), 3);
}

TEST(Implausible, OfPosesOfAnInstrumentItIsTheirTable) {
  PoseTable table;
  table.file = "poses.csv";
  table.poses.resize(2);
  table.poses[1].sample.line = 3;
  EXPECT_STREQ(fileErrorOf(ImplausibleCapture("odd", InputPart::kSamples, 1), table).what(), "poses.csv:3: odd");
  EXPECT_STREQ(fileErrorOf(ImplausibleCapture("odd", InputPart::kRobot), table).what(), "poses.csv:1: the robot: odd");
}

}  // namespace
}  // namespace poecal
