#include "detection/picture.hpp"

#include <cstdint>
#include <new>
#include <optional>
#include <string_view>

#include <boost/crc.hpp>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include "detection/memory.hpp"
#include "detection/picture_header.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/decoder_log.hpp"

namespace poecal {
namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegSignature = "\xFF\xD8\xFF";

std::uint32_t bigEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8U | static_cast<std::uint8_t>(bytes[k]);
  return value;
}

struct PngChunk {
  std::string_view type_and_data;
  std::uint32_t checksum = 0;

  /// A picture cannot be read without it.
  bool isNeeded() const { return type_and_data.front() >= 'A' && type_and_data.front() <= 'Z'; }
  bool isLast() const { return type_and_data.starts_with("IEND"); }
};

/// Takes the next chunk of a PNG off the front of `rest`; nothing where it is not there as a whole.
std::optional<PngChunk> takeChunk(std::string_view& rest) {
  constexpr std::size_t kNumber = 4, kType = 4, kOverhead = kNumber + kType + kNumber;  // length, type and checksum
  if (rest.size() < kOverhead) return {};
  const std::size_t length = bigEndian(rest);
  if (length > rest.size() - kOverhead) return {};
  const PngChunk chunk{rest.substr(kNumber, kType + length), bigEndian(rest.substr(kNumber + kType + length))};
  rest.remove_prefix(kOverhead + length);
  return chunk;
}

bool pngIsWhole(std::string_view bytes) {
  std::string_view rest = bytes.substr(kPngSignature.size());
  while (const std::optional<PngChunk> chunk = takeChunk(rest)) {
    if (chunk->isLast()) return true;
  }
  return false;
}

/// CRC-32 as PNG has it (ISO 3309).
std::uint32_t crc32(std::string_view bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return static_cast<std::uint32_t>(crc.checksum());
}

/// Whether a chunk that a picture needs is not what was written. libpng would say so on the standard error stream, and names no file.
bool pngIsDamaged(std::string_view bytes) {
  std::string_view rest = bytes.substr(kPngSignature.size());
  while (const std::optional<PngChunk> chunk = takeChunk(rest)) {
    if (chunk->isNeeded() && crc32(chunk->type_and_data) != chunk->checksum) return true;
    if (chunk->isLast()) return false;
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
  if (std::string_view(file.bytes).starts_with(kPngSignature) && pngIsDamaged(file.bytes)) {
    return {{}, "the file is damaged: its checksums are not those of its contents"};
  }
  const cv::Mat picture = decode(file.bytes);
  if (picture.empty()) return {{}, kNoPicture};
  if (picture.depth() == CV_8U) return {picture, ""};
  if (picture.depth() == CV_16U) return {toEightBit(picture), ""};
  return {{}, "has pixels that are neither 8 nor 16 bit integers"};
}

void silenceDecoders() { cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); }

Picture readPicture(const std::filesystem::path& file) { return decodePicture(readPictureFile(file)); }

}  // namespace poecal
