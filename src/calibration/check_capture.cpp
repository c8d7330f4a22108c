#include "poecal/calibration/check_capture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/check_parts.hpp"
#include "capture/manifest.hpp"
#include "cell/transform_names.hpp"
#include "core/yaml.hpp"
#include "poecal/cell/known_registration.hpp"
#include "poecal/core/error.hpp"
#include "registration/known_transforms.hpp"

namespace poecal {
namespace {

void sayRobot(const Arm& arm, CheckList& list) {
  std::size_t limited = 0;
  for (const Joint& joint : arm.joints) limited += joint.limits ? 1 : 0;
  list.add(CheckLevel::kOk, "robot",
           fmt::format("{}: {}, {} of them with limits, {}", arm.name, counted(arm.joints.size(), "joint"), limited,
                       arm.links.empty() ? "no link masses" : "link masses"));
  if (arm.links.empty()) {
    list.add(CheckLevel::kAdvice, "robot", "masses of the links [kg] are not known: they help to find compliances, but are not needed");
  }
}

void sayTarget(const Target& target, CheckList& list) {
  double smallest = target.square, largest = target.square;
  for (const TargetTag& tag : target.tags) {
    smallest = smallest == 0.0 ? tag.size : std::min(smallest, tag.size);
    largest = std::max(largest, tag.size);
  }
  const std::string text =
      fmt::format("{}{}", counted(target.points.size(), "corner"),
                  largest > 0.0 ? fmt::format(" of {} {:.6g} m wide", target.hasTags() ? "tags" : "squares", largest) : "");
  constexpr double kLeast = 2e-3;  // [m]; too large ones are refused where the file is read
  if (largest > 0.0 && smallest < kLeast) {
    list.add(CheckLevel::kAdvice, "target", fmt::format("{}, the smallest {:.6g} m: is that right?", text, smallest));
    return;
  }
  list.add(CheckLevel::kOk, "target", text);
}

void sayCamera(const Camera& camera, CheckList& list) {
  for (const std::string& remark : camera.remarks) list.add(CheckLevel::kAdvice, "camera", remark);
  if (camera.width == 0) {
    list.add(CheckLevel::kOk, "camera", fmt::format("focal length {:.1f} px, picture size taken from the pictures", camera.fx));
    return;
  }
  const double view = 2.0 * std::atan(0.5 * camera.width / camera.fx) * 180.0 / std::numbers::pi;
  const std::string text =
      fmt::format("{} x {} px, {}, sees about {:.0f} degrees across", camera.width, camera.height, distortionModelName(camera.model), view);
  list.add(CheckLevel::kOk, "camera", text);
  if (camera.standard_deviation.size() == 0) {
    list.add(CheckLevel::kAdvice, "camera", "no standard_deviation of the lens: it is taken as exact. poecal intrinsics states it");
  }
}

void sayRegistration(const Registration& registration, CheckList& list) {
  std::vector<std::string> known;
  if (registration.known_near) known.push_back(nearName(registration));
  if (registration.known_far) known.push_back(farName(registration));
  list.add(CheckLevel::kOk, "registration", fmt::format("{} known beforehand", fmt::join(known, " and ")));
}

/// Each part by itself.
void checkParts(const YamlNode& root, CheckList& list) {
  std::optional<NamedRobot> robot;
  list.attempt("robot", [&] {
    robot = readNamedRobot(root);
    if (robot) sayRobot(robot->arm, list);
  });
  list.attempt("target", [&] { sayTarget(readTarget(namedFile(root["target"])), list); });
  if (const auto camera = root.find("camera")) {
    list.attempt("camera", [&] { sayCamera(readCameraOfPictures(namedFile(*camera)), list); });
  }
  if (const auto intrinsics = root.find("intrinsics")) {
    list.attempt("intrinsics", [&] { checkIntrinsicsFolder(namedFolder(*intrinsics), list); });
  }
  Registration registration;
  if (const auto file = root.find("registration")) {
    list.attempt("registration", [&] {
      registration.setup = readSetup(root["setup"]);
      readKnownRegistration(namedFile(*file), registration);
      sayRegistration(registration, list);
    });
  }
  list.attempt("samples", [&] {
    const bool known = knowsBoth(registration);
    const Arm* arm = robot ? &robot->arm : nullptr;
    const SampleTable table = readSamples(namedFile(root["samples"]), robot ? robot->arm.jointCount() : 0, arm);
    if (arm != nullptr || !table.has_joints) checkSamples(table.has_joints ? arm : nullptr, table, known, list);
  });
}

}  // namespace

const char* checkLevelName(CheckLevel level) {
  switch (level) {
    case CheckLevel::kOk:
      return "ok";
    case CheckLevel::kAdvice:
      return "advice";
    case CheckLevel::kTooLittle:
      return "too little";
    case CheckLevel::kError:
      return "error";
  }
  return "";
}

int CaptureCheck::exitStatus() const {
  const auto any = [this](CheckLevel level) {
    return std::any_of(items.begin(), items.end(), [level](const CheckItem& item) { return item.level == level; });
  };
  return any(CheckLevel::kError) ? 3 : any(CheckLevel::kTooLittle) ? 4 : 0;
}

void CheckOptions::validate() const {
  if (detect < 0) throw InvalidArgument(fmt::format("detect is {}, expected 0 or more pictures", detect));
  if (jobs < 0) throw InvalidArgument(fmt::format("jobs is {}, expected 0 or more", jobs));
}

bool CheckList::attempt(const std::string& topic, const std::function<void()>& work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    if (stopped_) std::rethrow_exception(stopped_);
    const std::string text = error.what();
    const bool said = std::any_of(check_.items.begin(), check_.items.end(), [&](const CheckItem& item) { return item.text == text; });
    if (!said) add(error.exitStatus() == 4 ? CheckLevel::kTooLittle : CheckLevel::kError, topic, text);
    return false;
  }
}

ProgressFunction CheckList::progress() {
  if (!progress_) return {};
  return [this](const std::string& label, std::size_t done, std::size_t total) {
    try {
      progress_(label, done, total);
    } catch (...) {
      if (total > 0) stopped_ = std::current_exception();
      throw;
    }
  };
}

std::string counted(std::size_t count, const std::string& thing) { return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s"); }

CaptureCheck checkCapture(const std::filesystem::path& folder, const CheckOptions& options) {
  options.validate();
  CheckList list(options.progress);
  std::optional<YamlNode> root;
  if (!list.attempt("capture", [&] { root = YamlNode::load(folder / "capture.yaml"); })) return list.check();
  checkParts(*root, list);
  std::optional<Capture> capture;
  // What the parts do not see: unknown keys, names that two targets share.
  list.attempt("capture", [&] { capture = readCapture(folder); });
  if (!capture) return list.check();
  list.attempt("pictures", [&] { checkPictures(*capture, list); });
  if (options.detect > 0) list.attempt("detector", [&] { checkDetector(*capture, options, list); });
  return list.check();
}

}  // namespace poecal
