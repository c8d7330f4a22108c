// Strict YAML: every error names file and line, unknown keys are errors. Private, so that yaml-cpp stays out of the public headers.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <yaml-cpp/yaml.h>

namespace poecal {

/// A node of a YAML file that remembers where it stands and what it is called ("joints[2].axis").
class YamlNode {
 public:
  /// How many documents a file may hold, parted by "---". What a tool that listens to a topic writes has one for each message.
  enum class Documents { kOne, kFirstOfMany };
  /// @throws FileError: missing file, not YAML, the document is not a map, a document more than there may be.
  static YamlNode load(const std::filesystem::path& file, Documents documents = Documents::kOne);

  const std::filesystem::path& file() const { return *file_; }
  int line() const;
  const std::string& name() const { return name_; }
  bool isMap() const { return node_.IsMap(); }
  bool isSequence() const { return node_.IsSequence(); }

  /// @throws FileError unless this is a map whose keys are all among `known`.
  void checkKeys(std::initializer_list<const char*> known) const;
  /// Keys of a map, in the order of the file. @throws FileError unless this is a map.
  std::vector<std::string> keys() const;
  bool has(const char* key) const;
  /// @throws FileError where the key is missing.
  YamlNode operator[](const char* key) const;
  std::optional<YamlNode> find(const char* key) const;
  /// @throws FileError unless this is a sequence.
  std::vector<YamlNode> items() const;

  /// Scalars. @throws FileError: not a number, not finite...
  double number() const;
  double positive() const;
  /// Also @throws where zeros lead it: some readers of YAML take 012 for ten, others for twelve.
  int integer() const;
  std::string text() const;
  /// @param count  expected number of entries; negative: any.
  Eigen::VectorXd vector(int count = -1) const;
  Eigen::Vector3d vector3() const { return vector(3); }
  /// Checks `format: NAME/VERSION`.
  void checkFormat(const char* expected) const;

  [[noreturn]] void fail(const std::string& message) const;
  /// fail() with the line of one of this map's keys.
  [[noreturn]] void failAtKey(const std::string& key, const std::string& message) const;

 private:
  YamlNode(std::shared_ptr<const std::filesystem::path> file, YAML::Node node, std::string name);
  std::shared_ptr<const std::filesystem::path> file_;
  YAML::Node node_;
  std::string name_;
};

/// "[0.1, 0.2]" with numbers that read back as the same bits.
std::string yamlVector(const Eigen::VectorXd& values);
/// A scalar as YAML needs it, also inside {...} and [...]: quoted where it would read as something else than this string.
std::string yamlText(const std::string& text);

}  // namespace poecal
