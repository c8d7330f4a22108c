// UTF-8 taken apart. Private, so that Boost stays out of the public headers.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <boost/locale/utf.hpp>

namespace poecal {

/// The sign that `rest` begins with.
struct Utf8Sign {
  std::optional<std::uint32_t> code;  ///< nothing where the first byte begins no sign of UTF-8
  std::string_view bytes;             ///< its bytes; one byte where there is no sign
};

/// @param rest  not empty.
inline Utf8Sign firstSign(std::string_view rest) {
  using Utf8 = boost::locale::utf::utf_traits<char>;
  const char* at = rest.data();
  const boost::locale::utf::code_point code = Utf8::decode(at, rest.data() + rest.size());
  if (!boost::locale::utf::is_valid_codepoint(code)) return {std::nullopt, rest.substr(0, 1)};
  return {code, rest.substr(0, static_cast<std::size_t>(at - rest.data()))};
}

/// Whether all of a text is UTF-8.
inline bool isUtf8(std::string_view text) {
  while (!text.empty()) {
    const Utf8Sign sign = firstSign(text);
    if (!sign.code) return false;
    text.remove_prefix(sign.bytes.size());
  }
  return true;
}

}  // namespace poecal
