#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include <fmt/format.h>

#include "calibration/check_parts.hpp"
#include "calibration/row_contradictions.hpp"
#include "detection/picture_header.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/capture/image_names.hpp"
#include "poecal/cell/known_registration.hpp"
#include "poecal/cell/observation.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/detection/detect_capture.hpp"
#include "poecal/registration/implausible.hpp"
#include "poecal/registration/registration.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

/// The size that a picture's header states. @throws FileError where the picture is not there or is none.
ImageSize sizeOf(const fs::path& picture) {
  constexpr std::size_t kHeader = std::size_t{1} << 20U;  // a camera's notes and its small picture may stand before the size
  std::error_code status;
  if (!fs::is_regular_file(picture, status)) throw FileError(picture, 0, "is not there, expected a picture");
  std::ifstream file(picture, std::ios::binary);
  std::string bytes(kHeader, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  const auto size = sizeInHeader(bytes);
  if (!size) throw FileError(picture, 0, "is no picture that can be read, expected PNG, JPEG or TIFF");
  return *size;
}

/// "a, b, c and 7 more".
std::string some(const std::vector<std::string>& all) {
  constexpr std::size_t kShown = 3;
  std::string text;
  for (std::size_t k = 0; k < std::min(kShown, all.size()); ++k) text += (k == 0 ? "" : ", ") + all[k];
  return all.size() > kShown ? fmt::format("{} and {} more", text, all.size() - kShown) : text;
}

void sayPictures(const Capture& capture, CheckList& list) {
  std::vector<std::string> missing, unreadable, other_size;
  ImageSize expected = capture.camera ? ImageSize{capture.camera->width, capture.camera->height} : ImageSize{};
  std::size_t good = 0;
  Progress told(list.progress(), "looking at pictures", capture.table.samples.size());
  for (const Sample& sample : capture.table.samples) {
    const fs::path picture = capture.folder / sample.image;
    std::error_code status;
    if (!fs::exists(picture, status)) {
      missing.push_back(sample.image);
      told.advance();
      continue;
    }
    try {
      const ImageSize size = sizeOf(picture);
      if (expected.width == 0) expected = size;
      if (size == expected) {
        ++good;
      } else {
        other_size.push_back(fmt::format("{} ({} x {} px)", sample.image, size.width, size.height));
      }
    } catch (const FileError&) {
      unreadable.push_back(sample.image);
    }
    told.advance();
  }
  const auto say = [&list](const std::vector<std::string>& wrong, const std::string& what) {
    if (!wrong.empty())
      list.add(CheckLevel::kError, "pictures", fmt::format("{} {}: {}", counted(wrong.size(), "picture"), what, some(wrong)));
  };
  say(missing, "named in samples.csv but missing");
  say(unreadable, "cannot be read, expected PNG, JPEG or TIFF");
  say(other_size, fmt::format("of another size than the {} x {} px {}", expected.width, expected.height,
                              capture.camera && capture.camera->width > 0 ? "of the camera" : "of the first"));
  if (good > 0) list.add(CheckLevel::kOk, "pictures", fmt::format("{} of {} x {} px", good, expected.width, expected.height));
}

/// How much of the picture the corners cover, and how large the target is there.
void sayCoverage(const Detections& detections, const ImageSize& size, CheckList& list) {
  constexpr int kColumns = 6, kRows = 4;
  std::set<int> cells;
  std::vector<double> widths;
  for (const ImageCorners& image : detections.images) {
    Eigen::AlignedBox2d box;
    for (const Corner& corner : image.corners) {
      box.extend(corner.px);
      const auto cell = [](double at, int length, int count) { return std::clamp(static_cast<int>(at / length * count), 0, count - 1); };
      cells.insert(cell(corner.px.y(), size.height, kRows) * kColumns + cell(corner.px.x(), size.width, kColumns));
    }
    if (!image.corners.empty()) widths.push_back(box.sizes().maxCoeff());
  }
  const double share = static_cast<double>(cells.size()) / (kColumns * kRows);
  const double width = median(widths);
  constexpr double kWell = 0.6, kWide = 40.0;
  list.add(share >= kWell ? CheckLevel::kOk : CheckLevel::kAdvice, "corners",
           fmt::format("seen in {:.0f} % of the picture{}", 100.0 * share,
                       share >= kWell ? "" : ": also move the target near its edges, where lens distortion shows"));
  list.add(width >= kWide ? CheckLevel::kOk : CheckLevel::kAdvice, "corners",
           fmt::format("the target is {:.0f} px wide in the median picture{}", width,
                       width >= kWide ? "" : ": go nearer or use a larger one, 40 px or more"));
}

/// What a calibration would refuse, before anything is fitted that takes long. Too little of something is said by what lacks.
void tryRegistration(const Capture& capture, const Detections& detections, CheckList& list) {
  Cell cell;
  cell.camera = capture.camera;
  if (capture.table.has_joints) cell.arm = capture.arm;
  cell.registration.setup = capture.setup;
  list.attempt("registration", [&] {
    if (!capture.registration_file.empty()) readKnownRegistration(capture.registration_file, cell.registration);
    try {
      const RegistrationResult result =
          registerCell(cell, cornerObservations(capture.table, detections, capture.target), {.progress = list.progress()});
      // Zeros that are off by a degree leave a hundredth of a usual picture's width.
      constexpr double kFarOff = 0.03;
      const bool far = capture.camera && capture.camera->width > 0 && result.rms_px > kFarOff * capture.camera->width;
      list.add(far ? CheckLevel::kAdvice : CheckLevel::kOk, "registration",
               fmt::format("as the robot is stated, the readings explain the corners to {:.3g} px{}", result.rms_px,
                           far ? ", which is far for an arm made to its tolerances: is a zero, or a joint's type, axis or length in the "
                                 "robot's file wrong?"
                               : ""));
      for (const std::string& warning : result.warnings) list.add(CheckLevel::kAdvice, "registration", warning);
    } catch (const ImplausibleInput& suspicion) {
      throw fileErrorOf(suspicion, capture);
    } catch (const InsufficientData&) {
    }
  });
}

void sayDetections(const Capture& capture, CheckList& list) {
  const Target* reference = capture.reference ? &*capture.reference : nullptr;
  std::optional<ImageSize> size;
  if (capture.camera && capture.camera->width > 0) size = ImageSize{capture.camera->width, capture.camera->height};
  Detections detections = readDetections(capture.detections_file, capture.target, reference, size);
  for (const std::string& warning : checkImagesMeet(capture.table, detections, capture.detections_file)) {
    list.add(CheckLevel::kAdvice, "corners", warning);
  }
  for (const std::string& remark : remarksOnCorners(capture.detections_file, detections)) list.add(CheckLevel::kAdvice, "corners", remark);
  for (ImageCorners& image : detections.images) {
    std::erase_if(image.corners, [&capture](const Corner& corner) { return capture.target.find(corner.id) == nullptr; });
  }
  std::size_t corners = 0, pictures = 0;
  for (const ImageCorners& image : detections.images) {
    corners += image.corners.size();
    pictures += image.corners.empty() ? 0 : 1;
  }
  if (pictures == 0) {
    list.add(CheckLevel::kTooLittle, "corners", capture.detections_file.string() + ": no corners of the target");
    return;
  }
  list.add(CheckLevel::kOk, "corners", fmt::format("{} in {}, found earlier", counted(corners, "corner"), counted(pictures, "picture")));
  if (!size) return;
  sayCoverage(detections, *size, list);
  const bool told_apart = list.attempt("corners", [&] {
    for (const std::string& remark : compareCornersOfPictures(capture.table, detections)) list.add(CheckLevel::kAdvice, "corners", remark);
  });
  if (told_apart) tryRegistration(capture, detections, list);
}

}  // namespace

void checkPictures(const Capture& capture, CheckList& list) {
  if (capture.detections_file.empty()) {
    sayPictures(capture, list);
    list.attempt("pictures", [&] {
      for (const std::string& remark : compareBytesOfPictures(capture, list.progress())) list.add(CheckLevel::kAdvice, "pictures", remark);
    });
  } else {
    sayDetections(capture, list);
  }
}

void checkIntrinsicsFolder(const fs::path& folder, CheckList& list) {
  list.attempt("intrinsics", [&] { readTarget(folder / "target.yaml"); });
  const std::vector<std::string> pictures = listPictures(folder);
  constexpr std::size_t kNeeded = 3, kAdvised = 10;
  const std::string text = fmt::format("{} in {}", counted(pictures.size(), "picture"), folder.string());
  if (pictures.size() < kNeeded) {
    list.add(CheckLevel::kTooLittle, "intrinsics",
             fmt::format("{}: at least {} of the board are needed, 15 or more advised", text, kNeeded));
  } else {
    list.add(pictures.size() < kAdvised ? CheckLevel::kAdvice : CheckLevel::kOk, "intrinsics",
             text + (pictures.size() < kAdvised ? ": 15 or more, tilted both ways, are better" : ""));
  }
}

void checkDetector(const Capture& capture, const CheckOptions& options, CheckList& list) {
  const std::size_t all = capture.table.samples.size();
  const std::size_t count = std::min(all, static_cast<std::size_t>(options.detect));
  Capture tried = capture;
  tried.table.samples.clear();
  for (std::size_t k = 0; k < count; ++k) tried.table.samples.push_back(capture.table.samples[k * all / count]);
  takeSizeFromPictures(tried);
  DetectOptions detecting;
  detecting.jobs = options.jobs;
  detecting.camera = tried.camera;
  detecting.progress = list.progress();
  const DetectResult result = detectCapture(tried, detecting);
  std::size_t seen = 0;
  for (const ImageCorners& image : result.detections.images) {
    seen += std::any_of(image.corners.begin(), image.corners.end(),
                        [&](const Corner& corner) { return capture.target.find(corner.id) != nullptr; });
  }
  for (const PictureNote& note : result.notes) list.add(CheckLevel::kAdvice, "detector", note.text());
  list.add(seen == 0          ? CheckLevel::kTooLittle
           : 2 * seen < count ? CheckLevel::kAdvice
                              : CheckLevel::kOk,
           "detector", fmt::format("the target was found in {} of {} tried", seen, counted(count, "picture")));
}

}  // namespace poecal
