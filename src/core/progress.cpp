#include "poecal/core/progress.hpp"

#include <utility>

namespace poecal {

void Listener::warning(const std::string&) {}

void Listener::warnings(const std::vector<std::string>& messages) {
  for (const std::string& message : messages) warning(message);
}

void Listener::progress(const std::string&, std::size_t, std::size_t) {}

ProgressFunction Listener::progressFunction() {
  return [this](const std::string& label, std::size_t done, std::size_t total) { progress(label, done, total); };
}

Progress::Progress(ProgressFunction function, std::string label, std::size_t total)
    : function_(std::move(function)), label_(std::move(label)), total_(total) {}

Progress::~Progress() {
  if (!function_ || done_ >= total_) return;
  try {
    function_(label_, 0, 0);
  } catch (...) {
    // A destructor that threw would end the program.
  }
}

void Progress::show() {
  const std::lock_guard lock(mutex_);
  if (function_ && done_ < total_) function_(label_, done_, total_);
}

void Progress::advance() {
  const std::lock_guard lock(mutex_);
  ++done_;
  if (function_) function_(label_, done_, total_);
}

void Progress::finish() {
  const std::lock_guard lock(mutex_);
  if (done_ >= total_) return;
  done_ = total_;
  if (function_) function_(label_, done_, total_);
}

}  // namespace poecal
