#include "poecal/detection/detector.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <mutex>
#include <new>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "detection/corner_finder.hpp"
#include "detection/family_hint.hpp"
#include "detection/picture.hpp"
#include "detection/picture_header.hpp"
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
      return makeCharucoFinder(target, options.refine);
    case TargetType::kChessboard:
      return makeChessboardFinder(target, options.refine);
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
  try {
    FoundCorners found = finders.find(picture.grey);
    return {std::move(found.corners), std::move(found.notes), picture.grey.cols, picture.grey.rows, found.look};
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) throw std::bad_alloc();
    return unreadable("cannot be searched: " + error.err);
  }
}

/// search(), where it was not done before.
PictureFinding searchOnce(const PictureFile& file, FinderPool& finders, const std::string& detection_key, KnownCorners& known) {
  const std::string key = pictureKey(detection_key, file.bytes);
  if (std::optional<PictureFinding> before = known.find(key)) return *std::move(before);
  PictureFinding finding = search(file, finders);
  // A file that is no picture is told so in no time.
  if (isReadable(finding)) known.add(key, finding);
  return finding;
}

/// A picture whose header states another size than `size` is not decoded: that takes memory and time, and nothing comes of it.
PictureFinding searchOfSize(const PictureFile& file, const ImageSize& size, const std::function<PictureFinding()>& whole_search) {
  if (file.bytes.empty()) return unreadable(file.problem);
  const std::optional<ImageSize> stated = sizeInHeader(file.bytes);
  if (stated && *stated != size) return {{}, {}, stated->width, stated->height};
  return whole_search();
}

/// The size that all pictures must have: what is expected, or that which most of their headers state, the first of these where several do.
ImageSize commonSize(const std::filesystem::path& folder, const std::vector<std::string>& images, const DetectOptions& options) {
  if (options.expected_width > 0 && options.expected_height > 0) return {options.expected_width, options.expected_height};
  std::vector<std::pair<ImageSize, int>> sizes;
  for (const std::string& image : images) {
    const std::optional<ImageSize> size = sizeInHeader(readPictureFile(folder / image).bytes);
    if (!size) continue;
    const auto known = std::find_if(sizes.begin(), sizes.end(), [&](const auto& entry) { return entry.first == *size; });
    if (known == sizes.end()) {
      sizes.emplace_back(*size, 1);
    } else {
      ++known->second;
    }
  }
  const auto most = std::max_element(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == sizes.end() ? ImageSize{} : most->first;
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
  ImageSize size = commonSize(folder, images, options);
  Progress progress(options.progress, "detecting", images.size());
  parallelFor(images.size(), options.jobs, [&](std::size_t k) {
    try {
      const PictureFile file = readPictureFile(folder / images[k]);
      findings[k] =
          searchOfSize(file, size, [&] { return known != nullptr ? searchOnce(file, finders, key, *known) : search(file, finders); });
    } catch (const std::bad_alloc&) {
      throw OutOfMemory("to search " + images[k]);
    }
    progress.advance();
  });

  const bool any_size = options.expected_width > 0 || std::any_of(findings.begin(), findings.end(), isReadable);
  if (!any_size) size = {};
  DetectResult result;
  result.width = size.width;
  result.height = size.height;
  std::vector<std::string> readable;
  bool any_corners = false;
  for (std::size_t k = 0; k < images.size(); ++k) {
    PictureFinding& finding = findings[k];
    if (isReadable(finding) && ImageSize{finding.width, finding.height} != size) {
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
  std::error_code status, unknown;
  std::vector<std::string> names;
  // What is no file that can be read is told with the pictures, not passed over.
  for (const auto& entry : std::filesystem::directory_iterator(folder, status)) {
    std::string extension = entry.path().extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (!entry.is_directory(unknown) && kExtensions.contains(extension)) names.push_back(entry.path().filename().string());
  }
  if (status) throw FileError(folder, 0, "is not a folder that can be read");
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace poecal
