#include "withheld/cell.hpp"

#include <cmath>

#include <Eigen/Dense>

namespace withheld {
namespace {

Frame grown(Frame link, double factor) {
  link.p = link.p * factor;
  return link;
}

/// Calls visit(k, T_base_body_k) along the arm. @return T_base_flange
template <typename Visit>
Frame walk(const Cell& cell, const State& state, const Visit& visit) {
  const Arm& arm = cell.arm;
  Frame T_base_body = state.pedestal;
  for (std::size_t k = 0; k < arm.size(); ++k) {
    const Joint& joint = arm.joints[k];
    const Frame link = k == 0 ? joint.T_before : grown(joint.T_before, state.growth[k - 1]);
    T_base_body = T_base_body * link * state.tilt[k] * joint.moved(state.q[static_cast<Eigen::Index>(k)]) * state.bend[k];
    visit(k, T_base_body);
  }
  return T_base_body * grown(arm.T_last_flange, state.growth.back());
}

/// Each edge of a tag moves out by `by` pixels; corners are where the moved edges meet.
void moveEdgesOut(Eigen::Ref<Eigen::VectorXd> pixels, double by) {
  using Line = Eigen::Vector3d;
  for (Eigen::Index tag = 0; tag < pixels.size(); tag += 8) {
    const auto corner = [&](int i) -> Eigen::Vector2d { return pixels.segment<2>(tag + 2 * (i & 3)); };
    const Eigen::Vector2d middle = (corner(0) + corner(1) + corner(2) + corner(3)) / 4.0;
    Line edges[4];
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector2d along = (corner(i + 1) - corner(i)).normalized();
      Eigen::Vector2d normal(along.y(), -along.x());
      if (normal.dot(corner(i) - middle) < 0.0) normal = -normal;
      edges[i] << normal, -normal.dot(corner(i)) - by;
    }
    for (int i = 0; i < 4; ++i) pixels.segment<2>(tag + 2 * i) = edges[(i + 3) & 3].cross(edges[i]).hnormalized();
  }
}

Eigen::VectorXd seen(const Cell& cell, const State& state) {
  const Frame T_camera_target = targetInCamera(cell, state);
  Eigen::VectorXd pixels(2 * static_cast<Eigen::Index>(state.points.size()));
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    pixels.segment<2>(2 * static_cast<Eigen::Index>(i)) = state.lens.image(T_camera_target * state.points[i]);
  }
  return pixels;
}

/// Every row is exposed at its own time: each corner is where the moving arm has it when its own row is read.
Eigen::VectorXd seenRowByRow(const Cell& cell, const Shot& shot, const State& state) {
  Eigen::VectorXd pixels = seen(cell, state);
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    for (int round = 0; round < 3; ++round) {
      const State then = stateAtRow(shot, state, pixels[row + 1]);
      pixels.segment<2>(row) = state.lens.image(targetInCamera(cell, then) * state.points[i]);
    }
  }
  return pixels;
}

constexpr int kEquilibriumRounds = 4;  // deflections of 1e-3 rad change the torque by 1e-3: each round gains three digits

}  // namespace

std::vector<Vector> tagCorners(const std::vector<Tag>& tags) {
  std::vector<Vector> points;
  for (const Tag& tag : tags) {
    const double h = tag.size / 2.0;
    for (const Vector& corner : {Vector(-h, h, 0.0), Vector(h, h, 0.0), Vector(h, -h, 0.0), Vector(-h, -h, 0.0)}) {
      points.push_back(tag.center + corner);
    }
  }
  return points;
}

State flawless(const Cell& cell, const Shot& shot) {
  State state;
  state.q = shot.q;
  state.tilt.assign(cell.arm.size(), Frame::Identity());
  state.bend = state.tilt;
  state.growth.assign(cell.arm.size(), 1.0);
  state.lens = cell.lens;
  state.points = tagCorners(cell.tags);
  return state;
}

Frame targetInCamera(const Cell& cell, const State& state) {
  const Frame T_base_flange = walk(cell, state, [](std::size_t, const Frame&) {});
  const Frame T_mount_mount = cell.in_hand ? T_base_flange.Inverse() : T_base_flange;
  return state.camera * cell.T_camera_mount * T_mount_mount * cell.T_mount_target * state.grip;
}

Loads gravityLoads(const Cell& cell, const State& state, double payload) {
  const std::size_t n = cell.arm.size();
  std::vector<Frame> bodies(n);
  const Frame T_base_flange = walk(cell, state, [&](std::size_t k, const Frame& T_base_body) { bodies[k] = T_base_body; });
  const Vector down(0.0, 0.0, -cell.gravity);

  // From the flange inwards: mass and first moment of all that a joint carries.
  double mass = payload;
  Vector first_moment = payload * T_base_flange.p;
  Loads loads;
  loads.torque.resize(static_cast<Eigen::Index>(n));
  loads.moment_body.resize(n);
  for (std::size_t k = n; k-- > 0;) {
    const Body& body = cell.arm.bodies[k];
    mass += body.mass;
    first_moment += body.mass * (bodies[k] * body.com);
    const Vector moment = (first_moment - mass * bodies[k].p) * down;
    const Vector axis = bodies[k].M.UnitZ();
    loads.torque[static_cast<Eigen::Index>(k)] = cell.arm.joints[k].slides ? KDL::dot(axis, mass * down) : KDL::dot(axis, moment);
    loads.moment_body[k] = bodies[k].M.Inverse() * moment;
  }
  loads.moment_base = first_moment * down;
  return loads;
}

void Flaw::scale(double factor) {
  for (Parameter& parameter : parameters) {
    if (parameter.usual > 0.0) parameter.value *= factor;
  }
}

bool Flaw::credible() const {
  for (const Parameter& parameter : parameters) {
    if (parameter.usual > 0.0 && !(std::abs(parameter.value) <= parameter.most)) return false;
  }
  return true;
}

State stateAtRow(const Shot& shot, const State& state, double row) {
  State then = state;
  then.q += shot.dq * (state.line_time * (row - (state.lens.height - 1.0) / 2.0));
  return then;
}

State stateAt(const Cell& cell, const Shot& shot, const std::vector<Flaw>& flaws) {
  State state = flawless(cell, shot);
  bool yields = false;
  for (const Flaw& flaw : flaws) yields = yields || flaw.yields;
  Loads loads;
  for (int round = 0; round < (yields ? kEquilibriumRounds : 1); ++round) {
    if (yields) loads = gravityLoads(cell, state, shot.payload);
    state = flawless(cell, shot);
    for (const Flaw& flaw : flaws) flaw.act(flaw, shot, loads, state);
  }
  return state;
}

Eigen::VectorXd corners(const Cell& cell, const Shot& shot, const std::vector<Flaw>& flaws) {
  const State state = stateAt(cell, shot, flaws);
  Eigen::VectorXd pixels = state.line_time != 0.0 ? seenRowByRow(cell, shot, state) : seen(cell, state);
  if (state.outward != 0.0) moveEdgesOut(pixels, state.outward);
  if (state.warp) {
    for (Eigen::Index i = 0; i < pixels.size(); i += 2) pixels.segment<2>(i) = state.warp(pixels.segment<2>(i));
  }
  return pixels;
}

Eigen::VectorXd corners(const Cell& cell, const std::vector<Shot>& shots, const std::vector<Flaw>& flaws) {
  const auto per_shot = 8 * static_cast<Eigen::Index>(cell.tags.size());
  Eigen::VectorXd pixels(per_shot * static_cast<Eigen::Index>(shots.size()));
  for (std::size_t i = 0; i < shots.size(); ++i) {
    pixels.segment(per_shot * static_cast<Eigen::Index>(i), per_shot) = corners(cell, shots[i], flaws);
  }
  return pixels;
}

}  // namespace withheld
