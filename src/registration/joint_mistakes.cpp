#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "registration/mistakes.hpp"

namespace poecal {
namespace {

/// All subsets of so many joints are tried with the other sign; beyond it single ones, pairs, and all.
constexpr int kAllSubsets = 7;
constexpr int kSignsOfPairs = 2;  // joints that count the other way beside another mistake
constexpr std::array kZeros{90, -90, 180};

using Readings = std::function<void(Eigen::VectorXd&)>;

Mistake mistakeOfReadings(std::string text, Readings right) {
  return {std::move(text), InputPart::kSamples, [right](Problem& problem) {
            for (Observation& observation : problem.observations) right(observation.q);
            renewPoses(problem);
          }};
}

std::string listOf(const std::vector<int>& joints) {
  std::string text;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    text += fmt::format("{}q{}", k == 0 ? "" : k + 1 == joints.size() ? " and " : ", ", joints[k] + 1);
  }
  return text;
}

/// Whatever is mounted before a joint follows none of its readings, nor those of joints beyond.
void addUnmoved(const Problem& problem, std::vector<Mistake>& mistakes) {
  constexpr int kLast = 2;
  const char* mounted = problem.cell.registration.setup == Setup::kEyeInHand ? "camera" : "target";
  const int count = problem.cell.arm->jointCount();
  for (int first = count - 1; first >= std::max(1, count - kLast); --first) {
    std::vector<int> still(static_cast<std::size_t>(count - first));
    std::iota(still.begin(), still.end(), first);
    const char* move = still.size() == 1 ? "does not move" : "do not move";
    mistakes.push_back(mistakeOfReadings(fmt::format("{} {} the {}: is it mounted before joint {}, or is the arm's last link wrong?",
                                                     listOf(still), move, mounted, first + 1),
                                         [first](Eigen::VectorXd& q) { q.tail(q.size() - first).setZero(); }));
  }
}

void addUnits(const Arm& arm, std::vector<Mistake>& mistakes) {
  std::vector<int> revolute, prismatic;
  for (int k = 0; k < arm.jointCount(); ++k) {
    (arm.joints[static_cast<std::size_t>(k)].type == JointType::kRevolute ? revolute : prismatic).push_back(k);
  }
  const auto scaled = [](std::vector<int> joints, double factor) {
    return [joints = std::move(joints), factor](Eigen::VectorXd& q) {
      for (const int k : joints) q(k) *= factor;
    };
  };
  mistakes.push_back(mistakeOfReadings("joint readings look like degrees, expected radians", scaled(revolute, M_PI / 180.0)));
  for (const int k : revolute) {
    mistakes.push_back(mistakeOfReadings(fmt::format("q{} looks like degrees, expected radians", k + 1), scaled({k}, M_PI / 180.0)));
  }
  if (prismatic.empty()) return;
  mistakes.push_back(mistakeOfReadings(listOf(prismatic) + " look like millimetres, expected metres", scaled(prismatic, 1e-3)));
  mistakes.push_back(mistakeOfReadings("joint readings look like degrees and millimetres, expected radians and metres",
                                       [turn = scaled(revolute, M_PI / 180.0), slide = scaled(prismatic, 1e-3)](Eigen::VectorXd& q) {
                                         turn(q);
                                         slide(q);
                                       }));
}

/// @param most  joints at once.
void addSigns(int count, int most, std::vector<Mistake>& mistakes) {
  std::vector<std::vector<int>> subsets;
  for (int size = 1; size <= std::min(count, most); ++size) {
    if (count > kAllSubsets && size > 2 && size < count) continue;
    std::vector<bool> chosen(static_cast<std::size_t>(count), false);
    std::fill(chosen.begin(), chosen.begin() + size, true);
    do {
      std::vector<int> joints;
      for (int k = 0; k < count; ++k) {
        if (chosen[static_cast<std::size_t>(k)]) joints.push_back(k);
      }
      subsets.push_back(std::move(joints));
    } while (std::prev_permutation(chosen.begin(), chosen.end()));
  }
  for (const std::vector<int>& joints : subsets) {
    mistakes.push_back(mistakeOfReadings(listOf(joints) + (joints.size() == 1 ? " counts the other way" : " count the other way"),
                                         [joints](Eigen::VectorXd& q) {
                                           for (const int k : joints) q(k) = -q(k);
                                         }));
  }
}

/// @param column  of joint k, the column that holds its reading.
Readings permuted(const std::vector<int>& column) {
  return [column](Eigen::VectorXd& q) {
    const Eigen::VectorXd read = q;
    for (std::size_t k = 0; k < column.size(); ++k) q(static_cast<Eigen::Index>(k)) = read(column[k]);
  };
}

void addOrders(const Arm& arm, std::vector<Mistake>& mistakes) {
  const int count = arm.jointCount();
  std::vector<int> own(static_cast<std::size_t>(count));
  std::iota(own.begin(), own.end(), 0);
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      std::vector<int> column = own;
      std::swap(column[static_cast<std::size_t>(a)], column[static_cast<std::size_t>(b)]);
      const char* hint = a == 0 && b == 2 ? " (ROS' alphabetical order?)" : "";
      mistakes.push_back(mistakeOfReadings(fmt::format("q{} and q{} are exchanged{}", a + 1, b + 1, hint), permuted(column)));
    }
  }
  std::vector<int> by_name = own;
  std::stable_sort(by_name.begin(), by_name.end(), [&](int a, int b) {
    return arm.joints[static_cast<std::size_t>(a)].name < arm.joints[static_cast<std::size_t>(b)].name;
  });
  std::vector<int> column(own.size());
  for (std::size_t place = 0; place < by_name.size(); ++place) column[static_cast<std::size_t>(by_name[place])] = static_cast<int>(place);
  mistakes.push_back(
      mistakeOfReadings("the joints look to be in the alphabetical order of their names, as ROS gives them", permuted(column)));
  if (count < 4) return;
  std::vector<int> turned(own.rbegin(), own.rend());
  mistakes.push_back(mistakeOfReadings("the joints look to be in reverse order", permuted(turned)));
  for (const int by : {1, count - 1}) {
    std::vector<int> moved = own;
    std::rotate(moved.begin(), moved.begin() + by, moved.end());
    mistakes.push_back(mistakeOfReadings(by == 1 ? "the columns of the joints look shifted by one (q1 holds the last joint)"
                                                 : "the columns of the joints look shifted by one (q1 holds the second joint)",
                                         permuted(moved)));
  }
}

void addZeros(const Arm& arm, std::vector<Mistake>& mistakes) {
  for (int k = 0; k < arm.jointCount(); ++k) {
    if (arm.joints[static_cast<std::size_t>(k)].type != JointType::kRevolute) continue;
    for (const int degrees : kZeros) {
      mistakes.push_back(mistakeOfReadings(fmt::format("the zero of q{} is off by {} degrees", k + 1, degrees),
                                           [k, degrees](Eigen::VectorXd& q) { q(k) -= degrees * M_PI / 180.0; }));
    }
  }
}

/// Controllers of parallelogram arms and of coupled wrists give a joint's angle against another frame than the link before it.
void addCouplings(const Arm& arm, std::vector<Mistake>& mistakes) {
  for (Eigen::Index k = 1; k < arm.jointCount(); ++k) {
    if (arm.joints[static_cast<std::size_t>(k)].type != JointType::kRevolute) continue;
    if (arm.joints[static_cast<std::size_t>(k - 1)].type != JointType::kRevolute) continue;
    for (const double sign : {1.0, -1.0}) {
      mistakes.push_back(
          mistakeOfReadings(fmt::format("q{0} looks to hold q{0} {1} q{2} (a coupled joint?)", k + 1, sign > 0.0 ? "+" : "-", k),
                            [k, sign](Eigen::VectorXd& q) { q(k) -= sign * q(k - 1); }));
    }
  }
}

/// One mistake put right, then the other.
Mistake both(const Mistake& first, const Mistake& second) {
  return {first.text + ", and " + second.text, InputPart::kSamples,
          [first = first.undo, second = second.undo](Problem& problem) {
            first(problem);
            second(problem);
          },
          false};
}

}  // namespace

std::vector<Mistake> jointMistakePairs(const Problem& problem) {
  std::vector<Mistake> pairs;
  if (!problem.cell.arm) return pairs;
  const Arm& arm = *problem.cell.arm;
  std::vector<Mistake> orders, signs, zeros;
  addOrders(arm, orders);
  addSigns(arm.jointCount(), kSignsOfPairs, signs);
  addZeros(arm, zeros);
  for (const Mistake& sign : signs) {
    for (const Mistake& order : orders) pairs.push_back(both(order, sign));
    for (const Mistake& zero : zeros) pairs.push_back(both(sign, zero));
  }
  for (std::size_t a = 0; a < zeros.size(); ++a) {
    for (std::size_t b = a + 1; b < zeros.size(); ++b) {
      if (a / kZeros.size() != b / kZeros.size()) pairs.push_back(both(zeros[a], zeros[b]));
    }
  }
  return pairs;
}

std::vector<Mistake> jointMistakes(const Problem& problem) {
  std::vector<Mistake> mistakes;
  if (!problem.cell.arm) return mistakes;
  addUnmoved(problem, mistakes);
  addUnits(*problem.cell.arm, mistakes);
  addSigns(problem.cell.arm->jointCount(), problem.cell.arm->jointCount(), mistakes);
  addOrders(*problem.cell.arm, mistakes);
  addZeros(*problem.cell.arm, mistakes);
  addCouplings(*problem.cell.arm, mistakes);
  return mistakes;
}

}  // namespace poecal
