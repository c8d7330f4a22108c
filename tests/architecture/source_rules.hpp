// The rules that the source tree keeps, as functions of a tree: each returns its violations, "FILE:LINE: what is wrong", sorted.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace poecal::test {

using Violations = std::vector<std::string>;

/// The modules in the order in which includes may point, as src/CMakeLists.txt lists them: each may include those before it.
std::vector<std::string> moduleOrder(const std::filesystem::path& root);

/// #include "poecal/MODULE/..." and "MODULE/..." in include/ and src/ that point down the order, at no module, or, in a public header, at a
/// private one; folders of include/poecal/ and src/ that are no module.
Violations includesAgainstTheOrder(const std::filesystem::path& root);

/// Public headers that include or name anything but the standard library, Eigen, poecal and, where a picture enters, cv::Mat.
Violations librariesInPublicHeaders(const std::filesystem::path& root);

/// Sources and public headers that no CMakeLists.txt lists, so that nobody compiles or installs them; tests that nobody runs; private
/// headers that nobody includes.
Violations forgottenFiles(const std::filesystem::path& root);

/// Files outside tests/ in which `text` occurs.
Violations occurrencesOutsideTests(const std::filesystem::path& root, const std::string& text);

/// Types outside unnamed namespaces that have the name of another one in another file of include/, src/ or apps/: in one namespace two
/// definitions of a name are undefined behaviour that no compiler sees, and in two they mislead the reader.
Violations typesOfTheSameName(const std::filesystem::path& root);

/// What the top level holds besides the build's and git's folders and the few entries that it is meant to hold.
Violations strayTopLevelEntries(const std::filesystem::path& root);

}  // namespace poecal::test
