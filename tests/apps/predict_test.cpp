// poecal predict: what it says of samples without the columns that an effect follows.
#include <gmock/gmock.h>

#include "poecal/effects/catalogue.hpp"
#include "poecal/identification/model.hpp"
#include "poecal/robot/robot_file.hpp"
#include "robot/urdf_examples.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(PredictFiles, WhatTheOrderOfTheRowsStandsInForIsSaid) {
  const test::TempFolder folder;
  folder.write("arm.urdf", test::kSixJoints.text());
  Model model;
  model.urdf = "arm.urdf";
  model.base_link = test::kSixJoints.base_link;
  model.tip_link = test::kSixJoints.tip_link;
  model.cell.arm = readUrdf(test::kSixJoints.file(), test::kSixJoints.base_link, test::kSixJoints.tip_link);
  model.effects = {
      makeEffect({.effect = "joint_backlash", .location = "joint:2", .parameters = {{"half_gap", 1e-3}}}, model.cell),
      makeEffect({.effect = "joint_slip", .location = "joint:3", .parameters = {{"offset", 1e-3}, {"time", 1.5}}}, model.cell)};
  folder.write("model.yaml", modelYaml(model));
  folder.write("bare.csv", "q1,q2,q3,q4,q5,q6\n0.1,-0.7,0.9,0.3,0.8,-0.4\n0.1,-0.6,0.9,0.3,0.8,-0.4\n");
  folder.write("whole.csv",
               "q1,q2,q3,q4,q5,q6,stamp,dir1,dir2,dir3,dir4,dir5,dir6\n"
               "0.1,-0.7,0.9,0.3,0.8,-0.4,1,1,1,1,1,1,1\n0.1,-0.6,0.9,0.3,0.8,-0.4,2,1,1,1,1,1,1\n");
  const std::string said = test::runProgram(folder.path(), "predict --joints bare.csv --model model.yaml --out poses.csv").err;
  EXPECT_THAT(said, HasSubstr("joint_backlash at joint:2 follows the side that a joint came from, and these samples have no dir columns"));
  EXPECT_THAT(said, HasSubstr("joint_slip at joint:3 follows the time, and these samples have no stamp"));
  const test::ProgramRun whole = test::runProgram(folder.path(), "predict --joints whole.csv --model model.yaml --out poses.csv");
  EXPECT_EQ(whole.status, 0) << whole.err;
  EXPECT_THAT(whole.err, Not(HasSubstr("warning")));
  model.driver_ranges = {{"stamp", {0.0, 2.0}}};
  folder.write("model.yaml", modelYaml(model));
  folder.write("later.csv", "q1,q2,q3,q4,q5,q6,stamp\n0.1,-0.7,0.9,0.3,0.8,-0.4,1.76e9\n");
  EXPECT_THAT(test::runProgram(folder.path(), "predict --joints later.csv --model model.yaml --out poses.csv").err,
              HasSubstr("later.csv:2: stamp is 1760000000.0, far from 0.0 to 2.0"));
}

}  // namespace
}  // namespace poecal
