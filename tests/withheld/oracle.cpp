#include "withheld/oracle.hpp"

#include <algorithm>

#include <Eigen/Dense>

namespace withheld {
namespace {

/// Geometry, then hidden effects.
Eigen::MatrixXd allColumns(const Case& made, const std::vector<Shot>& shots) {
  Eigen::MatrixXd columns = geometryColumns(made.actual, shots, made.lens_deviation.has_value());
  for (const Hidden& hidden : made.hidden) {
    if (hidden.flaw.at_random) continue;
    const Eigen::MatrixXd more = flawColumns(made.actual, shots, hidden.flaw);
    columns.conservativeResize(Eigen::NoChange, columns.cols() + more.cols());
    columns.rightCols(more.cols()) = more;
  }
  return columns;
}

}  // namespace

double oracleOnUnseen(const Case& made) {
  // What comes at random is noise of a size that is known.
  std::vector<Flaw> flaws;
  Noise chance = made.noise;
  for (const Hidden& hidden : made.hidden) {
    if (hidden.flaw.at_random) {
      const std::string& location = hidden.flaw.location;  // joint:K
      chance.scatter[std::stoul(location.substr(location.find(':') + 1)) - 1] = hidden.flaw[0];
    } else {
      flaws.push_back(hidden.flaw);
    }
  }
  const Eigen::VectorXd right = corners(made.actual, made.shots, flaws);
  const Eigen::Index rows = right.size() / static_cast<Eigen::Index>(made.shots.size());

  // Rows without a usable sighting have neither noise nor derivatives.
  Eigen::VectorXd noise = Eigen::VectorXd::Zero(right.size()), used = noise;
  for (const Sighting& sighting : made.sightings) {
    const Shot& shot = made.shots[sighting.shot];
    if (std::find(made.wild.begin(), made.wild.end(), shot.image) != made.wild.end()) continue;
    Eigen::Index tag = 0;
    while (made.actual.tags[static_cast<std::size_t>(tag)].id != sighting.tag) ++tag;
    const Eigen::Index first = static_cast<Eigen::Index>(sighting.shot) * rows + 8 * tag;
    noise.segment<8>(first) = sighting.pixels.reshaped() - right.segment<8>(first);
    used.segment<8>(first).setOnes();
  }
  const std::vector<Eigen::MatrixXd> factors = noiseFactors(made.actual, made.shots, chance);
  Eigen::MatrixXd columns = whiten(used.asDiagonal() * allColumns(made, made.shots), factors);
  Eigen::VectorXd observed = whiten(noise, factors);

  if (made.lens_deviation) {
    const LensDeviation& d = *made.lens_deviation;
    const double deviations[kLensColumns] = {d.f / made.told.lens.fx, d.c, d.c, d.k1, d.k2};
    const Eigen::Index first = 6 * static_cast<Eigen::Index>(made.actual.arm.size()) + 12, end = columns.rows();
    columns.conservativeResize(end + kLensColumns, Eigen::NoChange);
    columns.bottomRows(kLensColumns).setZero();
    for (Eigen::Index i = 0; i < kLensColumns; ++i) columns(end + i, first + i) = 1.0 / deviations[i];
    observed.conservativeResize(end + kLensColumns);
    observed.tail(kLensColumns).setZero();
  }

  const Eigen::VectorXd scales = columnScales(columns);
  const Eigen::VectorXd fitted = scales.cwiseProduct(solveSmallest(columns * scales.asDiagonal(), observed).x);
  const Eigen::VectorXd off = allColumns(made, made.unseen) * fitted;
  return std::sqrt(off.squaredNorm() / (static_cast<double>(off.size()) / 2.0));
}

}  // namespace withheld
