#include "docs/page.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "poecal/core/text.hpp"

namespace poecal::test {
namespace {

constexpr const char* kFence = "```";
constexpr const char* kHeading = "## ";

std::set<std::string> wordsOf(const std::string& text) {
  std::set<std::string> words;
  for (const std::string& code : codeOf(text)) {
    std::string word;
    for (const char c : code + " ") {
      if (std::isalnum(static_cast<unsigned char>(c)) || c == '_') {
        word += c;
      } else if (!word.empty()) {
        words.insert(word);
        word.clear();
      }
    }
  }
  return words;
}

template <typename Item>
const Item& findItem(const std::vector<Item>& items, std::string Item::*name, const std::string& wanted) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.*name == wanted; });
  if (found == items.end()) throw std::runtime_error("the page has no " + wanted);
  return *found;
}

}  // namespace

std::vector<std::string> codeOf(const std::string& text) {
  std::vector<std::string> all;
  for (std::size_t begin = text.find('`'); begin != std::string::npos;) {
    const std::size_t end = text.find('`', begin + 1);
    if (end == std::string::npos) break;
    all.push_back(text.substr(begin + 1, end - begin - 1));
    begin = text.find('`', end + 1);
  }
  return all;
}

std::vector<std::string> linksOf(const std::string& text) {
  constexpr std::string_view kMark = "](";
  std::vector<std::string> links;
  for (std::size_t at = text.find(kMark); at != std::string::npos; at = text.find(kMark, at + 1)) {
    const std::size_t begin = at + kMark.size();
    const std::string link = text.substr(begin, text.find(')', begin) - begin);
    if (link.find("://") == std::string::npos) links.push_back(link);
  }
  return links;
}

std::string anchorOf(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_') {
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    if (c == ' ') anchor += '-';
  }
  return anchor;
}

const Section& Page::section(const std::string& heading) const { return findItem(sections, &Section::heading, heading); }

const Example& Page::example(const std::string& name) const { return findItem(examples, &Example::name, name); }

Page readPage(const std::filesystem::path& file) {
  Page page;
  page.sections.emplace_back();
  bool fenced = false;
  std::istringstream text(readTextFile(file));
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with(kFence)) {
      fenced = !fenced;
      if (!fenced) continue;
      Example example;
      std::istringstream tag(line.substr(std::string(kFence).size()));
      tag >> example.language >> example.name;
      example.section = page.sections.back().heading;
      page.examples.push_back(example);
    } else if (fenced) {
      page.examples.back().text += line + "\n";
    } else if (line.starts_with(kHeading)) {
      page.sections.emplace_back().heading = line.substr(std::string(kHeading).size());
    } else {
      page.sections.back().text += line + "\n";
    }
  }
  for (Section& section : page.sections) section.words = wordsOf(section.text);
  return page;
}

}  // namespace poecal::test
