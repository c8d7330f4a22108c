// Columns under names that people give them and no reader takes.
#pragma once

#include <string>

#include "poecal/core/csv.hpp"
#include "poecal/robot/arm.hpp"

namespace poecal {

/// @throws FileError where none of qx, qy, qz, qw is there, but an orientation is in other columns (rx, ry, rz; roll, pitch, yaw).
void requireKnownOrientation(const CsvTable& table);

/// "; rename 'shoulder' to q1 and so on" where the table has joint readings under other names; empty where it has none.
/// @param arm  whose joints may be columns; nullptr where it is not known.
std::string hintOfJointColumns(const CsvTable& table, const Arm* arm);

}  // namespace poecal
