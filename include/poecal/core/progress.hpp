// What a long job says while it runs. The library prints nothing itself: whoever calls it decides what becomes of this.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace poecal {

/// Told how far a job is: its name, and how many of its pieces are done. A job ends with done == total, or with total == 0 where it failed.
/// Calls may come from any thread, but never two at a time. What it throws stops the job, and the call that the job belongs to throws it.
/// Of what it throws where total == 0 nothing is heard: the job has failed already, and its caller is to hear why.
using ProgressFunction = std::function<void(const std::string& label, std::size_t done, std::size_t total)>;

/// Hears what a long job has to say. The functions of this class do nothing; override what is of interest.
class Listener {
 public:
  Listener() = default;
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  virtual ~Listener() = default;
  /// One sentence about something that the user should look at.
  virtual void warning(const std::string& message);
  /// Many of one kind; each by itself goes to warning().
  virtual void warnings(const std::vector<std::string>& messages);
  /// As ProgressFunction.
  virtual void progress(const std::string& label, std::size_t done, std::size_t total);
  /// This listener's progress() as a function. The listener must outlive it.
  ProgressFunction progressFunction();
};

/// The pieces of one job, counted.
class Progress {
 public:
  /// @param function  may be empty.
  Progress(ProgressFunction function, std::string label, std::size_t total);
  /// Where pieces are left, the job has failed: tells (label, 0, 0), whatever that throws.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Tells how far it is before a piece is done, for a job whose pieces take long.
  void show();
  /// One more piece is done. May be called from any thread.
  void advance();
  /// The pieces that are left were not needed.
  void finish();

 private:
  ProgressFunction function_;
  std::string label_;
  std::size_t total_ = 0, done_ = 0;
  std::mutex mutex_;
};

}  // namespace poecal
