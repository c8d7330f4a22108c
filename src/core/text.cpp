#include "poecal/core/text.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "poecal/core/error.hpp"

namespace poecal {

std::string formatNumber(double value) {
  if (value == 0.0) return "0.0";  // also for -0, whose sign means nothing in our files
  std::string text = fmt::format("{}", value);
  // Always with a point: YAML 1.1 readers take 1e-05 for a text and 3 for an integer.
  if (std::isfinite(value) && text.find('.') == std::string::npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

std::string readTextFile(const std::filesystem::path& file) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(file, status)) throw FileError(file, 0, "no such file");
  std::ifstream stream(file, std::ios::binary);
  // All at once: a picture would otherwise grow through a dozen buffers, each of fresh pages.
  const std::uintmax_t size = std::filesystem::file_size(file, status);
  std::string content(status ? 0 : static_cast<std::size_t>(size), '\0');
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<std::size_t>(stream.gcount()));
  if (stream.is_open() && !stream.bad()) content.append(std::istreambuf_iterator<char>(stream), {});  // of a file that has no size, or grew
  if (stream.bad() || !stream.is_open()) throw FileError(file, 0, "cannot be read");
  return content;
}

void writeTextFile(const std::filesystem::path& file, const std::string& content) {
  std::error_code status;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), status);
  if (status) throw FileError(file.parent_path(), 0, "the folder cannot be made: " + status.message());
  std::filesystem::path part = file;
  part += fmt::format(".{}.part", ::getpid());
  {
    std::ofstream stream(part, std::ios::binary | std::ios::trunc);
    stream << content;
    stream.close();
    if (!stream) {
      std::filesystem::remove(part, status);
      throw FileError(file, 0, "cannot be written");
    }
  }
  std::filesystem::rename(part, file, status);
  if (status) {
    const std::string reason = status.message();
    std::filesystem::remove(part, status);
    throw FileError(file, 0, "cannot be written: " + reason);
  }
}

}  // namespace poecal
