#include "poecal/core/choices.hpp"

#include <gmock/gmock.h>

namespace poecal {
namespace {

TEST(Choices, DistanceCountsLetters) {
  EXPECT_EQ(editDistance("", "abc"), 3u);
  EXPECT_EQ(editDistance("kitten", "sitting"), 3u);
  EXPECT_EQ(editDistance("sitting", "kitten"), 3u) << "the way back is as long";
  EXPECT_EQ(editDistance("diagnose", "diagnose"), 0u);
}

TEST(Choices, FewAreAllListedAsTheyCome) { EXPECT_EQ(choices("x", {"q3", "q1", "q2"}), "q3, q1, q2"); }

TEST(Choices, OfManyTheNearestAreListed) {
  std::vector<std::string> names;
  for (int k = 1; k <= 12; ++k) names.push_back("far_away_" + std::to_string(k));
  names.push_back("joint_gain");
  EXPECT_THAT(choices("joint_gian", names), ::testing::StartsWith("joint_gain, "));
  EXPECT_THAT(choices("joint_gian", names), ::testing::EndsWith(", ... (13 in all)"));
}

}  // namespace
}  // namespace poecal
