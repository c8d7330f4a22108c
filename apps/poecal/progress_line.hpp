// What the one line of a running job says: how far it is, and how long it will take yet.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace poecal::app {

class ProgressLine {
 public:
  /// @param seconds  of any clock that does not go back. @param width  columns of the terminal; longer lines end in "...".
  /// @return the line to show now; nothing where the one before may stay for a moment, or where the job has ended.
  std::optional<std::string> text(const std::string& label, std::size_t done, std::size_t total, double seconds, std::size_t width);

 private:
  std::string label_;
  std::size_t total_ = 0, first_done_ = 0;
  double began_ = 0.0, shown_ = 0.0;
};

/// "about 40 s left".
std::string timeLeftText(double seconds);

}  // namespace poecal::app
