#include "terminal.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "poecal/core/error.hpp"
#include "poecal/core/printable.hpp"

namespace poecal::app {

void printSummary(const Common& common, const std::string& text, const nlohmann::json& json) {
  printReport(common, text, json.dump(2, ' ', true, nlohmann::json::error_handler_t::replace));
}

void printReport(const Common& common, const std::string& text, const std::string& json) {
  if (common.json) {
    // Names in it may hold what a terminal obeys, and JSON can say all of it in plain letters.
    const nlohmann::ordered_json parsed = nlohmann::ordered_json::parse(json);
    printOut(parsed.dump(2, ' ', true, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  } else if (!common.quiet) {
    printOut(printableText(text));
  }
}

std::string jsonObject(const std::vector<std::pair<std::string, std::string>>& parts) {
  std::string text = "{";
  for (const auto& [key, json] : parts) {
    const std::size_t end = json.find_last_not_of('\n');
    text += fmt::format("{}\n\"{}\": {}", text.size() > 1 ? "," : "", key, json.substr(0, end + 1));
  }
  return text + "\n}\n";
}

void printOut(const std::string& text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return;
  throw FileError("stdout", 0, "cannot be written: " + std::generic_category().message(errno));
}

void printError(const char* kind, std::string_view message) {
  const std::string line = fmt::format("poecal: {}: {}\n", kind, printableLine(message));
  std::fwrite(line.data(), 1, line.size(), stderr);
}

void warn(const std::string& message) { printError("warning", message); }

TerminalListener::TerminalListener(const Common& common) : progress_shown_(!common.quiet && ::isatty(STDERR_FILENO) == 1) {}

void TerminalListener::warning(const std::string& message) { warn(message); }

void TerminalListener::warnings(const std::vector<std::string>& messages) {
  constexpr std::size_t kShown = 20;
  for (std::size_t k = 0; k < std::min(kShown, messages.size()); ++k) warn(messages[k]);
  if (messages.size() > kShown) warn(fmt::format("and {} more of this kind", messages.size() - kShown));
}

void TerminalListener::progress(const std::string& label, std::size_t done, std::size_t total) {
  if (!progress_shown_) return;
  const std::string line = done == total ? "\r\033[K" : fmt::format("\r{} {}/{}", label, done, total);
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fflush(stderr);
}

}  // namespace poecal::app
