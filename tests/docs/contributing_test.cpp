// CONTRIBUTING.md names the files that one more of a kind touches: all that there are of that kind stand in them.
#include <algorithm>
#include <cctype>
#include <sstream>

#include <gmock/gmock.h>

#include "docs/page.hpp"
#include "poecal/camera/camera.hpp"
#include "poecal/core/text.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal::test {
namespace {

namespace fs = std::filesystem;

using ::testing::IsEmpty;
using ::testing::SizeIs;

const fs::path kProject = POECAL_SOURCE_DIR;

const Page& guide() {
  static const Page page = readPage(kProject / "CONTRIBUTING.md");
  return page;
}

std::string lowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
  return text;
}

std::string withoutUnderscores(const std::string& name) { return replaced(name, "_", ""); }

/// A row `file` | what stands there of the guide's example.
struct Row {
  std::string file;
  std::vector<std::string> texts;  ///< those that bear the example's name, in small letters
};

/// The rows of a section, told of `name` in place of its `example`: kNames and functionNames without underscores.
std::vector<Row> rowsFor(const std::string& heading, const std::string& example, const std::string& name) {
  const auto told = [&](const std::string& code) {
    const std::string small = lowerCase(code);
    return small == code ? replaced(code, example, name) : replaced(small, withoutUnderscores(example), withoutUnderscores(name));
  };
  std::vector<Row> rows;
  std::istringstream text(guide().section(heading).text);
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with("| `")) continue;
    const std::size_t second = line.find('|', 1);
    const std::string file = codeOf(line.substr(0, second)).at(0);
    Row row{replaced(file, example, name), {}};
    for (const std::string& code : codeOf(line.substr(second))) {
      const bool of_the_example = withoutUnderscores(lowerCase(code)).find(withoutUnderscores(example)) != std::string::npos;
      if (of_the_example) row.texts.push_back(told(code));
    }
    rows.push_back(row);
  }
  return rows;
}

/// What the guide's files lack of one of a kind.
std::vector<std::string> lacking(const std::string& heading, const std::string& example, const std::string& name) {
  std::vector<std::string> missing;
  for (const Row& row : rowsFor(heading, example, name)) {
    if (!fs::exists(kProject / row.file)) {
      missing.push_back(name + ": there is no " + row.file);
      continue;
    }
    const std::string content = lowerCase(readTextFile(kProject / row.file));
    for (const std::string& text : row.texts) {
      if (content.find(text) == std::string::npos) missing.push_back(name + ": " + row.file + " has no " + text);
    }
  }
  return missing;
}

/// Stems of the files of a folder that end so, without the ending.
std::vector<std::string> stems(const std::string& folder, const std::string& ending) {
  std::vector<std::string> all;
  for (const fs::directory_entry& entry : fs::directory_iterator(kProject / folder)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(ending)) all.push_back(name.substr(0, name.size() - ending.size()));
  }
  std::sort(all.begin(), all.end());
  return all;
}

struct Kind {
  const char* heading;
  const char* example;
  std::vector<std::string> all;
};

std::vector<Kind> kinds() {
  Kind effects{"An effect", "joint_hysteresis", {}}, lenses{"A lens model", "equidistant", {}};
  for (const EffectKind& kind : effectKinds()) effects.all.push_back(kind.name);
  for (const DistortionModel model : kDistortionModels) lenses.all.emplace_back(distortionModelName(model));
  return {effects,
          lenses,
          {"A target type", "chessboard", {"apriltag", "points", "aprilgrid", "charuco", "chessboard"}},
          {"A detector", "charuco", stems("src/detection", "_finder.cpp")},
          {"A column", "temperature", {"pose", "stamp", "temperature", "payload"}},
          {"A command", "measure", stems("apps/poecal/commands", ".cpp")}};
}

TEST(Contributing, WhatThereIsOfEachKindStandsInTheFilesThatItsGuideNames) {
  for (const Kind& kind : kinds()) {
    EXPECT_THAT(kind.all, ::testing::Contains(kind.example));
    EXPECT_THAT(kind.all, SizeIs(::testing::Ge(3u))) << kind.heading;
    EXPECT_THAT(rowsFor(kind.heading, kind.example, kind.example), SizeIs(::testing::Ge(4u))) << kind.heading;
    for (const std::string& name : kind.all) EXPECT_THAT(lacking(kind.heading, kind.example, name), IsEmpty()) << kind.heading;
  }
}

TEST(Contributing, ANewOneIsMissedInEveryFile) {
  for (const Kind& kind : kinds()) {
    EXPECT_THAT(lacking(kind.heading, kind.example, "no_such_name"), SizeIs(::testing::Ge(4u))) << kind.heading;
  }
}

TEST(Contributing, EveryPathOfThePageIsThere) {
  for (const Section& section : guide().sections) {
    for (const std::string& code : codeOf(section.text)) {
      const std::string path = code.substr(0, code.find(' '));
      const bool is_path = fs::exists(kProject / path.substr(0, path.find('/'))) && path.find("MODULE") == std::string::npos;
      if (is_path) {
        EXPECT_TRUE(fs::exists(kProject / path)) << path;
      }
    }
  }
  std::istringstream commands(guide().examples.front().text);
  for (std::string line; std::getline(commands, line);) {
    std::istringstream words(line);
    for (std::string word; words >> word && word != "#";) {
      if (word.find('/') != std::string::npos) {
        EXPECT_TRUE(fs::exists(kProject / word)) << word;
      }
    }
  }
}

}  // namespace
}  // namespace poecal::test
