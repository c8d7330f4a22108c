// Progress of long work on stderr, only where that is a terminal and nobody asked for quiet.
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <string>

namespace poecal {

/// One line `label done/total`, rewritten in place and cleared at the end. advance() may be called from any thread.
class Progress {
 public:
  Progress(std::string label, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void advance();
  /// Switches all progress off (--quiet).
  static void setQuiet(bool quiet);

 private:
  std::string label_;
  std::size_t total_;
  std::atomic<std::size_t> done_{0};
  std::mutex mutex_;
  bool shown_ = false;
};

}  // namespace poecal
