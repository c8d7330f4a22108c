#include "poecal/capture/sample_arrays.hpp"

#include <cmath>

#include <fmt/format.h>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

/// Tells whether a column is there, and refuses one of another number of rows.
class RowCount {
 public:
  explicit RowCount(std::size_t rows) : rows_(rows) {}
  bool has(const std::string& name, std::size_t rows) const {
    if (rows != 0 && rows != rows_) throw InvalidArgument(fmt::format("{}: {} rows, expected {} as the others have", name, rows, rows_));
    return rows != 0;
  }
  bool has(const std::string& name, const Eigen::MatrixXd& column) const {
    const bool there = has(name, static_cast<std::size_t>(column.rows()));
    if (!column.allFinite()) throw InvalidArgument(name + ": a value is not finite, expected numbers alone");
    return there;
  }

 private:
  std::size_t rows_;
};

void requireWidth(const std::string& name, const Eigen::MatrixXd& column, const Eigen::MatrixXd& q) {
  if (column.rows() == 0 || q.rows() == 0 || column.cols() == q.cols()) return;
  throw InvalidArgument(fmt::format("{}: {} columns, expected {} as q has", name, column.cols(), q.cols()));
}

void requireSides(const Eigen::MatrixXd& dir) {
  const auto is_side = [](double side) { return side == -1.0 || side == 0.0 || side == 1.0; };
  for (Eigen::Index k = 0; k < dir.size(); ++k) {
    if (!is_side(dir(k))) throw InvalidArgument(fmt::format("dir: {}, expected -1, 0 or 1", dir(k)));
  }
}

}  // namespace

SampleTable sampleTable(const SampleArrays& arrays) {
  SampleTable table;
  table.has_joints = arrays.q.rows() > 0;
  table.has_flange_poses = !arrays.T_base_flange.empty();
  if (!table.has_joints && !table.has_flange_poses) throw InvalidArgument("samples without rows, expected q or T_base_flange");
  requireWidth("dir", arrays.dir, arrays.q);
  requireWidth("dq", arrays.dq, arrays.q);
  requireSides(arrays.dir);
  table.samples.resize(table.has_joints ? static_cast<std::size_t>(arrays.q.rows()) : arrays.T_base_flange.size());
  const RowCount rows(table.samples.size());
  const bool q = rows.has("q", arrays.q), flange = rows.has("T_base_flange", arrays.T_base_flange.size());
  const bool image = rows.has("image", arrays.image.size()), pose = rows.has("pose", arrays.pose.size());
  const bool stamp = rows.has("stamp", arrays.stamp), temperature = rows.has("temperature", arrays.temperature);
  const bool payload = rows.has("payload", arrays.payload), dir = rows.has("dir", arrays.dir), dq = rows.has("dq", arrays.dq);
  for (const auto& [name, values] : arrays.other) {
    if (!rows.has(name, static_cast<std::size_t>(values.size()))) throw InvalidArgument(name + ": no rows, expected one per sample");
    table.other_columns.push_back(name);
  }
  for (std::size_t k = 0; k < table.samples.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    Sample& sample = table.samples[k];
    if (q) sample.q = arrays.q.row(row);
    if (flange) sample.T_base_flange = arrays.T_base_flange[k];
    if (image) sample.image = arrays.image[k];
    if (pose) sample.pose = arrays.pose[k];
    if (stamp) sample.stamp = arrays.stamp(row);
    if (temperature) sample.temperature = arrays.temperature(row);
    if (payload) sample.payload = arrays.payload(row);
    if (dir) sample.dir = arrays.dir.row(row);
    if (dq) sample.dq = arrays.dq.row(row);
    for (const auto& [name, values] : arrays.other) sample.other.push_back(values(row));
  }
  return table;
}

}  // namespace poecal
