#include "poecal/effects/effect.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/core/error.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {

const std::string& Effect::name() const { return kind_->name; }

Place Effect::place() const { return {kind_->place, index_}; }

Eigen::Index Effect::parameterIndex(const std::string& name) const {
  std::vector<std::string> names;
  for (const EffectParameter& parameter : parameters_) {
    if (parameter.name == name) return static_cast<Eigen::Index>(names.size());
    names.push_back(parameter.name);
  }
  throw InvalidArgument(fmt::format("{} has no parameter '{}', expected {}", kind_->name, name, fmt::join(names, ", ")));
}

void Effect::addDerivative(Eigen::Index i, const Eigen::VectorXd& parameters, const SampleContext& context, double amount,
                           Disturbance& disturbance) const {
  if (kind_->add_derivative == nullptr || isFixed(parameters_[static_cast<std::size_t>(i)].role)) return;
  kind_->add_derivative(*this, i, parameters, context, amount, disturbance);
}

void Effect::disturb(const Eigen::VectorXd& parameters, const SampleContext& context, Disturbance& disturbance) const {
  if (by_masses_ && kind_->add_by_masses != nullptr) {
    kind_->add_by_masses(*this, parameters, context, disturbance);
    return;
  }
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    // Only where a parameter is not zero: 0 times an unknown torque would still be NaN.
    if (parameters_[i].role != ParameterRole::kLinear || parameters(index) == 0.0) continue;
    addDerivative(index, parameters, context, parameters(index), disturbance);
  }
}

void Effect::disturbAtRandom(const Eigen::VectorXd& parameters, const SampleContext& context, Disturbance& disturbance) const {
  if (kind_->add_draw != nullptr) kind_->add_draw(*this, parameters, context, disturbance);
}

EffectSpec Effect::spec(const Eigen::VectorXd& parameters) const {
  EffectSpec spec{.effect = name(), .location = location(), .parameters = {}, .driver = driver_.name()};
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const double value = parameters(static_cast<Eigen::Index>(i));
    if (!std::isnan(value)) spec.parameters[parameters_[i].name] = value;
  }
  return spec;
}

Disturbance disturbanceOf(const std::vector<AppliedEffect>& effects, const SampleContext& context, bool at_random) {
  Disturbance disturbance = Disturbance::zero(context.capture->cell, context.points.size());
  for (const AppliedEffect& applied : effects) {
    applied.effect.disturb(applied.parameters, context, disturbance);
    if (at_random) applied.effect.disturbAtRandom(applied.parameters, context, disturbance);
  }
  return disturbance;
}

}  // namespace poecal
