// Runs the program as somebody at a terminal sees it.
#pragma once

#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace poecal::test {

/// Everything that a command line of the shell writes to a terminal of `columns`, stdout and stderr together.
/// @param term  TERM; the surroundings have no NO_COLOR.
inline std::string runInTerminal(const std::filesystem::path& folder, const std::string& command, unsigned short columns = 120,
                                 const std::string& term = "xterm") {
  winsize size{.ws_row = 50, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, &size);
  if (child < 0) throw std::runtime_error("no pseudo-terminal");
  if (child == 0) {
    ::unsetenv("NO_COLOR");
    ::setenv("TERM", term.c_str(), 1);
    if (::chdir(folder.c_str()) == 0) ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    ::_exit(127);
  }
  std::string seen;
  char part[4096];
  // Linux ends the other side's terminal with an error, not with nothing read.
  for (ssize_t count = 0; (count = ::read(terminal, part, sizeof part)) > 0;) seen.append(part, static_cast<std::size_t>(count));
  ::close(terminal);
  ::waitpid(child, nullptr, 0);
  return seen;
}

}  // namespace poecal::test
