// Runs the program as a user would.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "poecal/core/text.hpp"

namespace poecal::test {

struct ProgramRun {
  int status = -1;  ///< Exit status.
  std::string out;
  std::string err;
};

/// A command line of the shell in `folder`, where stdout.txt and stderr.txt are left.
inline ProgramRun runShell(const std::filesystem::path& folder, const std::string& command) {
  const int status = std::system(("cd '" + folder.string() + "' && " + command + " >stdout.txt 2>stderr.txt").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readTextFile(folder / "stdout.txt"), readTextFile(folder / "stderr.txt")};
}

#ifdef POECAL_PROGRAM
/// `poecal ARGUMENTS`.
inline ProgramRun runProgram(const std::filesystem::path& folder, const std::string& arguments) {
  return runShell(folder, "'" POECAL_PROGRAM "' " + arguments);
}
#endif

}  // namespace poecal::test
