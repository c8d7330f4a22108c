// Good captures pass; what is left out, open or off is said.
#include <cmath>
#include <functional>
#include <map>

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
using test::withGrid;
using ::testing::HasSubstr;

TEST(PlausibilityStatistics, LooseArmsAndFewPicturesPass) {
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

TEST(PlausibilityStatistics, ACameraThatMovedOnceIsSaidWherePosesAreGiven) {
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

/// Four tags in a square, of which one is not as the file says: as if its corners were seen where `seen` puts them.
MadeCapture withFourTags(const MadeCapture& capture, int tag, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& seen) {
  MadeCapture board = withGrid(capture, 2, 2, 0.07);
  for (std::size_t k = 0; k < board.observations.size(); ++k) {
    const Eigen::Isometry3d T = capture.truth.registration.cameraTarget(forwardKinematics(*capture.truth.arm, capture.observations[k].q));
    for (CornerMeasurement& corner : board.observations[k].corners) {
      if (corner.id.tag == tag) corner.px += *project(*capture.truth.camera, T * seen(corner.p_target)) - corner.px;
    }
  }
  return board;
}

TEST(Plausibility, OneTagOfSeveralThatIsNotAsStatedIsNamed) {
  Rng rng = test::rngOfThisTest();
  const Eigen::Vector3d middle(0.035, -0.035, 0.0);  // of tag 1
  for (const CaptureKind& kind : {CaptureKind{"elbow"}, CaptureKind{"seven", Setup::kEyeInHand}}) {
    const MadeCapture good = makeCapture(kind, rng);
    const auto message = [&](const auto& seen) { return said(withFourTags(good, 1, seen)).message; };
    EXPECT_FALSE(said(withFourTags(good, 1, [](const Eigen::Vector3d& p) { return p; })).refused) << nameOf(kind);
    EXPECT_THAT(message([&](const Eigen::Vector3d& p) -> Eigen::Vector3d { return middle + 1.12 * (p - middle); }),
                HasSubstr("tag 1 does not fit the layout of the others: it looks 12.0 % larger than stated"));
    EXPECT_THAT(message([&](const Eigen::Vector3d& p) -> Eigen::Vector3d { return middle + 0.95 * (p - middle); }),
                HasSubstr("tag 1 does not fit the layout of the others: it looks 5.0 % smaller than stated"));
    EXPECT_THAT(message([&](const Eigen::Vector3d& p) -> Eigen::Vector3d { return p + Eigen::Vector3d(0.03, 0.04, 0.0); }),
                ::testing::ContainsRegex("tag 1 does not fit the layout of the others: it looks 50.?[0-9]? mm from its stated place"));
    EXPECT_THAT(message([&](const Eigen::Vector3d& p) -> Eigen::Vector3d { return p + Eigen::Vector3d(0.0, 0.0, 0.008); }),
                ::testing::ContainsRegex("tag 1 does not fit the layout of the others: it looks [78].?[0-9]* mm out of its stated plane"));
    EXPECT_THAT(message([&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
                  return middle + Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()) * (p - middle);
                }),
                ::testing::ContainsRegex("tag 1 does not fit the layout of the others: it looks tilted by 1[67].?[0-9]* degrees"));
    // A hundredth of its size is what cutting and glueing leave, a fifth a slip in the file: effects like others, whose size is told.
    for (const double off : {5e-4, 0.01}) {
      const MadeCapture cut =
          withFourTags(good, 1, [off](const Eigen::Vector3d& p) -> Eigen::Vector3d { return p + Eigen::Vector3d(off, 0, 0); });
      EXPECT_FALSE(said(cut).refused) << off << ": " << said(cut).message;
    }
  }
}

/// Two tags side by side, or points in space, seen where `seen` puts what the file states.
MadeCapture withPoints(const MadeCapture& capture, const std::map<PointId, Eigen::Vector3d>& stated,
                       const std::map<PointId, Eigen::Vector3d>& seen) {
  MadeCapture made = capture;
  Rng rng = test::rngOfThisTest();
  for (Observation& observation : made.observations) {
    const Eigen::Isometry3d T = capture.truth.registration.cameraTarget(forwardKinematics(*capture.truth.arm, observation.q));
    observation.corners.clear();
    for (const auto& [id, p] : stated) {
      CornerMeasurement corner;
      corner.id = id;
      corner.p_target = p;
      corner.px = *project(*capture.truth.camera, T * seen.at(id)) + 0.1 * Eigen::Vector2d(rng.normal(), rng.normal());
      observation.corners.push_back(corner);
    }
  }
  return made;
}

TEST(Plausibility, OfTwoTagsTheOneOfAnotherSizeIsNamed) {
  Rng rng = test::rngOfThisTest();
  std::map<PointId, Eigen::Vector3d> stated;
  for (int tag = 0; tag < 2; ++tag) {
    for (int corner = 0; corner < 4; ++corner) {
      stated[{tag, corner}] = {0.07 * tag + (corner == 1 || corner == 2 ? 0.02 : -0.02), corner < 2 ? 0.02 : -0.02, 0.0};
    }
  }
  for (const CaptureKind& kind : {CaptureKind{"elbow"}, CaptureKind{"seven", Setup::kEyeInHand}}) {
    const MadeCapture good = makeCapture(kind, rng);
    EXPECT_FALSE(said(withPoints(good, stated, stated)).refused) << nameOf(kind);
    std::map<PointId, Eigen::Vector3d> larger = stated, elsewhere = stated;
    for (auto& [id, p] : larger) {
      if (id.tag == 1) p = Eigen::Vector3d(0.07, 0, 0) + 1.25 * (p - Eigen::Vector3d(0.07, 0, 0));
    }
    EXPECT_THAT(said(withPoints(good, stated, larger)).message,
                HasSubstr("tag 1 does not fit the layout of the others: it looks 24.9 % larger than stated (so"));
    for (auto& [id, p] : elsewhere) {
      if (id.tag == 1) p.y() += 0.01;
    }
    EXPECT_FALSE(said(withPoints(good, stated, elsewhere)).refused) << "an effect of the target";
    std::map<PointId, Eigen::Vector3d> out = stated;
    for (auto& [id, p] : out) {
      if (id.tag == 1) p.z() += 0.01;
    }
    EXPECT_THAT(said(withPoints(good, stated, out)).message, HasSubstr("out of its stated plane"));
  }
}

TEST(Plausibility, AJointBeforeWhichTheTargetIsMountedIsNamed) {
  Rng rng = test::rngOfThisTest();
  for (const CaptureKind& kind : {CaptureKind{"elbow"}, CaptureKind{"seven", Setup::kEyeInHand}}) {
    MadeCapture made = makeCapture(kind, rng);
    for (Observation& observation : made.observations) {
      Eigen::VectorXd q = observation.q;
      q.tail<1>().setZero();
      const Eigen::Isometry3d T = made.truth.registration.cameraTarget(forwardKinematics(*made.truth.arm, q));
      for (CornerMeasurement& corner : observation.corners) {
        corner.px = *project(*made.truth.camera, T * corner.p_target) + 0.1 * Eigen::Vector2d(rng.normal(), rng.normal());
      }
    }
    EXPECT_THAT(said(made).message,
                HasSubstr(kind.setup == Setup::kEyeInHand
                              ? "q7 does not move the camera: is it mounted before joint 7, or is the arm's last link wrong?"
                              : "q6 does not move the target: is it mounted before joint 6, or is the arm's last link wrong?"))
        << nameOf(kind);
  }
}

TEST(Plausibility, PointsThatAreNotAsStatedAreNamed) {
  Rng rng = test::rngOfThisTest();
  const std::map<PointId, Eigen::Vector3d> stated{{{3, 0}, {0.1, 0, 0}},    {{4, 0}, {0, 0, 0}},           {{5, 0}, {0.1, 0.1, 0}},
                                                  {{9, 0}, {0, 0.1, 0.02}}, {{10, 0}, {0.05, 0.05, 0.03}}, {{12, 0}, {0.02, 0.06, 0.01}}};
  for (const CaptureKind& kind : {CaptureKind{"elbow"}, CaptureKind{"seven", Setup::kEyeInHand}}) {
    const MadeCapture good = makeCapture(kind, rng);
    const auto message = [&](const std::map<PointId, Eigen::Vector3d>& seen) { return said(withPoints(good, stated, seen)).message; };
    EXPECT_FALSE(said(withPoints(good, stated, stated)).refused) << nameOf(kind);
    std::map<PointId, Eigen::Vector3d> exchanged = stated, mirrored = stated, moved = stated;
    std::swap(exchanged[{5, 0}], exchanged[{9, 0}]);
    for (auto& [id, p] : mirrored) p.z() = -p.z();
    moved[{9, 0}].x() += 0.03;
    EXPECT_THAT(message(exchanged), HasSubstr("the points 5 and 9 look exchanged")) << nameOf(kind);
    EXPECT_THAT(message(mirrored), HasSubstr("the points look mirrored")) << nameOf(kind);
    EXPECT_THAT(message(moved), HasSubstr("the point 9 looks to lie at [0.03")) << nameOf(kind);
  }
}

constexpr int kColumns = 6, kRows = 4;
constexpr double kSquare = 0.03;

/// The same capture with a board of kColumns x kRows corners. @param at  where corner k of an observation really is on it.
MadeCapture withBoard(const MadeCapture& good, const std::function<Eigen::Vector3d(std::size_t, int)>& at) {
  MadeCapture board = good;
  for (std::size_t n = 0; n < board.observations.size(); ++n) {
    Observation& observation = board.observations[n];
    const Eigen::Isometry3d T = good.truth.registration.cameraTarget(forwardKinematics(*good.truth.arm, observation.q));
    observation.corners.clear();
    for (int k = 0; k < kColumns * kRows; ++k) {
      CornerMeasurement corner;
      corner.id = {-1, k};
      corner.p_target = {kSquare * (k % kColumns), kSquare * (k / kColumns), 0.0};
      corner.px = *project(*good.truth.camera, T * at(n, k));
      observation.corners.push_back(corner);
    }
  }
  return board;
}

Eigen::Vector3d onBoard(int column, int row) { return {kSquare * column, kSquare * row, 0.0}; }

TEST(Plausibility, ABoardWithColumnsAndRowsExchangedIsNamed) {
  Rng rng = test::rngOfThisTest();
  const MadeCapture good = makeCapture({"elbow"}, rng);
  MadeCapture board = withBoard(good, [](std::size_t, int k) { return onBoard(k % kColumns, k / kColumns); });
  EXPECT_FALSE(said(board).refused) << said(board).message;
  for (Observation& observation : board.observations) {
    for (CornerMeasurement& corner : observation.corners) {
      corner.p_target = {kSquare * (corner.id.corner % kRows), kSquare * (corner.id.corner / kRows), 0.0};
    }
  }
  EXPECT_THAT(said(board).message, HasSubstr("the board's columns and rows look exchanged"));
}

TEST(Plausibility, CornersOfABoardThatAreNotInTheirPlacesAreNamed) {
  Rng rng = test::rngOfThisTest();
  const MadeCapture good = makeCapture({"elbow"}, rng);
  const MadeCapture last_row = withBoard(good, [](std::size_t, int k) {
    const bool last = k / kColumns == kRows - 1;
    return onBoard(k % kColumns + (last ? 1 : 0), k / kColumns);
  });
  EXPECT_THAT(said(last_row).message, HasSubstr("the corners 18 to 23 of the target lie up to 30.0 mm from their places"));
  const MadeCapture exchanged = withBoard(good, [](std::size_t, int k) {
    const int of = k == 3 ? 14 : k == 14 ? 3 : k;
    return onBoard(of % kColumns, of / kColumns);
  });
  EXPECT_THAT(said(exchanged).message, HasSubstr("the corners 3, 14 of the target lie up to"));
}

TEST(Plausibility, RowsWhoseBoardIsCountedARowOffAreNamed) {
  Rng rng = test::rngOfThisTest();
  const MadeCapture good = makeCapture({"elbow"}, rng);
  constexpr std::size_t kFirst = 24;
  const MadeCapture later =
      withBoard(good, [](std::size_t n, int k) { return onBoard(k % kColumns, k / kColumns + (n < kFirst ? 0 : 1)); });
  EXPECT_THAT(said(later).message, HasSubstr("the board's corners look counted a row off"));
  const MadeCapture some = withBoard(good, [](std::size_t n, int k) { return onBoard(k % kColumns + (n % 5 == 2 ? 1 : 0), k / kColumns); });
  EXPECT_THAT(said(some).message, HasSubstr("the board's corners look counted a column off"));
}

TEST(PlausibilityStatistics, RowsThatAreMispairedInTurnAreNamed) {
  Rng rng = test::rngOfThisTest();
  for (const CaptureKind& kind : {CaptureKind{"elbow"}, CaptureKind{"shoulder", Setup::kEyeInHand, Readings::kJoints, View::kLookAt},
                                  CaptureKind{"seven", Setup::kEyeToHand, Readings::kFlangePoses}}) {
    const MadeCapture good = makeCapture(kind, rng);
    MadeCapture lagging = good, older = good, exchanged = good;
    for (std::size_t k = 1; k < good.observations.size(); k += 2) {
      lagging.observations[k].q = good.observations[k - 1].q;
      lagging.observations[k].T_base_flange = good.observations[k - 1].T_base_flange;
      if (k > 2) {
        older.observations[k].q = good.observations[k - 2].q;
        older.observations[k].T_base_flange = good.observations[k - 2].T_base_flange;
      }
      for (const auto& [to, from] : {std::pair(k, k - 1), std::pair(k - 1, k)}) {
        exchanged.observations[to].q = good.observations[from].q;
        exchanged.observations[to].T_base_flange = good.observations[from].T_base_flange;
      }
    }
    EXPECT_THAT(said(older).message, HasSubstr("every second row looks shifted by 2 against the pictures")) << nameOf(kind);
    EXPECT_THAT(said(exchanged).message, HasSubstr("the rows look shifted by 1 and by -1 in turn")) << nameOf(kind);
    EXPECT_THAT(said(lagging).message, HasSubstr("20 rows, this one the first, hold exactly the reading of the row before"))
        << nameOf(kind);
  }
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
