#include "poecal/camera/camera.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <opencv2/calib3d.hpp>

#include "camera/camera_examples.hpp"
#include "poecal/core/error.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

using test::IsNear;

/// OpenCV's pixel and its derivatives by the point (through the translation vector) and by fx fy cx cy and the coefficients.
struct Reference {
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, 3> J_px_p;
  Eigen::MatrixXd J_px_parameters;
};

Reference opencv(const Camera& camera, const Eigen::Vector3d& p) {
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const std::vector<double> k(camera.distortion.data(), camera.distortion.data() + camera.distortion.size());
  const std::vector<cv::Point3d> origin{{0, 0, 0}};
  const cv::Vec3d translation(p.x(), p.y(), p.z());
  std::vector<cv::Point2d> px;
  cv::Mat J;
  const bool fisheye = camera.model == DistortionModel::kEquidistant;
  if (fisheye) {
    cv::fisheye::projectPoints(origin, px, cv::Vec3d(), translation, K, k, 0, J);
  } else {
    cv::projectPoints(origin, cv::Vec3d(), translation, K, k, px, J);
  }
  // projectPoints: rotation 3, translation 3, f 2, c 2, k; fisheye: f 2, c 2, k 4, rotation 3, translation 3, skew.
  const int count = static_cast<int>(k.size()), p_column = fisheye ? 11 : 3, parameter_column = fisheye ? 0 : 6;
  Reference reference;
  reference.px << px[0].x, px[0].y;
  reference.J_px_parameters.resize(2, 4 + count);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) reference.J_px_p(row, column) = J.at<double>(row, p_column + column);
    for (int column = 0; column < 4 + count; ++column) {
      reference.J_px_parameters(row, column) = J.at<double>(row, parameter_column + column);
    }
  }
  return reference;
}

/// A point up to 1.2 times as far from the axis as the picture's corner, 0.3 to 3 m away.
Eigen::Vector3d pointInView(Rng& rng, const Camera& camera) {
  const double depth = rng.uniform(0.3, 3.0);
  const double reach = camera.model == DistortionModel::kEquidistant ? 2.0 : 0.8;
  return depth * Eigen::Vector3d(rng.uniform(-reach, reach), rng.uniform(-reach, reach), 1.0);
}

TEST(Camera, ProjectsAsOpenCvWithItsDerivatives) {
  Rng rng = test::rngOfThisTest();
  for (const Camera& camera : test::exampleCameras()) {
    for (int trial = 0; trial < 50; ++trial) {
      const Eigen::Vector3d p = pointInView(rng, camera);
      const auto ours = projectWithJacobians(camera, p);
      ASSERT_TRUE(ours) << distortionModelName(camera.model) << " " << p.transpose();
      const Reference reference = opencv(camera, p);
      // Two formulas of doubles for some hundred pixels: 1e-10 is a thousand roundings; derivatives by k reach 1e4.
      EXPECT_THAT(ours->px, IsNear(reference.px, 1e-10));
      EXPECT_THAT(ours->J_px_p, IsNear(reference.J_px_p, 1e-8));
      EXPECT_THAT(ours->J_px_parameters, IsNear(reference.J_px_parameters, 1e-8));
      EXPECT_EQ(*project(camera, p), ours->px);
    }
  }
}

TEST(Camera, DerivativesMatchCentralDifferences) {
  constexpr double kStep = 1e-6;       // truncation ~ 1e-12 of the third derivative, rounding ~ 1e-10 / 1e-6 relative to 1e3 px
  constexpr double kTolerance = 1e-5;  // px per unit, for derivatives up to 1e4
  Rng rng = test::rngOfThisTest();
  for (const Camera& camera : test::exampleCameras()) {
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::Vector3d p = pointInView(rng, camera);
      const auto analytic = projectWithJacobians(camera, p);
      ASSERT_TRUE(analytic);
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
        const Eigen::Vector2d numeric = (*project(camera, p + step) - *project(camera, p - step)) / (2.0 * kStep);
        EXPECT_THAT(analytic->J_px_p.col(k), IsNear(numeric, kTolerance)) << distortionModelName(camera.model) << " axis " << k;
      }
      for (int k = 0; k < camera.parameterCount(); ++k) {
        const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(camera.parameterCount(), k);
        Camera more = camera, less = camera;
        more.setParameters(camera.parameters() + step);
        less.setParameters(camera.parameters() - step);
        const Eigen::Vector2d numeric = (*project(more, p) - *project(less, p)) / (2.0 * kStep);
        EXPECT_THAT(analytic->J_px_parameters.col(k), IsNear(numeric, kTolerance)) << camera.parameterNames()[static_cast<std::size_t>(k)];
      }
    }
  }
}

TEST(Camera, EquidistantReachesBehindTheImagePlane) {
  const Camera camera = test::equidistantCamera();
  constexpr double kStep = 1e-6;
  for (const double degrees : {80.0, 89.999, 90.0, 100.0}) {
    const double angle = degrees * M_PI / 180.0;
    const Eigen::Vector3d p = 2.0 * Eigen::Vector3d(0.6 * std::sin(angle), -0.8 * std::sin(angle), std::cos(angle));
    const auto at = projectWithJacobians(camera, p);
    ASSERT_TRUE(at) << degrees;
    const double s = angle * angle;
    const double bent = angle * (1.0 - 0.013 * s + 0.021 * s * s - 0.012 * s * s * s + 0.0021 * s * s * s * s);
    EXPECT_THAT(at->px, IsNear(Eigen::Vector2d(190.0 * 0.6 * bent + 325.25, 191.0 * -0.8 * bent + 236.5), 1e-10)) << degrees;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      EXPECT_THAT(at->J_px_p.col(k),
                  IsNear(Eigen::Vector2d((*project(camera, p + step) - *project(camera, p - step)) / (2.0 * kStep)), 1e-6));
    }
  }
}

TEST(Camera, DerivativesStayFiniteOnTheAxis) {
  for (const Camera& camera : test::exampleCameras()) {
    // Near the axis every model is a pinhole: J = diag(f) [1/z 0 -x/z^2; 0 1/z -y/z^2] up to terms of (r/z)^2.
    for (const double x : {0.0, 1e-300, 1e-12, 1e-6}) {
      const auto at = projectWithJacobians(camera, Eigen::Vector3d(x, 0.0, 2.0));
      ASSERT_TRUE(at);
      Eigen::Matrix<double, 2, 3> pinhole;
      pinhole << camera.fx / 2.0, 0.0, -camera.fx * x / 4.0, 0.0, camera.fy / 2.0, 0.0;
      EXPECT_THAT(at->J_px_p, IsNear(pinhole, 1e-5)) << distortionModelName(camera.model) << " x = " << x;  // p1, p2 times 1e-6
      EXPECT_TRUE(at->J_px_parameters.allFinite());
    }
  }
}

TEST(Camera, UnprojectInvertsProjectOverThePicture) {
  for (const Camera& camera : test::exampleCameras()) {
    for (int v = 0; v < camera.height; v += 40) {
      for (int u = 0; u < camera.width; u += 40) {
        const Eigen::Vector2d px(u, v);
        const auto ray = unproject(camera, px);
        ASSERT_TRUE(ray) << distortionModelName(camera.model) << " " << px.transpose();
        EXPECT_NEAR(ray->norm(), 1.0, 1e-14);
        const auto back = project(camera, *ray);
        ASSERT_TRUE(back);
        EXPECT_THAT(*back, IsNear(px, 1e-9));
      }
    }
  }
}

TEST(Camera, UnprojectOfTheCentreIsTheAxis) {
  for (const Camera& camera : test::exampleCameras()) {
    EXPECT_THAT(*unproject(camera, Eigen::Vector2d(camera.cx, camera.cy)), IsNear(Eigen::Vector3d::UnitZ(), 1e-15));
  }
}

TEST(Camera, PixelsThatNoRayReachesHaveNone) {
  // k1 = -1/3: r_d = r - r^3 / 3 turns at r = 1, where r_d = 2/3.
  Camera camera = test::makeCamera(DistortionModel::kPlumbBob, {-1.0 / 3.0, 0.0, 0.0, 0.0, 0.0});
  const double edge = camera.fx * 2.0 / 3.0;
  EXPECT_TRUE(unproject(camera, {camera.cx + 0.999 * edge, camera.cy}));
  EXPECT_FALSE(unproject(camera, {camera.cx + 1.001 * edge, camera.cy}));
  EXPECT_FALSE(unproject(camera, {std::numeric_limits<double>::quiet_NaN(), 0.0}));
  EXPECT_FALSE(unproject(camera, {std::numeric_limits<double>::infinity(), 0.0}));
}

TEST(Camera, EveryModelIsInTheTableWithItsNames) {
  std::set<std::string> names;
  for (const DistortionModel model : kDistortionModels) {
    EXPECT_TRUE(names.insert(distortionModelName(model)).second) << distortionModelName(model);
    EXPECT_EQ(findDistortionModel(distortionModelName(model)), model);
    const Camera camera = test::makeCamera(model, std::vector<double>(static_cast<std::size_t>(distortionCount(model)), 0.0));
    EXPECT_EQ(camera.parameterNames().size(), static_cast<std::size_t>(camera.parameterCount()));
    EXPECT_LE(camera.parameterCount(), Camera::kMaxParameters);
  }
  EXPECT_EQ(test::exampleCameras().size(), names.size());
}

TEST(Camera, MissingCoefficientsAreZero) {
  const Eigen::Vector3d p(0.3, -0.2, 1.0);
  for (const DistortionModel model : kDistortionModels) {
    Camera full = test::makeCamera(model, std::vector<double>(static_cast<std::size_t>(distortionCount(model)), 0.0));
    full.distortion(0) = -0.2;
    const Camera brief = test::makeCamera(model, {-0.2});
    EXPECT_EQ(*project(brief, p), *project(full, p));
    EXPECT_EQ(projectWithJacobians(brief, p)->J_px_parameters.cols(), 5);
    EXPECT_TRUE(unproject(brief, {100.0, 100.0}));
    EXPECT_TRUE(project(test::makeCamera(model, {}), p));
  }
}

TEST(Camera, ParametersAndTheirNames) {
  Camera camera = test::rationalCamera();
  EXPECT_THAT(camera.parameterNames(), testing::ElementsAre("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"));
  EXPECT_THAT(test::equidistantCamera().parameterNames(), testing::ElementsAre("fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"));
  const Eigen::VectorXd changed = camera.parameters() + Eigen::VectorXd::Ones(12);
  camera.setParameters(changed);
  EXPECT_EQ(camera.parameters(), changed);
  EXPECT_THROW(camera.setParameters(Eigen::VectorXd::Zero(9)), InvalidArgument);
}

}  // namespace
}  // namespace poecal
