#include "core/yaml.hpp"

#include <fmt/format.h>
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

TEST(Yaml, OneDocumentIsRead) {
  const test::TempFolder folder;
  const auto load = [&folder](const std::string& text, YamlNode::Documents documents = YamlNode::Documents::kOne) {
    return YamlNode::load(folder.write("a.yaml", text), documents)["a"].integer();
  };
  EXPECT_THAT([&] { load("a: 1\n---\na: 2\n"); }, failsWith("a.yaml:2: a second document begins here, expected one"));
  EXPECT_THAT([&] { load("a: 1\n...\n---\n- 2\n"); }, failsWith("a second document begins here"));
  EXPECT_EQ(load("{\"a\": 1}, 2"), 1) << "yaml-cpp reads that for ever, as one document after the other";
  EXPECT_EQ(load("---\na: 1\n---\n"), 1) << "what listens to a topic ends every message so";
  EXPECT_EQ(load("a: 1\n---\na: 2\n", YamlNode::Documents::kFirstOfMany), 1);
}

TEST(Yaml, AnIntegerHasNoLeadingZero) {
  const test::TempFolder folder;
  const auto read = [&folder](const std::string& text) {
    return YamlNode::load(folder.write("a.yaml", "a: " + text + "\n"))["a"].integer();
  };
  EXPECT_THAT([&] { read("012"); }, failsWith("a.yaml:1: a: is 012, expected an integer without a leading zero"));
  EXPECT_THAT([&] { read("-007"); }, failsWith("is -007"));
  EXPECT_THAT([&] { read("0x1F"); }, failsWith("is 0x1F"));
  EXPECT_EQ(read("0"), 0);
  EXPECT_EQ(read("-10"), -10);
}

TEST(Yaml, AKeyIsThereOnce) {
  const test::TempFolder folder;
  const auto load = [&folder](const std::string& text) { return [&folder, text] { YamlNode::load(folder.write("a.yaml", text)); }; };
  EXPECT_THAT(load("a: 1\nb: 2\na: 3\n"), failsWith("a.yaml:3: key 'a' is there twice"));
  EXPECT_THAT(load("a: {x: 1, y: 2,\n    x: 3}\n"), failsWith("a.yaml:2: key 'x' is there twice"));
  EXPECT_THAT(load("list:\n- a: 1\n- {b: [{c: 1}, {c: 1}], d: 1,\n   d: 2}\n"), failsWith("a.yaml:4: key 'd' is there twice"));
  EXPECT_THAT(load("a: 1\n'a': 1\n"), failsWith("a.yaml:2: key 'a' is there twice"));
  EXPECT_THAT(load("{\"a\": 1,\n \"a\": 1}"), failsWith("a.yaml:2: key 'a' is there twice")) << "JSON is YAML";
  // Values may be what keys are, and other maps have keys of their own.
  load("a: b\nb: a\nc: [a, b, {a: 1, b: c}]\nd: &anchor {a: 1}\ne: *anchor\nf:\n? g\n: a\n")();
}

TEST(Yaml, NodesThatHoldThemselvesAndTheirOwnCopiesEnd) {
  const test::TempFolder folder;
  EXPECT_TRUE(YamlNode::load(folder.write("a.yaml", "a: &a [*a, 1]\n"))["a"].isSequence());
  std::string laughs = "l0: &l0 [x, x]\n";
  for (int k = 1; k < 60; ++k) laughs += fmt::format("l{0}: &l{0} [*l{1}, *l{1}]\n", k, k - 1);
  EXPECT_EQ(YamlNode::load(folder.write("b.yaml", laughs)).keys().size(), 60u);
  EXPECT_THAT([&] { YamlNode::load(folder.write("c.yaml", "a: " + std::string(100'000, '['))); }, failsWith("c.yaml:1: not valid YAML"));
}

TEST(Yaml, OnlyUtf8AndNoXml) {
  const test::TempFolder folder;
  const auto load = [&folder](const std::string& text) { return [&folder, text] { YamlNode::load(folder.write("a.yaml", text)); }; };
  EXPECT_THAT(load("a: 1\nname: Schw\xe4nker\n"), failsWith("a.yaml:2: byte 0xE4 is not UTF-8, expected a text in UTF-8"));
  EXPECT_THAT(load("\xff\xfe"
                   "a"),
              failsWith("a.yaml:1: byte 0xFF is not UTF-8"));
  EXPECT_THAT(load("<?xml version=\"1.0\"?>\n<a/>\n"), failsWith("a.yaml:1: begins as XML does, expected YAML"));
  EXPECT_THAT(load("\xef\xbb\xbf\n <a/>"), failsWith("begins as XML does"));
  EXPECT_EQ(YamlNode::load(folder.write("b.yaml", "name: Schw\u00e4nker\n"))["name"].text(), "Schw\u00e4nker");
}

TEST(Yaml, NumbersThatNothingHasAreNotFinite) {
  const test::TempFolder folder;
  const YamlNode root = YamlNode::load(folder.write("a.yaml", "a: 1e308\nb: 1e30\nc: -1e31\n"));
  EXPECT_THAT([&] { root["a"].number(); }, failsWith("a.yaml:1: a: expected a finite number"));
  EXPECT_EQ(root["b"].number(), 1e30);
  EXPECT_THAT([&] { root["c"].number(); }, failsWith("a.yaml:3: c: expected a finite number"));
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
