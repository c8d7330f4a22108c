// The columns of samples as tables are written with them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"
#include "poecal/core/csv.hpp"

namespace poecal {

/// A column of a table of samples; its cell is empty for the samples that have no value there.
struct OutputColumn {
  std::string name;
  std::function<std::optional<double>(const Sample&)> value;
  bool integer = false;

  void write(const Sample& sample, CsvWriter& writer) const;
};

/// q1.., pose, stamp, dir1.., dq1.., temperature and payload: those that some sample has.
std::vector<OutputColumn> readingColumns(const std::vector<Sample>& samples);
/// x, y, z, qx, qy, qz, qw of Sample::T_base_flange, where some sample has it.
std::vector<OutputColumn> flangePoseColumns(const std::vector<Sample>& samples);
/// The further columns of these names: those of which some sample has a number.
std::vector<OutputColumn> otherColumns(const std::vector<Sample>& samples, const std::vector<std::string>& names);

}  // namespace poecal
