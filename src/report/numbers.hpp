// Numbers of report.json, with the digits that a picture can show.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace poecal {

/// `value` to so many significant digits; null where it is not finite.
nlohmann::ordered_json rounded(double value, int digits = 5);
nlohmann::ordered_json roundedList(const Eigen::VectorXd& values, int digits = 5);

}  // namespace poecal
