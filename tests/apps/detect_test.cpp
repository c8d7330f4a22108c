// poecal detect as a user meets it: what it writes, what it says, how it ends.
#include <gmock/gmock.h>

#include "poecal/capture/detections.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;

TEST(DetectCommand, WithoutACornerNothingIsWritten) {
  const test::TempFolder folder;
  folder.write("capture.yaml",
               "format: poecal-capture/1\nname: cell\nsetup: eye_to_hand\nintrinsics: .\ntarget: target.yaml\nsamples: samples.csv\n");
  folder.write("target.yaml", "type: apriltag\nfamily: tag36h11\ntags:\n- {id: 7, size: 0.08}\n");
  folder.write("samples.csv", "image,x,y,z,qx,qy,qz,qw\na.png,0,0,0,0,0,0,1\nb.png,1,0,0,0,0,0,1\n");
  const test::ProgramRun run = test::runProgram(folder.path(), "detect . --out detections.csv");
  EXPECT_EQ(run.status, 4);
  EXPECT_THAT(run.err, HasSubstr("poecal: warning: a.png: no such file"));
  EXPECT_THAT(run.err, HasSubstr("the target was found in none of the 2 pictures"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "detections.csv"));
}

TEST(DetectCommand, AWrongCallIsToldFromABadInput) {
  const test::TempFolder folder;
  EXPECT_EQ(test::runProgram(folder.path(), "detect .").status, 2) << "--out is missing";
  EXPECT_EQ(test::runProgram(folder.path(), "detect . --out a.csv").status, 3) << "capture.yaml is missing";
}

TEST(DetectCommandReal, WritesTheCornersOfEveryPicture) {
  POECAL_REQUIRE_REAL("panda-apriltag");
  const test::TempFolder folder;
  const auto capture = test::realFolder() / "panda-apriltag";
  const test::ProgramRun run = test::runProgram(folder.path(), "detect '" + capture.string() + "' --out detections.csv");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("8 of 8 pictures show the target, 32 corners in"));
  EXPECT_EQ(readDetections(folder.path() / "detections.csv", readTarget(capture / "target.yaml")).images.size(), 8u);
}

}  // namespace
}  // namespace poecal
