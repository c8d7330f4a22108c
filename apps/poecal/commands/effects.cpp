// poecal effects: the catalogue of what a diagnosis can name.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "poecal/core/error.hpp"
#include "poecal/effects/catalogue.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

const char* roleName(ParameterRole role) {
  if (isScanned(role)) return "scanned";
  return isFixed(role) ? "fixed" : "linear";
}

/// "half_gap [rad], typically 0.0002"
std::string parameterText(const EffectParameter& parameter) {
  std::string text = parameter.name;
  if (!parameter.unit.empty()) text += fmt::format(" [{}]", parameter.unit);
  if (parameter.typical > 0.0) text += fmt::format(", typically {}", parameter.typical);
  return text;
}

std::string fullText(const EffectKind& kind) {
  std::string text = fmt::format("{}: {}\n", kind.name, kind.meaning);
  text += fmt::format("  where       {}\n  driven by   {}\n  formula     {}\n", kind.placePattern(), fmt::join(kind.drivers, " or "),
                      kind.formula);
  const char* heading = "parameters";
  for (const EffectParameter& parameter : kind.parameters) {
    text += fmt::format("  {:<11} {}\n", heading, parameterText(parameter));
    heading = "";
  }
  if (!kind.confused_with.empty()) text += fmt::format("  looks like  {}\n", fmt::join(kind.confused_with, ", "));
  text += fmt::format("  told apart  {}\n  at the cell {}\n", kind.separate, kind.remedy);
  return text;
}

std::string listText() {
  std::string text;
  for (const EffectKind& kind : effectKinds()) text += fmt::format("{:<19} {:<14} {}\n", kind.name, kind.placePattern(), kind.meaning);
  return text + "poecal effects NAME tells more about one. /t in a unit means /h if the driver is stamp, /K if it is temperature.\n";
}

nlohmann::json kindJson(const EffectKind& kind) {
  nlohmann::json parameters = nlohmann::json::array();
  for (const EffectParameter& parameter : kind.parameters) {
    parameters.push_back(
        {{"name", parameter.name}, {"unit", parameter.unit}, {"typical", parameter.typical}, {"role", roleName(parameter.role)}});
  }
  return {{"effect", kind.name},
          {"location", kind.placePattern()},
          {"drivers", kind.drivers},
          {"meaning", kind.meaning},
          {"formula", kind.formula},
          {"parameters", parameters},
          {"confused_with", kind.confused_with},
          {"told_apart_by", kind.separate},
          {"remedy", kind.remedy}};
}

int run(const std::string& name, const Common& common) {
  if (name.empty()) {
    nlohmann::json all = nlohmann::json::array();
    for (const EffectKind& kind : effectKinds()) all.push_back(kindJson(kind));
    printSummary(common, listText(), all);
    return 0;
  }
  const EffectKind& kind = effectKind(name);
  printSummary(common, fullText(kind), kindJson(kind));
  return 0;
}

constexpr const char* kExample = R"(
Example:
  $ poecal effects joint_backlash
  joint_backlash: the joint rests on either side of a gap, by where it came from
    where       joint:K
    driven by   dirK
    formula     d_K = half_gap dir_K
    parameters  half_gap [rad], typically 0.0002
    looks like  joint_compliance
    told apart  the same poses reached from both sides
    at the cell come to every pose from the same side, preload or replace the gear
)";

}  // namespace

std::function<int()> setUpEffects(CLI::App& app, const Common& common) {
  const auto name = std::make_shared<std::string>();
  app.add_option("NAME", *name, "One effect; all of them without it");
  app.footer(kExample);
  return [name, &common] { return run(*name, common); };
}

}  // namespace poecal::app
