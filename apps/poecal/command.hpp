// A command of the program: it parses, makes one call of the library, and words the result.
#pragma once

#include <functional>
#include <string>
#include <vector>

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

}  // namespace poecal::app
