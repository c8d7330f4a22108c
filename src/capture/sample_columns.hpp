// The columns that samples.csv and poses.csv share, and the checks that both need.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "poecal/capture/capture.hpp"
#include "poecal/core/csv.hpp"

namespace poecal {

/// Readings that differ by less are those of one pose [rad], [m]: below the resolution of any arm's encoders.
constexpr double kSameReading = 1e-6;

/// The columns of one table, found once by their names.
class SampleColumns {
 public:
  /// @param joint_count  0 where it is not known: the q columns are then counted.
  /// @param own          further columns that the file's own reader understands; all others are kept as other_columns.
  /// @throws FileError (line 1): a gap in q1..qn, dir1..dirn or dq1..dqn, or one more than there are joints.
  SampleColumns(const CsvTable& table, int joint_count, std::initializer_list<const char*> own);

  bool hasJoints() const { return !q_.empty(); }
  const std::vector<std::string>& otherColumns() const { return other_names_; }
  /// All but the image and the pose. @throws FileError with the row's line.
  Sample read(std::size_t row) const;

 private:
  std::optional<double> optionalNumber(std::size_t row, const std::optional<std::size_t>& column) const;

  const CsvTable& table_;
  std::vector<std::size_t> q_, dir_, dq_, other_;
  std::vector<std::string> other_names_;
  std::optional<std::size_t> pose_, stamp_, temperature_, payload_;
};

/// Pose of a row from the columns x, y, z, qx, qy, qz, qw. @throws FileError: a quaternion whose length is not 1 to 1e-3.
Eigen::Isometry3d readPoseCells(const CsvTable& table, std::size_t row, const std::array<std::size_t, 7>& columns);

/// @throws FileError with the line of the first reading that lies beyond its joint's limits by more than 5 % of their range, or that
/// no joint has; where another unit would explain it (degrees, millimetres), that is said.
void checkReadings(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm& arm);

/// @throws InsufficientData: no rows; two or more that are all at one pose. Compares joints, or flange poses where there are none.
void requireSeveralPoses(const std::filesystem::path& file, const std::vector<Sample>& samples);

}  // namespace poecal
