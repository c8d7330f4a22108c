#include "architecture/source_rules.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>

#include "poecal/core/text.hpp"

namespace poecal::test {
namespace {

namespace fs = std::filesystem;

bool isHeader(const fs::path& file) { return file.extension() == ".hpp"; }
bool isSource(const fs::path& file) { return file.extension() == ".cpp"; }
bool isPythonTest(const fs::path& file) { return file.filename().string().ends_with("_test.py"); }

/// Files below root/folder, relative to root, sorted; none where there is no such folder. Folders in `passed_over` are not entered.
std::vector<fs::path> filesBelow(const fs::path& root, const fs::path& folder, const std::set<std::string>& passed_over = {}) {
  std::vector<fs::path> files;
  if (!fs::exists(root / folder)) return files;
  for (auto entry = fs::recursive_directory_iterator(root / folder); entry != fs::recursive_directory_iterator(); ++entry) {
    if (passed_over.contains(entry->path().filename().string())) {
      entry.disable_recursion_pending();
    } else if (entry->is_regular_file()) {
      files.push_back(entry->path().lexically_relative(root));
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

void forEachLine(const fs::path& file, const std::function<void(int, const std::string&)>& visit) {
  std::istringstream text(readTextFile(file));
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) visit(number, line);
}

std::string place(const fs::path& file, int line) { return file.string() + ":" + std::to_string(line) + ": "; }

struct Include {
  std::string name;
  bool quoted = false;  ///< "name", otherwise <name>
};

std::optional<Include> includeOf(const std::string& line) {
  constexpr std::string_view kDirective = "#include";
  if (!line.starts_with(kDirective)) return std::nullopt;
  const std::size_t begin = line.find_first_of("\"<", kDirective.size());
  if (begin == std::string::npos) return std::nullopt;
  const std::size_t end = line.find_first_of("\">", begin + 1);
  return Include{line.substr(begin + 1, end - begin - 1), line[begin] == '"'};
}

/// What comes before the first slash, and the whole where there is none.
std::string firstFolder(const std::string& name) { return name.substr(0, name.find('/')); }

/// MODULE of include/poecal/MODULE/... and src/MODULE/...
std::string moduleOf(const fs::path& file) {
  auto part = file.begin();
  std::advance(part, *part == "include" ? 2 : 1);
  return part->string();
}

/// What is wrong with a quoted include in a file of `module`, or empty.
std::string faultOf(const std::string& name, bool in_public_header, const std::string& module, const std::vector<std::string>& order) {
  constexpr std::string_view kPublic = "poecal/";
  const bool names_public = name.starts_with(kPublic);
  if (in_public_header && !names_public) return "a public header includes the private \"" + name + "\"";
  if (name.find('/') == std::string::npos) return "";  // a neighbour
  const std::string target = firstFolder(names_public ? name.substr(kPublic.size()) : name);
  const auto place_of_target = std::find(order.begin(), order.end(), target);
  if (place_of_target == order.end()) return "\"" + name + "\" is of no module";
  if (place_of_target > std::find(order.begin(), order.end(), module)) return module + " includes \"" + name + "\", which comes after it";
  return "";
}

std::string withoutComment(const std::string& line) { return line.substr(0, line.find("//")); }

bool isPartOfAName(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// What a definition of a type at the start of a line defines, or empty: "struct Name {", "class Name : public Base {", "enum class Name
/// {".
std::string typeDefinedBy(const std::string& line) {
  for (const std::string_view keyword : {"struct ", "enum class ", "class "}) {
    if (!line.starts_with(keyword)) continue;
    const auto end = std::find_if_not(line.begin() + static_cast<std::ptrdiff_t>(keyword.size()), line.end(), isPartOfAName);
    const std::string rest(end, line.end());
    const bool member = rest.starts_with("::"), specialisation = rest.starts_with("<"), declaration = rest.find('{') == std::string::npos;
    if (member || specialisation || declaration) return "";
    return {line.begin() + static_cast<std::ptrdiff_t>(keyword.size()), end};
  }
  return "";
}

/// A library's namespace that `code` names, or empty. cv::Mat is how pictures enter; it needs no header of OpenCV.
std::string foreignNameIn(const std::string& code) {
  constexpr std::string_view kPicture = "cv::Mat";
  for (const char* name : {"cv", "YAML", "ceres", "nlohmann", "fmt", "urdf", "tinyxml2", "tbb", "boost"}) {
    const std::string use = std::string(name) + "::";
    for (std::size_t at = code.find(use); at != std::string::npos; at = code.find(use, at + 1)) {
      if (at > 0 && isPartOfAName(code[at - 1])) continue;
      const std::size_t end = at + kPicture.size();
      const bool picture = code.compare(at, kPicture.size(), kPicture) == 0 && (end == code.size() || !isPartOfAName(code[end]));
      if (!picture) return name;
    }
  }
  return "";
}

std::set<std::string> wordsOfCMakeLists(const fs::path& root, const std::vector<fs::path>& files) {
  std::set<std::string> words;
  for (const fs::path& file : files) {
    if (file.filename() != "CMakeLists.txt") continue;
    std::string text = readTextFile(root / file);
    for (char& c : text) {
      if (c == '(' || c == ')') c = ' ';
    }
    std::istringstream stream(text);
    for (std::string word; stream >> word;) {
      constexpr std::string_view kRoot = "${PROJECT_SOURCE_DIR}/";
      const bool from_root = word.starts_with(kRoot);
      words.insert((from_root ? fs::path(word.substr(kRoot.size())) : (file.parent_path() / word)).lexically_normal().string());
    }
  }
  return words;
}

/// The last part of every quoted include of the tree.
std::set<std::string> includedNames(const fs::path& root, const std::vector<fs::path>& files) {
  std::set<std::string> names;
  for (const fs::path& file : files) {
    if (!isHeader(file) && !isSource(file)) continue;
    forEachLine(root / file, [&](int, const std::string& line) {
      const std::optional<Include> include = includeOf(line);
      if (include && include->quoted) names.insert(fs::path(include->name).filename().string());
    });
  }
  return names;
}

}  // namespace

std::vector<std::string> moduleOrder(const fs::path& root) {
  constexpr std::string_view kList = "foreach(module ";
  const std::string text = readTextFile(root / "src/CMakeLists.txt");
  const std::size_t begin = text.find(kList);
  if (begin == std::string::npos) return {};
  std::istringstream list(text.substr(begin + kList.size(), text.find(')', begin) - begin - kList.size()));
  std::vector<std::string> modules;
  for (std::string module; list >> module;) modules.push_back(module);
  return modules;
}

Violations includesAgainstTheOrder(const fs::path& root) {
  const std::vector<std::string> order = moduleOrder(root);
  Violations violations;
  for (const char* folder : {"include/poecal", "src"}) {
    for (const fs::path& file : filesBelow(root, folder)) {
      if (!isHeader(file) && !isSource(file)) continue;
      if (std::find(order.begin(), order.end(), moduleOf(file)) == order.end()) {
        violations.push_back(place(file, 1) + "is of no module that src/CMakeLists.txt lists");
        continue;
      }
      forEachLine(root / file, [&](int number, const std::string& line) {
        const std::optional<Include> include = includeOf(line);
        if (!include || !include->quoted) return;
        const std::string fault = faultOf(include->name, *file.begin() == "include", moduleOf(file), order);
        if (!fault.empty()) violations.push_back(place(file, number) + fault);
      });
    }
  }
  return violations;
}

Violations librariesInPublicHeaders(const fs::path& root) {
  Violations violations;
  for (const fs::path& file : filesBelow(root, "include")) {
    forEachLine(root / file, [&](int number, const std::string& line) {
      if (const std::optional<Include> include = includeOf(line)) {
        // Headers of the standard library have neither folder nor ending.
        const bool standard = include->name.find_first_of("/.") == std::string::npos;
        const bool allowed = include->quoted || standard || include->name.starts_with("Eigen/");
        if (!allowed) violations.push_back(place(file, number) + "a public header includes <" + include->name + ">");
      } else if (const std::string name = foreignNameIn(withoutComment(line)); !name.empty()) {
        violations.push_back(place(file, number) + "a public header names " + name);
      }
    });
  }
  return violations;
}

Violations forgottenFiles(const fs::path& root) {
  std::vector<fs::path> files;
  for (const char* folder : {"include", "src", "apps", "tests"}) {
    const std::vector<fs::path> below = filesBelow(root, folder);
    files.insert(files.end(), below.begin(), below.end());
  }
  const std::set<std::string> listed = wordsOfCMakeLists(root, files);
  const std::set<std::string> included = includedNames(root, files);
  Violations violations;
  for (const fs::path& file : files) {
    const bool public_header = *file.begin() == "include";
    if ((isSource(file) || isPythonTest(file) || public_header) && !listed.contains(file.string())) {
      violations.push_back(place(file, 1) + "no CMakeLists.txt lists it");
    } else if (isHeader(file) && !public_header && !included.contains(file.filename().string())) {
      violations.push_back(place(file, 1) + "nobody includes it");
    }
  }
  std::sort(violations.begin(), violations.end());
  return violations;
}

Violations occurrencesOutsideTests(const fs::path& root, const std::string& text) {
  Violations violations;
  for (const fs::path& file : filesBelow(root, "", {".git", "build", "out", "tests"})) {
    if (file == ".git") continue;  // a file in a worktree
    forEachLine(root / file, [&](int number, const std::string& line) {
      if (line.find(text) != std::string::npos) violations.push_back(place(file, number) + "names " + text);
    });
  }
  return violations;
}

Violations typesOfTheSameName(const fs::path& root) {
  std::map<std::string, std::string> place_of_type;
  Violations violations;
  for (const char* folder : {"include", "src", "apps"}) {
    for (const fs::path& file : filesBelow(root, folder)) {
      if (!isHeader(file) && !isSource(file)) continue;
      bool unnamed = false;  // namespace: what it holds has no namesake elsewhere
      forEachLine(root / file, [&](int number, const std::string& line) {
        if (line == "namespace {") unnamed = true;
        if (line == "}  // namespace") unnamed = false;
        const std::string name = unnamed ? "" : typeDefinedBy(line);
        if (name.empty()) return;
        const std::string here = file.string() + ":" + std::to_string(number);
        const auto [earlier, fresh] = place_of_type.emplace(name, here);
        if (!fresh) violations.push_back(place(file, number) + name + " is a type of " + earlier->second + " too");
      });
    }
  }
  return violations;
}

Violations strayTopLevelEntries(const fs::path& root) {
  const std::set<std::string> meant{"CHANGELOG.md", "CMakeLists.txt", "CMakePresets.json", "CONTRIBUTING.md", "LICENSE", "README.md",
                                    "apps",         "build",          "calib_data",        "include",         "out",     "src",
                                    "tests"};
  Violations violations;
  for (const fs::directory_entry& entry : fs::directory_iterator(root)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.') && !meant.contains(name)) violations.push_back(place(name, 1) + "is not meant to be at the top level");
  }
  std::sort(violations.begin(), violations.end());
  return violations;
}

}  // namespace poecal::test
