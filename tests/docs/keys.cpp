#include "docs/keys.hpp"

#include <yaml-cpp/yaml.h>

#include "poecal/core/csv.hpp"

namespace poecal::test {
namespace {

void addKeys(const YAML::Node& node, const std::string& prefix, std::set<std::string>& keys) {
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) {
      if (!item.IsScalar()) addKeys(item, prefix + "[]", keys);
    }
  }
  if (!node.IsMap()) return;
  const bool of_an_effect = node["effect"] && node["parameters"];
  for (const auto& entry : node) {
    const std::string name = entry.first.as<std::string>();
    const std::string key = prefix.empty() ? name : prefix + "." + name;
    keys.insert(key);
    const bool by_parameter = name == "parameters" || name == "units" || name == "standard_deviation";
    if (!(of_an_effect && by_parameter)) addKeys(entry.second, key, keys);
  }
}

}  // namespace

std::set<std::string> keysOf(const std::filesystem::path& file) {
  if (file.extension() == ".csv") {
    const CsvTable table = CsvTable::read(file);
    return {table.header().begin(), table.header().end()};
  }
  std::set<std::string> keys;
  addKeys(YAML::LoadFile(file.string()), "", keys);
  return keys;
}

std::string lastPart(const std::string& key) { return key.substr(key.find_last_of('.') + 1); }

}  // namespace poecal::test
