#include "identification/remarks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include <fmt/format.h>

#include "cell/transform_names.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/registration/implausible.hpp"
#include "poecal/registration/registration.hpp"

namespace poecal {
namespace {

double degrees(double angle) { return angle * 180.0 / M_PI; }

/// What is stated of a row's corners or place, and how far it is off, per axis [px] or [m].
struct StatedRow {
  double stated = 0.0, off = 0.0;
};

StatedRow statedRow(const Cell& cell, const Observation& observation) {
  StatedRow row;
  const Eigen::Index count = observation.pose ? 3 : 2;
  for (const UnitResidual& unit : residuals(cell, observation)) {
    row.off += unit.residual.tail(count).squaredNorm() / static_cast<double>(count * observation.unitCount());
  }
  row.off = std::sqrt(row.off);
  std::vector<double> stated;
  for (const CornerMeasurement& corner : observation.corners) stated.push_back(corner.sigma_px);
  if (observation.pose) stated.push_back(std::sqrt(3.0) / observation.pose->whitening.bottomRightCorner<3, 3>().norm());
  row.stated = median(std::move(stated));
  return row;
}

template <typename Of>
double medianOf(const std::vector<StatedRow>& rows, Of of) {
  std::vector<double> values;
  std::transform(rows.begin(), rows.end(), std::back_inserter(values), of);
  return median(std::move(values));
}

}  // namespace

std::vector<SuspectRow> suspectRows(const MethodFit& fit, const Cell& cell, const std::vector<Observation>& fitted) {
  std::vector<SuspectRow> rows;
  if (fit.adjustment.weights.empty()) return rows;
  for (std::size_t k = 0; k < fitted.size(); ++k) {
    const std::vector<double>& weights = fit.adjustment.weights[k];
    if (*std::min_element(weights.begin(), weights.end()) >= 1.0) continue;
    SuspectRow row;
    row.sample = fitted[k].sample;
    row.left_out = keptShare(weights) < 0.5;
    double sum = 0.0;
    const std::vector<UnitResidual> units = residuals(cell, fitted[k]);
    for (const UnitResidual& unit : units) {
      row.sigmas = std::max(row.sigmas, std::sqrt(unit.squared_norm) / fit.adjustment.scale);
      sum += fitted[k].pose ? unit.residual.tail<3>().squaredNorm() : unit.residual.squaredNorm();
    }
    row.residual = std::sqrt(sum / static_cast<double>(units.size()));
    rows.push_back(row);
  }
  return rows;
}

void requireExplained(const Arm& nominal, const std::vector<Observation>& observations, const ErrorSummary& errors) {
  constexpr double kShare = 0.5, kLeast = 0.1, kTurn = 1.0;
  if (errors.rotation.median > kTurn) {
    throw ImplausibleCapture(
        fmt::format("with the arm identified its flange is still turned by {:.0f} degrees from how it was measured (median): expected "
                    "readings, robot and measurements that belong together",
                    degrees(errors.rotation.median)));
  }
  Eigen::Matrix3Xd flange(3, static_cast<Eigen::Index>(observations.size()));
  for (Eigen::Index k = 0; k < flange.cols(); ++k) {
    flange.col(k) = forwardKinematics(nominal, observations[static_cast<std::size_t>(k)].q).translation();
  }
  const double apart = std::sqrt((flange.colwise() - flange.rowwise().mean()).colwise().squaredNorm().mean());
  if (!(errors.position.median > std::max(kLeast, kShare * apart))) return;
  throw ImplausibleCapture(
      fmt::format("with the arm identified its flange is still {:.0f} mm from where it was measured (median), of poses that lie {:.0f} mm "
                  "about their middle: expected readings, robot and measurements that belong together",
                  1e3 * errors.position.median, 1e3 * apart));
}

std::vector<std::string> deviationWarnings(const Arm& nominal, const std::vector<JointDeviation>& deviations,
                                           const IdentifyOptions& options) {
  constexpr double kFar = 10.0;   // tolerances: out of reach of any part that was made to them
  constexpr double kZero = 0.03;  // [rad], [m]: well beyond what homing leaves
  const double far_tilt = kFar * (options.tolerance_rotation > 0.0 ? options.tolerance_rotation : 1.0);
  const double far_shift = kFar * (options.tolerance_position > 0.0 ? options.tolerance_position : 1.0);
  std::vector<std::string> warnings;
  for (std::size_t k = 0; k < deviations.size(); ++k) {
    const JointDeviation& deviation = deviations[k];
    const Joint& joint = nominal.joints[k];
    const auto say = [&](const std::string& what) {
      warnings.push_back(
          fmt::format("joint {} ({}): {} from what the robot file says, expected an arm made to its tolerances", k + 1, joint.name, what));
    };
    if (std::abs(deviation.zero) > kZero) {
      say(joint.type == JointType::kRevolute ? fmt::format("its zero is {:.1f} degrees away", degrees(deviation.zero))
                                             : fmt::format("its zero is {:.1f} mm away", 1e3 * deviation.zero));
    }
    if (deviation.tilt > far_tilt) say(fmt::format("its axis is tilted by {:.1f} degrees", degrees(deviation.tilt)));
    if (deviation.shift > far_shift) say(fmt::format("its axis lies {:.1f} mm away", 1e3 * deviation.shift));
  }
  return warnings;
}

std::string statedDeviationsWarning(double scale, bool corners) {
  constexpr double kOtherUnit = 30.0;
  if (!(scale > 0.0) || kOtherUnit * scale > 1.0) return "";
  return fmt::format("the stated deviations of the {} are {:.0f} times what the fit leaves: are they in {}?", corners ? "corners" : "poses",
                     1.0 / scale, corners ? "pixels" : "metres and radians");
}

std::string mixedDeviationsWarning(const Cell& cell, const std::vector<Observation>& observations) {
  constexpr double kOtherUnit = 50.0;    // metres and millimetres differ by a thousand, pictures of one camera by ten
  constexpr double kContradicted = 5.0;  // times farther off than the others are, both by what is stated of them
  constexpr std::size_t kFewest = 4;
  std::vector<StatedRow> rows;
  for (const Observation& observation : observations) {
    if (observation.unitCount() == 0) continue;
    const StatedRow row = statedRow(cell, observation);
    if (std::isfinite(row.off)) rows.push_back(row);
  }
  if (rows.empty()) return "";
  const auto [least, most] =
      std::minmax_element(rows.begin(), rows.end(), [](const StatedRow& a, const StatedRow& b) { return a.stated < b.stated; });
  const double between = std::sqrt(least->stated * most->stated);
  std::vector<StatedRow> small, large;
  for (const StatedRow& row : rows) (row.stated > between ? large : small).push_back(row);
  if (small.size() < kFewest || large.size() < kFewest) return "";
  const auto stated = [](const StatedRow& row) { return row.stated; };
  const auto share = [](const StatedRow& row) { return row.off / row.stated; };
  const double stated_here = medianOf(small, stated), stated_there = medianOf(large, stated);
  if (!(stated_there > kOtherUnit * stated_here)) return "";
  if (!(medianOf(small, share) > kContradicted * std::max(1.0, medianOf(large, share)))) return "";
  const bool corners = !observations.front().pose;
  const double unit = corners ? 1.0 : 1e3;
  return fmt::format(
      "{} of {} rows state deviations of {:.3g} {} and are off by {:.3g}, the others state {:.3g}: are the two in different units?",
      small.size(), rows.size(), unit * stated_here, corners ? "px" : "mm",
      unit * medianOf(small, [](const StatedRow& row) { return row.off; }), unit * stated_there);
}

std::vector<std::string> gaugeRemarks(const Arm& nominal, const MethodFit& fit, bool registered) {
  std::vector<std::string> remarks;
  for (std::size_t k = 0; k < nominal.joints.size(); ++k) {
    const bool revolute = nominal.joints[k].type == JointType::kRevolute;
    remarks.push_back(
        fmt::format("joint {}: {} changes nothing and is not a parameter", k + 1,
                    revolute ? "turning about and sliding along its own axis" : "turning about and shifting its own direction"));
  }
  const Registration& registration = fit.cell.registration;
  if (fit.free.near) {
    remarks.push_back(fmt::format("Gamma and {} are one unknown: Gamma is held at its nominal value", farName(registration)));
    remarks.push_back(
        fmt::format("moving the {} frame and all axes together changes nothing: the frame is where the axes are nearest to "
                    "nominal, weighed by the tolerances",
                    registration.nearFrame()));
  } else if (!registered) {
    remarks.push_back(fmt::format("{} and {} are held as registered with the nominal arm; the axes and Gamma take up what they lack",
                                  nearName(registration), farName(registration)));
  }
  return remarks;
}

std::string lensMoveText(const MethodFit& fit, const Camera& stated) {
  const Eigen::VectorXd move = fit.cell.camera->parameters() - stated.parameters();
  const Eigen::VectorXd deviation = fit.covariance.diagonal().tail(move.size()).cwiseSqrt();
  const std::vector<std::string> names = fit.cell.camera->parameterNames();
  std::vector<Eigen::Index> order(names.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return std::abs(move(a)) / deviation(a) > std::abs(move(b)) / deviation(b); });
  std::string text;
  for (std::size_t k = 0; k < order.size() && k < 4; ++k) {
    const Eigen::Index i = order[k];
    if (k > 0 && std::abs(move(i)) < 3.0 * deviation(i)) break;
    text += fmt::format("{}{} {:.4g} instead of {:.4g}", text.empty() ? "" : ", ", names[static_cast<std::size_t>(i)],
                        fit.cell.camera->parameters()(i), stated.parameters()(i));
  }
  return text;
}

std::string lensMoveWarning(const MethodFit& fit, const Camera& stated) {
  const Eigen::VectorXd prior = cameraPrior(stated);
  const Eigen::VectorXd move = fit.cell.camera->parameters() - stated.parameters();
  for (Eigen::Index k = 0; k < move.size(); ++k) {
    if (prior(k) > 0.0 && std::abs(move(k)) > 5.0 * prior(k)) {
      return fmt::format("the stated lens is wrong: {} moved by {:.1f} of its stated standard deviations ({})",
                         fit.cell.camera->parameterNames()[static_cast<std::size_t>(k)], std::abs(move(k)) / prior(k),
                         lensMoveText(fit, stated));
    }
  }
  return "";
}

}  // namespace poecal
