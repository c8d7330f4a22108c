// Corrected DH parameters against the product of exponentials.
#include "poecal/exporting/dh.hpp"

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/robot/robot_file.hpp"
#include "support/arms.hpp"
#include "support/matchers.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kSame = 1e-12;  // products of seven poses of metres, each rounded

/// A row of a data sheet's table.
struct Stated {
  double a, alpha, d, theta;
};

/// An arm of turning joints from a data sheet's DH table, by its own product of matrices.
Arm armOf(const std::vector<Stated>& rows) {
  Arm arm;
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  for (const Stated& row : rows) {
    arm.joints.push_back(Joint::revolute("joint_" + std::to_string(arm.joints.size() + 1), T.block<3, 1>(0, 2), T.block<3, 1>(0, 3)));
    const double ct = std::cos(row.theta), st = std::sin(row.theta), ca = std::cos(row.alpha), sa = std::sin(row.alpha);
    Eigen::Matrix4d A;
    A << ct, -st * ca, st * sa, row.a * ct, st, ct * ca, -ct * sa, row.a * st, 0, sa, ca, row.d, 0, 0, 0, 1;
    T = T * A;
  }
  Eigen::Isometry3d T_base_flange;
  T_base_flange.matrix() = T;
  arm.gamma = logSe3(T_base_flange);
  return arm;
}

constexpr double kRight = 1.5707963267948966;
/// Puma 560 and UR5, as Corke's and the maker's tables have them.
const std::vector<Stated> kPuma{{0, kRight, 0, 0},      {0.4318, 0, 0, 0},  {0.0203, -kRight, 0.15005, 0},
                                {0, kRight, 0.4318, 0}, {0, -kRight, 0, 0}, {0, 0, 0, 0}};
const std::vector<Stated> kUr5{{0, kRight, 0.089159, 0}, {-0.425, 0, 0, 0},        {-0.39225, 0, 0, 0},
                               {0, kRight, 0.10915, 0},  {0, -kRight, 0.09465, 0}, {0, 0, 0.0823, 0}};

void expectSameArm(const DhTable& table, const Arm& arm, Rng& rng) {
  for (int k = 0; k < 10; ++k) {
    const Eigen::VectorXd q = test::uniformVector(rng, arm.jointCount(), 3.0);
    EXPECT_THAT(dhForward(table, arm, q), test::PoseIsNear(forwardKinematics(arm, q), kSame));
  }
}

class DhOf : public ::testing::TestWithParam<const char*> {};

TEST_P(DhOf, AnyArmReachesTheSamePoses) {
  Rng rng = test::rngOfThisTest();
  const Arm nominal = test::randomArm(rng, GetParam());
  const Arm calibrated = displaceTwists(nominal, test::uniformVector(rng, twistParameterCount(nominal), 2e-3));
  const DhTables tables = dhTables(nominal, calibrated);
  expectSameArm(tables.nominal, nominal, rng);
  expectSameArm(tables.calibrated, calibrated, rng);
}

INSTANTIATE_TEST_SUITE_P(All, DhOf, ::testing::Values("RRRRRR", "RRRRRRR", "RRPRRR", "PPPRRR", "RP", "R"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST(Dh, ThePumaHasItsOwnTable) {
  Rng rng(1);
  const Arm nominal = armOf(kPuma);
  const Arm calibrated = displaceTwists(nominal, test::uniformVector(rng, twistParameterCount(nominal), 1e-3));
  const DhTables tables = dhTables(nominal, calibrated);
  EXPECT_TRUE(tables.nominal.plain());
  expectSameArm(tables.calibrated, calibrated, rng);
  for (std::size_t k = 0; k < kPuma.size(); ++k) {
    const DhRow& row = tables.nominal.rows[k];
    EXPECT_EQ(row.rule, k == 1 ? DhRule::kHayati : DhRule::kDh) << k;  // of its axes 2 and 3 alone are parallel
    EXPECT_NEAR(row.a, kPuma[k].a, kSame) << k;
    EXPECT_NEAR(row.alpha, kPuma[k].alpha, kSame) << k;
    EXPECT_NEAR(row.d, kPuma[k].d, kSame) << k;
    EXPECT_NEAR(row.theta, kPuma[k].theta, kSame) << k;
    EXPECT_NEAR(row.beta, 0.0, kSame) << k;
  }
}

TEST(Dh, SmallErrorsOfAxesAreSmallInTheRows) {
  Rng rng(2);
  constexpr double kError = 1e-3;
  for (const auto& table : {kPuma, kUr5}) {
    const Arm nominal = armOf(table);
    const Arm calibrated = displaceTwists(nominal, test::uniformVector(rng, twistParameterCount(nominal), kError));
    const DhTables tables = dhTables(nominal, calibrated);
    expectSameArm(tables.calibrated, calibrated, rng);
    for (std::size_t k = 0; k < table.size(); ++k) {
      const DhRow &from = tables.nominal.rows[k], &to = tables.calibrated.rows[k];
      // An axis that tilts by an angle moves by that angle times a metre at most; links of 0.4 m turn a shift into an angle 2.5 times as
      // large. By the common normal alone, rows of parallel axes would jump by metres.
      for (const double change :
           {to.a - from.a, to.alpha - from.alpha, to.d - from.d, std::remainder(to.theta - from.theta, 2 * M_PI), to.beta - from.beta}) {
        EXPECT_LT(std::abs(change), 20.0 * kError) << k;
      }
      if (to.rule == DhRule::kDh) {
        EXPECT_EQ(to.beta, 0.0);
      } else {
        EXPECT_EQ(to.d, 0.0);
      }
    }
  }
}

TEST(Dh, AnArmThatStandsAsideNeedsABase) {
  Rng rng(3);
  const Arm arm = test::randomArm(rng, "RRRRRR");
  EXPECT_FALSE(dhTables(arm, arm).nominal.plain());
}

TEST(Dh, AnotherArmIsRefused) {
  Rng rng(4);
  EXPECT_THAT([&] { dhTables(test::randomArm(rng, "RRR"), test::randomArm(rng, "RPR")); },
              ThrowsMessage<InvalidArgument>(HasSubstr("not the nominal one")));
}

}  // namespace
}  // namespace poecal
