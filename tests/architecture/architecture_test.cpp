// The project's own source tree keeps the rules, and the rules see it where a tree does not.
#include <gmock/gmock.h>

#include "architecture/source_rules.hpp"
#include "support/temp_folder.hpp"

namespace poecal::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const std::filesystem::path kProject = POECAL_SOURCE_DIR;

/// The folder that holds the optional real captures, as it would be named in a path.
std::string folderOfRealCaptures() { return std::filesystem::path(POECAL_TEST_REAL_DIR).parent_path().filename().string() + "/"; }

TEST(Architecture, IncludesPointUpTheOrderOfModules) {
  ASSERT_THAT(moduleOrder(kProject), SizeIs(::testing::Ge(11u)));
  EXPECT_THAT(includesAgainstTheOrder(kProject), IsEmpty());
}

TEST(Architecture, PublicHeadersNameOnlyTheStandardLibraryAndEigen) { EXPECT_THAT(librariesInPublicHeaders(kProject), IsEmpty()); }

TEST(Architecture, EveryFileIsInTheBuild) { EXPECT_THAT(forgottenFiles(kProject), IsEmpty()); }

TEST(Architecture, OnlyTestsKnowWhereTheRealCapturesAre) {
  EXPECT_THAT(occurrencesOutsideTests(kProject, folderOfRealCaptures()), IsEmpty());
}

TEST(Architecture, NoTwoTypesHaveTheSameName) { EXPECT_THAT(typesOfTheSameName(kProject), IsEmpty()); }

TEST(Architecture, TopLevelHoldsOnlyWhatItIsMeantTo) { EXPECT_THAT(strayTopLevelEntries(kProject), IsEmpty()); }

/// A tree of two modules, `low` before `high`, which keeps every rule.
class FakeTree : public ::testing::Test {
 protected:
  FakeTree() {
    tree_.write("src/CMakeLists.txt", "foreach(module low high)\n  add_subdirectory(${module})\nendforeach()\n");
    tree_.write("src/low/CMakeLists.txt", "target_sources(x PUBLIC FILES ${PROJECT_SOURCE_DIR}/include/poecal/low/a.hpp PRIVATE a.cpp)\n");
    tree_.write("src/low/a.cpp", "#include \"poecal/low/a.hpp\"\n#include <opencv2/core.hpp>\n#include \"secret.hpp\"\n");
    tree_.write("src/low/secret.hpp", "#pragma once\n");
    tree_.write("include/poecal/low/a.hpp",
                "#include <vector>\n#include <Eigen/Core>\nnamespace cv { class Mat; }\nvoid f(const cv::Mat& picture);\n");
    tree_.write("src/high/CMakeLists.txt", "target_sources(x PRIVATE b.cpp)\n");
    tree_.write("src/high/b.cpp", "#include \"low/secret.hpp\"\n#include \"poecal/low/a.hpp\"\n");
  }
  const std::filesystem::path& root() const { return tree_.path(); }

  TempFolder tree_;
};

TEST_F(FakeTree, KeepsEveryRule) {
  EXPECT_THAT(moduleOrder(root()), ElementsAre("low", "high"));
  EXPECT_THAT(includesAgainstTheOrder(root()), IsEmpty());
  EXPECT_THAT(librariesInPublicHeaders(root()), IsEmpty());
  EXPECT_THAT(forgottenFiles(root()), IsEmpty());
  EXPECT_THAT(typesOfTheSameName(root()), IsEmpty());
  EXPECT_THAT(strayTopLevelEntries(root()), IsEmpty());
}

TEST_F(FakeTree, IncludeDownTheOrderIsSeen) {
  tree_.write("src/low/a.cpp", "#include \"poecal/high/b.hpp\"\n\n#include \"high/b.hpp\"\n");
  EXPECT_THAT(includesAgainstTheOrder(root()), ElementsAre("src/low/a.cpp:1: low includes \"poecal/high/b.hpp\", which comes after it",
                                                           "src/low/a.cpp:3: low includes \"high/b.hpp\", which comes after it"));
}

TEST_F(FakeTree, IncludeOfNoModuleIsSeen) {
  tree_.write("src/high/b.cpp", "#include \"lowest/a.hpp\"\n");
  EXPECT_THAT(includesAgainstTheOrder(root()), ElementsAre("src/high/b.cpp:1: \"lowest/a.hpp\" is of no module"));
}

TEST_F(FakeTree, PrivateHeaderInAPublicOneIsSeen) {
  tree_.write("include/poecal/low/a.hpp", "#include \"low/secret.hpp\"\n");
  EXPECT_THAT(includesAgainstTheOrder(root()),
              ElementsAre("include/poecal/low/a.hpp:1: a public header includes the private \"low/secret.hpp\""));
}

TEST_F(FakeTree, FolderThatIsNoModuleIsSeen) {
  tree_.write("src/misc/c.cpp", "");
  EXPECT_THAT(includesAgainstTheOrder(root()), ElementsAre("src/misc/c.cpp:1: is of no module that src/CMakeLists.txt lists"));
}

TEST_F(FakeTree, LibraryInAPublicHeaderIsSeen) {
  tree_.write("include/poecal/low/a.hpp",
              "#include <yaml-cpp/yaml.h>\n// YAML::Node stays private\nYAML::Node f();\ncv::Size g(const cv::Mat& picture);\n");
  EXPECT_THAT(librariesInPublicHeaders(root()), ElementsAre("include/poecal/low/a.hpp:1: a public header includes <yaml-cpp/yaml.h>",
                                                            "include/poecal/low/a.hpp:3: a public header names YAML",
                                                            "include/poecal/low/a.hpp:4: a public header names cv"));
}

TEST_F(FakeTree, ForgottenFilesAreSeen) {
  tree_.write("include/poecal/low/new.hpp", "");
  tree_.write("src/high/a.cpp", "");  // listed in another folder's list
  tree_.write("src/low/unused.hpp", "");
  tree_.write("tests/low/a_test.cpp", "");
  tree_.write("tests/low/b_test.py", "");
  tree_.write("tests/low/shared.py", "");  // for the tests beside it
  EXPECT_THAT(forgottenFiles(root()),
              ElementsAre("include/poecal/low/new.hpp:1: no CMakeLists.txt lists it", "src/high/a.cpp:1: no CMakeLists.txt lists it",
                          "src/low/unused.hpp:1: nobody includes it", "tests/low/a_test.cpp:1: no CMakeLists.txt lists it",
                          "tests/low/b_test.py:1: no CMakeLists.txt lists it"));
}

TEST_F(FakeTree, WordsAreSeenOutsideTestsAlone) {
  tree_.write("apps/demo.sh", "#!/bin/sh\nls ../elsewhere/data\n");
  tree_.write("tests/run.sh", "ls ../elsewhere/data\n");
  EXPECT_THAT(occurrencesOutsideTests(root(), "elsewhere/"), ElementsAre("apps/demo.sh:2: names elsewhere/"));
}

TEST_F(FakeTree, TypesOfTheSameNameAreSeen) {
  tree_.write("include/poecal/low/a.hpp",
              "namespace poecal {\nstruct Finding {\n  struct Part {};\n};\nclass Other;\n}  // namespace poecal\n");
  tree_.write("src/low/secret.hpp",
              "namespace poecal {\nclass Finding : public Base {\n};\nenum class Part { kOne };\n}  // namespace poecal\n");
  tree_.write("src/low/a.cpp",
              "namespace poecal {\nnamespace {\nstruct Part {};\n}  // namespace\nstruct Other::Part {};\n}  // namespace poecal\n");
  tree_.write("src/high/b.cpp", "namespace poecal {\nenum class Part { kTwo };\n}  // namespace poecal\n");
  EXPECT_THAT(typesOfTheSameName(root()), ElementsAre("src/low/secret.hpp:2: Finding is a type of include/poecal/low/a.hpp:2 too",
                                                      "src/low/secret.hpp:4: Part is a type of src/high/b.cpp:2 too"));
}

TEST_F(FakeTree, StrayEntriesAreSeen) {
  tree_.write("notes.txt", "");
  tree_.write(".editorconfig", "");
  EXPECT_THAT(strayTopLevelEntries(root()), ElementsAre("notes.txt:1: is not meant to be at the top level"));
}

}  // namespace
}  // namespace poecal::test
