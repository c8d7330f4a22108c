// Every reader of a file, as a function of bytes that may come from anybody.
#pragma once

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace poecal::test {

/// What a reader must not do: its error is none of an input, names no file, or holds what a terminal obeys; what it read cannot be written
/// and read again.
class Fault : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

struct Reader {
  std::string name;                   ///< also of the folder of its corpus
  std::string file;                   ///< where the bytes are put, in a cell
  std::vector<std::string> examples;  ///< of calib_data/FORMATS.md or calib_data itself, to begin with
  std::string functions;              ///< the library's functions that it calls, separated by blanks
  /// Reads the file with all functions that take its kind. Errors of poecal's are its own to throw.
  std::function<void(const std::filesystem::path& cell)> read;
  std::size_t cost = 1;  ///< how many inputs of the others take as long as one of its own
};

const std::vector<Reader>& readers();
/// @throws std::runtime_error where there is none of that name.
const Reader& readerNamed(const std::string& name);

/// Fills a folder with what the files under test stand beside: all examples of calib_data/FORMATS.md, an arm as a URDF, results.
void writeCell(const std::filesystem::path& folder);

/// Inputs to begin with: the examples, and the files of tests/fuzz/corpus/NAME by name.
struct Seed {
  std::string name, bytes;
};
std::vector<Seed> seedsOf(const Reader& reader);

/// Puts `bytes` in their place and reads them.
/// @returns whether they were read without an error. @throws Fault, and whatever else the reader lets through.
bool feed(const Reader& reader, const std::filesystem::path& cell, std::string_view bytes);

}  // namespace poecal::test
