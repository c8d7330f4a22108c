// plumb_bob: three radial terms and two tangential ones.
#include "camera/lens_model.hpp"

namespace poecal {
namespace {

constexpr Coefficient kCoefficients[] = {{"k1", 1.0}, {"k2", 1.0}, {"p1", 0.1}, {"p2", 0.1}, {"k3", 1.0}};

}  // namespace

constinit const LensModel kPlumbBobLens{DistortionModel::kPlumbBob, "plumb_bob", kCoefficients, distortPinhole, rayOfRadiusPinhole};

}  // namespace poecal
