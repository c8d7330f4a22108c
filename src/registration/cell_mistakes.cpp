#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "poecal/core/text.hpp"
#include "registration/mistakes.hpp"
#include "robot/arm_size.hpp"

namespace poecal {
namespace {

// No arm of this kind is built.
constexpr double kLargestArm = 20.0;
constexpr double kSmallestArm = 0.02;

Arm scaledArm(const Arm& arm, double factor) {
  Arm scaled = arm;
  for (Joint& joint : scaled.joints) {
    joint.anchor *= factor;
    if (joint.type == JointType::kRevolute) joint.xi.tail<3>() *= factor;
  }
  Eigen::Isometry3d tip = expSe3(arm.gamma);
  tip.translation() *= factor;
  scaled.gamma = logSe3(tip);
  return scaled;
}

/// Where a reading belongs whose place among the others was sorted as text: 1, 10, 11, ..., 2, 20, ...
std::vector<std::size_t> orderAsText(std::size_t count, std::size_t first) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [first](std::size_t a, std::size_t b) { return std::to_string(a + first) < std::to_string(b + first); });
  return order;
}

/// Observation k gets the reading of the observation of `row_of_sample` of its sample. @param joint  of this one alone; nothing: of all
Mistake mistakeOfOrder(std::string text, const std::vector<Observation>& all, std::vector<std::size_t> row_of_sample,
                       std::optional<Eigen::Index> joint = std::nullopt) {
  return {std::move(text), InputPart::kSamples, [&all, rows = std::move(row_of_sample), joint](Problem& problem) {
            std::map<std::size_t, const Observation*> of_sample;
            for (const Observation& observation : all) of_sample[observation.sample] = &observation;
            std::erase_if(problem.observations, [&](Observation& observation) {
              const auto found = of_sample.find(rows[observation.sample]);
              if (found == of_sample.end()) return true;
              if (joint) {
                observation.q(*joint) = found->second->q(*joint);
                return false;
              }
              observation.q = found->second->q;
              observation.T_base_flange = found->second->T_base_flange;
              return false;
            });
            renewPictures(problem);
          }};
}

Mistake mistakeOfLens(std::string text, std::function<void(Camera&)> right) {
  return {std::move(text), InputPart::kCamera, [right](Problem& problem) {
            right(*problem.cell.camera);
            renewPictures(problem);
          }};
}

std::string ratioText(double factor) {
  constexpr std::pair<double, const char*> kRatios[] = {{0.25, "1/4"}, {1.0 / 3.0, "1/3"}, {0.5, "1/2"},  {2.0 / 3.0, "2/3"},
                                                        {0.75, "3/4"}, {0.8, "4/5"},       {1.25, "5/4"}, {4.0 / 3, "4/3"},
                                                        {1.5, "3/2"},  {2.0, "2"},         {3.0, "3"},    {4.0, "4"}};
  for (const auto& [ratio, text] : kRatios) {
    if (std::abs(factor - ratio) < 1e-3) return text;
  }
  return fmt::format("{:.3g}", factor);
}

/// The distance of neighbouring corners of a board along an axis of it [m]; 0 where all have the same place there.
double spacing(const std::vector<Observation>& observations, int axis) {
  std::vector<double> places;
  for (const auto& [id, point] : pointsSeen(observations)) places.push_back(point(axis));
  places = distinctPlaces(std::move(places));
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < places.size(); ++k) least = std::min(least, places[k] - places[k - 1]);
  return places.size() > 1 ? least : 0.0;
}

}  // namespace

std::vector<Mistake> orderMistakes(const Problem& problem, const std::vector<Observation>& all) {
  std::vector<Mistake> mistakes;
  const std::size_t count = all.back().sample + 1;
  std::vector<std::size_t> next(count), last(count);
  for (std::size_t row = 0; row < count; ++row) {
    next[row] = row + 1;
    last[row] = row == 0 ? count : row - 1;  // no row has that number
  }
  for (Eigen::Index k = 0; problem.cell.arm && k < problem.cell.arm->jointCount(); ++k) {
    mistakes.push_back(mistakeOfOrder(fmt::format("q{} looks to hold the readings of the row before", k + 1), all, next, k));
    mistakes.push_back(mistakeOfOrder(fmt::format("q{} looks to hold the readings of the row after", k + 1), all, last, k));
  }
  std::vector<std::size_t> reversed(count);
  std::iota(reversed.rbegin(), reversed.rend(), 0);
  mistakes.push_back(mistakeOfOrder("the rows look to be in reverse order against the pictures", all, reversed));
  if (count < 11) return mistakes;
  for (const std::size_t first : {0u, 1u}) {
    const std::vector<std::size_t> as_text = orderAsText(count, first);
    std::vector<std::size_t> inverse(count);
    for (std::size_t place = 0; place < count; ++place) inverse[as_text[place]] = place;
    for (const auto& rows : {as_text, inverse}) {
      mistakes.push_back(
          mistakeOfOrder("rows in the order of numbers (2, 10) look paired with pictures in that of text (10, 2)", all, rows));
    }
  }
  return mistakes;
}

std::vector<Mistake> unitMistakes(const Problem& problem) {
  std::vector<Mistake> mistakes;
  const auto target = [](double factor) { return [factor](Problem& changed) { scaleTarget(changed, factor); }; };
  if (problem.cell.arm) {
    const double reach = reachOf(*problem.cell.arm);
    const auto arm = [](double factor) {
      return [factor](Problem& changed) {
        changed.cell.arm = scaledArm(*changed.cell.arm, factor);
        renewPoses(changed);
      };
    };
    if (reach > kLargestArm) {
      mistakes.push_back(
          {fmt::format("an arm of {:.1f} km looks like millimetres, expected metres", 1e-3 * reach), InputPart::kRobot, arm(1e-3)});
    }
    if (reach < kSmallestArm) {
      mistakes.push_back({fmt::format("an arm of {:.2g} mm looks like thousandths of its size", 1e3 * reach), InputPart::kRobot, arm(1e3)});
    }
  }
  const bool measured = problem.observations.front().pose.has_value();
  if (measured && problem.cell.arm) {
    mistakes.push_back({"x, y, z look like metres of an arm in millimetres", InputPart::kRobot, target(1e3)});
  } else if (!measured) {
    mistakes.push_back({"the target's size looks like millimetres, expected metres", InputPart::kTarget, target(1e-3)});
    mistakes.push_back({"the target's size looks like centimetres, expected metres", InputPart::kTarget, target(1e-2)});
    mistakes.push_back({"the target's size looks like inches, expected metres", InputPart::kTarget, target(0.0254)});
    // Beside poses it would be those that are in millimetres.
    if (problem.cell.arm) mistakes.push_back({"the target's size looks 1000 times too small", InputPart::kTarget, target(1e3)});
  }
  return mistakes;
}

std::vector<Mistake> resolutionMistakes(const Problem& problem) {
  std::vector<Mistake> mistakes;
  if (!problem.cell.camera) return mistakes;
  const Camera stated = *problem.cell.camera;
  for (const double factor : {0.25, 1.0 / 3.0, 0.5, 2.0 / 3.0, 0.75, 0.8, 1.25, 4.0 / 3.0, 1.5, 2.0, 3.0, 4.0}) {
    mistakes.push_back(
        mistakeOfLens(fmt::format("the corners look like those of pictures with {} of the camera's resolution ({} x {})", ratioText(factor),
                                  std::lround(factor * stated.width), std::lround(factor * stated.height)),
                      [factor](Camera& camera) {
                        camera.fx *= factor;
                        camera.fy *= factor;
                        // The centre of the first pixel is 0.
                        camera.cx = factor * (camera.cx + 0.5) - 0.5;
                        camera.cy = factor * (camera.cy + 0.5) - 0.5;
                      }));
  }
  return mistakes;
}

std::vector<Mistake> lensMistakes(const Problem& problem) {
  std::vector<Mistake> mistakes = resolutionMistakes(problem);
  if (!problem.cell.camera) return mistakes;
  mistakes.push_back(
      {"the lens is not that of these pictures (cut out, or of another resolution?)", InputPart::kCamera, [](Problem& changed) {
         const auto found = solve(changed, 1);
         if (!found) return;
         AdjustmentOptions options = registrationAdjustment(true);
         options.free.intrinsics = true;
         options.max_iterations = 60;
         const double f = changed.cell.camera->fx;
         options.camera_prior_sigma = Eigen::VectorXd::Constant(changed.cell.camera->parameterCount(), 0.1);
         options.camera_prior_sigma.head<4>().setConstant(f);
         changed.cell.camera = adjust(found->fit.cell, changed.observations, options).cell.camera;
         renewPictures(changed);
       }});
  return mistakes;
}

std::vector<Mistake> pictureMistakes(const Problem& problem) {
  std::vector<Mistake> mistakes;
  if (!problem.cell.camera) return mistakes;
  const Eigen::Vector2d last(problem.cell.camera->width - 1, problem.cell.camera->height - 1);
  const auto add = [&](const char* text, const std::function<void(CornerMeasurement&)>& right) {
    mistakes.push_back({text, InputPart::kDetections, [right](Problem& changed) {
                          for (Observation& observation : changed.observations) {
                            for (CornerMeasurement& corner : observation.corners) right(corner);
                          }
                          renewPictures(changed);
                        }});
  };
  add("the pictures look turned by 180 degrees", [last](CornerMeasurement& corner) { corner.px = last - corner.px; });
  add("the pictures look mirrored from left to right", [last](CornerMeasurement& corner) { corner.px.x() = last.x() - corner.px.x(); });
  add("the pictures look upside down (mirrored from top to bottom)",
      [last](CornerMeasurement& corner) { corner.px.y() = last.y() - corner.px.y(); });
  // Of a board without numbers either end is the first.
  if (problem.observations.front().corners.empty() || problem.observations.front().corners.front().id.tag >= 0) return mistakes;
  Eigen::AlignedBox3d board;
  for (const Observation& observation : problem.observations) {
    for (const CornerMeasurement& corner : observation.corners) board.extend(corner.p_target);
  }
  add("the board looks read from its opposite corner",
      [ends = Eigen::Vector3d(board.min() + board.max())](CornerMeasurement& corner) { corner.p_target = ends - corner.p_target; });
  for (int axis = 0; axis < 2; ++axis) {
    const double square = spacing(problem.observations, axis);
    for (const double late : {1.0, -1.0}) {
      add(axis == 0 ? "the board's corners look counted a column off" : "the board's corners look counted a row off",
          [axis, shift = late * square](CornerMeasurement& corner) { corner.p_target(axis) += shift; });
    }
  }
  return mistakes;
}

}  // namespace poecal
