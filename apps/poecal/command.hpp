// A command of the program: it parses, loads, calls the library, writes, and says what it did.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace CLI {
class App;
}

namespace poecal::app {

/// Options that every command has.
struct Common {
  int jobs = 0;        ///< --jobs N, 0: one per core
  bool quiet = false;  ///< --quiet: no summary, no progress; warnings stay
  bool json = false;   ///< --json: the summary as JSON on stdout
};

/// One row of main's table.
struct Command {
  const char* name;
  const char* summary;
  /// Adds the command's own options to `app` and returns what runs once they are parsed; that returns the exit status.
  std::function<int()> (*setUp)(CLI::App& app, const Common& common);
};

/// The summary of a command: `text` on stdout, or `json` with --json, or nothing with --quiet.
void printSummary(const Common& common, const std::string& text, const nlohmann::json& json);
/// `poecal: warning: MESSAGE` on stderr.
void warn(const std::string& message);

}  // namespace poecal::app
