#include "withheld/arms.hpp"

#include <numbers>
#include <stdexcept>

namespace withheld {
namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;

Arm cobot(double s) {
  Arm arm{"cobot", {}, {}, step(0.0, 0.0, 0.03)};
  arm.joints = {{false, step(0.0, 0.0, 0.16 * s), -3.1, 3.1},      {false, step(kQuarter, 0.0, 0.0), -3.1, 3.1},
                {false, step(0.0, -0.42 * s, 0.0), -2.7, 2.7},     {false, step(0.0, -0.39 * s, 0.13 * s), -3.1, 3.1},
                {false, step(kQuarter, 0.0, 0.10 * s), -3.1, 3.1}, {false, step(-kQuarter, 0.0, 0.10 * s), -3.1, 3.1}};
  arm.bodies = {{3.8, {}}, {8.2, {}}, {2.4, {}}, {1.3, {}}, {1.2, {}}, {0.3, {}}};
  return arm;
}

Arm sphericalWrist(double s) {
  Arm arm{"wrist", {}, {}, step(0.0, 0.0, 0.09 * s)};
  arm.joints = {{false, step(0.0, 0.0, 0.40 * s), -2.8, 2.8}, {false, step(-kQuarter, 0.07 * s, 0.0), -2.6, 0.9},
                {false, step(0.0, 0.38 * s, 0.0), -2.6, 1.2}, {false, step(-kQuarter, 0.05 * s, 0.40 * s), -3.1, 3.1},
                {false, step(kQuarter, 0.0, 0.0), -2.0, 2.0}, {false, step(-kQuarter, 0.0, 0.0), -3.1, 3.1}};
  arm.bodies = {{9.0, {}}, {7.0, {}}, {5.0, {}}, {2.0, {}}, {0.9, {}}, {0.3, {}}};
  return arm;
}

Arm sevenJoints(double s, double elbow) {
  Arm arm{"seven", {}, {}, step(0.0, 0.0, 0.11 * s)};
  arm.joints = {{false, step(0.0, 0.0, 0.34 * s), -2.8, 2.8},          {false, step(-kQuarter, 0.0, 0.0), -2.0, 2.0},
                {false, step(kQuarter, 0.0, 0.36 * s), -2.8, 2.8},     {false, step(kQuarter, elbow, 0.0), -2.2, 2.2},
                {false, step(-kQuarter, -elbow, 0.38 * s), -2.8, 2.8}, {false, step(kQuarter, 0.0, 0.0), -2.1, 2.1},
                {false, step(-kQuarter, elbow, 0.0), -2.9, 2.9}};
  arm.bodies = {{4.5, {}}, {4.0, {}}, {3.2, {}}, {3.4, {}}, {2.2, {}}, {1.6, {}}, {0.5, {}}};
  return arm;
}

Arm scara(double s, bool slides_last) {
  Arm arm{"scara", {}, {}, step(0.0, 0.0, 0.05 * s)};
  const Frame down = step(2.0 * kQuarter, 0.26 * s, -0.15 * s);
  const Joint slider{true, slides_last ? step(0.0, 0.0, 0.06) : down, 0.0, 0.22};
  const Joint turner{false, slides_last ? down : step(0.0, 0.0, 0.06), -3.1, 3.1};
  arm.joints = {{false, step(0.0, 0.0, 0.30 * s), -2.3, 2.3}, {false, step(0.0, 0.32 * s, 0.0), -2.5, 2.5}};
  arm.joints.push_back(slides_last ? turner : slider);
  arm.joints.push_back(slides_last ? slider : turner);
  arm.bodies = {{7.0, {}}, {5.0, {}}, {1.2, {}}, {0.4, {}}};
  return arm;
}

/// Centres of mass about half way to the next joint.
void fillBodies(Arm& arm, Chance& chance) {
  for (std::size_t k = 0; k < arm.size(); ++k) {
    const Vector next = k + 1 < arm.size() ? arm.joints[k + 1].T_before.p : arm.T_last_flange.p;
    arm.bodies[k].mass *= chance.between(0.8, 1.25);
    arm.bodies[k].com = chance.between(0.3, 0.6) * next + normalVector(chance, 0.015);
  }
}

}  // namespace

std::vector<Frame> framesAtRest(const Arm& arm) {
  std::vector<Frame> frames;
  Frame T_base_here = Frame::Identity();
  for (const Joint& joint : arm.joints) frames.push_back(T_base_here = T_base_here * joint.T_before);
  frames.push_back(T_base_here * arm.T_last_flange);
  return frames;
}

std::string drawFamily(Chance& chance) {
  return chance.oneOf(std::vector<std::string>{"cobot", "wrist", "seven", "cobot", "wrist", "seven", "scara"});
}

Arm drawArm(Chance& chance, const std::string& family) {
  const double size = chance.between(0.85, 1.2);
  Arm arm;
  if (family == "cobot") {
    arm = cobot(size);
  } else if (family == "wrist") {
    arm = sphericalWrist(size);
  } else if (family == "seven") {
    arm = sevenJoints(size, chance.happens(0.5) ? 0.08 : 0.0);
  } else if (family == "scara") {
    arm = scara(size, chance.happens(0.5));
  } else {
    throw std::invalid_argument("no arm family '" + family + "', expected cobot, wrist, seven or scara");
  }
  fillBodies(arm, chance);
  return arm;
}

void moveAxis(Arm& arm, std::size_t joint, const Frame& small) {
  arm.joints[joint].T_before = arm.joints[joint].T_before * small;
  Frame& next = joint + 1 < arm.size() ? arm.joints[joint + 1].T_before : arm.T_last_flange;
  next = small.Inverse() * next;
}

Arm withErrors(const Arm& nominal, const Tolerances& tolerances, Chance& chance) {
  Arm actual = nominal;
  for (std::size_t k = 0; k < actual.size(); ++k) {
    const Frame error = motion(normalVector(chance, tolerances.rotation), normalVector(chance, tolerances.position));
    if (tolerances.by_link) {
      actual.joints[k].T_before = actual.joints[k].T_before * error;
    } else {
      moveAxis(actual, k, error);
    }
  }
  const Frame error = motion(normalVector(chance, tolerances.rotation), normalVector(chance, tolerances.position));
  actual.T_last_flange = actual.T_last_flange * error;
  return actual;
}

}  // namespace withheld
