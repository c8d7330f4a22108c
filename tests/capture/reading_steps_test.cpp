// Rounded readings, against steps that were put in and against differences of the forward kinematics.
#include "capture/reading_steps.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "capture/test_arm.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = M_PI / 180.0;

std::vector<double> drawn(int count, double step, double offset = 0.0) {
  Rng rng = test::rngOfThisTest();
  std::vector<double> readings;
  for (int k = 0; k < count; ++k) {
    const double reading = rng.uniform(-1.5, 1.5);
    readings.push_back(offset + (step > 0.0 ? step * std::round(reading / step) : reading));
  }
  return readings;
}

std::string stepText(const std::vector<double>& readings, JointType type = JointType::kRevolute) {
  const auto step = readingStep(type, readings);
  return step ? step->text : "none";
}

TEST(ReadingStep, TheCoarsestStepIsFound) {
  EXPECT_EQ(stepText(drawn(40, 0.01)), "0.01 rad");
  EXPECT_EQ(stepText(drawn(40, 0.002)), "0.002 rad");
  EXPECT_EQ(stepText(drawn(40, kDegree)), "1 degree");
  EXPECT_EQ(stepText(drawn(40, 0.1 * kDegree)), "0.1 degree");
  EXPECT_EQ(stepText(drawn(40, kDegree, 0.3)), "1 degree") << "with a zero of its own";
  EXPECT_EQ(stepText(drawn(40, 2.0 * M_PI / 4096.0)), "1/4096 of a turn");
  EXPECT_EQ(stepText(drawn(40, 5e-4), JointType::kPrismatic), "0.5 mm");
  EXPECT_DOUBLE_EQ(readingStep(JointType::kRevolute, drawn(40, 0.05))->size, 0.05);
}

TEST(ReadingStep, WrittenWithFewDigitsADegreeIsStillOne) {
  std::vector<double> readings = drawn(40, kDegree);
  for (double& reading : readings) reading = std::round(1e5 * reading) * 1e-5;
  EXPECT_EQ(stepText(readings), "1 degree");
}

TEST(ReadingStep, FineReadingsAndGridsOfPosesHaveNone) {
  EXPECT_EQ(stepText(drawn(40, 0.0)), "none");
  EXPECT_EQ(stepText(drawn(40, 0.5)), "none") << "seven values";
  EXPECT_EQ(stepText({0.1, 0.2, 0.3}), "none");
  EXPECT_EQ(stepText({}), "none");
}

class RoundingOf : public ::testing::Test {
 protected:
  RoundingOf() {
    Rng rng = test::rngOfThisTest();
    for (int row = 0; row < 30; ++row) {
      Sample sample;
      sample.q = Eigen::Vector3d(rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.5), rng.uniform(0.0, 0.2));
      samples_.push_back(sample);
    }
  }
  void round(Eigen::Index joint, double step) {
    for (Sample& sample : samples_) sample.q(joint) = step * std::round(sample.q(joint) / step);
  }
  const Arm arm_ = [] {
    Arm arm = test::smallArm();
    arm.gamma << 0.0, 0.0, 0.0, 0.6, 0.0, 0.5;
    return arm;
  }();
  std::vector<Sample> samples_;
};

TEST_F(RoundingOf, WhatItCostsIsWhatHalfAStepMovesTheFlange) {
  round(0, 0.01);
  round(1, 0.002);
  const Rounding rounding = roundingOf(arm_, samples_);
  double largest = 0.0, squares = 0.0;
  for (const Sample& sample : samples_) {
    const Eigen::Vector3d here = forwardKinematics(arm_, sample.q).translation();
    double sum = 0.0;
    for (const auto& [joint, step] : {std::pair(0, 0.01), std::pair(1, 0.002)}) {
      constexpr double kTiny = 1e-6;
      Eigen::VectorXd moved = sample.q;
      moved(joint) += kTiny;
      const double way = step * (forwardKinematics(arm_, moved).translation() - here).norm() / kTiny;
      sum += 0.5 * way;
      squares += way * way / 12.0;
    }
    largest = std::max(largest, sum);
  }
  EXPECT_NEAR(rounding.largest, largest, 1e-8);
  EXPECT_NEAR(rounding.rms, std::sqrt(squares / 30.0), 1e-8);
  EXPECT_TRUE(rounding.isCoarse());
  EXPECT_THAT(rounding.text(), HasSubstr("q1 holds multiples of 0.01 rad: rounded so, the flange is off by up to"));
  round(1, 0.01);
  EXPECT_THAT(roundingOf(arm_, samples_).text(), HasSubstr("q1, q2 hold multiples of 0.01 rad"));
}

TEST_F(RoundingOf, WhatNobodySeesIsNotCoarse) {
  EXPECT_FALSE(roundingOf(arm_, samples_).isCoarse());
  for (const Eigen::Index joint : {0, 1, 2}) round(joint, 1e-4);
  const Rounding rounding = roundingOf(arm_, samples_);
  EXPECT_FALSE(rounding.isCoarse());
  EXPECT_GT(rounding.largest, 0.0);
}

}  // namespace
}  // namespace poecal
