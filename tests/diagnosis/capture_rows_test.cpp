// Rows of a capture against differences of the model itself.
#include "diagnosis/capture_rows.hpp"

#include <gmock/gmock.h>

#include "diagnosis/small_cell.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {
namespace {

// Moments of two links that nearly cancel each other, as a fit of unknown masses finds them: the axes carry their difference.
TEST(CaptureRows, DerivativesKnowWhatTheAxesDoToDeflections) {
  test::SmallCell small = test::smallCell(61, 6, 0.0, {});
  small.cell.arm->links.clear();
  small.nominal.links.clear();
  const MeasuredCell measured = small.measured();
  ModelState state = test::nominalState(measured);
  state.effects = {makeEffect(
      {"base_compliance", "base", {{"m1", 0.0}, {"m2", 8e-3}, {"m3", -7e-3}, {"m4", 0.0}, {"m5", 0.0}, {"m6", 0.0}}}, state.cell.cell)};
  const CaptureRows rows = captureRows(measured, state, {});
  const ParameterLayout layout(state.cell.cell, measured.free);
  // Central differences of a step h are off by h^2 and by rounding over h, some 1e-9 of a column each.
  constexpr double kStep = 1e-5;
  for (int i = 0; i < layout.twists; ++i) {
    const auto at = [&](double step) {
      ModelState moved = state;
      moved.cell = state.cell.moved(layout, step * Eigen::VectorXd::Unit(layout.total, i));
      return captureRows(measured, moved, {}).r;
    };
    const Eigen::VectorXd difference = (at(-kStep) - at(kStep)) / (2.0 * kStep);
    EXPECT_LT((rows.J.col(i) - difference).norm(), 1e-5 * difference.norm() + 1e-6) << "parameter " << i;
  }
}

}  // namespace
}  // namespace poecal
