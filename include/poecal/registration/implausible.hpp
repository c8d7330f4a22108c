// Input that reads well and cannot be true, with the file that is wrong.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "poecal/capture/capture.hpp"
#include "poecal/core/error.hpp"

namespace poecal {

/// The files of a capture; kSamples is poses.csv where poses of an instrument are read.
enum class InputPart { kSamples, kRobot, kTarget, kCamera, kManifest, kDetections, kRegistration };

/// What the search over mistakes suspects.
class ImplausibleCapture : public ImplausibleInput {
 public:
  /// @param part    the file that is suspected.
  /// @param sample  index of the sample from which on it is wrong, where it is not wrong as a whole.
  explicit ImplausibleCapture(const std::string& message, InputPart part = InputPart::kSamples, std::optional<std::size_t> sample = {})
      : ImplausibleInput(message), part_(part), sample_(sample) {}
  InputPart part() const { return part_; }
  const std::optional<std::size_t>& sample() const { return sample_; }

 private:
  InputPart part_;
  std::optional<std::size_t> sample_;
};

/// The same with the file and line of a capture.
FileError fileErrorOf(const ImplausibleInput& suspicion, const Capture& capture);
/// The same with that of a table of poses, which does not know its arm's file.
FileError fileErrorOf(const ImplausibleInput& suspicion, const PoseTable& table);

}  // namespace poecal
