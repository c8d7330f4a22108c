// The catalogue: every kind of effect, what it is, how to make one, and which of them a capture can tell of.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"
#include "poecal/effects/effect.hpp"

namespace poecal {

/// The effect that stands for what nobody listed.
inline constexpr const char* kUnknownEffect = "unknown";

/// What the samples or the cell must have for an effect to be testable.
enum class Need { kJoints, kDir, kDq, kStamp, kTemperature, kRevolute, kTags, kSeveralTags, kTangential, kCamera, kMasses };

/// How far into the cell a kind of effect reaches.
enum class Reach {
  kJoint,   ///< the angle of its own joint alone
  kPose,    ///< joints, links, base, mount and grip: what T_camera_target follows
  kPicture  ///< points, pixels and intrinsics too
};

/// A kind of effect. Adding one: a file under src/effects/, a row in kinds.hpp.
struct EffectKind {
  std::string name;
  PlaceKind place = PlaceKind::kJoint;
  /// The effect disturbs nothing beyond this. kPicture is right for any kind; a smaller reach saves work.
  Reach reach = Reach::kPicture;
  /// Names as in model.yaml, with K for the place's number and J for another joint's; the first is the default.
  std::vector<std::string> drivers;         ///< empty: whatever the spec says
  std::vector<EffectParameter> parameters;  ///< units of a turning joint; "/t": "/h" where stamps drive it, "/K" where the temperature does
  std::vector<Need> needs;
  std::string meaning;  ///< one line
  std::string formula;
  std::vector<std::string> confused_with;  ///< names of kinds
  std::string separate;                    ///< what tells it from those
  std::string remedy;                      ///< what to do about it at a real cell

  /// Adds amount * d(disturbance)/d(parameter i).
  using AddDerivative = void (*)(const Effect&, Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext&, double amount,
                                 Disturbance&);
  /// Adds a random draw.
  using AddDraw = void (*)(const Effect&, const Eigen::VectorXd& parameters, const SampleContext&, Disturbance&);
  AddDerivative add_derivative = nullptr;  ///< nullptr: adds nothing
  AddDraw add_draw = nullptr;              ///< nullptr: not random
  /// Adds what all parameters of an effect by masses do together, which costs as much as one of them; nullptr: each adds its own.
  using AddByMasses = void (*)(const Effect&, const Eigen::VectorXd& parameters, const SampleContext&, Disturbance&);
  AddByMasses add_by_masses = nullptr;

  /// Where the parameters depend on which are given (a curve has as many as it has waves): in place of `parameters`.
  using ParametersOf = std::vector<EffectParameter> (*)(const Driver& driver, const std::map<std::string, double>& given);
  ParametersOf parameters_of = nullptr;

  /// It is a compliance times the load of gravity; see Effect::byMasses.
  bool yields_to_gravity = false;
  /// It turns about one of the arm's axes, or goes with the distance between two.
  bool stands_on_axes = false;
  /// It moves single points or pixels, so that pictures cannot be drawn by moving the target or changing the lens.
  bool moves_points = false;
  /// What it adds goes with gravity's load on the arm.
  bool takesLoad() const;
  /// What it adds depends on where the arm's axes are: it stands on them, or they are the load's lever arms.
  bool followsAxes() const { return stands_on_axes || takesLoad(); }
  /// "joint:K", "camera.lens", ...
  std::string placePattern() const;
  /// Index of its parameter of that role; nothing where it has none.
  std::optional<std::size_t> parameterOf(ParameterRole role) const;
};

/// All kinds, in the order of their table in calib_data/FORMATS.md.
const std::vector<EffectKind>& effectKinds();
/// nullptr where there is none of that name.
const EffectKind* findEffectKind(const std::string& name);
/// @throws InvalidArgument with the names that there are.
const EffectKind& effectKind(const std::string& name);

/// The instance that a spec names, with its values: parameters that the spec leaves out are 0. Beside those of effectKinds there is
/// `unknown`, the curve that a diagnosis found where no listed effect serves.
/// @throws InvalidArgument: unknown effect, location, driver or parameter (with those that there are); a scanned or fixed parameter
/// left out; a joint that the cell does not have.
AppliedEffect makeEffect(const EffectSpec& spec, const Cell& cell);

/// Why an effect cannot be tested with these samples ("no dq1.. columns"); empty where it can.
std::string whyNotTestable(const Effect& effect, const Cell& cell, const Target& target, const std::vector<Sample>& samples);

/// What effects do to each sample of a capture; points are those of the target.
/// @param at_random  with the draws of the random ones, as the simulator wants. @param other_columns  names of the samples' further
/// columns.
/// @throws InsufficientData: an effect is driven by what some sample lacks.
std::vector<Disturbance> disturbancesOf(const std::vector<AppliedEffect>& effects, const Cell& cell, const Target& target,
                                        const Eigen::Vector3d& gravity, const std::vector<Sample>& samples, bool at_random = false,
                                        const std::vector<std::string>& other_columns = {});

/// An instance that cannot be tested, and why.
struct NotTestable {
  std::string effect, location, why;
};

/// Every instance that a cell can have: one per joint or link, driver, source joint and tag.
struct Candidates {
  std::vector<Effect> effects;
  std::vector<NotTestable> not_testable;
};
Candidates candidateEffects(const Cell& cell, const Target& target, const std::vector<Sample>& samples);

}  // namespace poecal
