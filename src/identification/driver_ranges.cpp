#include "poecal/identification/driver_ranges.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "poecal/core/text.hpp"
#include "poecal/effects/catalogue.hpp"

namespace poecal {
namespace {

/// A column of samples.csv that drives effects beyond where the arm stands.
struct Column {
  const char* name;
  std::optional<double> (*value)(const Sample& sample);
  bool (*drives)(const Effect& effect);
};
constexpr Column kColumns[] = {
    {"stamp", [](const Sample& sample) { return sample.stamp; },
     [](const Effect& effect) { return effect.driver().kind() == DriverKind::kStamp; }},
    {"temperature", [](const Sample& sample) { return sample.temperature; },
     [](const Effect& effect) { return effect.driver().kind() == DriverKind::kTemperature; }},
    {"payload", [](const Sample& sample) { return std::optional(sample.payload.value_or(0.0)); },
     [](const Effect& effect) { return effect.kind().takesLoad(); }},
};

}  // namespace

DriverRanges driverRangesOf(const std::vector<AppliedEffect>& effects, const std::vector<Sample>& samples) {
  DriverRanges ranges;
  for (const Column& column : kColumns) {
    const auto drives = [&column](const AppliedEffect& one) { return column.drives(one.effect); };
    if (std::none_of(effects.begin(), effects.end(), drives)) continue;
    for (const Sample& sample : samples) {
      const std::optional<double> value = column.value(sample);
      if (!value) continue;
      const auto [range, is_new] = ranges.try_emplace(column.name, *value, *value);
      if (is_new) continue;
      range->second.first = std::min(range->second.first, *value);
      range->second.second = std::max(range->second.second, *value);
    }
  }
  return ranges;
}

std::vector<std::string> remarksOnDrivers(const DriverRanges& ranges, const std::filesystem::path& file,
                                          const std::vector<Sample>& samples) {
  std::vector<std::string> remarks;
  for (const Column& column : kColumns) {
    const auto range = ranges.find(column.name);
    if (range == ranges.end()) continue;
    const auto [low, high] = range->second;
    const double margin = high > low ? high - low : std::abs(high);
    std::size_t beyond = 0;
    const Sample* first = nullptr;
    for (const Sample& sample : samples) {
      const std::optional<double> value = column.value(sample);
      if (!value || (*value >= low - margin && *value <= high + margin)) continue;
      if (first == nullptr) first = &sample;
      ++beyond;
    }
    if (first == nullptr) continue;
    remarks.push_back(
        fmt::format("{}:{}: {} is {}, far from {} to {}, where the model's effects were found: they are extrapolated in {} of {} rows; "
                    "expected the same unit and clock as in that capture",
                    file.string(), first->line, column.name, formatNumber(*column.value(*first)), formatNumber(low), formatNumber(high),
                    beyond, samples.size()));
  }
  return remarks;
}

}  // namespace poecal
