// Good captures pass; what is left out, open or off is said.
#include <cmath>
#include <functional>

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/registration/registration.hpp"
#include "registration/captures.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using test::CaptureKind;
using test::MadeCapture;
using test::makeCapture;
using test::Readings;
using test::Said;
using test::said;
using test::View;
using ::testing::HasSubstr;

TEST(Plausibility, LooseArmsAndFewPicturesPass) {
  Rng rng = test::rngOfThisTest();
  for (const char* arm : {"elbow", "seven", "shoulder", "scara"}) {
    for (const auto setup : {Setup::kEyeToHand, Setup::kEyeInHand}) {
      for (const View view : {View::kWide, View::kLookAt}) {
        for (const int pictures : {12, 40}) {
          const CaptureKind kind{arm, setup, Readings::kJoints, view, pictures, 6e-3, 2e-3};
          const Said answer = said(makeCapture(kind, rng));
          EXPECT_FALSE(answer.refused) << nameOf(kind) << ": " << answer.message;
        }
      }
    }
  }
}

TEST(Plausibility, ACameraThatMovedOnceIsSaidWherePosesAreGiven) {
  Rng rng = test::rngOfThisTest();
  for (const CaptureKind& kind :
       {CaptureKind{"elbow", Setup::kEyeInHand, Readings::kFlangePoses}, CaptureKind{"seven", Setup::kEyeToHand, Readings::kFlangePoses}}) {
    for (const double size : {0.1, 0.2}) {
      const auto row = 14 + rng.below(12);
      const Said answer = said(movedFrom(makeCapture(kind, rng), row, test::randomPose(rng, size, size)));
      EXPECT_TRUE(answer.refused) << nameOf(kind) << ", moved by " << size << " from row " << row;
      EXPECT_THAT(answer.message, HasSubstr("stands elsewhere than before"));
    }
  }
}

TEST(Plausibility, AJointThatIsParkedIsNotStuck) {
  Rng rng = test::rngOfThisTest();
  for (const char* arm : {"elbow", "seven", "shoulder"}) {
    const MadeCapture capture = makeCapture({arm, Setup::kEyeToHand, Readings::kJoints, View::kLookAt}, rng);
    for (const Eigen::Index joint : {0, 2, 4}) {
      const Said answer = said(parkedFrom(capture, 22, joint));
      EXPECT_FALSE(answer.refused) << arm << ", joint " << joint + 1 << ": " << answer.message;
    }
  }
}

TEST(Plausibility, ShotsOfOnePoseAreNotStuck) {
  Rng rng = test::rngOfThisTest();
  MadeCapture capture = makeCapture({"elbow", Setup::kEyeToHand, Readings::kJoints, View::kWide, 30}, rng);
  // A pose that belongs to no other, five times: as of a camera that was touched and put back.
  Observation wild = capture.observations[11];
  wild.q(1) += 0.2;
  capture.observations.insert(capture.observations.begin() + 11, 5, wild);
  for (std::size_t k = 0; k < capture.observations.size(); ++k) capture.observations[k].sample = k;
  const Said answer = said(capture);
  EXPECT_FALSE(answer.refused) << answer.message;
}

TEST(Plausibility, ABoardThatIsStatedWronglyIsNamed) {
  Rng rng = test::rngOfThisTest();
  const MadeCapture good = makeCapture({"elbow", Setup::kEyeInHand, Readings::kJoints, View::kLookAt, 25}, rng);
  /// Every tag where `centre` says, which knows it by its number.
  const auto restated = [](MadeCapture board, const std::function<Eigen::Vector2d(int)>& moved) {
    for (Observation& observation : board.observations) {
      for (CornerMeasurement& corner : observation.corners) corner.p_target.head<2>() += moved(corner.id.tag);
    }
    return board;
  };
  const double kCell = 0.05;
  const MadeCapture board = withGrid(good, 4, 3, kCell), few = withGrid(good, 2, 2, kCell);
  EXPECT_FALSE(said(board).refused) << said(board).message;
  const auto at = [=](int tag, int columns) { return Eigen::Vector2d(kCell * (tag % columns), kCell * (tag / columns)); };
  EXPECT_THAT(said(restated(board, [&](int tag) { return Eigen::Vector2d(at(tag, 3) - at(tag, 4)); })).message,
              HasSubstr("the grid's columns and rows look exchanged"));
  const auto exchanged = [&](int tag) {
    return Eigen::Vector2d(tag == 1 || tag == 3 ? Eigen::Vector2d(at(4 - tag, 2) - at(tag, 2)) : Eigen::Vector2d(0.0, 0.0));
  };
  EXPECT_THAT(said(restated(few, exchanged)).message, HasSubstr("the tags 1 and 3 look exchanged"));
  // No single change mends it.
  const auto scattered = [](int tag) { return Eigen::Vector2d(0.08 * std::sin(7.0 * tag), 0.08 * std::cos(5.0 * tag)); };
  EXPECT_THAT(said(restated(few, scattered)).message, HasSubstr("no pose of this target shows the corners as the pictures do"));
}

TEST(Plausibility, RowsOfOtherPicturesAreRefusedWithoutAGuess) {
  Rng rng = test::rngOfThisTest();
  for (const View view : {View::kWide, View::kLookAt}) {
    const CaptureKind kind{"elbow", Setup::kEyeInHand, Readings::kFlangePoses, view, 17};
    MadeCapture capture = makeCapture(kind, rng);
    for (std::size_t k = capture.observations.size(); k > 1; --k) {
      std::swap(capture.observations[k - 1].T_base_flange, capture.observations[rng.below(k)].T_base_flange);
    }
    const Said answer = said(capture);
    EXPECT_TRUE(answer.refused);
    EXPECT_THAT(answer.message, HasSubstr("no registration explains")) << nameOf(kind);
  }
}

TEST(Plausibility, NearlyHalfOfTheRowsMayBeWrong) {
  Rng rng = test::rngOfThisTest();
  const CaptureKind kind{"elbow", Setup::kEyeInHand, Readings::kFlangePoses, View::kWide, 20, 0.0, 0.0};
  MadeCapture capture = makeCapture(kind, rng);
  // Nine of twenty, each with a pose that belongs to none of them.
  for (std::size_t k = 0; k < 9; ++k) {
    Observation& observation = capture.observations[2 * k];
    observation.T_base_flange = *observation.T_base_flange * test::randomPose(rng, 0.4, 0.2);
  }
  const RegistrationResult result = registerCell(capture.told, capture.observations, {});
  for (const RegisteredSample& sample : result.samples) {
    EXPECT_EQ(sample.left_out, sample.sample % 2 == 0 && sample.sample < 18) << sample.sample;
  }
  EXPECT_THAT(result.cell.registration.T_camera_near, test::PoseIsNear(capture.truth.registration.T_camera_near, 2e-3));
}

TEST(Plausibility, OfOneAxisOfRotationThePlaceAlongItIsOpen) {
  Rng rng = test::rngOfThisTest();
  const CaptureKind kind{"scara", Setup::kEyeInHand, Readings::kFlangePoses, View::kWide, 25, 0.0, 0.0};
  const MadeCapture capture = makeCapture(kind, rng);
  const RegistrationResult result = registerCell(capture.told, capture.observations, {});
  ASSERT_TRUE(result.open_axis);
  EXPECT_NEAR(std::abs(result.open_axis->z()), 1.0, 1e-2);
  EXPECT_FALSE(result.open.empty());
  for (const int open : result.open) EXPECT_TRUE((open >= 3 && open < 6) || open >= 9) << "rotations are known: " << open;
}

TEST(Plausibility, ARepeatedPoseIsOnePose) {
  Rng rng = test::rngOfThisTest();
  MadeCapture capture = makeCapture({"elbow", Setup::kEyeToHand, Readings::kJoints, View::kWide, 2}, rng);
  const std::vector<Observation> two = capture.observations;
  for (int shot = 0; shot < 10; ++shot) capture.observations.insert(capture.observations.end(), two.begin(), two.end());
  for (std::size_t k = 0; k < capture.observations.size(); ++k) capture.observations[k].sample = k;
  EXPECT_THAT([&] { registerCell(capture.told, capture.observations, {}); },
              ::testing::ThrowsMessage<InsufficientData>(HasSubstr("2 pictures of different poses")));
}

TEST(Plausibility, ASizeThatIsOffALittleIsWarnedOfWithItsDeviation) {
  Rng rng = test::rngOfThisTest();
  MadeCapture capture = makeCapture({"elbow", Setup::kEyeInHand, Readings::kFlangePoses, View::kWide, 30, 0.0, 0.0}, rng);
  for (Observation& observation : capture.observations) {
    for (CornerMeasurement& corner : observation.corners) corner.p_target *= 1.05;
  }
  const RegistrationResult result = registerCell(capture.told, capture.observations, {});
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_THAT(result.warnings.front(), HasSubstr("the target is 0.952 +- 0.000 of its stated size"));
}

}  // namespace
}  // namespace poecal
