#include "poecal/calibration/model_of_capture.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

std::string differenceOfJoints(const Arm& expected, const Arm& arm) {
  if (arm.jointCount() != expected.jointCount()) {
    return fmt::format("its arm has {} joints, expected the {} of the capture", arm.jointCount(), expected.jointCount());
  }
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    if (arm.joints[k].name != expected.joints[k].name || arm.joints[k].type != expected.joints[k].type) {
      return fmt::format("its joint {} is '{}', expected '{}' as in the capture", k + 1, arm.joints[k].name, expected.joints[k].name);
    }
  }
  const std::string axes = differenceOfArms(expected, arm);
  return axes.empty() ? "" : fmt::format("is a model of {}, expected one of the capture's arm {}: {}", arm.name, expected.name, axes);
}

bool sameTarget(const Target& expected, const Target& target) {
  constexpr double kSame = 1e-9;  // [m]
  return expected.points.size() == target.points.size() &&
         std::all_of(expected.points.begin(), expected.points.end(), [&target](const TargetPoint& point) {
           const TargetPoint* same = target.find(point.id);
           return same != nullptr && (same->p_target - point.p_target).norm() <= kSame;
         });
}

/// What makes a model one of another cell; empty where nothing does.
std::string difference(const CellParts& cell, const Model& model) {
  if (cell.arm != nullptr) {
    const std::string joints = differenceOfJoints(*cell.arm, *model.cell.arm);
    if (!joints.empty()) return joints;
  }
  if (!model.cell.camera) return "";  // found from poses of an instrument, whose frame and tool are no part of a capture
  const Setup setup = model.cell.registration.setup;
  if (setup != cell.setup) {
    return fmt::format("its setup is {}, expected {} as in the capture", setupName(setup), setupName(cell.setup));
  }
  const Camera& camera = *model.cell.camera;
  if (cell.camera != nullptr && cell.camera->width > 0 && (camera.width != cell.camera->width || camera.height != cell.camera->height)) {
    return fmt::format("its pictures are {} x {}, expected the {} x {} of the capture", camera.width, camera.height, cell.camera->width,
                       cell.camera->height);
  }
  if (cell.target != nullptr && model.target && !sameTarget(*cell.target, *model.target)) return "its target is not that of the capture";
  return "";
}

}  // namespace

CellParts partsOf(const Capture& capture) {
  return {capture.setup, capture.arm ? &*capture.arm : nullptr, capture.camera ? &*capture.camera : nullptr, &capture.target};
}

void requireModelOf(const CellParts& cell, const Model& model, const std::filesystem::path& model_file) {
  const std::string other = difference(cell, model);
  if (!other.empty()) throw FileError(model_file, 1, other);
}

}  // namespace poecal
