// Corners of boards against those drawn: how far they are from the truth and from the limit, and what they state.
#include "detection/board_saddles.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "detection/corner_finder.hpp"
#include "detection/saddle_fit.hpp"
#include "poecal/camera/intrinsics.hpp"
#include "support/exact_board.hpp"
#include "support/exact_tag.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"
#include "support/rendering.hpp"

namespace poecal {
namespace {

struct Conditions {
  const char* name;
  double side, blur, noise;  ///< [px], [px], [grey levels]
  bool charuco = false;
  double lens = 0.0;  ///< k1, at a focal length of 0.9 pictures
};

std::string conditionsName(const ::testing::TestParamInfo<Conditions>& conditions) { return conditions.param.name; }

constexpr double kMarker = 0.75;

Target targetOf(const test::ExactBoard& board) {
  if (board.dictionary) return charucoTarget(board.cols, board.rows, 0.04, 0.04 * kMarker, "DICT_4X4_250");
  return chessboardTarget(board.cols - 1, board.rows - 1, 0.04);
}

FoundCorners cornersOf(const cv::Mat& picture, const test::ExactBoard& board) {
  return board.dictionary ? makeCharucoFinder(targetOf(board))->find(picture) : makeChessboardFinder(targetOf(board))->find(picture);
}

/// Where the corner of that number is on the board [squares].
Eigen::Vector2d squaresOf(const test::ExactBoard& board, int corner) {
  return {corner % (board.cols - 1) + 1.0, corner / (board.cols - 1) + 1.0};
}

/// A board somewhere about the middle of its picture, turned and tilted by chance.
test::ExactBoard anyBoard(Rng& rng, const Conditions& conditions) {
  test::ExactBoard board;
  board.cols = 7;
  board.rows = 6;
  board.blur = conditions.blur;
  if (conditions.charuco) board.dictionary = cv::aruco::DICT_4X4_250;
  board.marker = kMarker;
  const int width = static_cast<int>(9.0 * conditions.side) + 60;
  board.size = {width, width};
  const Eigen::Vector2d centre = Eigen::Vector2d::Constant(0.5 * width) + Eigen::Vector2d(rng.uniform(), rng.uniform());
  test::Quad squares;
  squares << 0, 7, 7, 0,  //
      6.5, 6.5, -0.5, -0.5;
  const test::Quad ends = test::tiltedSquare(centre, 7.0 * conditions.side, rng.uniform(-0.7, 0.7), rng.uniform(0.0, 0.6));
  const double focal = 0.9 * width, k1 = conditions.lens;
  board.pixelOf = [=](const Eigen::Vector2d& place) -> Eigen::Vector2d {
    const Eigen::Vector2d from_centre = (test::mapPoints(place, squares, ends).col(0) - centre) / focal;
    return centre + focal * (1.0 + k1 * from_centre.squaredNorm()) * from_centre;
  };
  return board;
}

/// Sums over many corners.
struct Tally {
  double squares = 0.0, normalised = 0.0, outward = 0.0;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  int corners = 0;

  void add(const test::ExactBoard& board, const FoundCorners& found) {
    const Eigen::Vector2d middle = board.pixelOf({0.5 * board.cols, 0.5 * board.rows});
    for (const Corner& corner : found.corners) {
      const Eigen::Vector2d truth = board.pixelOf(squaresOf(board, corner.id.corner)), error = corner.px - truth;
      squares += 0.5 * error.squaredNorm();
      normalised += 0.5 * error.squaredNorm() / (corner.sigma * corner.sigma);
      outward += error.dot((truth - middle).normalized());
      shift += error;
      ++corners;
    }
  }
  double rms() const { return std::sqrt(squares / corners); }
};

class BoardCorners : public ::testing::TestWithParam<Conditions> {};

TEST_P(BoardCorners, AreAsExactAsThePictureAllowsAndKnowHowFarTheyAreOff) {
  constexpr int kBoards = 2;
  constexpr double kOfLimit = 1.5, kBias = 0.005;  // [px]
  constexpr double kLeast = 0.7, kMost = 1.4;      // the mean of 120 squared and normalised errors is 1 +- 0.13
  const Conditions& conditions = GetParam();
  Rng rng = test::rngOfThisTest();
  Tally tally;
  double limit = 0.0;
  for (int trial = 0; trial < kBoards; ++trial) {
    const test::ExactBoard board = anyBoard(rng, conditions);
    const FoundCorners found = cornersOf(test::withNoise(test::exactPicture(board), rng, conditions.noise), board);
    ASSERT_EQ(found.corners.size(), 30U) << trial;
    tally.add(board, found);
    limit += std::sqrt(0.5 * test::cornerLimit(board, {3.0, 3.0}, conditions.noise).trace()) / kBoards;
  }
  EXPECT_LT(tally.rms(), kOfLimit * limit);
  EXPECT_LT((tally.shift / tally.corners).cwiseAbs().maxCoeff(), kBias);
  EXPECT_LT(std::abs(tally.outward / tally.corners), kBias);
  EXPECT_GT(tally.normalised / tally.corners, kLeast);
  EXPECT_LT(tally.normalised / tally.corners, kMost);
}

INSTANTIATE_TEST_SUITE_P(Pictures, BoardCorners,
                         ::testing::Values(Conditions{"Small", 20, 0.8, 2.0}, Conditions{"SmallSoft", 20, 1.2, 4.0},
                                           Conditions{"Sharp", 40, 0.5, 1.0}, Conditions{"Middle", 40, 0.8, 2.0},
                                           Conditions{"Noisy", 40, 1.0, 4.0}, Conditions{"Large", 80, 0.8, 2.0},
                                           Conditions{"Soft", 80, 1.2, 1.0}, Conditions{"Charuco", 40, 0.8, 2.0, true},
                                           Conditions{"CharucoNoisy", 40, 0.6, 4.0, true}, Conditions{"CharucoLarge", 80, 0.8, 1.0, true},
                                           Conditions{"BehindALens", 40, 0.8, 4.0, false, -0.3}),
                         conditionsName);

TEST(BoardSaddles, AStrongLensBendsEdgesAndNotCorners) {
  // The picture is rounded and has no other noise. Straight edges instead would put the outer corners outward by 0.1 px.
  constexpr double kBias = 0.005;  // [px]
  Rng rng = test::rngOfThisTest();
  for (const double k1 : {-0.3, 0.15}) {
    const test::ExactBoard board = anyBoard(rng, {"", 80, 0.8, 0.0, false, k1});
    Tally tally;
    tally.add(board, cornersOf(test::withNoise(test::exactPicture(board), rng, 0.0), board));
    ASSERT_EQ(tally.corners, 30);
    EXPECT_LT(std::abs(tally.outward / tally.corners), kBias) << k1;
    EXPECT_LT(tally.rms(), kBias) << k1;
  }
}

TEST(BoardSaddles, InkThatHasGrownDoesNotMoveCorners) {
  constexpr double kError = 0.003;  // [px]
  Rng rng = test::rngOfThisTest();
  for (const double growth : {-0.01, 0.01}) {
    test::ExactBoard board = anyBoard(rng, {"", 40, 0.8, 0.0});
    board.growth = growth;
    Tally tally;
    tally.add(board, cornersOf(test::withNoise(test::exactPicture(board), rng, 0.0), board));
    ASSERT_EQ(tally.corners, 30);
    EXPECT_LT(tally.rms(), kError) << growth;
  }
}

TEST(BoardSaddles, GlareOverAnEdgeMakesTheSigmaLarger) {
  constexpr int kSpoilt = 9;
  constexpr double kSigmas = 4.0;
  constexpr double kLarger = 2.0;
  Rng rng = test::rngOfThisTest();
  const test::ExactBoard board = anyBoard(rng, {"", 40, 0.8, 2.0});
  cv::Mat exact = test::exactPicture(board);
  const Eigen::Vector2d spot = board.pixelOf(squaresOf(board, kSpoilt) + Eigen::Vector2d(0.3, 0.0));
  cv::Mat glare = cv::Mat::zeros(exact.size(), CV_32F);
  cv::circle(glare, cv::Point(static_cast<int>(spot.x()), static_cast<int>(spot.y())), 8, cv::Scalar(200.0), cv::FILLED);
  cv::GaussianBlur(glare, glare, {}, 3.0);
  exact = cv::min(exact + glare, 255.0);
  const FoundCorners found = cornersOf(test::withNoise(exact, rng, 2.0), board);
  ASSERT_EQ(found.corners.size(), 30U);
  std::vector<double> sigmas;
  for (const Corner& corner : found.corners) sigmas.push_back(corner.sigma);
  std::nth_element(sigmas.begin(), sigmas.begin() + 15, sigmas.end());
  const Corner& spoilt = found.corners[kSpoilt];
  EXPECT_GT(spoilt.sigma, kLarger * sigmas[15]);
  EXPECT_LT((spoilt.px - board.pixelOf(squaresOf(board, kSpoilt))).norm(), kSigmas * spoilt.sigma);
}

TEST(SaddleView, PlacesAndPixelsAreEachOthersInverse) {
  constexpr double kTolerance = 1e-4;  // [squares]
  Rng rng = test::rngOfThisTest();
  for (int trial = 0; trial < 50; ++trial) {
    SaddleView view;
    view.px = test::uniformVector(rng, 2, 500.0);
    view.J_px_squares << 40.0, 5.0, -8.0, 30.0;
    view.uu = test::uniformVector(rng, 2, 1.5);
    view.uv = test::uniformVector(rng, 2, 1.5);
    view.vv = test::uniformVector(rng, 2, 1.5);
    const Eigen::Vector2d squares = test::uniformVector(rng, 2, 0.5);
    EXPECT_THAT(view.squaresAt(view.pixelOf(squares), view.J_px_squares.inverse()), test::IsNear(squares, kTolerance));
  }
}

TEST(SaddleCells, MarkersBeginAMarginFromTheirSquares) {
  const SaddleCells cells = SaddleCells::charuco(0.1, 0.12);
  const TagPattern& pattern = cells.pattern(DarkPair::kMain);
  const auto isWhite = [&](double u, double v) {
    return pattern.white(cellAt(cells.middle() + u / cells.cell()), cellAt(cells.middle() + v / cells.cell())) == 1;
  };
  EXPECT_FALSE(isWhite(-0.3, -0.3));
  EXPECT_FALSE(isWhite(0.05, 0.3));
  EXPECT_TRUE(isWhite(0.05, -0.3)) << "the margin";
  EXPECT_TRUE(isWhite(0.3, -0.05)) << "the margin";
  EXPECT_FALSE(isWhite(0.15, -0.15)) << "the marker's border";
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(0.05);
  EXPECT_FALSE(cells.isHidden({0.16, -0.3}, reach, DarkPair::kMain));
  EXPECT_TRUE(cells.isHidden({0.18, -0.3}, reach, DarkPair::kMain)) << "the marker's bits begin at 0.22";
  EXPECT_FALSE(cells.isHidden({0.3, 0.3}, reach, DarkPair::kMain)) << "dark squares hold nothing";
}

/// px of a pinhole camera with a lens, by its own formula.
Eigen::Vector2d seen(const Eigen::Vector3d& p) {
  const Eigen::Vector2d m = p.head<2>() / p.z();
  return 520.0 * (1.0 - 0.28 * m.squaredNorm() + 0.07 * m.squaredNorm() * m.squaredNorm()) * m + Eigen::Vector2d(325.0, 238.0);
}

test::ExactBoard anyBoardBeforeACamera(Rng& rng) {
  test::ExactBoard board;
  const auto outline = {Eigen::Vector2d(0, 0), Eigen::Vector2d(10, 0), Eigen::Vector2d(0, 7), Eigen::Vector2d(10, 7)};
  for (;;) {
    Eigen::Isometry3d T(Eigen::AngleAxisd(rng.uniform(-0.5, 0.5), Eigen::Vector3d::UnitZ()) *
                        Eigen::AngleAxisd(rng.uniform(-0.65, 0.65), Eigen::Vector3d::UnitY()) *
                        Eigen::AngleAxisd(rng.uniform(-0.65, 0.65), Eigen::Vector3d::UnitX()));
    const double z = rng.uniform(0.3, 0.6);
    T.translation() << rng.uniform(-0.25, 0.25) * z, rng.uniform(-0.2, 0.2) * z, z;
    board.pixelOf = [T](const Eigen::Vector2d& place) -> Eigen::Vector2d {
      return seen(T * Eigen::Vector3d((place.x() - 5.0) * 0.025, (place.y() - 3.5) * 0.025, 0.0));
    };
    const bool inside = std::all_of(outline.begin(), outline.end(), [&board](const Eigen::Vector2d& place) {
      const Eigen::Vector2d px = board.pixelOf(place);
      return px.minCoeff() > 5.0 && px.x() < 634.0 && px.y() < 474.0;
    });
    if (inside) return board;
  }
}

TEST(BoardSaddles, IntrinsicsAreSeveralTimesNearerThanOpenCvs) {
  constexpr int kPictures = 15;
  constexpr double kNoise = 2.0, kOfOpenCvs = 0.5;
  const Eigen::Vector3d truth(520.0, 325.0, 238.0);
  Rng rng = test::rngOfThisTest();
  const Target target = chessboardTarget(9, 6, 0.025);
  std::vector<BoardView> views;
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (int k = 0; k < kPictures; ++k) {
    const test::ExactBoard board = anyBoardBeforeACamera(rng);
    const cv::Mat picture = test::withNoise(test::exactPicture(board), rng, kNoise);
    const FoundCorners found = makeChessboardFinder(target)->find(picture);
    ASSERT_EQ(found.corners.size(), 54U) << k;
    BoardView& view =
        views.emplace_back(BoardView{std::to_string(k), Eigen::Matrix3Xd(3, 54), Eigen::Matrix2Xd(2, 54), Eigen::VectorXd(54)});
    points.emplace_back();
    for (Eigen::Index i = 0; i < 54; ++i) {
      const Corner& corner = found.corners[static_cast<std::size_t>(i)];
      view.points.col(i) = target.find(corner.id)->p_target;
      view.pixels.col(i) = corner.px;
      view.sigmas(i) = corner.sigma;
      points.back().emplace_back(0.025F * static_cast<float>(i % 9), 0.025F * static_cast<float>(i / 9), 0.0F);
    }
    ASSERT_TRUE(cv::findChessboardCorners(picture, {9, 6}, pixels.emplace_back()));
    cv::cornerSubPix(picture, pixels.back(), {11, 11}, {-1, -1}, {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-4});
  }
  const Camera ours = calibrateIntrinsics(views, 640, 480, {}).chosen().camera;
  cv::Mat K, distortion;
  std::vector<cv::Mat> rotations, translations;
  cv::calibrateCamera(points, pixels, {640, 480}, K, distortion, rotations, translations);
  const Eigen::Vector3d opencvs(K.at<double>(0, 0), K.at<double>(0, 2), K.at<double>(1, 2));
  EXPECT_LT((Eigen::Vector3d(ours.fx, ours.cx, ours.cy) - truth).norm(), kOfOpenCvs * (opencvs - truth).norm());
  for (const int k : {0, 2, 3}) {
    EXPECT_LT(std::abs(ours.parameters()(k) - (k == 0 ? 520.0 : truth(k - 1))), 4.0 * ours.standard_deviation(k)) << k;
  }
}

}  // namespace
}  // namespace poecal
