#include "detection/picture.hpp"

#include <cstdint>
#include <new>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "detection/memory.hpp"
#include "detection/picture_header.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"

namespace poecal {
namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegSignature = "\xFF\xD8\xFF";

/// Walks the chunks of a PNG to its IEND.
bool pngIsWhole(std::string_view bytes) {
  constexpr std::size_t kOverhead = 12;  // length, type and checksum
  std::size_t at = kPngSignature.size();
  while (at + kOverhead <= bytes.size()) {
    std::size_t length = 0;
    for (std::size_t k = 0; k < 4; ++k) length = (length << 8) | static_cast<std::uint8_t>(bytes[at + k]);
    const bool last = bytes.substr(at + 4, 4) == "IEND";
    at += kOverhead + length;
    if (last) return at <= bytes.size();
  }
  return false;
}

/// Whether the last scan of a JPEG is ended. Neither marker can occur inside a scan, whose 0xFF bytes are followed by 0; a thumbnail's come
/// before.
bool jpegIsWhole(std::string_view bytes) {
  const std::size_t scan = bytes.rfind("\xFF\xDA");
  const std::size_t end = bytes.rfind("\xFF\xD9");
  return scan != std::string_view::npos && end != std::string_view::npos && end > scan;
}

/// OpenCV fills what is missing of a cut file with grey and says nothing.
bool isCutShort(std::string_view bytes) {
  if (bytes.starts_with(kPngSignature)) return !pngIsWhole(bytes);
  if (bytes.starts_with(kJpegSignature)) return !jpegIsWhole(bytes);
  return false;
}

cv::Mat decode(const std::string& bytes) {
  // imdecode only reads its input; the cast spares a copy of the file.
  const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
  const MemoryWatch watch;
  cv::Mat picture;
  try {
    picture = cv::imdecode(buffer, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) throw std::bad_alloc();
  }
  if (picture.empty()) watch.check();  // the decoders take memory that is refused for a broken file
  return picture;
}

cv::Mat toEightBit(const cv::Mat& wide) {
  double largest = 0.0;
  cv::minMaxLoc(wide, nullptr, &largest);
  cv::Mat grey;
  wide.convertTo(grey, CV_8U, 255.0 / (largest < 4096.0 ? 4095.0 : 65535.0));
  return grey;
}

}  // namespace

PictureFile readPictureFile(const std::filesystem::path& file) {
  try {
    PictureFile picture{readTextFile(file), ""};
    if (picture.bytes.empty()) picture.problem = "the file is empty";
    return picture;
  } catch (const FileError& error) {
    return {"", error.reason()};  // whoever tells it names the picture
  }
}

Picture decodePicture(const PictureFile& file) {
  if (file.bytes.empty()) return {{}, file.problem};
  constexpr const char* kNoPicture = "is not a picture that can be read, expected PNG, JPEG or TIFF";
  if (isCutShort(file.bytes)) return {{}, "the file is cut short"};
  const std::optional<ImageSize> size = sizeInHeader(file.bytes);
  if (!size) return {{}, kNoPicture};
  if (size->pixels() > kMostPixels) {
    return {{}, fmt::format("is {} x {} pixels, expected at most {:.0f} million", size->width, size->height, 1e-6 * kMostPixels)};
  }
  const cv::Mat picture = decode(file.bytes);
  if (picture.empty()) return {{}, kNoPicture};
  if (picture.depth() == CV_8U) return {picture, ""};
  if (picture.depth() == CV_16U) return {toEightBit(picture), ""};
  return {{}, "has pixels that are neither 8 nor 16 bit integers"};
}

Picture readPicture(const std::filesystem::path& file) { return decodePicture(readPictureFile(file)); }

}  // namespace poecal
