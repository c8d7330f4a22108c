#include "diagnosis/wave_folds.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Cholesky>

namespace poecal {
namespace {

constexpr std::size_t kStretches = 10;

/// Squares that a fit to all but one stretch leaves in it. @param all, part  [X r]'[X r] of all and of the stretch. @param count  columns
/// of X.
double squaresLeftOut(const Eigen::MatrixXd& all, const Eigen::MatrixXd& part, const Eigen::MatrixXd& precision,
                      const Eigen::VectorXd& pull, Eigen::Index count) {
  const Eigen::Index r = all.cols() - 1;
  Eigen::MatrixXd A = all.topLeftCorner(count, count) - part.topLeftCorner(count, count) + precision.topLeftCorner(count, count);
  // Radians and metres stand side by side.
  const Eigen::VectorXd d = A.diagonal().unaryExpr([](double v) { return v > 0.0 ? 1.0 / std::sqrt(v) : 1.0; });
  A = d.asDiagonal() * A * d.asDiagonal();
  A.diagonal().array() += 1e-10;
  const Eigen::VectorXd g = all.col(r).head(count) - part.col(r).head(count) - pull.head(count);
  const Eigen::VectorXd b = d.cwiseProduct(A.llt().solve(Eigen::VectorXd(d.cwiseProduct(g))));
  return part(r, r) - 2.0 * b.dot(part.col(r).head(count)) + b.dot(part.topLeftCorner(count, count) * b);
}

}  // namespace

WaveFolds::WaveFolds(const MeasuredCell& measured, const Linearised& linear)
    : prior_(basePrior(measured, linear.state, linear.noise.tolerance).joinedWith(linear.column_prior)) {
  const CaptureRows& rows = linear.rows;
  const Whitening whitening(rows, linear.components, linear.noise.theta);
  const std::size_t poses = whitening.poses(), stretches = std::min(kStretches, poses);
  const Eigen::Index joints = rows.observations.front().ports.joints.cols();
  const Eigen::Index columns = rows.J.cols() + linear.columns.cols();
  const auto count = static_cast<Eigen::Index>(poses);
  ports_.assign(static_cast<std::size_t>(joints), {Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::MatrixXd(columns, count)});
  squares_.assign(stretches, Eigen::MatrixXd::Zero(columns + 1, columns + 1));
  for (std::size_t stretch = 0; stretch <= stretches; ++stretch) begin_.push_back(static_cast<Eigen::Index>(stretch * poses / stretches));
  std::size_t stretch = 0;
  for (std::size_t g = 0; g < poses; ++g) {
    while (static_cast<Eigen::Index>(g) >= begin_[stretch + 1]) ++stretch;
    const int begin = whitening.begin(g), size = whitening.size(g);
    Eigen::MatrixXd all(size, columns + 1 + joints);
    all.leftCols(columns + 1) << rows.J.middleRows(begin, size), linear.columns.middleRows(begin, size), rows.r.segment(begin, size);
    for (const std::size_t k : rows.groups[g]) {
      const ObservationRows& part = rows.observations[k];
      all.block(part.begin - begin, columns + 1, part.size, joints) = part.rows.H * part.ports.joints;
    }
    const Eigen::MatrixXd white = whitening.applyTo(g, all);
    const auto Xr = white.leftCols(columns + 1);
    squares_[stretch].noalias() += Xr.transpose() * Xr;
    const Eigen::MatrixXd met = Xr.transpose() * white.rightCols(joints);
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
      PortSums& port = ports_[static_cast<std::size_t>(joint)];
      const auto pose = static_cast<Eigen::Index>(g);
      port.weight(pose) = white.col(columns + 1 + joint).squaredNorm();
      port.residual(pose) = met(columns, joint);
      port.cross.col(pose) = met.col(joint).head(columns);
    }
  }
}

std::size_t WaveFolds::bestCount(std::size_t joint, const std::vector<Eigen::MatrixX2d>& shapes,
                                 const std::vector<double>& variances) const {
  if (shapes.empty()) return 0;
  const PortSums& port = ports_[joint];
  const Eigen::Index base = port.cross.rows(), count = 2 * static_cast<Eigen::Index>(shapes.size()), r = base + count;
  Eigen::MatrixXd shape(port.weight.size(), count);
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(r, r);
  precision.topLeftCorner(base, base) = prior_.precision;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Eigen::Index column = 2 * static_cast<Eigen::Index>(i);
    shape.middleCols<2>(column) = shapes[i];
    precision.diagonal().segment<2>(base + column).setConstant(1.0 / variances[i]);
  }
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(r);
  pull.head(base) = prior_.precision * prior_.offset;
  std::vector<Eigen::MatrixXd> parts;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(r + 1, r + 1);
  for (std::size_t f = 0; f < squares_.size(); ++f) {
    const Eigen::Index begin = begin_[f], size = begin_[f + 1] - begin;
    const auto there = shape.middleRows(begin, size);
    Eigen::MatrixXd part(r + 1, r + 1);
    part.topLeftCorner(base, base) = squares_[f].topLeftCorner(base, base);
    part.block(0, base, base, count).noalias() = port.cross.middleCols(begin, size) * there;
    part.block(base, base, count, count).noalias() = there.transpose() * port.weight.segment(begin, size).asDiagonal() * there;
    part.col(r).head(base) = squares_[f].col(base).head(base);
    part.col(r).segment(base, count).noalias() = there.transpose() * port.residual.segment(begin, size);
    part(r, r) = squares_[f](base, base);
    part.triangularView<Eigen::StrictlyLower>() = part.transpose();
    all += part;
    parts.push_back(std::move(part));
  }
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t waves = 0; waves <= shapes.size(); ++waves) {
    double left = 0.0;
    for (const Eigen::MatrixXd& part : parts)
      left += squaresLeftOut(all, part, precision, pull, base + 2 * static_cast<Eigen::Index>(waves));
    if (left < least) {
      least = left;
      best = waves;
    }
  }
  return best;
}

}  // namespace poecal
