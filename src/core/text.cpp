#include "poecal/core/text.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/utf8.hpp"
#include "poecal/core/error.hpp"

namespace poecal {
namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 31;

/// An open file, closed at the end.
class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Descriptor(Descriptor&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

std::string lastReason() { return std::generic_category().message(errno); }

[[noreturn]] void failToRead(const std::filesystem::path& file, const std::string& reason) {
  throw FileError(file, 0, "cannot be read: " + reason);
}

[[noreturn]] void failAsTooLarge(const std::filesystem::path& file) {
  throw FileError(file, 0, "is larger than 2 GiB, expected a smaller file");
}

[[noreturn]] void failToWrite(const std::filesystem::path& file, const std::filesystem::path& part, const std::string& reason) {
  ::unlink(part.c_str());
  throw FileError(file, 0, "cannot be written: " + reason);
}

void requireRegular(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (std::filesystem::is_regular_file(status)) return;
  if (status.type() == std::filesystem::file_type::not_found) throw FileError(file, 0, "no such file");
  if (status.type() == std::filesystem::file_type::none) failToRead(file, error.message());
  throw FileError(file, 0, std::filesystem::is_directory(status) ? "is a folder, expected a file" : "is no regular file, expected one");
}

/// The temporary file, empty and held by nobody else. Who held it before may have moved it to its place meanwhile: then it is another one.
Descriptor openAlone(const std::filesystem::path& part, const std::filesystem::path& file) {
  for (;;) {
    Descriptor descriptor(::open(part.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666));
    if (descriptor.get() < 0) throw FileError(file, 0, "cannot be written: " + lastReason());
    ::flock(descriptor.get(), LOCK_EX);  // not every file system has locks; it is written without one there
    struct stat held {
    }, named{};
    if (::fstat(descriptor.get(), &held) != 0) failToWrite(file, part, lastReason());
    if (::lstat(part.c_str(), &named) != 0 || held.st_ino != named.st_ino || held.st_dev != named.st_dev) continue;
    if (::ftruncate(descriptor.get(), 0) != 0) failToWrite(file, part, lastReason());
    return descriptor;
  }
}

}  // namespace

std::string formatNumber(double value) {
  if (value == 0.0) return "0.0";  // also for -0, whose sign means nothing in our files
  std::string text = fmt::format("{}", value);
  // Always with a point: YAML 1.1 readers take 1e-05 for a text and 3 for an integer.
  if (std::isfinite(value) && text.find('.') == std::string::npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

std::string readTextFile(const std::filesystem::path& file) {
  requireRegular(file);
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.get() < 0) failToRead(file, lastReason());
  struct stat status {};
  if (::fstat(descriptor.get(), &status) != 0) failToRead(file, lastReason());
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > kLargestFile) failAsTooLarge(file);
  // All at once: a picture would otherwise grow through a dozen buffers, each of fresh pages. One byte more tells the end of the file.
  std::string content(size + 1, '\0');
  std::size_t filled = 0;
  for (;;) {
    const ssize_t count = ::read(descriptor.get(), content.data() + filled, content.size() - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) failToRead(file, lastReason());
    if (count == 0) break;
    filled += static_cast<std::size_t>(count);
    if (filled > kLargestFile) failAsTooLarge(file);
    if (filled == content.size()) content.resize(2 * filled + 4096);  // of a file that has no size, or grew
  }
  content.resize(filled);
  return content;
}

void requireReplaceable(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::symlink_status(file, error);
  if (status.type() == std::filesystem::file_type::not_found || std::filesystem::is_regular_file(status)) return;
  if (status.type() == std::filesystem::file_type::none) throw FileError(file, 0, "cannot be written: " + error.message());
  throw FileError(file, 0, "is there and no regular file, expected a new name or a file to replace");
}

bool looksLikeXml(std::string_view content) {
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
  const std::size_t begin = content.find_first_not_of(" \t\r\n");
  return begin != std::string_view::npos && content[begin] == '<';
}

std::string readUtf8File(const std::filesystem::path& file) {
  std::string content = readTextFile(file);
  int line = 1;
  for (std::string_view rest = content; !rest.empty();) {
    const Utf8Sign sign = firstSign(rest);
    if (!sign.code) {
      const auto byte = static_cast<unsigned char>(rest.front());
      throw FileError(file, line, fmt::format("byte 0x{:02X} is not UTF-8, expected a text in UTF-8", byte));
    }
    line += *sign.code == '\n';
    rest.remove_prefix(sign.bytes.size());
  }
  return content;
}

void writeTextFile(const std::filesystem::path& file, const std::string& content) {
  std::error_code status;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), status);
  if (status) throw FileError(file.parent_path(), 0, "the folder cannot be made: " + status.message());
  requireReplaceable(file);
  std::filesystem::path part = file;
  part += ".part";
  const Descriptor descriptor = openAlone(part, file);
  for (std::string_view rest = content; !rest.empty();) {
    const ssize_t written = ::write(descriptor.get(), rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) failToWrite(file, part, lastReason());
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::rename(part.c_str(), file.c_str()) != 0) failToWrite(file, part, lastReason());
}

}  // namespace poecal
