#include "diagnosis/measurement_noise.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/QR>

namespace poecal {
namespace {

/// A mean square and of how many numbers it is.
struct MeanSquare {
  double value = 0.0, numbers = 0.0;
};

double pointsOf(const CaptureRows& rows) {
  double points = 0.0;
  for (const ObservationRows& part : rows.observations)
    points += static_cast<double>(std::count(part.rows.valid.begin(), part.rows.valid.end(), true));
  return points;
}

/// What a component makes of the mean square of a point.
double shareOf(const Linearised& linear, const std::string& name) {
  const Eigen::VectorXd weights = squareWeights(linear.rows);
  for (std::size_t i = 0; i < linear.components.size(); ++i) {
    if (linear.components[i].name != name) continue;
    double sum = 0.0;
    Eigen::Index begin = 0;
    for (const Eigen::MatrixXd& Z : linear.components[i].Z) {
      sum += Z.cwiseAbs2().rowwise().sum().dot(weights.segment(begin, Z.rows()));
      begin += Z.rows();
    }
    return linear.noise.theta(static_cast<Eigen::Index>(i)) * sum / std::max(1.0, pointsOf(linear.rows));
  }
  return 0.0;
}

/// Variance of a corner's numbers beside a free pose of its target, in units of the stated one.
MeanSquare besideFreePoses(const Linearised& linear) {
  const Eigen::VectorXd r = linear.residual();
  MeanSquare mean;
  for (const ObservationRows& part : linear.rows.observations) {
    const bool whole = std::all_of(part.rows.valid.begin(), part.rows.valid.end(), [](bool valid) { return valid; });
    constexpr int kPose = 6;
    if (!whole || part.size <= kPose) continue;
    const Eigen::VectorXd own = r.segment(part.begin, part.size);
    mean.value += (own - part.rows.H * part.rows.H.colPivHouseholderQr().solve(own)).squaredNorm();
    mean.numbers += part.size - kPose;
  }
  mean.value /= std::max(1.0, mean.numbers);
  return mean;
}

bool hasRepeats(const MeasuredCell& measured) {
  return std::any_of(measured.groups.begin(), measured.groups.end(), [](const auto& group) { return group.size() > 1; });
}

MeasurementNoise ofCorners(const MeasuredCell& measured, const Linearised& linear) {
  const double corner = shareOf(linear, "corner"), tag = shareOf(linear, "tag");
  MeasurementNoise noise;
  noise.source = hasRepeats(measured) ? NoiseSource::kRepeats : NoiseSource::kEstimated;
  const double numbers = linear.rows.size();
  const double rounding = shareOf(linear, kRoundedReadings);
  noise.least = corner;
  noise.most = corner + tag + rounding + shareOf(linear, "repeatability");
  double known_by = std::max(1.0, numbers - static_cast<double>(linear.rows.J.cols()));
  // What the arm does cannot get into the corners beside a free pose; where these are quieter, it got into the component.
  const MeanSquare free = besideFreePoses(linear);
  constexpr double kFewest = 20.0, kSurely = 3.0;
  const double theta = varianceOf("corner", linear.components, linear.noise).value_or(1.0);
  if (free.numbers >= kFewest && free.value * (1.0 + kSurely * std::sqrt(2.0 / free.numbers)) < theta) {
    noise.least *= free.value / theta;
    known_by = free.numbers;
  }
  if (severalTags(linear.rows) || hasRepeats(measured)) noise.least += tag;
  noise.least += rounding;
  noise.chance = std::sqrt(2.0 / numbers + 2.0 / known_by);
  return noise;
}

/// Mean square of a position about the mean of its repeats.
MeanSquare amongRepeats(const Linearised& linear) {
  const Eigen::VectorXd r = linear.residual();
  MeanSquare mean;
  constexpr int kAxes = 3;
  for (const std::vector<std::size_t>& group : linear.rows.groups) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0.0;
    for (const std::size_t k : group) {
      const ObservationRows& part = linear.rows.observations[k];
      const Eigen::Vector3d off = part.unit_sigma.front() * r.segment<kAxes>(part.begin + part.size - kAxes);
      sum += off;
      squares += off.squaredNorm();
    }
    const auto shots = static_cast<double>(group.size());
    mean.value += std::max(0.0, squares - sum.squaredNorm() / shots);
    mean.numbers += kAxes * (shots - 1.0);
  }
  mean.value *= kAxes / std::max(1.0, mean.numbers);
  return mean;
}

MeasurementNoise ofPoses(const Linearised& linear, bool stated) {
  MeasurementNoise noise;
  const double numbers = 3.0 * pointsOf(linear.rows);
  const double components = shareOf(linear, "position");
  const MeanSquare repeats = amongRepeats(linear);
  constexpr double kFewest = 15.0;
  noise.chance = std::sqrt(2.0 / std::max(1.0, numbers));
  const double rounding = shareOf(linear, kRoundedReadings);
  noise.most = components + rounding + shareOf(linear, "repeatability");
  if (repeats.numbers >= kFewest) {
    noise.source = NoiseSource::kRepeats;
    noise.least = repeats.value;
    noise.chance = std::hypot(noise.chance, std::sqrt(2.0 / repeats.numbers));
  } else if (stated) {
    noise.source = NoiseSource::kGiven;
    const double theta = varianceOf("position", linear.components, linear.noise).value_or(1.0);
    noise.least = components / std::max(1.0, theta);  // deviations that are stated too large are no noise that there is
  } else {
    noise.source = NoiseSource::kUnknown;
  }
  noise.least += rounding;  // shots of one pose are rounded alike
  noise.most = std::max(noise.most, noise.least);
  return noise;
}

}  // namespace

bool severalTags(const CaptureRows& rows) {
  return std::any_of(rows.observations.begin(), rows.observations.end(), [](const ObservationRows& part) {
    std::set<int> tags;
    for (const PointContext& point : part.context.points) tags.insert(point.id.tag);
    return tags.size() > 1;
  });
}

MeasurementNoise measurementNoise(const MeasuredCell& measured, const Linearised& linear, bool stated) {
  MeasurementNoise noise = measured.start.camera ? ofCorners(measured, linear) : ofPoses(linear, stated);
  noise.random = noise.most;
  for (const NoiseComponent& component : linear.components) {
    if (component.name.starts_with("scatter")) noise.random += shareOf(linear, component.name);
  }
  return noise;
}

const char* noiseSourceName(NoiseSource source) {
  switch (source) {
    case NoiseSource::kRepeats:
      return "repeats";
    case NoiseSource::kGiven:
      return "given";
    case NoiseSource::kEstimated:
      return "estimated";
    case NoiseSource::kUnknown:
      return "not known: no repeats, no stated deviation";
  }
  return "";
}

}  // namespace poecal
