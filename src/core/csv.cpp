#include "poecal/core/csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>

#include <boost/algorithm/string/trim.hpp>
#include <boost/tokenizer.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"

namespace poecal {
namespace {

std::vector<std::string> splitRow(const std::filesystem::path& file, int line, const std::string& text) {
  // No escape character: a backslash is data, as RFC 4180 has it.
  using Separator = boost::escaped_list_separator<char>;
  std::vector<std::string> cells;
  try {
    for (std::string cell : boost::tokenizer<Separator>(text, Separator("", ",", "\""))) {
      boost::trim(cell);
      cells.push_back(std::move(cell));
    }
  } catch (const boost::escaped_list_error&) {
    throw FileError(file, line, "quotes are not closed");
  }
  return cells;
}

template <typename Value>
std::optional<Value> parse(const std::string& text) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  Value value{};
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

/// A table in another dialect, or with no header, would be answered with odd columns.
void requireHeader(const std::filesystem::path& file, int line, const std::string& text, const std::vector<std::string>& cells) {
  if (text.find('\r') != std::string::npos) throw FileError(file, line, "lines end in CR alone, expected LF or CR LF");
  for (const auto& [sign, name] : {std::pair(';', "';'"), std::pair('\t', "tabs"), std::pair('|', "'|'"), std::pair(' ', "blanks")}) {
    const bool separates = std::count(text.begin(), text.end(), sign) > std::count(text.begin(), text.end(), ',');
    if (separates && (sign != ' ' || cells.size() == 1)) {
      throw FileError(file, line, fmt::format("is separated by {}, expected a header line with column names separated by ','", name));
    }
  }
  const auto numbers = std::count_if(cells.begin(), cells.end(), [](const std::string& cell) { return parse<double>(cell).has_value(); });
  if (2 * numbers >= static_cast<std::ptrdiff_t>(cells.size())) {
    throw FileError(file, line, "begins with numbers, expected a header line with column names separated by ','");
  }
  std::set<std::string> names;
  for (const std::string& name : cells) {
    if (!names.insert(name).second) throw FileError(file, line, fmt::format("column '{}' is there twice", name));
  }
}

}  // namespace

CsvTable CsvTable::read(const std::filesystem::path& file) {
  CsvTable table;
  table.file_ = file;
  std::istringstream stream(readUtf8File(file));
  std::string text;
  for (int line = 1; std::getline(stream, text); ++line) {
    boost::trim(text);
    if (line == 1 && text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);  // spreadsheets write a byte order mark
    if (text.empty() || text.front() == '#') continue;
    std::vector<std::string> cells = splitRow(file, line, text);
    if (table.header_.empty()) {
      requireHeader(file, line, text, cells);
      table.header_ = std::move(cells);
      continue;
    }
    if (cells.size() != table.header_.size()) {
      const bool quoted = text.find('"') != std::string::npos;
      throw FileError(file, line,
                      fmt::format("{} cells, expected {} as in the header{}", cells.size(), table.header_.size(),
                                  quoted ? "; is a quote open that should be closed?" : ""));
    }
    table.rows_.push_back(std::move(cells));
    table.lines_.push_back(line);
  }
  if (table.header_.empty()) throw FileError(file, 0, "is empty, expected a header row");
  return table;
}

std::optional<std::size_t> CsvTable::findColumn(const std::string& name) const {
  for (std::size_t k = 0; k < header_.size(); ++k) {
    if (header_[k] == name) return k;
  }
  return std::nullopt;
}

std::size_t CsvTable::column(const std::string& name) const {
  if (const auto found = findColumn(name)) return *found;
  throw FileError(file_, 1, fmt::format("column '{}' is missing (there are: {})", name, fmt::join(header_, ", ")));
}

std::optional<double> CsvTable::findNumber(std::size_t row, std::size_t column) const {
  const std::optional<double> value = parse<double>(text(row, column));
  return value && std::abs(*value) <= kLargestNumber ? value : std::nullopt;
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  if (const auto value = findNumber(row, column)) return *value;
  throw FileError(file_, line(row), fmt::format("{} is '{}', expected a finite number", header_[column], text(row, column)));
}

long CsvTable::integer(std::size_t row, std::size_t column) const {
  const std::optional<long> value = parse<long>(text(row, column));
  if (!value) {
    throw FileError(file_, line(row), fmt::format("{} is '{}', expected an integer", header_[column], text(row, column)));
  }
  return *value;
}

CsvWriter::CsvWriter(const std::vector<std::string>& header) : columns_(header.size()) {
  for (const std::string& name : header) cell(name);
  endRow();
}

CsvWriter& CsvWriter::cell(const std::string& text) {
  if (filled_++ > 0) text_ += ',';
  if (text.find_first_of(",\"\n") == std::string::npos) {
    text_ += text;
    return *this;
  }
  text_ += '"';
  for (const char c : text) text_ += c == '"' ? std::string("\"\"") : std::string(1, c);
  text_ += '"';
  return *this;
}

CsvWriter& CsvWriter::cell(double number) { return cell(formatNumber(number)); }
CsvWriter& CsvWriter::cell(long integer) { return cell(std::to_string(integer)); }

void CsvWriter::endRow() {
  if (filled_ != columns_) throw InvalidArgument(fmt::format("a CSV row of {} cells, expected {}", filled_, columns_));
  filled_ = 0;
  text_ += '\n';
}

}  // namespace poecal
