// Text from outside made fit for a terminal: names in a file of a stranger may hold what moves the cursor or rewrites the window's title.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace poecal {

constexpr std::size_t kLongestPrintedLine = 800;  ///< bytes; what is told in one line is some hundred long

/// `text` as one line that a terminal shows as it is: control characters (below 0x20, 0x7f, U+0080 to U+009F), line ends among them, signs
/// that change the direction of writing or are not seen, and bytes that are not UTF-8 become `\n`, `\t`, `\x1b` or `\u202e`. Where the
/// result is longer than `longest` bytes its middle becomes "...", as what is meant stands at its ends.
std::string printableLine(std::string_view text, std::size_t longest = kLongestPrintedLine);

/// printableLine() of each line of `text`; the ends of lines stay.
std::string printableText(std::string_view text, std::size_t longest_line = kLongestPrintedLine);

/// JSON text with the same content in printable ASCII and line ends alone: every other sign, U+007F too, becomes `\u` and four digits,
/// above U+FFFF two such (RFC 8259, section 7); a byte that is not UTF-8 becomes `\ufffd`.
/// @param json  text of JSON without control characters outside its indents.
std::string asciiJson(std::string_view json);

}  // namespace poecal
