// The parts of a check, each of which adds what it has to say.
#pragma once

#include <exception>
#include <functional>
#include <optional>
#include <string>

#include "poecal/calibration/check_capture.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/core/progress.hpp"

namespace poecal {

/// What has been said so far.
class CheckList {
 public:
  explicit CheckList(ProgressFunction progress) : progress_(std::move(progress)) {}
  CheckList(const CheckList&) = delete;
  CheckList& operator=(const CheckList&) = delete;
  void add(CheckLevel level, const std::string& topic, const std::string& text) { check_.items.push_back({level, topic, text}); }
  /// Does `work`; what it throws on purpose is said instead, once; but for what progress() threw. @returns whether it came to its end.
  bool attempt(const std::string& topic, const std::function<void()>& work);
  const CaptureCheck& check() const { return check_; }
  /// Told how far the parts are. The list must outlive it.
  ProgressFunction progress();

 private:
  CaptureCheck check_;
  ProgressFunction progress_;
  std::exception_ptr stopped_;  ///< by progress_
};

/// "3 poses", "1 pose".
std::string counted(std::size_t count, const std::string& thing);

/// Rows, poses, repeats, how far the joints and the flange moved, and columns that a diagnosis would want.
/// @param arm  nullptr where the table has no joints.
/// @param known  whether both transforms of the registration are known beforehand.
void checkSamples(const Arm* arm, const SampleTable& table, bool known, CheckList& list);
/// Whether the pictures are there and as large as the camera says; of detections.csv where there is one: how much of the picture was seen.
void checkPictures(const Capture& capture, CheckList& list);
void checkIntrinsicsFolder(const std::filesystem::path& folder, CheckList& list);
/// Tries the detector.
void checkDetector(const Capture& capture, const CheckOptions& options, CheckList& list);

}  // namespace poecal
