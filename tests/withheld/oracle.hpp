// The best that any diagnosis can do: a fit that is told which effects there are and how the corners scatter.
#pragma once

#include "withheld/case.hpp"

namespace withheld {

/// Root mean square distance [px] from the true corners of the unseen poses to those that a linear least-squares fit predicts, which starts
/// at the truth, has the case's own noise, and estimates geometry, the sizes of the hidden effects and, where camera.yaml states a
/// deviation, the lens with that as its prior. Wild rows are left out.
double oracleOnUnseen(const Case& made);

}  // namespace withheld
