// Rows of a capture against differences of the model itself.
#include "diagnosis/capture_rows.hpp"

#include <set>
#include <string>

#include <gmock/gmock.h>

#include "diagnosis/candidates.hpp"
#include "diagnosis/small_cell.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {
namespace {

using ::testing::IsSupersetOf;

/// Expects the derivatives of all rows by the arm's axes and both transforms to be those that differences show.
void expectDerivatives(const MeasuredCell& measured, const ModelState& state) {
  const CaptureRows rows = captureRows(measured, state, {});
  const ParameterLayout layout(state.cell.cell, measured.free);
  // Central differences of a step h are off by h^2 and by rounding over h, some 1e-9 of a column each; what follows the axes is itself a
  // difference, of one side, by 1e-6.
  constexpr double kStep = 1e-5;
  for (int i = 0; i < layout.pose_parameters; ++i) {
    const auto at = [&](double step) {
      ModelState moved = state;
      moved.cell = state.cell.moved(layout, step * Eigen::VectorXd::Unit(layout.total, i));
      return captureRows(measured, moved, {}).r;
    };
    const Eigen::VectorXd difference = (at(-kStep) - at(kStep)) / (2.0 * kStep);
    EXPECT_LT((rows.J.col(i) - difference).norm(), 1e-5 * difference.norm() + 1e-6) << "parameter " << i;
  }
}

// Thirty times as large as on real cells, so that what an effect does to the derivatives is far beyond rounding.
TEST(CaptureRows, DerivativesKnowWhatTheAxesDoToEffects) {
  const test::SmallCell small = test::smallCell(61, 6, 0.0, {});
  const MeasuredCell measured = small.measured();
  const ModelState nominal = test::nominalState(measured);
  std::set<std::string> kinds;
  for (const Candidate& candidate : allCandidates(measured, nominal).candidates) {
    if (!candidate.known() || candidate.entry().reach == Reach::kPicture) continue;
    // It goes with |tau|, which has a kink where no moment acts on the upright first axis and on the last.
    if (candidate.name == "joint_hysteresis" && (candidate.place.index == 0 || candidate.place.index == 5)) continue;
    SCOPED_TRACE(candidate.answer());
    Eigen::VectorXd parameters = candidate.parameters;
    for (std::size_t k = 0; k < candidate.linear.size(); ++k) {
      parameters(candidate.linear[k]) = 30.0 * candidate.typical(static_cast<Eigen::Index>(k));
    }
    ModelState state = nominal;
    state.effects = {{*candidate.effect, parameters}};
    expectDerivatives(measured, state);
    kinds.insert(candidate.name);
  }
  EXPECT_THAT(kinds, IsSupersetOf({"axis_wobble", "joint_hysteresis", "joint_compliance", "link_bending", "base_compliance"}));
}

// Moments of two links that nearly cancel each other, as a fit of unknown masses finds them: the axes carry their difference.
TEST(CaptureRows, DerivativesKnowWhatTheAxesDoToDeflections) {
  test::SmallCell small = test::smallCell(61, 6, 0.0, {});
  small.cell.arm->links.clear();
  small.nominal.links.clear();
  const MeasuredCell measured = small.measured();
  ModelState state = test::nominalState(measured);
  state.effects = {makeEffect(
      {"base_compliance", "base", {{"m1", 0.0}, {"m2", 8e-3}, {"m3", -7e-3}, {"m4", 0.0}, {"m5", 0.0}, {"m6", 0.0}}}, state.cell.cell)};
  expectDerivatives(measured, state);
}

}  // namespace
}  // namespace poecal
