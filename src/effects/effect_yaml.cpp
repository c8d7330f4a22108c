#include "effects/effect_yaml.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {
namespace {

AppliedEffect readEffect(const YamlNode& entry, const Cell& cell, bool as_found) {
  if (as_found) {
    entry.checkKeys({"effect", "location", "driver", "parameters", "units", "standard_deviation"});
  } else {
    entry.checkKeys({"effect", "location", "driver", "parameters"});
  }
  EffectSpec spec{.effect = entry["effect"].text(), .location = entry["location"].text(), .parameters = {}, .driver = ""};
  if (const auto driver = entry.find("driver")) spec.driver = driver->text();
  const YamlNode parameters = entry["parameters"];
  for (const std::string& name : parameters.keys()) spec.parameters[name] = parameters[name.c_str()].number();
  try {
    AppliedEffect applied = makeEffect(spec, cell);
    if (const auto deviations = as_found ? entry.find("standard_deviation") : std::nullopt) {
      applied.standard_deviation = Eigen::VectorXd::Constant(applied.parameters.size(), std::numeric_limits<double>::quiet_NaN());
      for (const std::string& name : deviations->keys()) {
        applied.standard_deviation(applied.effect.parameterIndex(name)) = (*deviations)[name.c_str()].number();
      }
    }
    return applied;
  } catch (const InvalidArgument& error) {
    entry.fail(error.what());
  }
}

/// Those that are numbers; NaN stands for what was left out.
std::string namedNumbers(const Effect& effect, const Eigen::VectorXd& values) {
  std::vector<std::string> pairs;
  for (std::size_t i = 0; i < effect.parameters().size(); ++i) {
    const double value = values(static_cast<Eigen::Index>(i));
    if (!std::isnan(value)) pairs.push_back(fmt::format("{}: {}", effect.parameters()[i].name, formatNumber(value)));
  }
  return fmt::format("{{{}}}", fmt::join(pairs, ", "));
}

std::string namedUnits(const Effect& effect) {
  std::vector<std::string> pairs;
  for (const EffectParameter& parameter : effect.parameters()) {
    pairs.push_back(fmt::format("{}: {}", parameter.name, yamlText(parameter.unit)));
  }
  return fmt::format("{{{}}}", fmt::join(pairs, ", "));
}

}  // namespace

std::vector<AppliedEffect> readEffects(const YamlNode& list, const Cell& cell, bool as_found) {
  std::vector<AppliedEffect> effects;
  for (const YamlNode& entry : list.items()) effects.push_back(readEffect(entry, cell, as_found));
  return effects;
}

std::string effectsYaml(const std::vector<AppliedEffect>& effects) {
  if (effects.empty()) return "effects: []\n";
  std::string text = "effects:\n";
  for (const AppliedEffect& applied : effects) {
    const Effect& effect = applied.effect;
    text += fmt::format("- {{effect: {}, location: {}, driver: {}, parameters: {}, units: {}", effect.name(), yamlText(effect.location()),
                        yamlText(effect.driver().name()), namedNumbers(effect, applied.parameters), namedUnits(effect));
    if (applied.standard_deviation.size() > 0) text += ", standard_deviation: " + namedNumbers(effect, applied.standard_deviation);
    text += "}\n";
  }
  return text;
}

}  // namespace poecal
