// Files as text: read whole, written whole or not at all; numbers that read back as the same bits.
#pragma once

#include <filesystem>
#include <string>

namespace poecal {

/// Shortest decimal text that reads back as exactly `value`; always with a point (YAML 1.1 needs it), or "nan", "inf", "-inf".
std::string formatNumber(double value);

/// Content of a file. @throws FileError if it cannot be opened or read.
std::string readTextFile(const std::filesystem::path& file);

/// Writes `content` to a temporary file beside `file` and renames it, so that `file` is the old or the new content, never a part.
/// Makes the parent folder. @throws FileError where the folder or the file cannot be written.
void writeTextFile(const std::filesystem::path& file, const std::string& content);

}  // namespace poecal
