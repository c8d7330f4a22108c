#include "fuzz/mutator.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <iterator>
#include <set>
#include <utility>

namespace poecal::test {
namespace {

using std::string;
using Span = std::pair<std::size_t, std::size_t>;  ///< begin and length

constexpr std::size_t kLongest = 1 << 16;  // [bytes] what is longer shows nothing new

/// Texts that readers stumble over.
const string kTraps[] = {"nan",
                         "inf",
                         "-inf",
                         ".nan",
                         ".inf",
                         "1e308",
                         "-1e308",
                         "1e-320",
                         "1e30",
                         "1e31",
                         "0",
                         "-0",
                         "-1",
                         "1",
                         "2147483647",
                         "2147483648",
                         "0x10",
                         "1e9",
                         "65536",
                         "4294967296",
                         "-2",
                         "1e5",
                         "9999999999999999",
                         "99999999999999999999",
                         "",
                         "~",
                         "null",
                         "true",
                         "[]",
                         "{}",
                         "[1, 2, 3]",
                         "{a: b}",
                         "*a",
                         "&a ",
                         "!!str",
                         "\"",
                         "'",
                         ",",
                         "\n",
                         "\r\n",
                         "#",
                         "\t",
                         " ",
                         "\xEF\xBB\xBF",
                         "\xFF",
                         "\x1b[2J",
                         "\\e",
                         "\xED\xA0\x80",
                         "../",
                         "/",
                         ".",
                         "..",
                         "&#xD800;",
                         "&#0;",
                         "&#27;",
                         "<!--",
                         "]]>",
                         "\"\\0\"",
                         "\xE2\x80\xAE",
                         "0.5",
                         "1e-12",
                         "0.0001",
                         "1000",
                         "- "};

bool isNumberSign(char c) { return std::isdigit(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '+' || c == 'e'; }
bool isWordSign(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// Runs of signs of a kind.
std::vector<Span> runsOf(const string& text, bool (*of_kind)(char)) {
  std::vector<Span> runs;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (!of_kind(text[at])) continue;
    const std::size_t begin = at;
    while (at < text.size() && of_kind(text[at])) ++at;
    runs.emplace_back(begin, at - begin);
  }
  return runs;
}

std::vector<string> split(const string& text, char at) {
  std::vector<string> parts(1);
  for (const char c : text) {
    if (c == at) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

string joined(const std::vector<string>& parts, char with) {
  string text;
  for (std::size_t k = 0; k < parts.size(); ++k) text += (k > 0 ? string(1, with) : "") + parts[k];
  return text;
}

template <typename Item>
const Item& anyOf(const std::vector<Item>& items, Rng& rng) {
  return items[rng.below(items.size())];
}

Span anySpan(const string& text, Rng& rng) {
  const std::size_t begin = rng.below(text.size() + 1);
  const std::size_t most = std::min<std::size_t>(text.size() - begin, rng.below(4) == 0 ? text.size() : 8);
  return {begin, rng.below(most + 1)};
}

string flipBits(string text, Rng& rng) {
  if (text.empty()) return text;
  text[rng.below(text.size())] ^= static_cast<char>(1U << rng.below(8));
  return text;
}

string setByte(string text, Rng& rng) {
  if (text.empty()) return text;
  text[rng.below(text.size())] = static_cast<char>(rng.below(256));
  return text;
}

string setNumberOfBytes(string text, Rng& rng) {
  // Sizes and offsets of pictures: four bytes at once.
  const char fill = std::vector<char>{'\0', '\xff', '\x7f', '\x01'}[rng.below(4)];
  for (std::size_t k = 0, at = rng.below(text.size() + 1); k < 4 && at + k < text.size(); ++k) text[at + k] = fill;
  return text;
}

string eraseSome(string text, Rng& rng) {
  const auto [begin, length] = anySpan(text, rng);
  return text.erase(begin, length);
}

string repeatSome(string text, Rng& rng) {
  const auto [begin, length] = anySpan(text, rng);
  const string part = text.substr(begin, length);
  for (std::size_t k = 0, times = 1 + rng.below(rng.below(8) == 0 ? 300 : 3); k < times; ++k) text.insert(begin, part);
  return text;
}

string cutEnd(string text, Rng& rng) {
  text.resize(rng.below(text.size() + 1));
  return text;
}

string setNumber(string text, Rng& rng) {
  const std::vector<Span> numbers = runsOf(text, isNumberSign);
  if (numbers.empty()) return text;
  const Span number = anyOf(numbers, rng);
  return text.replace(number.first, number.second, kTraps[rng.below(std::size(kTraps))]);
}

string insertTrap(string text, Rng& rng) { return text.insert(rng.below(text.size() + 1), kTraps[rng.below(std::size(kTraps))]); }

string changeLines(const string& text, Rng& rng) {
  std::vector<string> lines = split(text, '\n');
  const std::size_t a = rng.below(lines.size()), b = rng.below(lines.size());
  switch (rng.below(4)) {
    case 0:
      lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(a));
      break;
    case 1:
      lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(a), string(lines[b]));
      break;
    case 2:
      std::swap(lines[a], lines[b]);
      break;
    default:
      lines[a].insert(0, rng.below(2) == 0 ? "  " : "- ");
  }
  return joined(lines, '\n');
}

string changeCells(const string& text, Rng& rng) {
  std::vector<string> lines = split(text, '\n');
  const std::size_t kind = rng.below(3), a = rng.below(16), b = rng.below(16);
  const bool all = rng.below(2) == 0;
  const std::size_t one = rng.below(lines.size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (!all && k != one) continue;
    std::vector<string> cells = split(lines[k], ',');
    const std::size_t from = a % cells.size(), to = b % cells.size();
    if (kind == 0) std::swap(cells[from], cells[to]);
    if (kind == 1) cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(from));
    if (kind == 2) cells.insert(cells.begin() + static_cast<std::ptrdiff_t>(from), string(cells[to]));
    lines[k] = joined(cells, ',');
  }
  return joined(lines, '\n');
}

}  // namespace

Mutator::Mutator(std::vector<string> known) : known_(std::move(known)) {
  if (known_.empty()) known_.emplace_back();
  std::set<string> words;
  for (const string& text : known_) {
    for (const Span& word : runsOf(text, isWordSign)) words.insert(text.substr(word.first, word.second));
  }
  words_.assign(words.begin(), words.end());
}

string Mutator::changed(const string& text, Rng& rng) const {
  using Change = std::function<string(const string&, Rng&)>;
  const auto swapWord = [this](string whole, Rng& r) {
    const std::vector<Span> words = runsOf(whole, isWordSign);
    if (words.empty() || words_.empty()) return whole;
    const Span word = anyOf(words, r);
    return whole.replace(word.first, word.second, anyOf(words_, r));
  };
  const auto splice = [this](const string& whole, Rng& r) {
    const string& other = anyOf(known_, r);
    return whole.substr(0, r.below(whole.size() + 1)) + other.substr(r.below(other.size() + 1));
  };
  const auto takeIn = [this](string whole, Rng& r) {
    const string& other = anyOf(known_, r);
    const auto [begin, length] = anySpan(other, r);
    return whole.insert(r.below(whole.size() + 1), other, begin, length);
  };
  static const Change kPlain[] = {flipBits,  setByte,   setNumberOfBytes, eraseSome,   repeatSome,  cutEnd,
                                  setNumber, setNumber, insertTrap,       changeLines, changeCells, changeLines};
  const std::size_t kind = rng.below(std::size(kPlain) + 4);
  string result = kind < std::size(kPlain)        ? kPlain[kind](text, rng)
                  : kind == std::size(kPlain)     ? splice(text, rng)
                  : kind == std::size(kPlain) + 1 ? takeIn(text, rng)
                                                  : swapWord(text, rng);
  if (result.size() > kLongest) result.resize(kLongest);
  return result;
}

string Mutator::mutated(Rng& rng) const {
  string text = anyOf(known_, rng);
  for (std::size_t k = 0, changes = 1 + rng.below(4); k < changes; ++k) text = changed(text, rng);
  return text;
}

}  // namespace poecal::test
