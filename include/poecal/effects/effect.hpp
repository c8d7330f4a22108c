// An effect: a place, what drives it, and how its few parameters disturb one port of the cell.
//
// The same effect serves the simulator, the diagnosis and the prediction. Each kind is one file under src/effects/.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "poecal/cell/ports.hpp"
#include "poecal/effects/place.hpp"
#include "poecal/effects/sample_context.hpp"

namespace poecal {

/// An effect as a file says it: {effect: joint_backlash, location: joint:3, parameters: {half_gap: 3.0e-4}, driver: dir3}.
struct EffectSpec {
  std::string effect = {};
  std::string location = {};
  std::map<std::string, double> parameters = {};
  std::string driver = {};  ///< empty: the first that the kind has
};

/// What a parameter is: how it enters the disturbance, and where its values come from.
enum class ParameterRole {
  kLinear,     ///< the disturbance is proportional to it: estimated by linear algebra
  kOrder,      ///< scanned: how many times a turn
  kTime,       ///< scanned: when it happened [s]
  kSource,     ///< fixed: number of the joint that leaks
  kTag,        ///< fixed: id of a tag
  kReference,  ///< fixed: value of the driver at which a drift is zero; left out: the capture's first
  kRange,      ///< fixed: end of a curve's driver
  kSpread,     ///< fixed: size of random draws
  kSeed        ///< fixed: of random draws; may be left out
};
/// Not linear, tried over a range.
constexpr bool isScanned(ParameterRole role) { return role == ParameterRole::kOrder || role == ParameterRole::kTime; }
/// Says which instance this is.
constexpr bool isFixed(ParameterRole role) { return role != ParameterRole::kLinear && !isScanned(role); }

struct EffectParameter {
  std::string name;
  std::string unit;      ///< "" for ratios and orders
  double typical = 0.0;  ///< linear: 1 sigma of its size on real cells; of drifts, an EffectKind's is that of one hour
  ParameterRole role = ParameterRole::kLinear;
};

struct EffectKind;
struct CurveTerms;

/// One effect at one place. Made by the catalogue.
class Effect {
 public:
  const std::string& name() const;
  Place place() const;
  /// Its name: "joint:3", "camera.lens", ...
  std::string location() const { return place().name(); }
  /// Index from 0 of the joint or link; 0 where the place has none.
  std::size_t index() const { return index_; }
  const Driver& driver() const { return driver_; }
  /// It depends on loads whose masses are unknown. Its parameters are then compliance times (m, m com) of each body that the place carries,
  /// named m3, mx3, my3, mz3, and `payload`, the compliance as a known payload shows it; of a link once about each axis across its
  /// joint's, m3_a and m3_b. Together they cover all that gravity can do to an arm of any masses.
  bool byMasses() const { return by_masses_; }
  const EffectKind& kind() const { return *kind_; }
  const std::vector<EffectParameter>& parameters() const { return parameters_; }
  /// Values that the instance begins with: its fixed parameters as given, all others 0.
  const Eigen::VectorXd& start() const { return start_; }
  /// What the parameters of `unknown` are factors of, as their names say; nullptr for others.
  const CurveTerms* curveTerms() const { return curve_terms_.get(); }
  /// Index of a parameter. @throws InvalidArgument with the names that there are.
  Eigen::Index parameterIndex(const std::string& name) const;

  /// Adds to `disturbance` what the effect does to a sample: sum over the linear parameters of p_i shape_i. Nothing for the random
  /// effects, which no prediction knows.
  /// @param parameters  one per parameters(). @param disturbance  of full length (Disturbance::zero).
  void disturb(const Eigen::VectorXd& parameters, const SampleContext& context, Disturbance& disturbance) const;

  /// Adds `amount` times d(disturbance)/d(parameter i) at `parameters`. Linear: the shape. Scanned: zero where the disturbance jumps
  /// (time of a slip), else the derivative. Fixed: zero.
  void addDerivative(Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                     Disturbance& disturbance) const;

  /// Adds one draw of a random effect (joint_scatter, bad_samples), always the same for its seed and the sample's number. Nothing for
  /// others.
  void disturbAtRandom(const Eigen::VectorXd& parameters, const SampleContext& context, Disturbance& disturbance) const;

  /// The instance as a file says it; parameters that are NaN (a drift's reference that was left out) are left out.
  EffectSpec spec(const Eigen::VectorXd& parameters) const;

 private:
  friend Effect instantiate(const EffectKind& kind, std::size_t index, const Driver& driver,
                            const std::map<std::string, double>& parameters, const Cell& cell);
  Effect() = default;

  const EffectKind* kind_ = nullptr;
  std::size_t index_ = 0;
  Driver driver_;
  bool by_masses_ = false;
  std::vector<EffectParameter> parameters_;
  Eigen::VectorXd start_;
  std::shared_ptr<const CurveTerms> curve_terms_;
};

/// An effect with values, as scenes and models hold it.
struct AppliedEffect {
  Effect effect;
  Eigen::VectorXd parameters;
  Eigen::VectorXd standard_deviation = {};  ///< of the parameters; NaN for those that were not estimated, empty where none was
};

/// What all effects of a list do to one sample. @param at_random  with the draws of the random ones, as the simulator wants.
Disturbance disturbanceOf(const std::vector<AppliedEffect>& effects, const SampleContext& context, bool at_random = false);

}  // namespace poecal
