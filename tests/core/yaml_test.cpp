#include "core/yaml.hpp"

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

auto failsWith(const std::string& message) { return Throws<FileError>(Property(&FileError::what, HasSubstr(message))); }

TEST(Yaml, ErrorsNameLineKeyAndExpectation) {
  const test::TempFolder folder;
  const YamlNode root =
      YamlNode::load(folder.write("a.yaml", "format: poecal-x/1\nsize: -1\nlist:\n- {a: [1, 2]}\n- {b: .nan}\ntext: hello\n"));
  EXPECT_THAT(
      [&] {
        root.checkKeys({"format", "size", "list"});
      },
      failsWith("a.yaml:6: unknown key 'text', expected one of: format, size, list"));
  EXPECT_THAT([&] { root["size"].positive(); }, failsWith("a.yaml:2: size: is -1.0, expected a positive number"));
  EXPECT_THAT([&] { root["list"].items()[0]["a"].vector(3); }, failsWith("a.yaml:4: list[0].a: 2 numbers, expected 3"));
  EXPECT_THAT([&] { root["list"].items()[1]["b"].number(); }, failsWith("a.yaml:5: list[1].b: expected a finite number"));
  EXPECT_THAT([&] { root["nothing"]; }, failsWith("key 'nothing' is missing"));
  EXPECT_THAT([&] { root["text"].number(); }, failsWith("a.yaml:6: text: expected a number"));
  EXPECT_THAT([&] { root.checkFormat("poecal-y/1"); }, failsWith("a.yaml:1: format: is 'poecal-x/1', expected poecal-y/1"));
  EXPECT_THAT([&] { YamlNode::load(folder.write("b.yaml", "a: [1, 2\nb: 3\n")); }, failsWith("b.yaml:"));
  EXPECT_THAT([&] { YamlNode::load(folder.write("c.yaml", "- 1\n")); }, failsWith("c.yaml:1: expected a YAML map"));
}

TEST(Yaml, TextIsQuotedWhereItMustBe) {
  EXPECT_EQ(yamlText("plain_name"), "plain_name");
  EXPECT_EQ(yamlText("true"), "\"true\"");
  EXPECT_EQ(yamlText("12"), "\"12\"");
  for (const std::string text : {"x: y #z", "a, b", "a]", "}", "'", "\"", "~", ""}) {
    EXPECT_EQ(YAML::Load("{a: " + yamlText(text) + ", b: 1}")["a"].as<std::string>(), text);
  }
}

}  // namespace
}  // namespace poecal
