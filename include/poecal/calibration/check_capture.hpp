// Judges a capture before anything is fitted: what is there, what is wrong, what would help.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "poecal/core/progress.hpp"

namespace poecal {

enum class CheckLevel {
  kOk,         ///< as it should be
  kAdvice,     ///< it can be calibrated; with this it could be better
  kTooLittle,  ///< too little for a calibration
  kError       ///< wrong, or missing
};
/// "ok", "advice", "too little", "error".
const char* checkLevelName(CheckLevel level);

struct CheckItem {
  CheckLevel level = CheckLevel::kOk;
  std::string topic;  ///< "robot", "target", "camera", "registration", "samples", "joints", "pictures", "corners", "columns",
                      ///< "detector"
  std::string text;   ///< one line, without a full stop
};

struct CaptureCheck {
  std::vector<CheckItem> items;
  /// 3 where something is wrong, 4 where there is too little, else 0.
  int exitStatus() const;
};

struct CheckOptions {
  int detect = 0;                  ///< pictures in which the detector is tried, evenly over the capture
  int jobs = 1;                    ///< pictures at a time; 0: one per core
  ProgressFunction progress = {};  ///< told of every step; may be empty
  void validate() const;           ///< @throws InvalidArgument with the field's name and value.
};

/// Reads a capture folder part by part, so that one mistake does not hide the next. Pictures are opened at their headers alone, but for
/// those of `detect`. Nothing is written and nothing fitted.
CaptureCheck checkCapture(const std::filesystem::path& folder, const CheckOptions& options = {});

}  // namespace poecal
