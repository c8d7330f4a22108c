// rational_polynomial: plumb_bob with a denominator of three terms.
#include "camera/lens_model.hpp"

namespace poecal {
namespace {

// Numerator and denominator of a real lens are large and nearly alike.
constexpr Coefficient kCoefficients[] = {{"k1", 10.0}, {"k2", 10.0}, {"p1", 0.1},  {"p2", 0.1},
                                         {"k3", 10.0}, {"k4", 10.0}, {"k5", 10.0}, {"k6", 10.0}};

}  // namespace

constinit const LensModel kRationalPolynomialLens{DistortionModel::kRationalPolynomial, "rational_polynomial", kCoefficients,
                                                  distortPinhole, rayOfRadiusPinhole};

}  // namespace poecal
