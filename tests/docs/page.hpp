// A page of Markdown as the tests of the documentation see it: sections, words in `code`, and fenced blocks that are named after a file.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace poecal::test {

/// ```LANGUAGE NAME
struct Example {
  std::string language, name, text;
  std::string section;  ///< heading that it stands under
};

struct Section {
  std::string heading;          ///< of "## heading"; empty for what stands before the first
  std::string text;             ///< without fenced blocks
  std::set<std::string> words;  ///< letters, digits and underscores that stand together within `code`
};

struct Page {
  std::vector<Section> sections;
  std::vector<Example> examples;

  /// @throws std::runtime_error for a heading or name that is not there, so that no test passes over what it is about.
  const Section& section(const std::string& heading) const;
  const Example& example(const std::string& name) const;
};

Page readPage(const std::filesystem::path& file);

/// What the links of a text name: "FILE", "FILE#anchor" or "#anchor". Those to other sites are passed over.
std::vector<std::string> linksOf(const std::string& text);

/// The anchor that Markdown makes of a heading: small letters, blanks as hyphens, no other signs.
std::string anchorOf(const std::string& heading);

/// All `code` of a text, in its order, without the quotes.
std::vector<std::string> codeOf(const std::string& text);

}  // namespace poecal::test
