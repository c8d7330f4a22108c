#include "withheld/shots.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace withheld {
namespace {

constexpr double kMargin = 25.0;                   // of the picture that stays empty [px]
constexpr double kShortestEdge = 45.0;             // of a tag in the picture [px]
constexpr double kFacing = 0.5;                    // cosine between the tag's normal and the line of sight
constexpr double kNearest = 0.5, kFarthest = 2.3;  // [m]
constexpr int kMostTries = 40000;
constexpr double kSmallestShare = 0.02;  // of random poses that show the target, for a camera to be well placed

Eigen::VectorXd randomJoints(const Arm& arm, Chance& chance) {
  Eigen::VectorXd q(static_cast<Eigen::Index>(arm.size()));
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const Joint& joint = arm.joints[static_cast<std::size_t>(k)];
    q[k] = chance.between(joint.low, joint.high);
  }
  return q;
}

Frame lookAt(const Vector& eye, const Vector& point, double roll) {
  Vector forward = point - eye;
  forward.Normalize();
  Vector right = forward * (std::abs(forward.z()) > 0.95 ? Vector(1.0, 0.0, 0.0) : Vector(0.0, 0.0, 1.0));
  right.Normalize();
  const Vector down = forward * right;
  return Frame(Rotation(right, down, forward), eye) * Frame(Rotation::RotZ(roll));
}

Frame targetInBase(const Cell& cell, const Eigen::VectorXd& q) {
  Cell at_base = cell;
  at_base.T_camera_mount = Frame::Identity();
  Shot shot;
  shot.q = q;
  return targetInCamera(at_base, flawless(at_base, shot));
}

double temperatureAt(double hours, double span, double swing, double turns) {
  return 21.0 + swing * (1.0 - std::exp(-3.0 * hours / span)) - 0.5 * swing * std::sin(3.0 * turns * hours / span);
}

Eigen::VectorXd randomJointsInView(const Cell& cell, Chance& chance) {
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    const Eigen::VectorXd q = randomJoints(cell.arm, chance);
    if (shows(cell, q)) return q;
  }
  throw std::runtime_error("no pose shows the target");
}

void drawSpeeds(Shot& shot, bool moving, Chance& chance) {
  shot.dir.resize(shot.q.size());
  shot.dq.setZero(shot.q.size());
  for (Eigen::Index k = 0; k < shot.q.size(); ++k) {
    shot.dir[k] = chance.sign();
    if (moving) shot.dq[k] = shot.dir[k] * chance.between(0.003, 0.05);
  }
}

}  // namespace

bool shows(const Cell& cell, const Eigen::VectorXd& q) {
  Shot shot;
  shot.q = q;
  const State state = flawless(cell, shot);
  const Frame T_camera_target = targetInCamera(cell, state);
  const Vector& center = T_camera_target.p;
  if (center.z() < kNearest || center.z() > kFarthest) return false;
  if (KDL::dot(T_camera_target.M.UnitZ(), center) < kFacing * center.Norm()) return false;
  std::vector<Eigen::Vector2d> pixels;
  for (const Vector& point : state.points) {
    if (!cell.lens.reaches(T_camera_target * point)) return false;
    pixels.push_back(cell.lens.image(T_camera_target * point));
    if (!cell.lens.shows(pixels.back(), kMargin)) return false;
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if ((pixels[i] - pixels[i % 4 == 3 ? i - 3 : i + 1]).norm() < kShortestEdge) return false;
  }
  return true;
}

void placeCamera(Cell& cell, Chance& chance) {
  for (int place = 0; place < 400; ++place) {
    Vector middle = Vector::Zero();
    for (int i = 0; i < 30; ++i) middle += targetInBase(cell, randomJoints(cell.arm, chance)).p / 30.0;
    const Frame T_base_target = targetInBase(cell, randomJoints(cell.arm, chance));
    Vector outward = -T_base_target.M.UnitZ() + chance.between(0.0, 0.6) * randomDirection(chance);
    outward.Normalize();
    const Vector point = chance.between(0.4, 1.0) * (T_base_target.p - middle) + middle;
    const Vector eye = point + chance.between(1.0, 1.7) * outward;
    cell.T_camera_mount = lookAt(eye, point, chance.between(-KDL::PI, KDL::PI)).Inverse();
    int shown = 0;
    const int tries = 400;
    for (int i = 0; i < tries; ++i) shown += shows(cell, randomJoints(cell.arm, chance)) ? 1 : 0;
    if (shown >= kSmallestShare * tries) return;
  }
  throw std::runtime_error("no place for the camera from which enough poses show the target");
}

void placeTarget(Cell& cell, Chance& chance) {
  constexpr double kEnough = 0.004;  // of random poses: a camera that looks anywhere sees little of one place
  for (int place = 0; place < 4000; ++place) {
    Shot shot;
    shot.q = randomJoints(cell.arm, chance);
    cell.T_mount_target = Frame::Identity();
    const Frame T_base_camera = targetInCamera(cell, flawless(cell, shot)).Inverse();
    const Frame before(Rotation::RotX(chance.between(-0.6, 0.6)) * Rotation::RotY(chance.between(-0.6, 0.6)) *
                           Rotation::RotZ(chance.between(-KDL::PI, KDL::PI)),
                       Vector(0.0, 0.0, chance.between(0.6, 1.2)));
    cell.T_mount_target = T_base_camera * before;
    int shown = 0;
    const int tries = 1500;
    for (int i = 0; i < tries; ++i) shown += shows(cell, randomJoints(cell.arm, chance)) ? 1 : 0;
    if (shown >= kEnough * tries) return;
  }
  throw std::runtime_error("no place for the target that enough poses show");
}

void comeStraight(std::vector<Shot>& shots) {
  for (std::size_t i = 1; i < shots.size(); ++i) {
    for (Eigen::Index k = 0; k < shots[i].q.size(); ++k) {
      const double way = shots[i].q[k] - shots[i - 1].q[k];
      shots[i].dir[k] = way > 0.0 ? 1.0 : way < 0.0 ? -1.0 : shots[i - 1].dir[k];
    }
  }
}

std::vector<Shot> drawShots(const Cell& cell, std::size_t count, std::size_t times, bool moving, bool payloads, Chance& chance) {
  std::vector<Shot> shots;
  double stamp = 1000.0;
  const std::size_t turn = std::max<std::size_t>(1, count / 4);  // the load is changed three times
  for (std::size_t i = 0; i < count; ++i) {
    Shot shot;
    shot.q = randomJointsInView(cell, chance);
    shot.pose = static_cast<int>(i);
    drawSpeeds(shot, moving, chance);
    shot.payload = payloads && (i / turn) % 2 == 1 ? 2.0 : 0.0;
    stamp += chance.between(20.0, 40.0);
    for (std::size_t again = 0; again < times; ++again) {
      char image[32];
      std::snprintf(image, sizeof image, "images/%04zu.png", shots.size());
      shot.image = image;
      shot.stamp = stamp;
      shots.push_back(shot);
      stamp += 1.0;
    }
  }
  const double span = (shots.back().stamp - shots.front().stamp) / 3600.0;
  const double swing = chance.between(6.0, 16.0), turns = chance.between(0.8, 2.0);
  for (Shot& shot : shots) {
    shot.hours = (shot.stamp - shots.front().stamp) / 3600.0;
    shot.temperature = temperatureAt(shot.hours, span, swing, turns) + chance.normal(0.05);
    shot.kelvin = shot.temperature - shots.front().temperature;
  }
  return shots;
}

std::vector<Shot> drawUnseen(const Cell& cell, const std::vector<Shot>& seen, std::size_t count, Chance& chance) {
  std::vector<std::size_t> when(count);
  for (std::size_t i = 0; i < count; ++i) when[i] = i == 0 ? 0 : chance.index(seen.size());
  std::sort(when.begin(), when.end());
  std::vector<Shot> shots;
  for (const std::size_t i : when) {
    Shot shot = seen[i];  // its hour, temperature and load
    shot.q = randomJointsInView(cell, chance);
    drawSpeeds(shot, seen[i].dq.any(), chance);
    shot.pose = static_cast<int>(shots.size());
    char image[32];
    std::snprintf(image, sizeof image, "unseen/%04zu.png", shots.size());
    shot.image = image;
    shots.push_back(shot);
  }
  return shots;
}

}  // namespace withheld
