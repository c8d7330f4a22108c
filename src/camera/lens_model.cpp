#include "camera/lens_model.hpp"

#include <cassert>

namespace poecal {
namespace {

constexpr const LensModel* kLensModels[] = {&kPlumbBobLens, &kRationalPolynomialLens, &kEquidistantLens, &kThinPrismLens};

}  // namespace

const LensModel& lensModel(DistortionModel model) {
  for (const LensModel* entry : kLensModels) {
    if (entry->model == model) return *entry;
  }
  assert(false && "a distortion model that is not in the table");
  return kPlumbBobLens;
}

}  // namespace poecal
