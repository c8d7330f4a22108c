#include "poecal/core/csv.hpp"

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

TEST(Csv, ReadsHeaderRowsQuotesAndLines) {
  const test::TempFolder folder;
  const CsvTable table = CsvTable::read(folder.write("a.csv", "\xEF\xBB\xBFname, x\r\n# a comment\n\"a,b\",1.5\n\nc\\d,-2e-3\n"));
  EXPECT_THAT(table.header(), ElementsAre("name", "x"));
  ASSERT_EQ(table.rowCount(), 2u);
  EXPECT_EQ(table.text(0, 0), "a,b");
  EXPECT_EQ(table.text(1, 0), "c\\d");
  EXPECT_EQ(table.number(1, 1), -2e-3);
  EXPECT_EQ(table.line(1), 5);
}

TEST(Csv, ErrorsNameFileLineAndExpectation) {
  const test::TempFolder folder;
  const CsvTable table = CsvTable::read(folder.write("a.csv", "x,n\n1,2\nnan,2.5\n,1\n"));
  EXPECT_THAT([&] { table.number(1, 0); },
              Throws<FileError>(Property(&FileError::what, HasSubstr("a.csv:3: x is 'nan', expected a finite number"))));
  EXPECT_THAT([&] { table.number(2, 0); }, Throws<FileError>(Property(&FileError::what, HasSubstr("a.csv:4: x is ''"))));
  EXPECT_EQ(table.findNumber(1, 0), std::nullopt);
  EXPECT_EQ(table.findNumber(1, 1), 2.5);
  EXPECT_THAT([&] { table.integer(1, 1); }, Throws<FileError>(Property(&FileError::what, HasSubstr("expected an integer"))));
  EXPECT_THAT([&] { table.column("y"); }, Throws<FileError>(Property(&FileError::what, HasSubstr("a.csv:1: column 'y' is missing"))));
  EXPECT_THAT([&] { CsvTable::read(folder.write("b.csv", "x,y\n1,2\n1\n")); },
              Throws<FileError>(Property(&FileError::what, HasSubstr("b.csv:3: 1 cells, expected 2"))));
  EXPECT_THAT([&] { CsvTable::read(folder.write("b.csv", "x,y\n\"1,2\n3,4\n")); },
              Throws<FileError>(Property(&FileError::what, HasSubstr("b.csv:2: 1 cells, expected 2 as in the header; is a quote open"))));
  EXPECT_THAT([&] { CsvTable::read(folder.write("c.csv", "x,x\n")); },
              Throws<FileError>(Property(&FileError::what, HasSubstr("column 'x' is there twice"))));
  const auto expectRefused = [&folder](const std::string& content, const std::string& message) {
    EXPECT_THAT([&] { CsvTable::read(folder.write("g.csv", content)); }, Throws<FileError>(Property(&FileError::what, HasSubstr(message))));
  };
  expectRefused("1,2\n1,3\n", "g.csv:1: begins with numbers, expected a header line with column names separated by ','");
  expectRefused("# poses\na.png,0.1,0.1\n", "g.csv:2: begins with numbers");
  expectRefused("x;y\n1,5;2,5\n", "g.csv:1: is separated by ';', expected a header line with column names separated by ','");
  expectRefused("x\ty\n1\t2\n", "g.csv:1: is separated by tabs");
  expectRefused("x y\n1 2\n", "g.csv:1: is separated by blanks");
  expectRefused("x,y\r1,2\r3,4\r", "g.csv:1: lines end in CR alone, expected LF or CR LF");
  EXPECT_EQ(CsvTable::read(folder.write("h.csv", "x, wind (m/s)\r\n1,2\r\n")).rowCount(), 1u);
  EXPECT_THAT([&] { CsvTable::read(folder.write("e.csv", "x\n1e308\n")).number(0, 0); },
              Throws<FileError>(Property(&FileError::what, HasSubstr("e.csv:2: x is '1e308', expected a finite number"))));
  EXPECT_THAT(
      [&] {
        CsvTable::read(folder.write("f.csv",
                                    "x\n1\n# 20 \xb0"
                                    "C\n"));
      },
      Throws<FileError>(Property(&FileError::what, HasSubstr("f.csv:3: byte 0xB0 is not UTF-8"))));
  EXPECT_THAT([&] { CsvTable::read(folder.write("d.csv", "\n")); }, Throws<FileError>(Property(&FileError::what, HasSubstr("is empty"))));
  EXPECT_THAT([&] { CsvTable::read(folder.path() / "none.csv"); },
              Throws<FileError>(Property(&FileError::what, HasSubstr("no such file"))));
}

TEST(Csv, WhatIsWrittenReadsBackBitForBit) {
  const test::TempFolder folder;
  const double awkward[] = {0.1, 1.0 / 3.0, 5e-324, 1e30, -0.0, 123456789.0};
  CsvWriter writer({"text", "value"});
  for (const double value : awkward) {
    writer.cell(std::string("a, c")).cell(value);
    writer.endRow();
  }
  const CsvTable table = CsvTable::read(folder.write("a.csv", writer.str()));
  for (std::size_t row = 0; row < std::size(awkward); ++row) EXPECT_EQ(table.number(row, 1), awkward[row]);
  EXPECT_THROW(writer.endRow(), InvalidArgument);
}

}  // namespace
}  // namespace poecal
