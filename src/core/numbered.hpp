// Words that count: "q3", "joint:3", "c12".
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace poecal {

/// The number of a word "prefixN", N >= 0 and nothing behind it; nothing for other words.
inline std::optional<int> numberAfter(std::string_view word, std::string_view prefix) {
  if (!word.starts_with(prefix)) return std::nullopt;
  int number = 0;
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data() + prefix.size(), end, number);
  return error == std::errc() && stop == end && number >= 0 ? std::optional(number) : std::nullopt;
}

}  // namespace poecal
