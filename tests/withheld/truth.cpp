#include "withheld/truth.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace withheld {
namespace {

nlohmann::json readJson(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return nlohmann::json::parse(in);
}

Named readNamed(const nlohmann::json& json) {
  Named named;
  named.effect = json.at("effect").get<std::string>();
  if (json.contains("location") && json["location"].is_string()) named.location = json["location"].get<std::string>();
  if (json.contains("probability") && json["probability"].is_number()) named.probability = json["probability"].get<double>();
  return named;
}

/// Parameters of a hidden effect as the contract has them.
std::map<std::string, double> contractParameters(const std::string& effect, const nlohmann::json& hidden) {
  auto parameters = hidden.get<std::map<std::string, double>>();
  for (const char* which : {"order", "source", "time", "tag"}) parameters.erase(which);
  // atan2(sin q + b, cos q + a) - q is b cos q - a sin q, to first order in the shift of the disc.
  if (effect == "joint_eccentricity") return {{"sine", -parameters.at("a")}, {"cosine", parameters.at("b")}};
  return parameters;
}

std::map<std::string, double> readNumbers(const nlohmann::json& json) {
  std::map<std::string, double> numbers;
  for (const auto& [name, value] : json.items()) {
    if (value.is_number()) numbers[name] = value.get<double>();
  }
  return numbers;
}

}  // namespace

std::string placeName(const std::string& effect, const std::string& location) { return effect + "@" + location; }

bool TrueEffect::is(const std::string& place) const {
  return place == placeName(effect, location) || std::find(aliases.begin(), aliases.end(), place) != aliases.end();
}

Truth readTruth(const std::filesystem::path& file) {
  const nlohmann::json json = readJson(file);
  Truth truth;
  const std::string path = file.string();
  truth.folder = path.substr(0, path.size() - std::string(".truth.json").size());
  truth.set = json.at("set").get<std::string>();
  truth.recording = json.value("recording", "");
  truth.shots = json.at("shots").get<std::size_t>();
  truth.wild = json.at("wild").get<std::vector<std::string>>();
  truth.silent = json.at("silent").get<std::vector<std::string>>();
  if (json.contains("baselines")) truth.baselines = json["baselines"].get<std::map<std::string, std::vector<std::string>>>();
  if (json.contains("oracle_px")) truth.oracle_px = json["oracle_px"].get<double>();
  for (const nlohmann::json& effect : json.at("effects")) {
    TrueEffect one;
    one.effect = effect.at("effect").get<std::string>();
    one.location = effect.at("location").get<std::string>();
    one.driver = effect.at("driver").get<std::string>();
    one.listed = effect.value("listed", true);
    one.S = effect.at("S").get<double>();
    one.left_by_nearest = effect.at("left_by_nearest").get<double>();
    one.aliases = effect.at("aliases").get<std::vector<std::string>>();
    one.close = effect.at("close").get<std::vector<std::string>>();
    if (one.effect == "target_scale") one.size = effect.at("parameters").at("scale").get<double>();
    one.parameters = contractParameters(one.effect, effect.at("parameters"));
    truth.effects.push_back(one);
  }
  return truth;
}

Answer readAnswer(const std::filesystem::path& file) {
  const nlohmann::json json = readJson(file);
  Answer answer;
  for (const nlohmann::json& item : json.at("findings")) {
    Finding finding;
    static_cast<Named&>(finding) = readNamed(item);
    if (item.contains("driver") && item["driver"].is_string()) finding.driver = item["driver"].get<std::string>();
    if (item.contains("alternatives")) {
      for (const nlohmann::json& other : item["alternatives"]) finding.alternatives.push_back(readNamed(other));
    }
    if (item.contains("parameters") && item["parameters"].contains("scale")) finding.size = item["parameters"]["scale"].get<double>();
    if (item.contains("parameters")) finding.parameters = readNumbers(item["parameters"]);
    if (item.contains("standard_deviation")) finding.deviations = readNumbers(item["standard_deviation"]);
    answer.findings.push_back(finding);
  }
  if (json.contains("not_testable")) {
    for (const nlohmann::json& item : json["not_testable"]) answer.not_testable.push_back(readNamed(item).place());
  }
  const nlohmann::json gap = json.value("gap", nlohmann::json::object());
  if (gap.contains("shrinkage") && gap["shrinkage"].is_number() && gap.contains("shrinkage_ci95") && gap["shrinkage_ci95"].is_array()) {
    answer.shrinkage = gap["shrinkage"].get<double>();
    answer.shrinkage_low = gap["shrinkage_ci95"].at(0).get<double>();
    answer.shrinkage_high = gap["shrinkage_ci95"].at(1).get<double>();
  }
  return answer;
}

}  // namespace withheld
