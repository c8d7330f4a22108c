#include "terminal.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace poecal::app {

void printSummary(const Common& common, const std::string& text, const nlohmann::json& json) { printReport(common, text, json.dump(2)); }

void printReport(const Common& common, const std::string& text, const std::string& json) {
  if (common.json) {
    fmt::print("{}{}", json, json.ends_with('\n') ? "" : "\n");
  } else if (!common.quiet) {
    fmt::print("{}", text);
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

void warn(const std::string& message) { fmt::print(stderr, "poecal: warning: {}\n", message); }

TerminalListener::TerminalListener(const Common& common) : progress_shown_(!common.quiet && ::isatty(STDERR_FILENO) == 1) {}

void TerminalListener::warning(const std::string& message) { warn(message); }

void TerminalListener::warnings(const std::vector<std::string>& messages) {
  constexpr std::size_t kShown = 20;
  for (std::size_t k = 0; k < std::min(kShown, messages.size()); ++k) warn(messages[k]);
  if (messages.size() > kShown) warn(fmt::format("and {} more of this kind", messages.size() - kShown));
}

void TerminalListener::progress(const std::string& label, std::size_t done, std::size_t total) {
  if (!progress_shown_) return;
  if (done == total) {
    fmt::print(stderr, "\r\033[K");
  } else {
    fmt::print(stderr, "\r{} {}/{}", label, done, total);
  }
  std::fflush(stderr);
}

}  // namespace poecal::app
