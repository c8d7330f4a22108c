#include "capture/output_columns.hpp"

#include <algorithm>
#include <cmath>

#include "poecal/geometry/se3.hpp"

namespace poecal {
namespace {

std::vector<OutputColumn> thatSomeSampleHas(std::vector<OutputColumn> columns, const std::vector<Sample>& samples) {
  std::erase_if(columns, [&](const OutputColumn& column) {
    return std::none_of(samples.begin(), samples.end(), [&](const Sample& sample) { return column.value(sample).has_value(); });
  });
  return columns;
}

}  // namespace

void OutputColumn::write(const Sample& sample, CsvWriter& writer) const {
  const std::optional<double> number = value(sample);
  if (!number) {
    writer.cell(std::string());
  } else if (integer) {
    writer.cell(static_cast<long>(*number));
  } else {
    writer.cell(*number);
  }
}

std::vector<OutputColumn> readingColumns(const std::vector<Sample>& samples) {
  std::vector<OutputColumn> columns;
  const auto addVector = [&](const char* prefix, Eigen::VectorXd Sample::*member, bool integer) {
    const Eigen::Index count = samples.empty() ? 0 : (samples.front().*member).size();
    for (Eigen::Index k = 0; k < count; ++k) {
      columns.push_back(
          {prefix + std::to_string(k + 1), [member, k](const Sample& sample) { return std::optional((sample.*member)(k)); }, integer});
    }
  };
  addVector("q", &Sample::q, false);
  columns.push_back({"pose", [](const Sample& sample) { return std::optional<double>(sample.pose); }, true});
  columns.push_back({"stamp", [](const Sample& sample) { return sample.stamp; }});
  addVector("dir", &Sample::dir, true);
  addVector("dq", &Sample::dq, false);
  columns.push_back({"temperature", [](const Sample& sample) { return sample.temperature; }});
  columns.push_back({"payload", [](const Sample& sample) { return sample.payload; }});
  return thatSomeSampleHas(std::move(columns), samples);
}

std::vector<OutputColumn> flangePoseColumns(const std::vector<Sample>& samples) {
  std::vector<OutputColumn> columns;
  Eigen::Index k = 0;
  for (const char* name : {"x", "y", "z", "qx", "qy", "qz", "qw"}) {
    columns.push_back({name, [k](const Sample& sample) -> std::optional<double> {
                         if (!sample.T_base_flange) return std::nullopt;
                         return k < 3 ? sample.T_base_flange->translation()(k) : quaternionXyzw(*sample.T_base_flange)(k - 3);
                       }});
    ++k;
  }
  return thatSomeSampleHas(std::move(columns), samples);
}

std::vector<OutputColumn> otherColumns(const std::vector<Sample>& samples, const std::vector<std::string>& names) {
  std::vector<OutputColumn> columns;
  for (std::size_t k = 0; k < names.size(); ++k) {
    columns.push_back({names[k], [k](const Sample& sample) -> std::optional<double> {
                         if (k >= sample.other.size() || std::isnan(sample.other[k])) return std::nullopt;
                         return sample.other[k];
                       }});
  }
  return thatSomeSampleHas(std::move(columns), samples);
}

}  // namespace poecal
