// Comma-separated tables with a header row, whose cells know the line they came from.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace poecal {

/// A table read from a CSV file. Quoted cells ("a,b") are understood, blank lines skipped, lines starting with # are comments.
class CsvTable {
 public:
  /// @throws FileError for a missing file, an empty one, a repeated column name, or a row with another number of cells.
  static CsvTable read(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  const std::vector<std::string>& header() const { return header_; }
  std::size_t rowCount() const { return rows_.size(); }
  /// 1-based line of a row in the file.
  int line(std::size_t row) const { return lines_.at(row); }
  std::optional<std::size_t> findColumn(const std::string& name) const;
  /// @throws FileError (line 1) that names the missing column.
  std::size_t column(const std::string& name) const;
  const std::string& text(std::size_t row, std::size_t column) const { return rows_.at(row).at(column); }
  /// @throws FileError with the row's line if the cell is not a finite number.
  double number(std::size_t row, std::size_t column) const;
  /// The cell, or nothing where it is not a finite number.
  std::optional<double> findNumber(std::size_t row, std::size_t column) const;
  /// @throws FileError with the row's line if the cell is not an integer.
  long integer(std::size_t row, std::size_t column) const;

 private:
  std::filesystem::path file_;
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<int> lines_;
};

/// Builds the text of a CSV file row by row; cells with commas or quotes are quoted.
class CsvWriter {
 public:
  explicit CsvWriter(const std::vector<std::string>& header);
  CsvWriter& cell(const std::string& text);
  CsvWriter& cell(double number);
  CsvWriter& cell(long integer);
  CsvWriter& cell(int integer) { return cell(static_cast<long>(integer)); }
  /// @throws InvalidArgument if the row has another number of cells than the header.
  void endRow();
  const std::string& str() const { return text_; }

 private:
  std::size_t columns_;
  std::size_t filled_ = 0;
  std::string text_;
};

}  // namespace poecal
