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

/// `poecal ARGUMENTS` through the shell, in `folder`, where stdout.txt and stderr.txt are left.
inline ProgramRun runProgram(const std::filesystem::path& folder, const std::string& arguments) {
  const std::string command = "cd '" + folder.string() + "' && '" POECAL_PROGRAM "' " + arguments + " >stdout.txt 2>stderr.txt";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readTextFile(folder / "stdout.txt"), readTextFile(folder / "stderr.txt")};
}

}  // namespace poecal::test
