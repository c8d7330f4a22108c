#include "detection/picture_header.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <limits>

namespace poecal {
namespace {

/// Numbers in a file's bytes; what lies behind the end is nothing.
class Bytes {
 public:
  Bytes(std::string_view bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}

  std::optional<std::uint64_t> number(std::uint64_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) return std::nullopt;
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t byte = static_cast<std::size_t>(at) + (big_endian_ ? k : size - 1 - k);
      value = (value << 8) | static_cast<std::uint8_t>(bytes_[byte]);
    }
    return value;
  }

 private:
  std::string_view bytes_;
  bool big_endian_;
};

int clamped(std::uint64_t value) { return static_cast<int>(std::min<std::uint64_t>(value, std::numeric_limits<int>::max())); }

std::optional<ImageSize> sizeOf(const std::optional<std::uint64_t>& width, const std::optional<std::uint64_t>& height) {
  if (!width || !height || *width == 0 || *height == 0) return std::nullopt;
  return ImageSize{clamped(*width), clamped(*height)};
}

std::optional<ImageSize> pngSize(std::string_view bytes) {
  const Bytes file(bytes, true);
  return sizeOf(file.number(16, 4), file.number(20, 4));
}

/// Walks the segments to the first frame header (SOF0 to SOF15, but for the tables DHT, JPG and DAC among these numbers).
std::optional<ImageSize> jpegSize(std::string_view bytes) {
  const Bytes file(bytes, true);
  for (std::uint64_t at = 2;;) {
    const auto marker = file.number(at, 2);
    if (!marker || (*marker >> 8) != 0xFF) return std::nullopt;
    const std::uint64_t kind = *marker & 0xFF;
    if (kind == 0xFF) {  // a fill byte
      ++at;
      continue;
    }
    if (kind == 0x01 || (kind >= 0xD0 && kind <= 0xD8)) {  // without a length
      at += 2;
      continue;
    }
    if (kind >= 0xC0 && kind <= 0xCF && kind != 0xC4 && kind != 0xC8 && kind != 0xCC)
      return sizeOf(file.number(at + 7, 2), file.number(at + 5, 2));
    const auto length = file.number(at + 2, 2);
    if (!length || *length < 2) return std::nullopt;
    at += 2 + *length;
  }
}

/// The tags ImageWidth and ImageLength of the first directory, of a TIFF or a BigTIFF.
std::optional<ImageSize> tiffSize(std::string_view bytes) {
  constexpr std::uint64_t kWidth = 256, kLength = 257;
  const Bytes file(bytes, bytes.starts_with("MM"));
  const bool big = file.number(2, 2) == 43;
  const auto directory = big ? file.number(8, 8) : file.number(4, 4);
  if (!directory) return std::nullopt;
  const auto count = file.number(*directory, big ? 8 : 2);
  std::optional<std::uint64_t> width, length;
  const std::uint64_t entry_size = big ? 20 : 12;
  for (std::uint64_t k = 0; count && k < *count; ++k) {
    const std::uint64_t entry = *directory + (big ? 8 : 2) + k * entry_size;
    const auto tag = file.number(entry, 2), type = file.number(entry + 2, 2);
    if (!tag || !type) break;
    if (*tag != kWidth && *tag != kLength) continue;
    const std::size_t size = *type == 3 ? 2 : *type == 4 ? 4 : 8;
    (*tag == kWidth ? width : length) = file.number(entry + (big ? 12 : 8), size);
  }
  return sizeOf(width, length);
}

/// Heights below zero are of pictures whose first row is the upper one.
std::optional<ImageSize> bmpSize(std::string_view bytes) {
  const Bytes file(bytes, false);
  const auto header = file.number(14, 4);
  if (!header) return std::nullopt;
  if (*header == 12) return sizeOf(file.number(18, 2), file.number(20, 2));
  auto height = file.number(22, 4);
  if (height && *height > std::numeric_limits<std::int32_t>::max()) height = (std::uint64_t{1} << 32) - *height;
  return sizeOf(file.number(18, 4), height);
}

/// The first two numbers behind P1 to P6; lines of comments begin with #.
std::optional<ImageSize> pnmSize(std::string_view bytes) {
  std::optional<std::uint64_t> numbers[2];
  bytes.remove_prefix(2);
  for (auto& number : numbers) {
    for (;;) {
      bytes.remove_prefix(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
      if (!bytes.starts_with('#')) break;
      bytes.remove_prefix(std::min(bytes.find('\n'), bytes.size()));
    }
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(bytes.data(), bytes.data() + bytes.size(), value);
    if (error != std::errc()) return std::nullopt;
    number = value;
    bytes.remove_prefix(static_cast<std::size_t>(end - bytes.data()));
  }
  return sizeOf(numbers[0], numbers[1]);
}

}  // namespace

std::optional<ImageSize> sizeInHeader(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("\x89PNG\r\n\x1a\n"sv)) return pngSize(bytes);
  if (bytes.starts_with("\xFF\xD8\xFF"sv)) return jpegSize(bytes);
  for (const std::string_view signature : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv}) {
    if (bytes.starts_with(signature)) return tiffSize(bytes);
  }
  if (bytes.starts_with("BM")) return bmpSize(bytes);
  if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6') return pnmSize(bytes);
  return std::nullopt;
}

}  // namespace poecal
