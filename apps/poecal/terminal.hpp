// What the program says: summaries on stdout, warnings and progress on stderr.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "command.hpp"
#include "poecal/core/progress.hpp"
#include "progress_line.hpp"

namespace poecal::app {

/// The summary of a command: `text` on stdout, its verdict bold on a terminal; or `json` with --json, or nothing with --quiet.
void printSummary(const Common& common, const std::string& text, const nlohmann::json& json);
/// The same where the JSON is written already: indented by 2, with a line end. It is printed as asciiJson() has it.
void printReport(const Common& common, const std::string& text, const std::string& json);
/// A JSON object of parts that are JSON already, in their order, likewise indented by 2. @param parts  key, and text of its value.
std::string jsonObject(const std::vector<std::pair<std::string, std::string>>& parts);

/// Whether a stream is a terminal that takes colours: TERM is not "dumb", and NO_COLOR is not set (no-color.org).
bool takesColours(int stream);

/// Text on stdout. @throws FileError where stdout does not take all of it.
void printOut(const std::string& text);
/// `poecal: KIND: MESSAGE` on stderr, as printableLine() has it, KIND in colour on a terminal; where stderr takes nothing there is nobody
/// to tell.
void printError(const char* kind, std::string_view message);
/// `poecal: warning: MESSAGE` on stderr.
void warn(const std::string& message);

/// Warnings as warn() prints them, equal ones once with their number, only the first few of many of one kind. Progress as one line that is
/// rewritten, with the time left, if stderr is a terminal that can rewrite one (not TERM=dumb) and --quiet was not given.
class TerminalListener : public Listener {
 public:
  explicit TerminalListener(const Common& common);
  void warning(const std::string& message) override;
  void warnings(const std::vector<std::string>& messages) override;
  void progress(const std::string& label, std::size_t done, std::size_t total) override;

 private:
  void clearLine();
  bool progress_shown_ = false;
  bool line_open_ = false;
  ProgressLine line_;
};

}  // namespace poecal::app
