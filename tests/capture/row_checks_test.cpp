// Rows that contradict each other, or what any arm can do.
#include "capture/row_checks.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "capture/test_arm.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kRows = 6;

class RowChecks : public ::testing::Test {
 protected:
  RowChecks() {
    for (int row = 0; row < kRows; ++row) {
      Sample sample;
      sample.line = row + 2;
      sample.q = Eigen::Vector3d(0.3 * row, -0.2 * row, 0.01 * row);
      sample.stamp = 12.0 * row;
      samples_.push_back(sample);
    }
  }
  std::string error() const {
    return test::messageOf<FileError>([this] { checkRows("rows.csv", samples_, &arm_); });
  }
  std::vector<std::string> remarks() const { return stampRemarks("rows.csv", samples_); }
  void stamp(double (*of)(int row)) {
    for (int row = 0; row < kRows; ++row) samples_[static_cast<std::size_t>(row)].stamp = of(row);
  }

  Arm arm_ = test::smallArm(false);
  std::vector<Sample> samples_;
};

TEST_F(RowChecks, ShotsOfOnePoseStandAtOnePlace) {
  samples_[1].pose = samples_[4].pose = 7;
  EXPECT_EQ(error(), "rows.csv:6: is pose 7 as line 3 is, but q1 is 1.2 here and 0.3 there, expected shots of an arm at rest");
  samples_[4].q = samples_[1].q + Eigen::Vector3d(1e-3, 0.0, 0.0);
  EXPECT_EQ(error(), "no error") << "encoders repeat to less than that";
  samples_[1].T_base_flange = Eigen::Isometry3d(Eigen::Translation3d(0.4, 0.0, 0.2));
  samples_[4].T_base_flange = Eigen::Isometry3d(Eigen::Translation3d(0.4, 0.0, 0.3));
  EXPECT_THAT(error(), HasSubstr("rows.csv:6: is pose 7 as line 3 is, but its flange is 0.1 m and 0 rad away"));
}

TEST_F(RowChecks, AJointWithoutAnEndIsNotWoundUp) {
  samples_[3].q(0) = -40.0;
  EXPECT_THAT(error(),
              HasSubstr("rows.csv:5: q1 (joint_1) is -40 here and spans 7 turns in all, expected radians; are the readings in degrees?"));
  for (Sample& sample : samples_) sample.q(0) -= 500.0;
  samples_[3].q(0) = -510.0;
  EXPECT_EQ(error(), "no error") << "where it was wound up before";
  samples_[3].q(2) = 40.0;
  EXPECT_EQ(error(), "no error") << "a long track";
}

TEST_F(RowChecks, NoCommandIsManyTurnsFromZero) {
  const auto refused = [this] { return test::messageOf<FileError>([this] { requireCommands("rows.csv", samples_, arm_); }); };
  EXPECT_EQ(refused(), "no error");
  samples_[3].q(0) = 90.0;
  EXPECT_THAT(refused(),
              HasSubstr("rows.csv:5: q1 (joint_1) is 90 here and spans 14 turns in all, expected radians; are the readings in degrees?"));
}

TEST_F(RowChecks, VelocitiesAreThoseOfAnArm) {
  arm_.joints[1].largest_speed = 2.0;
  for (Sample& sample : samples_) sample.dq = Eigen::Vector3d(1.0, 2.1, 0.2);
  EXPECT_EQ(error(), "no error");
  samples_[2].dq(1) = -6.5;
  EXPECT_THAT(error(), HasSubstr("rows.csv:4: dq2 is -6.5, far beyond the velocity limit 2 of joint_2, expected rad/s"));
  samples_[2].dq(1) = 0.0;
  samples_[5].dq(0) = 90.0;
  EXPECT_THAT(error(), HasSubstr("rows.csv:7: dq1 is 90, faster than any arm, expected rad/s"));
}

TEST_F(RowChecks, PayloadsAreWhatAnArmCarries) {
  samples_[2].payload = 12.5;
  EXPECT_EQ(error(), "no error");
  samples_[3].payload = 750.0;
  EXPECT_THAT(error(), HasSubstr("rows.csv:5: payload is 750, more than such an arm carries, expected kg; is it in grams?"));
  arm_.joints[1] = Joint::revolute("joint_2", {0, 1, 0}, {0, 0, 2.8});
  EXPECT_EQ(error(), "no error") << "an arm of that size may";
}

TEST_F(RowChecks, StampsOfAClockInSecondsPass) {
  EXPECT_THAT(remarks(), IsEmpty());
  stamp([](int row) { return 1.7e9 + 1800.0 * row; });
  EXPECT_THAT(remarks(), IsEmpty());
  stamp([](int row) { return row < 2 ? 5.0 : 6.0; });
  EXPECT_THAT(remarks(), IsEmpty()) << "a coarse clock";
  for (Sample& sample : samples_) sample.stamp.reset();
  EXPECT_THAT(remarks(), IsEmpty());
}

TEST_F(RowChecks, StampsThatNoClockGivesAreTold) {
  stamp([](int row) { return row < 3 ? 100.0 + row : 1.0 * row; });
  EXPECT_THAT(remarks(),
              ElementsAre("rows.csv:5: stamp is 3, earlier than 102 of line 4, expected rows in the order in which they were taken"));
  stamp([](int) { return 8.0; });
  EXPECT_THAT(remarks(), ElementsAre(HasSubstr("rows.csv:2: stamp is 8 in all rows")));
  stamp([](int row) { return 1.7e12 + 12e3 * row; });
  EXPECT_THAT(remarks(), ElementsAre(HasSubstr("are they milliseconds?")));
  stamp([](int row) { return 12e9 * row; });
  EXPECT_THAT(remarks(), ElementsAre(HasSubstr("are they nanoseconds?")));
}

TEST_F(RowChecks, TemperaturesOfAnotherUnitAreSaid) {
  const auto said = [this] { return temperatureRemarks("rows.csv", samples_); };
  EXPECT_THAT(said(), IsEmpty());
  for (int row = 0; row < kRows; ++row) samples_[static_cast<std::size_t>(row)].temperature = 20.0 + 3.0 * row;
  EXPECT_THAT(said(), IsEmpty()) << "an arm that warms up";
  samples_[2].temperature.reset();
  EXPECT_THAT(said(), IsEmpty());
  for (std::size_t row = 3; row < samples_.size(); ++row) samples_[row].temperature = 32.0 + 1.8 * *samples_[row].temperature;
  EXPECT_THAT(said(), ElementsAre("rows.csv:5: temperature is 84.2 here and 23 in line 3, expected one unit, degrees Celsius"));
  for (Sample& sample : samples_) sample.temperature = 294.0;
  EXPECT_THAT(said(), ElementsAre("rows.csv:2: temperature is 294, expected degrees Celsius; is it in kelvin?"));
}

TEST_F(RowChecks, CountersThatWrapAroundAreSaid) {
  for (int row = 0; row < kRows; ++row) samples_[static_cast<std::size_t>(row)].q(0) = 3.0 + 0.1 * row;
  EXPECT_THAT(turnRemarks("rows.csv", samples_, arm_), IsEmpty());
  for (Sample& sample : samples_) sample.q(0) = std::remainder(sample.q(0), 2.0 * M_PI);
  EXPECT_THAT(
      turnRemarks("rows.csv", samples_, arm_),
      ElementsAre("rows.csv:4: q1 (joint_1) is -3.08319 here and 3.1 in line 3, and but for whole turns it never leaves half a turn: "
                  "expected readings that do not wrap around (2 pi off in some rows?)"));
  for (int row = 0; row < kRows; ++row) samples_[static_cast<std::size_t>(row)].q(0) = 1.6 * row;
  EXPECT_THAT(turnRemarks("rows.csv", samples_, arm_), IsEmpty()) << "a joint that turns far";
}

TEST_F(RowChecks, APayloadHeavierThanTheArmIsSaid) {
  samples_[2].payload = 12.0;
  arm_.joints.pop_back();
  EXPECT_THAT(payloadRemarks("rows.csv", samples_, arm_), IsEmpty()) << "no masses";
  arm_.links = {{.mass = 7.0}, {.mass = 3.0}};
  EXPECT_THAT(payloadRemarks("rows.csv", samples_, arm_),
              ElementsAre("rows.csv:4: payload is 12, more than the 10 kg of the arm itself, expected kg; is it in grams or newtons?"));
  arm_.links[1].mass = 0.0;
  EXPECT_THAT(payloadRemarks("rows.csv", samples_, arm_), IsEmpty()) << "masses in part";
}

}  // namespace
}  // namespace poecal
