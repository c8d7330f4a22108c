// What no listed effect explains, as a smooth curve of what drives it: the waves that such a curve is a sum of, and the effect `unknown`
// that a model holds it as.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "effects/angle_wave.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {

/// Value of a driver in one sample: "q3" [rad, m], "tau2" [N m], "stamp" [s], "temperature" [degC], or a further column of the samples by
/// its name; NaN where the sample does not have it.
double driverValue(const Driver& driver, const SampleContext& context);

/// Whether a sample has all that a curve follows: its driver, or each of "q1,q3".
bool hasDriver(const Driver& driver, const SampleContext& context);

/// A curve of a driver between two of its values: sum over j = 1 .. count of c_j cos(pi j x), x = (value - low) / (high - low), which stays
/// as it is at the ends beyond them.
struct CurveRange {
  double low = 0.0, high = 1.0;

  /// The `count` cosines at a value of the driver; zero where that is NaN.
  Eigen::RowVectorXd waves(double value, Eigen::Index count) const;
  /// cos(2 pi f x) and sin(2 pi f x) for each f, which is how often a sway comes and goes over the range; zero where the value is NaN.
  Eigen::RowVectorXd sways(double value, const std::vector<double>& cycles) const;
};

/// A factor of a sway that comes and goes so many times over the range, as its name "rx_cos(5.5)" says it.
struct NamedSway {
  bool sine = false;
  double cycles = 0.0;
  /// cos(2 pi f x) or sin(2 pi f x); zero where the value is NaN.
  double at(const CurveRange& range, double value) const;
};

/// cos(pi i u / width) cos(pi j v / height) of a pixel, for i, j >= 0 and 1 <= i + j <= orders, by i and then j.
Eigen::RowVectorXd pixelWaves(const Eigen::Vector2d& px, const Camera& camera, int orders);
/// i and j of each.
std::vector<std::pair<int, int>> pixelOrders(int orders);

/// What the parameters of a curve are factors of. Names are long to read: once, not at every sample.
struct CurveTerms {
  std::vector<NamedWave> waves;             ///< joint: of each parameter; empty for a curve of one driver
  std::vector<NamedSway> sways;             ///< mount: of each parameter behind the range; empty for a curve
  std::vector<std::pair<int, int>> pixels;  ///< lens: of each two parameters, along u and v
};
CurveTerms curveTermsOf(PlaceKind place, const std::vector<EffectParameter>& parameters);

/// The effect `unknown`: a curve at a joint's reading, the camera's mount, the target's mount (each of their six numbers its own curve),
/// or, driven by the pixel, at the lens (u and v each its own).
/// @param factors  joint: c1, c2, ... [rad, m]; mounts: those of rx, then ry, rz, tx, ty, tz [rad, m]; lens: u and v of each pixel wave
/// [px].
/// @throws InvalidArgument: no such place.
AppliedEffect makeCurve(const Place& place, const Driver& driver, const CurveRange& range, const Eigen::VectorXd& factors,
                        const Cell& cell);

/// The effect `unknown` at a mount as sways, sum of a cos(2 pi f x) + b sin(2 pi f x).
/// @param cycles  f, ascending, each once. @param factors  of rx, then ry, rz, tx, ty, tz: a, b of each f [rad, m].
/// @throws InvalidArgument: no mount.
AppliedEffect makeSway(const Place& place, const Driver& driver, const CurveRange& range, const std::vector<double>& cycles,
                       const Eigen::VectorXd& factors, const Cell& cell);

/// The effect `unknown` at a joint's reading as waves of several angles, sum of a cos(n.q) + b sin(n.q).
/// @param joint  index from 0. @param waves  ascending, each once. @param factors  a, b of each [rad, m]. @throws InvalidArgument: no such
/// joint.
AppliedEffect makeAngleWaves(std::size_t joint, const std::vector<AngleWave>& waves, const Eigen::VectorXd& factors, const Cell& cell);

namespace kinds {

/// The kind `unknown` at a place, nullptr where it cannot be there. It stands in no table of candidates.
const EffectKind* unknownAt(PlaceKind place);

}  // namespace kinds
}  // namespace poecal
