// The curve of each finding, and what is left of it before and after it enters the model.
#include <cmath>
#include <limits>

#include "effects/curve.hpp"
#include "poecal/effects/catalogue.hpp"
#include "report/numbers.hpp"
#include "report/sections.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Value of a finding's driver; of several the first.
double valueOf(const std::string& drivers, const Effect& effect, const SampleContext& context) {
  const Driver driver(drivers.substr(0, drivers.find(',')));
  const auto number = static_cast<Eigen::Index>(effect.index());
  switch (driver.kind()) {
    case DriverKind::kDirection: {
      const auto k = static_cast<Eigen::Index>(driver.joint());
      return k < context.sample.dir.size() ? context.sample.dir(k) : kNone;
    }
    case DriverKind::kGravity:
      if (effect.place().kind == PlaceKind::kBase) return context.base_moment.norm();
      return number < context.torque.size() ? context.torque(number) : kNone;
    case DriverKind::kPixel:
    case DriverKind::kNone:
    case DriverKind::kVelocity:
      return static_cast<double>(context.number);
    default:
      return driverValue(driver, context);
  }
}

/// What one finding does to one sample, and what the models without and with it leave there.
struct CurvePoint {
  double curve = 0.0, before = kNone, after = kNone;
};

/// At a joint: its angle or shift [mrad, mm]. Residuals are then the error of this joint that comes nearest to them.
CurvePoint atJoint(std::size_t joint, const Disturbance& disturbance, const Eigen::VectorXd& joint_errors) {
  const auto k = static_cast<Eigen::Index>(joint);
  CurvePoint point;
  point.curve = 1e3 * disturbance.joints(k);
  point.after = 1e3 * joint_errors(k);
  point.before = point.after + point.curve;
  return point;
}

/// Elsewhere: root mean square of the measured numbers' motion [px] or [mm], and the part of the residuals along it.
CurvePoint alongMotion(const Observation& observation, const Eigen::VectorXd& motion, const Eigen::VectorXd& r) {
  const Eigen::Index first = observation.pose && !observation.pose->position_only ? 3 : 0;
  const Eigen::VectorXd s = motion.tail(motion.size() - first);
  const Eigen::VectorXd known = r.tail(r.size() - first).array().isFinite().select(r.tail(r.size() - first), 0.0);
  const double unit = observation.pose ? 1e3 : 1.0 / std::sqrt(std::max<double>(1.0, 0.5 * static_cast<double>(s.size())));
  CurvePoint point;
  const double length = s.norm();
  point.curve = unit * length;
  if (length > 0.0) {
    point.after = unit * known.dot(s) / length;
    point.before = point.after + point.curve;
  }
  return point;
}

/// The effects of the model that a finding stands for: by unknown masses it may be two.
std::vector<AppliedEffect> effectsOf(const Finding& finding, const Model& model) {
  std::vector<AppliedEffect> effects;
  for (const AppliedEffect& one : model.effects) {
    const bool same = one.effect.name() == finding.effect && one.effect.location() == finding.location;
    if (same && one.effect.driver().name() == finding.driver) effects.push_back(one);
  }
  return effects;
}

Json curveJson(const ReportSource& source, const Finding& finding) {
  const Model& model = source.calibration.diagnosis->model;
  const std::vector<AppliedEffect> effects = effectsOf(finding, model);
  const StageAt& all = source.at.back();
  if (effects.empty()) return nullptr;
  const Measurements& measured = source.measurements;
  const std::vector<Disturbance> disturbances =
      disturbancesOf(effects, model.cell, measured.target, measured.gravity, measured.samples, false, measured.other_columns);
  const bool joint = finding.location.starts_with("joint:");
  const std::size_t index = effects.front().effect.index();
  const bool random = effects.front().effect.kind().add_draw != nullptr;
  bool at_joint = joint && random;
  for (const Disturbance& each : disturbances) {
    at_joint = at_joint || (joint && each.joints.size() > 0 && each.joints(static_cast<Eigen::Index>(index)) != 0.0);
  }
  Eigen::VectorXd x(source.shown.size()), before(x.size()), after(x.size()), curve(x.size());
  for (std::size_t number = 0; number < source.shown.size(); ++number) {
    const Observation& observation = measured.observations[source.shown[number]];
    const Sample& sample = measured.samples[observation.sample];
    const MeasuredMotion motion(model.cell, sample, observation, measured.target);
    const Eigen::VectorXd r = all.residual(observation);
    const Disturbance& disturbance = disturbances[observation.sample];
    CurvePoint point;
    if (at_joint) {
      point = atJoint(index, disturbance, motion.jointErrors(r));
    } else {
      point = alongMotion(observation, motion.along(disturbance), r);
    }
    // What nobody can foretell is as large with it in the model as without.
    if (random) point.before = kNone;
    const auto row = static_cast<Eigen::Index>(number);
    x(row) = valueOf(finding.driver, effects.front().effect, source.contexts[number]);
    before(row) = point.before;
    after(row) = point.after;
    curve(row) = point.curve;
  }
  const bool angle = model.cell.arm->joints.at(index).type == JointType::kRevolute;
  const char* unit = at_joint ? (angle ? "mrad" : "mm") : (source.calibration.diagnosis->pixels ? "px" : "mm");
  return {{"quantity", at_joint ? "error of " + finding.location : "motion by the finding"},
          {"unit", unit},
          {"x", roundedList(x, 13)},
          {"before", roundedList(before, 4)},
          {"after", roundedList(after, 4)},
          {"curve", roundedList(curve, 4)}};
}

}  // namespace

nlohmann::ordered_json curvesJson(const ReportSource& source) {
  Json list = Json::array();
  if (!source.calibration.diagnosis) return list;
  for (const Finding& finding : source.calibration.diagnosis->findings) {
    Json json{{"effect", finding.effect}, {"location", finding.location}, {"driver", finding.driver}};
    if (finding.effect != "unknown") {
      const EffectKind& kind = effectKind(finding.effect);
      json["meaning"] = kind.meaning;
      json["formula"] = kind.formula;
    } else {
      json["meaning"] = "structure that no listed effect explains";
      json["formula"] = "";
    }
    json["points"] = curveJson(source, finding);
    list.push_back(json);
  }
  return list;
}

}  // namespace poecal
