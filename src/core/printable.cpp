#include "poecal/core/printable.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "core/utf8.hpp"

namespace poecal {
namespace {

/// Signs that are not seen or that turn the direction of writing (Unicode's Bidi_Control, line and paragraph separators, zero widths).
bool isHidden(std::uint32_t code) {
  return code == 0x061C || (code >= 0x200B && code <= 0x200F) || (code >= 0x2028 && code <= 0x202E) || (code >= 0x2060 && code <= 0x206F) ||
         code == 0xFEFF;
}

std::string printableSign(const Utf8Sign& sign) {
  if (!sign.code) return fmt::format("\\x{:02x}", static_cast<unsigned char>(sign.bytes.front()));
  const std::uint32_t code = *sign.code;
  if (code == '\n') return "\\n";
  if (code == '\t') return "\\t";
  if (code < 0x20 || code == 0x7f) return fmt::format("\\x{:02x}", code);
  if ((code >= 0x80 && code < 0xA0) || isHidden(code)) return fmt::format("\\u{:04x}", code);
  return std::string(sign.bytes);
}

/// The printable signs of one end of `text`, at most `room` bytes. Only as much of the text is looked at.
std::string headOf(std::string_view text, std::size_t room) {
  std::string head;
  while (!text.empty()) {
    const Utf8Sign sign = firstSign(text);
    const std::string printable = printableSign(sign);
    if (head.size() + printable.size() > room) break;
    head += printable;
    text.remove_prefix(sign.bytes.size());
  }
  return head;
}

std::string tailOf(std::string_view text, std::size_t room) {
  // As many bytes as may be printed, from the beginning of a sign on.
  text.remove_prefix(text.size() - std::min(text.size(), room));
  while (!text.empty() && (static_cast<unsigned char>(text.front()) & 0xC0) == 0x80) text.remove_prefix(1);
  std::vector<std::string> signs;
  std::size_t length = 0;
  while (!text.empty()) {
    const Utf8Sign sign = firstSign(text);
    signs.push_back(printableSign(sign));
    length += signs.back().size();
    text.remove_prefix(sign.bytes.size());
  }
  std::string tail;
  for (const std::string& sign : signs) {
    if (length <= room)
      tail += sign;
    else
      length -= sign.size();
  }
  return tail;
}

/// As JSON's strings have it, in UTF-16.
std::string escapedSign(const Utf8Sign& sign) {
  constexpr std::uint32_t kReplacement = 0xFFFD, kTwoUnits = 0x10000;
  const std::uint32_t code = sign.code.value_or(kReplacement);
  if (code < kTwoUnits) return fmt::format("\\u{:04x}", code);
  const std::uint32_t rest = code - kTwoUnits;
  return fmt::format("\\u{:04x}\\u{:04x}", 0xD800 + (rest >> 10), 0xDC00 + (rest & 0x3FF));
}

}  // namespace

std::string printableLine(std::string_view text, std::size_t longest) {
  constexpr std::string_view kCut = " ... ";
  if (text.size() <= longest) {
    const std::string whole = headOf(text, std::string::npos);
    if (whole.size() <= longest) return whole;
  }
  const std::size_t room = longest - std::min(longest, kCut.size());
  return headOf(text, room - room / 3).append(kCut).append(tailOf(text, room / 3));
}

std::string printableText(std::string_view text, std::size_t longest_line) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    result += printableLine(text.substr(0, end), longest_line);
    if (end == std::string_view::npos) break;
    result += '\n';
    text.remove_prefix(end + 1);
  }
  return result;
}

std::string asciiJson(std::string_view json) {
  std::string result;
  while (!json.empty()) {
    const auto plain_end = std::find_if(json.begin(), json.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x7f; });
    result.append(json.begin(), plain_end);
    json.remove_prefix(static_cast<std::size_t>(plain_end - json.begin()));
    if (json.empty()) break;
    // JSON has other signs than ASCII within strings alone, where an escape stands for its sign.
    const Utf8Sign sign = firstSign(json);
    result += escapedSign(sign);
    json.remove_prefix(sign.bytes.size());
  }
  return result;
}

}  // namespace poecal
