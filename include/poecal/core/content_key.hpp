// Fingerprints: tell whether something was made from the same bytes and options as before.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace poecal {

/// 128 bits of XXH3 over `bytes` alone, 32 hexadecimal digits: whether a file is as it was, whichever build asks.
std::string checksum(std::string_view bytes);

/// 128 bits of XXH3 over the program's version, the key of its build and everything added, in order. The borders between the pieces count
/// too:
/// ("ab", "c") and ("a", "bc") differ.
class ContentKey {
 public:
  ContentKey();
  ~ContentKey();
  ContentKey(const ContentKey&) = delete;
  ContentKey& operator=(const ContentKey&) = delete;

  ContentKey& add(std::string_view bytes);
  /// The name of a file (without its folder) and its bytes, which are read in blocks; a missing file counts as an empty one.
  ContentKey& addFile(const std::filesystem::path& file);
  std::string text() const;  ///< 32 hexadecimal digits

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace poecal
