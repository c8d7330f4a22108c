// Columns that the way from one row to the next contradicts.
#include "capture/motion_checks.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "capture/test_arm.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kRows = 60;

/// Rows to and fro at random, 12 s apart, each come to straight from the one before.
class MotionChecks : public ::testing::Test {
 protected:
  MotionChecks() {
    Rng rng = test::rngOfThisTest();
    for (std::size_t row = 0; row < kRows; ++row) {
      Sample sample;
      sample.line = static_cast<int>(row) + 2;
      sample.q = Eigen::Vector3d(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(0.0, 0.2));
      sample.dir = Eigen::Vector3d::Ones();
      if (row > 0) sample.dir = (sample.q - samples_.back().q).cwiseSign();
      sample.stamp = 12.0 * static_cast<double>(row);
      samples_.push_back(sample);
    }
  }
  std::vector<std::string> directions() const { return directionRemarks("rows.csv", samples_, arm_); }
  std::vector<std::string> speeds() const { return speedRemarks("rows.csv", samples_, arm_); }

  Arm arm_ = test::smallArm();
  std::vector<Sample> samples_;
};

TEST_F(MotionChecks, StampsOfAnotherUnitMakeTheArmTooFast) {
  EXPECT_THAT(speeds(), IsEmpty());
  for (Sample& sample : samples_) *sample.stamp /= 86400.0;
  EXPECT_THAT(speeds(), ElementsAre(HasSubstr("and so do most rows: expected seconds; is stamp in minutes, hours or days?")));
  for (Sample& sample : samples_) *sample.stamp *= 1440.0;  // minutes: 0.2 of one is slow enough for an arm without stated limits
  EXPECT_THAT(speeds(), IsEmpty());
  for (Joint& joint : arm_.joints) joint.largest_speed = 0.5;
  EXPECT_THAT(speeds(), ElementsAre(HasSubstr("which no such arm can, and so do most rows")));
}

TEST_F(MotionChecks, OneJumpOfTheClockIsNoOtherUnit) {
  for (std::size_t row = 30; row < kRows; ++row) *samples_[row].stamp -= 11.9999;
  EXPECT_THAT(speeds(), IsEmpty());
}

TEST_F(MotionChecks, SidesThatTheRowsContradictAreSaid) {
  EXPECT_THAT(directions(), IsEmpty());
  const std::vector<Sample> good = samples_;
  for (Sample& sample : samples_) sample.dir(1) *= -1.0;
  EXPECT_THAT(directions(), ElementsAre(HasSubstr("rows.csv: dir2: opposite to the move from the row before in nearly every row")));
  samples_ = good;
  for (Sample& sample : samples_) sample.dir(0) = sample.dir(0) > 0.0 ? 1.0 : 0.0;
  EXPECT_THAT(directions(), ElementsAre(HasSubstr("rows.csv: dir1: only 0 and 1, expected -1 and 1")));
  samples_ = good;
  for (Sample& sample : samples_) std::swap(sample.dir(0), sample.dir(1));
  EXPECT_THAT(directions(), ElementsAre(HasSubstr("dir2: follows joint 1 and not its own in nearly every row"),
                                        HasSubstr("dir1: follows joint 2 and not its own in nearly every row")));
  samples_ = good;
  for (std::size_t row = 0; row + 1 < kRows; ++row) samples_[row].dir = good[row + 1].dir;
  EXPECT_THAT(directions(),
              ElementsAre(HasSubstr("dir1, dir2, dir3: as the move to the next row in nearly every row: shifted by one row?")));
}

TEST_F(MotionChecks, ControllersMayComeFromASideOfTheirOwn) {
  Rng rng = test::rngOfThisTest();
  for (Sample& sample : samples_) {
    for (double& side : sample.dir) side = rng.uniform() < 0.5 ? -1.0 : 1.0;
  }
  EXPECT_THAT(directions(), IsEmpty());
  for (Sample& sample : samples_) sample.dir.setOnes();
  EXPECT_THAT(directions(), IsEmpty()) << "always from below";
  for (Sample& sample : samples_) sample.dir = sample.dir.cwiseMax(0.0);
  for (std::size_t row = 1; row < kRows; ++row) samples_[row].q(1) = samples_[row - 1].q(1) + samples_[row].dir(1) * 0.01;
  EXPECT_THAT(directions(), ::testing::Not(::testing::Contains(HasSubstr("dir2: only 0 and 1")))) << "0 where the joint stands still";
  for (std::size_t row = 0; row < kRows; ++row) {
    samples_[row].q = samples_[row % 3].q;
    samples_[row].q(0) += 1e-5 * static_cast<double>(row);  // as encoders do
    samples_[row].dir.setConstant(row % 3 == 1 ? -1.0 : 1.0);
  }
  EXPECT_THAT(directions(), IsEmpty()) << "three poses, again and again";
  for (Sample& sample : samples_) sample.dir.resize(0);
  EXPECT_THAT(directions(), IsEmpty());
}

}  // namespace
}  // namespace poecal
