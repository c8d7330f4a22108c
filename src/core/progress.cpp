#include "poecal/core/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace poecal {
namespace {

std::atomic<bool> quiet_everywhere{false};

}  // namespace

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)), total_(total), shown_(!quiet_everywhere && ::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::advance() {
  const std::size_t done = ++done_;
  if (!shown_) return;
  const std::lock_guard lock(mutex_);
  std::fprintf(stderr, "\r%s %zu/%zu", label_.c_str(), done, total_);
  std::fflush(stderr);
}

void Progress::setQuiet(bool quiet) { quiet_everywhere = quiet; }

}  // namespace poecal
