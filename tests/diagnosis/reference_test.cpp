// Tags in view that never move: whether a camera that moved is told from a base that moved, and from joints.
#include <gmock/gmock.h>

#include "diagnosis/reference_sight.hpp"
#include "diagnosis/small_cell.hpp"
#include "poecal/camera/camera.hpp"
#include "poecal/geometry/se3.hpp"
#include "support/random.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr int kPoses = 60;
constexpr double kSigma = 0.1;   // [px]
constexpr double kSlip = 905.0;  // [s], between two of the poses

using Motion = std::function<Vector6d(const Sample&)>;

Vector6d still(const Sample&) { return Vector6d::Zero(); }

/// A tag on the wall, 1.6 m before the camera, in every picture. @param motion  of the camera's mount.
void addReference(test::SmallCell& small, const Motion& motion, double sigma) {
  Rng rng(77);
  Eigen::Isometry3d T_camera_reference = Eigen::Isometry3d::Identity();
  T_camera_reference.linear() = expSo3({0.2, -0.3, 0.1});
  T_camera_reference.translation() << -0.4, -0.3, 1.6;
  const Target reference = apriltagTarget("tag36h11", {{.id = 40, .size = 0.1}});
  for (Observation& observation : small.observations) {
    const Eigen::Isometry3d T = expSe3(motion(small.samples[observation.sample])) * T_camera_reference;
    for (const TargetPoint& point : reference.points) {
      const Eigen::Vector2d px = *project(*small.cell.camera, T * point.p_target) + sigma * Eigen::Vector2d(rng.normal(), rng.normal());
      observation.reference.push_back({.id = point.id, .p_target = point.p_target, .px = px, .sigma_px = 1.0});
    }
  }
}

const EffectSpec kCameraSlip{"camera_slip", "camera.mount", {{"time", kSlip}, {"rx", 4e-4}, {"ty", 4e-4}}};

Vector6d slipped(const Sample& sample) {
  Vector6d motion = Vector6d::Zero();
  if (*sample.stamp >= kSlip) motion << 4e-4, 0.0, 0.0, 0.0, 4e-4, 0.0;
  return motion;
}

TEST(Reference, ACameraThatSlippedMovesItToo) {
  test::SmallCell small = test::smallCell(2, kPoses, kSigma, {kCameraSlip});
  addReference(small, slipped, kSigma);
  const Diagnosis diagnosis = small.diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  const Finding& found = diagnosis.findings.front();
  EXPECT_EQ(found.effect, "camera_slip");
  EXPECT_THAT(found.reference, HasSubstr("it is the camera that moved"));
  EXPECT_NEAR(found.parameters.at("rx"), 4e-4, 4.0 * found.standard_deviation.at("rx"));
}

TEST(Reference, ABaseThatSlippedLeavesItWhereItWas) {
  test::SmallCell small = test::smallCell(2, kPoses, kSigma, {kCameraSlip});
  addReference(small, still, kSigma);
  const Diagnosis diagnosis = small.diagnosis();
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_EQ(diagnosis.findings.front().effect, "camera_slip");
  EXPECT_THAT(diagnosis.findings.front().reference, HasSubstr("it is the base that moved"));
}

TEST(Reference, ACellWithoutFlawsStaysOne) {
  test::SmallCell small = test::smallCell(1, kPoses, kSigma, {});
  addReference(small, still, kSigma);
  EXPECT_THAT(small.diagnosis().findings, SizeIs(0));
}

/// Tags on a cart, or on the arm: nothing of what they say holds, and the findings are those of a capture without them.
TEST(Reference, ThatWandersIsSaidAndNotUsed) {
  test::SmallCell small = test::smallCell(2, kPoses, kSigma, {kCameraSlip});
  const Diagnosis without = small.diagnosis();
  addReference(small, still, kSigma);
  for (std::size_t k = 0; k < small.observations.size(); ++k) {
    for (CornerMeasurement& corner : small.observations[k].reference) corner.px.x() += 8.0 * static_cast<double>(k);
  }
  const Diagnosis diagnosis = small.diagnosis();
  EXPECT_THAT(diagnosis.warnings, ::testing::Contains(HasSubstr("it does not stand still beside the arm, and is not used")));
  ASSERT_THAT(diagnosis.findings, SizeIs(without.findings.size()));
  for (std::size_t k = 0; k < without.findings.size(); ++k) {
    EXPECT_EQ(diagnosis.findings[k].effect, without.findings[k].effect);
    EXPECT_EQ(diagnosis.findings[k].probability, without.findings[k].probability);
  }
}

/// A small slip of the camera and one of a joint look alike in the target. The reference tells them apart.
TEST(ReferenceStatistics, LeavesNoDoubtOfASmallSlip) {
  const auto motion = [](const Sample& sample) {
    Vector6d turn = Vector6d::Zero();
    if (*sample.stamp >= kSlip) turn(0) = 6e-5;
    return turn;
  };
  double least_without = 1.0, least_with = 1.0;
  for (const std::uint64_t seed : {11, 12, 13, 14}) {
    test::SmallCell small = test::smallCell(seed, kPoses, kSigma, {{"camera_slip", "camera.mount", {{"time", kSlip}, {"rx", 6e-5}}}});
    const auto probability = [&small] {
      const Diagnosis diagnosis = small.diagnosis();
      const bool named = !diagnosis.findings.empty() && diagnosis.findings.front().effect == "camera_slip";
      return named ? diagnosis.findings.front().probability : 0.0;
    };
    least_without = std::min(least_without, probability());
    addReference(small, motion, kSigma);
    least_with = std::min(least_with, probability());
  }
  EXPECT_LT(least_without, 0.9);
  EXPECT_GT(least_with, 0.999);
}

/// Information of the rows against that of the residuals written out with T_camera_reference as six more unknowns.
TEST(Reference, ItsRowsAreThoseOfAFitWithItsPlaceFree) {
  test::SmallCell small = test::smallCell(3, 12, 0.0, {});
  addReference(small, still, 0.0);
  Rng rng(5);
  for (Observation& observation : small.observations) {
    for (CornerMeasurement& corner : observation.reference) corner.px += kSigma * Eigen::Vector2d(rng.normal(), rng.normal());
  }
  const MeasuredCell measured = small.measured();
  const ModelState state = test::nominalState(measured);
  const CaptureRows rows = captureRows(measured, state, {});
  const ReferenceSight sight(measured, state.cell.cell, {}, rows);
  ASSERT_EQ(sight.pictures(), 12u);
  // A motion that is the same in all pictures is one of the reference's place, of which nothing is known.
  Eigen::MatrixXd motions(72, 2);
  for (int k = 0; k < 12; ++k) {
    motions.block<6, 1>(6 * k, 0) << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6;
    motions.block<6, 1>(6 * k, 1) << 0.1 * k, 0.0, 0.0, 0.0, 0.01 * k, 0.0;
  }
  const Eigen::MatrixXd S = sight.information(motions, motions);
  EXPECT_NEAR(S(0, 0), 0.0, 1e-9 * S(1, 1));
  EXPECT_NEAR(S(0, 1), 0.0, 1e-9 * S(1, 1));
  EXPECT_NEAR(sight.score(motions)(0), 0.0, 1e-6 * std::sqrt(S(1, 1)));
  // 12 pictures of six numbers each, six of them in the common place: chi-square of 66, five of its standard deviations.
  EXPECT_NEAR(sight.misfit(), 66.0, 5.0 * std::sqrt(2.0 * 66.0));
}

}  // namespace
}  // namespace poecal
