// Captures with one mistake are refused with its name; the same captures without it pass, and so do those of a cell with a large effect.
#include <gmock/gmock.h>

#include "registration/captures.hpp"

namespace poecal {
namespace {

using test::CaptureKind;
using test::MadeCapture;
using test::makeCapture;
using test::Readings;
using test::Said;
using test::said;
using test::View;
using test::withGrid;

class PlausibilityOf : public ::testing::TestWithParam<CaptureKind> {};

TEST_P(PlausibilityOf, GoodCapturesPassAndSpoiltOnesAreNamed) {
  Rng rng = test::rngOfThisTest();
  const MadeCapture good = makeCapture(GetParam(), rng);
  ASSERT_EQ(static_cast<int>(good.observations.size()), GetParam().pictures);
  const Said of_good = said(good);
  EXPECT_FALSE(of_good.refused) << of_good.message;
  int spoilt = 0, named = 0;
  std::string unnamed;
  for (const test::Spoilt& one : spoiltCaptures(GetParam(), good)) {
    ++spoilt;
    const Said answer = said(one.capture);
    EXPECT_TRUE(answer.refused || answer.message.find(one.said) != std::string::npos) << one.name << " passed: " << answer.message;
    if (answer.message.find(one.said) != std::string::npos) {
      ++named;
    } else {
      unnamed += one.name + ": " + answer.message + "\n";
    }
  }
  EXPECT_GE(named, 0.9 * spoilt) << unnamed;
  RecordProperty("named", named);
  RecordProperty("spoilt", spoilt);
}

// Four arms, both setups, wide and look-at cells, poses alone, poses of a tracker.
INSTANTIATE_TEST_SUITE_P(Kinds, PlausibilityOf,
                         ::testing::Values(CaptureKind{"elbow"}, CaptureKind{"elbow", Setup::kEyeInHand, Readings::kJoints, View::kLookAt},
                                           CaptureKind{"elbow", Setup::kEyeToHand, Readings::kTracker},
                                           CaptureKind{"elbow", Setup::kEyeToHand, Readings::kFlangePoses, View::kWide, 20},
                                           CaptureKind{"elbow", Setup::kEyeInHand, Readings::kFlangePoses, View::kLookAt, 20},
                                           CaptureKind{"seven", Setup::kEyeToHand, Readings::kJoints, View::kLookAt},
                                           CaptureKind{"seven", Setup::kEyeInHand},
                                           CaptureKind{"seven", Setup::kEyeToHand, Readings::kTracker, View::kLookAt}, CaptureKind{"scara"},
                                           CaptureKind{"scara", Setup::kEyeInHand}, CaptureKind{"shoulder"},
                                           CaptureKind{"shoulder", Setup::kEyeInHand, Readings::kJoints, View::kLookAt}),
                         [](const auto& kind) { return nameOf(kind.param); });

TEST(Plausibility, ACameraThatMovedOnceIsNoMistakeInTheInputWhereAnArmIsDiagnosed) {
  Rng rng = test::rngOfThisTest();
  // In the middle neither half is the majority, which is hardest.
  constexpr std::size_t kMiddle = 20;
  for (const CaptureKind& kind : {CaptureKind{"elbow"}, CaptureKind{"shoulder", Setup::kEyeInHand},
                                  CaptureKind{"seven", Setup::kEyeToHand, Readings::kJoints, View::kLookAt}, CaptureKind{"scara"},
                                  CaptureKind{"elbow", Setup::kEyeToHand, Readings::kTracker}}) {
    for (const double size : {0.05, 0.2, 0.2}) {
      const Said answer = said(movedFrom(makeCapture(kind, rng), kMiddle, test::randomPose(rng, size, size)));
      EXPECT_FALSE(answer.refused) << nameOf(kind) << ", moved by " << size << ": " << answer.message;
    }
  }
}

// As seen from a camera on the flange, a target that turned in its mount leaves hundreds of pixels, but every picture by itself is well.
TEST(Plausibility, LargeEffectsAreNoOtherOrderOfTheCorners) {
  Rng rng = test::rngOfThisTest();
  for (int draw = 0; draw < 4; ++draw) {
    const MadeCapture board = withGrid(makeCapture({"elbow", Setup::kEyeInHand, Readings::kJoints, View::kLookAt}, rng), 4, 3, 0.05);
    const Said answer = said(movedFrom(board, 20, test::randomPose(rng, 0.2, 0.1)));
    EXPECT_FALSE(answer.refused) << answer.message;
  }
}

}  // namespace
}  // namespace poecal
