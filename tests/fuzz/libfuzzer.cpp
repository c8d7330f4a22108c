// libFuzzer's way in. $POECAL_FUZZ_READER names the reader; $POECAL_FUZZ_SEEDS a folder to write its first inputs into.
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "fuzz/readers.hpp"
#include "poecal/core/text.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path& cell() {
  static const fs::path folder = fs::temp_directory_path() / ("poecal-fuzz-" + std::to_string(::getpid()));
  return folder;
}

const poecal::test::Reader& reader() {
  static const char* const name = std::getenv("POECAL_FUZZ_READER");
  static const poecal::test::Reader& chosen = poecal::test::readerNamed(name != nullptr ? name : "");
  return chosen;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  poecal::test::writeCell(cell());
  std::atexit([] {
    std::error_code status;
    fs::remove_all(cell(), status);
  });
  if (const char* const folder = std::getenv("POECAL_FUZZ_SEEDS")) {
    for (poecal::test::Seed& seed : poecal::test::seedsOf(reader())) {
      for (char& c : seed.name) c = c == '/' ? '-' : c;
      poecal::writeTextFile(fs::path(folder) / seed.name, seed.bytes);
    }
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  poecal::test::feed(reader(), cell(), {reinterpret_cast<const char*>(data), size});
  return 0;
}
