#include "withheld/listed_flaws.hpp"

#include <cmath>

#include <fmt/format.h>

namespace withheld {
namespace {

using Act = std::function<void(const Flaw&, const Shot&, const Loads&, State&)>;

std::string numbered(const char* word, std::size_t index) { return fmt::format("{}{}", word, index + 1); }

Frame sixNumbers(const Flaw& flaw, std::size_t first, double factor) {
  return motion(factor * Vector(flaw[first], flaw[first + 1], flaw[first + 2]),
                factor * Vector(flaw[first + 3], flaw[first + 4], flaw[first + 5]));
}

std::vector<Parameter> sixParameters(double turn, double shift) {
  return {{"rx", 0, turn, 50 * turn},   {"ry", 0, turn, 50 * turn},   {"rz", 0, turn, 50 * turn},
          {"tx", 0, shift, 50 * shift}, {"ty", 0, shift, 50 * shift}, {"tz", 0, shift, 50 * shift}};
}

/// "Time" of what drifts: hours, or kelvin.
struct Clock {
  const char* driver;
  double Shot::*elapsed;
  double unit;  ///< typical span [h] or [K], by which rates are divided
};

std::vector<Clock> clocks(const Columns& columns) {
  std::vector<Clock> there;
  if (columns.stamp) there.push_back({"stamp", &Shot::hours, 1.0});
  if (columns.temperature) there.push_back({"temperature", &Shot::kelvin, 8.0});
  return there;
}

void addJointFlaws(std::vector<Flaw>& flaws, const Cell& cell, const Columns& columns, const Instances& instances, std::size_t k) {
  const auto K = static_cast<Eigen::Index>(k);
  const std::string place = numbered("joint:", k);
  const bool slides = cell.arm.joints[k].slides;
  const double unit = slides ? 0.3 : 1.0;  // a slider errs in metres, about as far as a turning joint moves what it carries
  const auto add = [&](const char* effect, const std::string& driver, std::vector<Parameter> parameters, Act act) {
    flaws.push_back({effect, place, driver, std::move(parameters), std::move(act)});
  };
  const std::string q = numbered("q", k);

  add("joint_gain", q, {{"gain", 0, 1e-3, 3e-2}},
      [K](const Flaw& f, const Shot& s, const Loads&, State& c) { c.q[K] = s.q[K] + f[0] * s.q[K]; });
  add("joint_compliance", numbered("tau", k), {{"compliance", 0, 2e-5 * unit, 3e-4 * unit}},
      [K](const Flaw& f, const Shot&, const Loads& loads, State& c) { c.q[K] += f[0] * loads.torque[K]; });
  flaws.back().yields = true;
  if (columns.dir) {
    add("joint_backlash", numbered("dir", k), {{"half_gap", 0, 2e-4 * unit, 1e-2 * unit}},
        [K](const Flaw& f, const Shot& s, const Loads&, State& c) { c.q[K] += s.dir[K] > 0   ? f[0]
                                                                              : s.dir[K] < 0 ? -f[0]
                                                                                             : 0.0; });
  }
  if (columns.stamp) {
    add("joint_slip", "stamp", {{"time", instances.slip_time, 0, 0}, {"offset", 0, 1e-3 * unit, 4e-2 * unit}},
        [K](const Flaw& f, const Shot& s, const Loads&, State& c) {
          if (s.stamp >= f[0]) c.q[K] += f[1];
        });
  }
  for (const Clock& clock : clocks(columns)) {
    add("joint_drift", clock.driver, {{"rate", 0, 2e-4 * unit / clock.unit, 2e-2 * unit / clock.unit}},
        [K, clock](const Flaw& f, const Shot& s, const Loads&, State& c) { c.q[K] += f[0] * s.*clock.elapsed; });
  }
  for (std::size_t j = 0; j < cell.arm.size(); ++j) {
    if (j == k) continue;
    const auto J = static_cast<Eigen::Index>(j);
    add("joint_coupling", numbered("q", j), {{"source", static_cast<double>(j + 1), 0, 0}, {"ratio", 0, 1e-3 * unit, 5e-2}},
        [K, J](const Flaw& f, const Shot& s, const Loads&, State& c) { c.q[K] += f[1] * s.q[J]; });
  }
  if (slides) return;

  // A disc whose centre is off by (a, b) radii of itself reads the angle of a point seen from a wrong centre.
  add("joint_eccentricity", q, {{"a", 0, 3e-4, 1e-2}, {"b", 0, 3e-4, 1e-2}}, [K](const Flaw& f, const Shot& s, const Loads&, State& c) {
    const double off = std::atan2(std::sin(s.q[K]) + f[1], std::cos(s.q[K]) + f[0]) - std::atan2(std::sin(s.q[K]), std::cos(s.q[K]));
    c.q[K] += std::remainder(off, 2.0 * KDL::PI);  // half a turn away one of the two may have come round
  });
  for (const int order : instances.orders) {
    add("joint_harmonic", q, {{"order", static_cast<double>(order), 0, 0}, {"sine", 0, 2e-4, 5e-3}, {"cosine", 0, 2e-4, 5e-3}},
        [K](const Flaw& f, const Shot& s, const Loads&, State& c) {
          c.q[K] += f[1] * std::sin(f[0] * s.q[K]) + f[2] * std::cos(f[0] * s.q[K]);
        });
  }
  add("axis_wobble", q, {{"sine_x", 0, 1e-4, 1e-2}, {"cosine_x", 0, 1e-4, 1e-2}, {"sine_y", 0, 1e-4, 1e-2}, {"cosine_y", 0, 1e-4, 1e-2}},
      [k, K](const Flaw& f, const Shot& s, const Loads&, State& c) {
        const double sine = std::sin(s.q[K]), cosine = std::cos(s.q[K]);
        c.tilt[k] = c.tilt[k] * motion(Vector(f[0] * sine + f[1] * cosine, f[2] * sine + f[3] * cosine, 0.0));
      });
}

void addLinkFlaws(std::vector<Flaw>& flaws, const Cell& cell, const Columns& columns, std::size_t k) {
  const std::string place = numbered("link:", k);
  if (!cell.arm.joints[k].slides) {
    // A beam, softer one way than the other by its profile.
    flaws.push_back({"link_bending",
                     place,
                     "gravity",
                     {{"about_x", 0, 5e-6, 3e-4}, {"about_y", 0, 5e-6, 3e-4}},
                     [k](const Flaw& f, const Shot&, const Loads& loads, State& c) {
                       const Vector& moment = loads.moment_body[k];
                       c.bend[k] = c.bend[k] * motion(Vector(f[0] * moment.x(), f[1] * moment.y(), 0.0));
                     },
                     true});
  }
  // Axes that meet have nothing between them that could grow.
  constexpr double kShortestLink = 0.01;  // [m]
  const Frame& link = k + 1 < cell.arm.size() ? cell.arm.joints[k + 1].T_before : cell.arm.T_last_flange;
  if (link.p.Norm() < kShortestLink) return;
  for (const Clock& clock : clocks(columns)) {
    flaws.push_back({"link_expansion",
                     place,
                     clock.driver,
                     {{"expansion", 0, 2e-4 / clock.unit, 2e-2 / clock.unit}},
                     [k, clock](const Flaw& f, const Shot& s, const Loads&, State& c) { c.growth[k] *= 1.0 + f[0] * s.*clock.elapsed; }});
  }
}

void addCameraFlaws(std::vector<Flaw>& flaws, const Columns& columns, const Instances& instances) {
  if (columns.stamp) {
    std::vector<Parameter> slip = sixParameters(5e-4, 5e-4);
    slip.insert(slip.begin(), {"time", instances.slip_time, 0, 0});
    flaws.push_back({"camera_slip", "camera.mount", "stamp", slip, [](const Flaw& f, const Shot& s, const Loads&, State& c) {
                       if (s.stamp >= f[0]) c.camera = sixNumbers(f, 1, 1.0) * c.camera;
                     }});
    flaws.push_back({"target_slip", "target.mount", "stamp", slip, [](const Flaw& f, const Shot& s, const Loads&, State& c) {
                       if (s.stamp >= f[0]) c.grip = sixNumbers(f, 1, 1.0) * c.grip;
                     }});
  }
  for (const Clock& clock : clocks(columns)) {
    flaws.push_back(
        {"camera_drift", "camera.mount", clock.driver, sixParameters(5e-4 / clock.unit, 5e-4 / clock.unit),
         [clock](const Flaw& f, const Shot& s, const Loads&, State& c) { c.camera = sixNumbers(f, 0, s.*clock.elapsed) * c.camera; }});
    flaws.push_back({"focal_drift",
                     "camera.lens",
                     clock.driver,
                     {{"rate", 0, 5e-4 / clock.unit, 3e-2 / clock.unit}},
                     [clock](const Flaw& f, const Shot& s, const Loads&, State& c) {
                       c.lens.fx *= 1.0 + f[0] * s.*clock.elapsed;
                       c.lens.fy *= 1.0 + f[0] * s.*clock.elapsed;
                     }});
  }
  flaws.push_back({"lens_distortion",
                   "camera.lens",
                   "pixel",
                   {{"dk1", 0, 0.02, 0.3}, {"dk2", 0, 0.02, 0.6}, {"dp1", 0, 5e-4, 2e-2}, {"dp2", 0, 5e-4, 2e-2}},
                   [](const Flaw& f, const Shot&, const Loads&, State& c) {
                     c.lens.k1 += f[0];
                     c.lens.k2 += f[1];
                     c.lens.p1 += f[2];
                     c.lens.p2 += f[3];
                   }});
  flaws.push_back(
      {"focal_length", "camera.lens", "pixel", {{"scale", 0, 2e-3, 0.04}}, [](const Flaw& f, const Shot&, const Loads&, State& c) {
         c.lens.fx *= 1.0 + f[0];
         c.lens.fy *= 1.0 + f[0];
       }});
  flaws.push_back({"principal_point",
                   "camera.lens",
                   "pixel",
                   {{"dx", 0, 5.0, 60.0}, {"dy", 0, 5.0, 60.0}},
                   [](const Flaw& f, const Shot&, const Loads&, State& c) {
                     c.lens.cx += f[0];
                     c.lens.cy += f[1];
                   }});
  flaws.push_back({"corner_bias", "detector", "pixel", {{"outward", 0, 0.1, 3.0}}, [](const Flaw& f, const Shot&, const Loads&, State& c) {
                     c.outward += f[0];
                   }});
  if (columns.dq) {
    flaws.push_back(
        {"rolling_shutter", "camera.shutter", "dq", {{"line_time", 0, 2e-5, 3e-4}}, [](const Flaw& f, const Shot&, const Loads&, State& c) {
           c.line_time += f[0];
         }});
    flaws.push_back({"time_offset", "timing", "dq", {{"offset", 0, 5e-3, 0.3}}, [](const Flaw& f, const Shot& s, const Loads&, State& c) {
                       c.q += f[0] * s.dq;
                     }});
  }
}

void addTargetFlaws(std::vector<Flaw>& flaws, const Cell& cell) {
  Vector center = Vector::Zero();
  for (const Tag& tag : cell.tags) center += tag.center / static_cast<double>(cell.tags.size());
  flaws.push_back({"target_anisotropy",
                   "target.shape",
                   "none",
                   {{"stretch", 0, 2e-3, 0.05}},
                   [center](const Flaw& f, const Shot&, const Loads&, State& c) {
                     for (Vector& point : c.points) point.x(point.x() + f[0] * (point.x() - center.x()));
                   }});
  flaws.push_back({"target_bend",
                   "target.shape",
                   "none",
                   {{"curvature_x", 0, 0.2, 4.0}, {"curvature_y", 0, 0.2, 4.0}, {"saddle", 0, 0.2, 4.0}},
                   [center](const Flaw& f, const Shot&, const Loads&, State& c) {
                     for (Vector& point : c.points) {
                       const double x = point.x() - center.x(), y = point.y() - center.y();
                       point.z(point.z() + 0.5 * (f[0] * x * x + f[1] * y * y) + f[2] * x * y);
                     }
                   }});
  if (cell.tags.size() < 2) return;
  for (std::size_t tag = 0; tag < cell.tags.size(); ++tag) {
    flaws.push_back({"target_layout",
                     "target.shape",
                     "none",
                     {{"tag", static_cast<double>(cell.tags[tag].id), 0, 0}, {"dx", 0, 5e-4, 1e-2}, {"dy", 0, 5e-4, 1e-2}},
                     [tag](const Flaw& f, const Shot&, const Loads&, State& c) {
                       for (std::size_t i = 4 * tag; i < 4 * tag + 4; ++i) c.points[i] += Vector(f[1], f[2], 0.0);
                     }});
  }
}

}  // namespace

std::vector<Flaw> listedFlaws(const Cell& cell, const Columns& columns, const Instances& instances) {
  std::vector<Flaw> flaws;
  for (std::size_t k = 0; k < cell.arm.size(); ++k) {
    addJointFlaws(flaws, cell, columns, instances, k);
    addLinkFlaws(flaws, cell, columns, k);
  }
  // The pedestal yields alike in all directions.
  flaws.push_back(
      {"base_compliance",
       "base",
       "gravity",
       {{"compliance", 0, 5e-6, 3e-4}},
       [](const Flaw& f, const Shot&, const Loads& loads, State& c) { c.pedestal = motion(f[0] * loads.moment_base) * c.pedestal; },
       true});
  addCameraFlaws(flaws, columns, instances);
  addTargetFlaws(flaws, cell);
  return flaws;
}

Flaw withUnknownMasses(const Cell& cell, const Flaw& flaw) {
  constexpr double kHeaviest = 20.0;  // [kg], or kg m
  std::vector<Cell> units;            // arms of which one body weighs 1 kg
  for (std::size_t body = 0; body < cell.arm.size(); ++body) {
    for (int axis = -1; axis < 3; ++axis) {
      Cell unit = cell;
      for (Body& other : unit.arm.bodies) other = {};
      unit.arm.bodies[body].mass = 1.0;
      if (axis >= 0) unit.arm.bodies[body].com[axis] = 1.0;
      units.push_back(unit);
    }
  }
  Flaw free = flaw;
  free.yields = false;  // the loads that it is handed are not its own
  free.parameters.clear();
  for (std::size_t unit = 0; unit < units.size(); ++unit) {
    for (const Parameter& own : flaw.parameters) {
      free.parameters.push_back({fmt::format("{}_{}", own.name, unit), 0.0, own.usual, kHeaviest * own.most});
    }
  }
  free.act = [units, flaw](const Flaw& f, const Shot& shot, const Loads&, State& state) {
    for (std::size_t i = 0; i < f.parameters.size(); ++i) {
      if (f[i] == 0.0) continue;
      Flaw part = flaw;
      part.scale(0.0);
      part.parameters[i % flaw.parameters.size()].value = f[i];
      part.act(part, shot, gravityLoads(units[i / flaw.parameters.size()], state, 0.0), state);
    }
  };
  return free;
}

Flaw jointScatter(const Cell& cell, std::size_t joint, std::uint64_t seed) {
  const auto K = static_cast<Eigen::Index>(joint);
  const double usual = cell.arm.joints[joint].slides ? 6e-5 : 2e-4;
  return {"joint_scatter",
          numbered("joint:", joint),
          "none",
          {{"sigma", usual, usual, 100.0 * usual}},
          [K, seed](const Flaw& f, const Shot& s, const Loads&, State& c) {
            c.q[K] += Chance(seed + static_cast<std::uint64_t>(s.pose) * 2654435761U).normal(f[0]);
          },
          false,
          true};
}

Flaw zeroOffset(std::size_t joint, double offset) {
  const auto K = static_cast<Eigen::Index>(joint);
  return {"zero offset",
          numbered("joint:", joint),
          "none",
          {{"offset", offset, 1e-3, 0.1}},
          [K](const Flaw& f, const Shot&, const Loads&, State& c) { c.q[K] += f[0]; }};
}

Flaw targetScale(double share) {
  return {"target_scale", "target.shape", "none", {{"scale", share, 5e-3, 0.1}}, [](const Flaw& f, const Shot&, const Loads&, State& c) {
            for (Vector& point : c.points) point = point * (1.0 + f[0]);
          }};
}

}  // namespace withheld
