#include "report/numbers.hpp"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

namespace poecal {

nlohmann::ordered_json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
}

nlohmann::ordered_json roundedList(const Eigen::VectorXd& values, int digits) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const double value : values) list.push_back(rounded(value, digits));
  return list;
}

}  // namespace poecal
