// Files as text: read whole, written whole or not at all; numbers that read back as the same bits.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace poecal {

/// Larger numbers in a file are no figure of anything, and products of them no numbers: to the readers they are not finite.
constexpr double kLargestNumber = 1e30;

/// Shortest decimal text that reads back as exactly `value`; always with a point (YAML 1.1 needs it), or "nan", "inf", "-inf".
std::string formatNumber(double value);

/// Content of a file, at most 2 GiB. @throws FileError: there is none, it is no regular file, it cannot be read (with the system's reason).
std::string readTextFile(const std::filesystem::path& file);

/// Whether the first sign of a file's content, after spaces and a byte order mark, is '<'.
bool looksLikeXml(std::string_view content);

/// readTextFile() of a file that must be UTF-8. @throws FileError with the line and the byte where it is not.
std::string readUtf8File(const std::filesystem::path& file);

/// @throws FileError where something is at `file` that a result must not replace: a folder, a device, a symbolic link.
void requireReplaceable(const std::filesystem::path& file);

/// Writes `content` to a temporary file beside `file` and renames it, so that `file` is the old or the new content, never a part.
/// Makes the parent folder. What a killed program left of the temporary file is used again; two programs that write one file wait for each
/// other.
/// @throws FileError where the folder or the file cannot be written, or where something is there that is no regular file.
void writeTextFile(const std::filesystem::path& file, const std::string& content);

}  // namespace poecal
