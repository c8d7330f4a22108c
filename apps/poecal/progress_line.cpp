#include "progress_line.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace poecal::app {
namespace {

constexpr double kEvery = 0.1;      // [s] a reader follows no faster
constexpr double kRateKnown = 3.0;  // [s] before, the first pieces say little of the rest
constexpr std::size_t kLeast = 20;  // columns

}  // namespace

std::string timeLeftText(double seconds) {
  constexpr double kMinute = 60.0, kHour = 3600.0;
  if (seconds < 90.0) return fmt::format("about {:.0f} s left", 5.0 * std::max(1.0, std::ceil(seconds / 5.0)));
  if (seconds < 90.0 * kMinute) return fmt::format("about {:.0f} min left", std::ceil(seconds / kMinute));
  return fmt::format("about {:.0f} h left", std::ceil(seconds / kHour));
}

std::optional<std::string> ProgressLine::text(const std::string& label, std::size_t done, std::size_t total, double seconds,
                                              std::size_t width) {
  if (done >= total) {
    label_.clear();
    return std::nullopt;
  }
  if (label != label_ || total != total_ || done < first_done_) {
    label_ = label;
    total_ = total;
    first_done_ = done;
    began_ = seconds;
  } else if (seconds - shown_ < kEvery) {
    return std::nullopt;
  }
  shown_ = seconds;
  std::string line = total == 1 ? label : fmt::format("{}: {} of {}", label, done, total);
  if (seconds - began_ >= kRateKnown && done > first_done_) {
    const double of_each = (seconds - began_) / static_cast<double>(done - first_done_);
    line += ", " + timeLeftText(of_each * static_cast<double>(total - done));
  }
  // A line that reaches the last column goes on in the next one, where the next text would not cover it.
  const std::size_t most = std::max(width, kLeast) - 1;
  if (line.size() > most) line = line.substr(0, most - 3) + "...";
  return line;
}

}  // namespace poecal::app
