#include "terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "poecal/core/error.hpp"
#include "poecal/core/printable.hpp"

namespace poecal::app {
namespace {

constexpr const char* kBold = "1";
constexpr const char* kRed = "31";
constexpr const char* kYellow = "33";

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// A terminal that can do more than write one line after another.
bool isScreen(int stream) { return ::isatty(stream) == 1 && environment("TERM") != "dumb"; }

std::string coloured(const char* colour, std::string_view text) { return fmt::format("\033[{}m{}\033[0m", colour, text); }

/// The line that says what was found stands out.
std::string withBoldVerdict(const std::string& text) {
  constexpr std::string_view kVerdict = "diagnosis: ";
  std::size_t begin = text.starts_with(kVerdict) ? 0 : text.find("\n" + std::string(kVerdict));
  if (begin == std::string::npos) return text;
  if (begin > 0) ++begin;
  const std::size_t end = std::min(text.find('\n', begin), text.size());
  return text.substr(0, begin) + coloured(kBold, text.substr(begin, end - begin)) + text.substr(end);
}

std::size_t columnsOf(int stream) {
  constexpr std::size_t kUsual = 80;
  winsize size{};
  return ::ioctl(stream, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsual;
}

double secondsNow() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

bool takesColours(int stream) { return isScreen(stream) && environment("NO_COLOR").empty(); }

void printSummary(const Common& common, const std::string& text, const nlohmann::json& json) {
  printReport(common, text, json.dump(2, ' ', true, nlohmann::json::error_handler_t::replace) + "\n");
}

void printReport(const Common& common, const std::string& text, const std::string& json) {
  if (common.json) {
    // Names in it may hold what a terminal obeys, and JSON can say all of it in plain letters.
    printOut(asciiJson(json));
  } else if (!common.quiet) {
    const std::string printable = printableText(text);
    printOut(takesColours(STDOUT_FILENO) ? withBoldVerdict(printable) : printable);
  }
}

std::string jsonObject(const std::vector<std::pair<std::string, std::string>>& parts) {
  std::string text = "{";
  for (const auto& [key, json] : parts) {
    text += fmt::format("{}\n  \"{}\": ", text.size() > 1 ? "," : "", key);
    const std::string_view lines = std::string_view(json).substr(0, json.find_last_not_of('\n') + 1);
    // A line end in it is no part of a string, where JSON writes it as an escape.
    for (const char c : lines) text += c == '\n' ? "\n  " : std::string(1, c);
  }
  return text + "\n}\n";
}

void printOut(const std::string& text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return;
  throw FileError("stdout", 0, "cannot be written: " + std::generic_category().message(errno));
}

void printError(const char* kind, std::string_view message) {
  const std::string word = fmt::format("{}:", kind);
  const char* const colour = std::string_view(kind) == "error" ? kRed : kYellow;
  const std::string line =
      fmt::format("poecal: {} {}\n", takesColours(STDERR_FILENO) ? coloured(colour, word) : word, printableLine(message));
  std::fwrite(line.data(), 1, line.size(), stderr);
}

void warn(const std::string& message) { printError("warning", message); }

TerminalListener::TerminalListener(const Common& common) : progress_shown_(!common.quiet && isScreen(STDERR_FILENO)) {}

void TerminalListener::warning(const std::string& message) {
  clearLine();
  warn(message);
}

void TerminalListener::warnings(const std::vector<std::string>& messages) {
  constexpr std::size_t kShown = 20;
  std::vector<std::pair<std::string, std::size_t>> different;  // in the order of their first
  for (const std::string& message : messages) {
    const auto same = std::find_if(different.begin(), different.end(), [&](const auto& each) { return each.first == message; });
    if (same == different.end()) {
      different.emplace_back(message, 1);
    } else {
      ++same->second;
    }
  }
  for (std::size_t k = 0; k < std::min(kShown, different.size()); ++k) {
    const auto& [message, times] = different[k];
    warning(times == 1 ? message : fmt::format("{} ({} times)", message, times));
  }
  if (different.size() > kShown) warning(fmt::format("and {} more of this kind", different.size() - kShown));
}

void TerminalListener::progress(const std::string& label, std::size_t done, std::size_t total) {
  if (!progress_shown_) return;
  const std::optional<std::string> text = line_.text(label, done, total, secondsNow(), columnsOf(STDERR_FILENO));
  if (done >= total) return clearLine();
  if (!text) return;
  const std::string line = "\r\033[K" + *text;
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fflush(stderr);
  line_open_ = true;
}

void TerminalListener::clearLine() {
  if (!line_open_) return;
  constexpr std::string_view kClear = "\r\033[K";
  std::fwrite(kClear.data(), 1, kClear.size(), stderr);
  std::fflush(stderr);
  line_open_ = false;
}

}  // namespace poecal::app
