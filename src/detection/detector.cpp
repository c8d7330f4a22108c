#include "poecal/detection/detector.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <mutex>
#include <set>

#include <fmt/format.h>

#include "detection/corner_finder.hpp"
#include "detection/family_hint.hpp"
#include "detection/picture.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/parallel.hpp"
#include "poecal/core/progress.hpp"
#include "poecal/detection/known_corners.hpp"
#include "target/names.hpp"

namespace poecal {
namespace {

std::unique_ptr<CornerFinder> makeFinder(const Target& target, const DetectOptions& options) {
  switch (target.type) {
    case TargetType::kAprilTag:
    case TargetType::kAprilGrid:
      return makeAprilTagFinder(target, options);
    case TargetType::kCharuco:
      return makeCharucoFinder(target);
    case TargetType::kChessboard:
      return makeChessboardFinder(target);
    case TargetType::kPoints:
      break;
  }
  throw InvalidArgument("a target of type points is found by another detector, expected its corners in detections.csv");
}

/// Finders that wait for a picture: as many as there are threads, each with its tables made once.
class FinderPool {
 public:
  FinderPool(const Target& target, const DetectOptions& options) : target_(target), options_(options) {
    idle_.push_back(makeFinder(target, options));
  }

  FoundCorners find(const cv::Mat& grey) {
    std::unique_ptr<CornerFinder> finder = take();
    FoundCorners finding = finder->find(grey);
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(finder));
    return finding;
  }

 private:
  std::unique_ptr<CornerFinder> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<CornerFinder> finder = std::move(idle_.back());
        idle_.pop_back();
        return finder;
      }
    }
    return makeFinder(target_, options_);
  }

  const Target& target_;
  const DetectOptions& options_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<CornerFinder>> idle_;
};

/// What is kept of a picture; 0 x 0 where it could not be read.
PictureFinding unreadable(const std::string& problem) { return {{}, {problem}}; }

bool isReadable(const PictureFinding& finding) { return finding.width > 0; }

PictureFinding search(const PictureFile& file, FinderPool& finders) {
  const Picture picture = decodePicture(file);
  if (picture.grey.empty()) return unreadable(picture.problem);
  FoundCorners found = finders.find(picture.grey);
  return {std::move(found.corners), std::move(found.notes), picture.grey.cols, picture.grey.rows, found.look};
}

/// search(), where it was not done before.
PictureFinding searchOnce(const PictureFile& file, FinderPool& finders, const std::string& detection_key, KnownCorners& known) {
  if (file.bytes.empty()) return unreadable(file.problem);
  const std::string key = pictureKey(detection_key, file.bytes);
  if (std::optional<PictureFinding> before = known.find(key)) return *std::move(before);
  PictureFinding finding = search(file, finders);
  // A file that is no picture is told so in no time.
  if (isReadable(finding)) known.add(key, finding);
  return finding;
}

/// The size that all pictures must have: what is expected, or that of the first one that could be read.
cv::Size commonSize(const std::vector<PictureFinding>& findings, const DetectOptions& options) {
  if (options.expected_width > 0 && options.expected_height > 0) return {options.expected_width, options.expected_height};
  for (const PictureFinding& finding : findings) {
    if (isReadable(finding)) return {finding.width, finding.height};
  }
  return {};
}

}  // namespace

void DetectOptions::validate() const {
  if (jobs < 0) throw InvalidArgument(fmt::format("jobs is {}, expected 0 or more", jobs));
  if (!(quad_decimate >= 1.0 && quad_decimate <= 16.0)) {
    throw InvalidArgument(fmt::format("quad_decimate is {}, expected 1 to 16", quad_decimate));
  }
  if (expected_width < 0 || expected_height < 0 || (expected_width == 0) != (expected_height == 0)) {
    throw InvalidArgument(
        fmt::format("the expected size is {} x {}, expected two positive numbers or 0 x 0", expected_width, expected_height));
  }
}

std::vector<std::string> texts(const std::vector<PictureNote>& notes) {
  std::vector<std::string> all;
  for (const PictureNote& note : notes) all.push_back(note.text());
  return all;
}

DetectResult detect(const std::filesystem::path& folder, const std::vector<std::string>& images, const Target& target,
                    const DetectOptions& options, KnownCorners* known) {
  options.validate();
  FinderPool finders(target, options);
  const std::string key = known != nullptr ? detectionKey(target, options) : "";
  std::vector<PictureFinding> findings(images.size());
  Progress progress(options.progress, "detecting", images.size());
  parallelFor(images.size(), options.jobs, [&](std::size_t k) {
    const PictureFile file = readPictureFile(folder / images[k]);
    findings[k] = known != nullptr ? searchOnce(file, finders, key, *known) : search(file, finders);
    progress.advance();
  });

  const cv::Size size = commonSize(findings, options);
  DetectResult result;
  result.width = size.width;
  result.height = size.height;
  std::vector<std::string> readable;
  bool any_corners = false;
  for (std::size_t k = 0; k < images.size(); ++k) {
    PictureFinding& finding = findings[k];
    if (isReadable(finding) && cv::Size(finding.width, finding.height) != size) {
      finding = {{}, {fmt::format("is {} x {} pixels, expected {} x {}", finding.width, finding.height, size.width, size.height)}};
    } else if (isReadable(finding)) {
      readable.push_back(images[k]);
    }
    any_corners = any_corners || !finding.corners.empty();
    for (std::string& message : finding.notes) result.notes.push_back({images[k], std::move(message), finding.corners.empty()});
    result.detections.images.push_back({images[k], std::move(finding.corners), finding.look});
  }
  if (!any_corners && (target.hasTags() || target.type == TargetType::kCharuco)) {
    if (const auto image = findMirrored(folder, readable, target)) {
      throw FileError(
          folder / *image, 0,
          fmt::format("shows the target's {} mirrored, expected the picture as the camera took it", target.hasTags() ? "tags" : "markers"));
    }
    if (auto hint = hintAtFamily(folder, readable, target)) result.notes.push_back(std::move(*hint));
  }
  return result;
}

std::vector<std::string> knownFamilies() {
  std::vector<std::string> names;
  for (const IdSet& family : tagFamilies()) names.emplace_back(family.name);
  return names;
}

std::vector<std::string> listPictures(const std::filesystem::path& folder) {
  static const std::set<std::string> kExtensions{".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp"};
  std::error_code status;
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder, status)) {
    std::string extension = entry.path().extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (entry.is_regular_file() && kExtensions.contains(extension)) names.push_back(entry.path().filename().string());
  }
  if (status) throw FileError(folder, 0, "is not a folder that can be read");
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace poecal
