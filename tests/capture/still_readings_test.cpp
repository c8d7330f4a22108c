#include "capture/still_readings.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "support/random.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class StillReadings : public ::testing::Test {
 protected:
  StillReadings() {
    Rng rng = test::rngOfThisTest();
    for (int row = 0; row < 20; ++row) {
      Sample sample;
      sample.line = row + 2;
      sample.q = Eigen::Vector3d(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
      samples_.push_back(sample);
    }
  }
  std::vector<std::string> remarks() const { return stillRemarks("rows.csv", samples_); }
  std::vector<Sample> samples_;
};

TEST_F(StillReadings, AJointThatStaysWhileOthersMoveIsSaid) {
  EXPECT_THAT(remarks(), IsEmpty());
  for (std::size_t k = 12; k < 20; ++k) samples_[k].q(1) = 0.125;
  EXPECT_THAT(remarks(), ElementsAre("rows.csv:14: q2 stays at exactly 0.125 in lines 14 to 21 while others move; if it was not parked "
                                     "there, its reading is stuck: expected the reading of each moment"));
  samples_[15].q(1) = 0.5;
  samples_[16].q(1) = 0.6;
  EXPECT_THAT(remarks(), IsEmpty()) << "three rows may be alike";
}

TEST_F(StillReadings, ALoggerThatStopsIsSaid) {
  for (std::size_t k = 8; k < 14; ++k) samples_[k].q = samples_[8].q;
  EXPECT_THAT(remarks(), ElementsAre("rows.csv:10: no reading changes in lines 10 to 15; if these are no shots of one pose, the readings "
                                     "are stuck: expected the reading of each moment"));
  for (std::size_t k = 8; k < 14; ++k) samples_[k].pose = 3;
  EXPECT_THAT(remarks(), IsEmpty()) << "they are said to be shots of one pose";
}

TEST_F(StillReadings, GridsAndShotsOfEveryPoseAreTheRule) {
  for (std::size_t k = 0; k < 20; ++k) samples_[k].q(0) = k < 5 ? 0.0 : k < 10 ? 0.4 : k < 15 ? 0.8 : 0.4;
  EXPECT_THAT(remarks(), IsEmpty());
  for (std::size_t k = 0; k < 20; ++k) samples_[k].q = samples_[k - k % 5].q;
  EXPECT_THAT(remarks(), IsEmpty());
}

}  // namespace
}  // namespace poecal
