// A plane in a picture: its points, and how its corners follow a motion of the pattern.
#include "detection/plane_map.hpp"

#include <gmock/gmock.h>

#include "support/matchers.hpp"
#include "support/random.hpp"
#include "support/rendering.hpp"

namespace poecal {
namespace {

const TagCorners kCells = (TagCorners() << 1, 9, 9, 1, 9, 9, 1, 1).finished();

TEST(PlaneMap, MapsAsTheRenderersHomography) {
  constexpr double kTolerance = 2e-5;  // [px], [cells]; the renderer takes its corners in single precision
  const TagCorners px = test::tiltedSquare({100.0, 90.0}, 80.0, 0.4, 0.6);
  const PlaneMap map(kCells, px);
  Eigen::Matrix2Xd uv(2, 3);
  uv << 0.0, 4.3, 10.0, 0.0, 7.9, 10.0;
  const Eigen::Matrix2Xd expected = test::mapPoints(uv, kCells, px);
  for (Eigen::Index k = 0; k < uv.cols(); ++k) {
    EXPECT_THAT(map.pixelOf(uv.col(k)), test::IsNear(expected.col(k).eval(), kTolerance));
    EXPECT_THAT(map.cellOf(expected.col(k)), test::IsNear(uv.col(k).eval(), kTolerance));
  }
}

TEST(PlaneMap, DerivativesMatchCentralDifferences) {
  constexpr double kStep = 1e-5;       // truncation 1e-10, rounding 1e-9
  constexpr double kTolerance = 1e-6;  // [px], of derivatives of up to 1000 px
  const TagCorners px = test::tiltedSquare({100.0, 90.0}, 80.0, 0.4, 0.6);
  const PlaneMap map(kCells, px);
  const Eigen::Vector2d at = map.pixelOf({3.2, 6.1});
  const Eigen::Matrix<double, 8, 8> J = map.cornersByMotion();
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(k);
    const Eigen::Vector2d numeric = (map.cellOf(at + step) - map.cellOf(at - step)) / (2.0 * kStep);
    EXPECT_THAT(map.cellsPerPixel({3.2, 6.1}, at).col(k), test::IsNear(numeric, kTolerance));
  }
  for (int k = 0; k < 8; ++k) {
    const auto corners = [&](double m) {
      Eigen::Matrix<double, 8, 1> motion = m * Eigen::Matrix<double, 8, 1>::Unit(k);
      TagCorners moved;
      for (int corner = 0; corner < 4; ++corner) {
        const Eigen::Vector2d uv = kCells.col(corner);
        const double stretch = motion.tail<2>().dot(uv);
        moved.col(corner) = map.pixelOf({uv.x() + motion(0) + motion.segment<2>(1).dot(uv) + uv.x() * stretch,
                                         uv.y() + motion(3) + motion.segment<2>(4).dot(uv) + uv.y() * stretch});
      }
      return moved;
    };
    const TagCorners numeric = (corners(kStep) - corners(-kStep)) / (2.0 * kStep);
    EXPECT_THAT(J.col(k), test::IsNear(numeric.reshaped().eval(), kTolerance)) << k;
  }
}

}  // namespace
}  // namespace poecal
