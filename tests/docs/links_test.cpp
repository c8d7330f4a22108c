// Links of the project's pages lead to files and headings that are there.
#include <algorithm>

#include <gmock/gmock.h>

#include "docs/page.hpp"
#include "poecal/core/text.hpp"

namespace poecal::test {
namespace {

namespace fs = std::filesystem;

const fs::path kProject = POECAL_SOURCE_DIR;

bool hasAnchor(const fs::path& page, const std::string& anchor) {
  const std::vector<Section> sections = readPage(page).sections;
  return std::any_of(sections.begin(), sections.end(), [&](const Section& section) { return anchorOf(section.heading) == anchor; });
}

class Links : public ::testing::TestWithParam<const char*> {};

TEST_P(Links, LeadSomewhere) {
  const fs::path page = kProject / GetParam();
  const std::vector<std::string> links = linksOf(readTextFile(page));
  EXPECT_FALSE(links.empty());
  for (const std::string& link : links) {
    const std::size_t mark = link.find('#');
    const std::string file = link.substr(0, mark);
    const fs::path target = file.empty() ? page : page.parent_path() / file;
    EXPECT_TRUE(fs::exists(target)) << link;
    if (mark != std::string::npos && fs::is_regular_file(target)) {
      EXPECT_TRUE(hasAnchor(target, link.substr(mark + 1))) << link;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pages, Links,
                         ::testing::Values("README.md", "CHANGELOG.md", "calib_data/README.md", "calib_data/FORMATS.md",
                                           "calib_data/TUTORIAL.md"));

TEST(LinksOf, AnchorsAreMadeAsMarkdownMakesThem) {
  EXPECT_THAT(linksOf("[a](b.md#c-d), [e](#f) and [g](https://h.org)"), ::testing::ElementsAre("b.md#c-d", "#f"));
  EXPECT_EQ(anchorOf("capture.yaml"), "captureyaml");
  EXPECT_EQ(anchorOf("The truth of a scene"), "the-truth-of-a-scene");
}

}  // namespace
}  // namespace poecal::test
