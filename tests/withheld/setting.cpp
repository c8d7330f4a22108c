#include "withheld/setting.hpp"

#include <cmath>

#include "withheld/shots.hpp"

namespace withheld {
namespace {

constexpr double kSeveralTags = 0.2, kRepeats = 0.15, kMoving = 0.25, kPayloads = 0.12, kMassesTold = 0.7;

constexpr double kMostShots = 250.0, kMostPictures = 80.0;
const Tag kTagOfPictures = {7, 0.12, Vector::Zero()};  // larger, as pixels are

Lens drawLens(Chance& chance) {
  Lens lens;
  lens.fx = chance.between(2200.0, 2650.0);
  lens.fy = lens.fx * chance.between(0.999, 1.001);
  lens.cx += chance.normal(12.0);
  lens.cy += chance.normal(12.0);
  lens.k1 = chance.normal(0.08);
  lens.k2 = chance.normal(0.05);
  lens.p1 = chance.normal(4e-4);
  lens.p2 = chance.normal(4e-4);
  return lens;
}

/// Two by two pixels become one.
Lens halved(Lens lens) {
  lens.width /= 2;
  lens.height /= 2;
  lens.fx /= 2.0;
  lens.fy /= 2.0;
  lens.cx = (lens.cx - 0.5) / 2.0;
  lens.cy = (lens.cy - 0.5) / 2.0;
  return lens;
}

std::vector<Tag> drawTags(bool several) {
  if (!several) return {{7, 0.08, Vector::Zero()}};
  return {{10, 0.06, Vector(-0.04, -0.04, 0.0)},
          {11, 0.06, Vector(0.04, -0.04, 0.0)},
          {12, 0.06, Vector(-0.04, 0.04, 0.0)},
          {13, 0.06, Vector(0.04, 0.04, 0.0)}};
}

/// On a bracket: turned about the flange's axis, leant over, its front away from the flange.
Frame drawGrip(Chance& chance) {
  const Rotation turned =
      Rotation::RotZ(chance.between(-KDL::PI, KDL::PI)) * Rotation::RotX(chance.between(0.0, 0.6)) * Rotation::RotX(KDL::PI);
  return {turned * Rotation::RotZ(chance.between(-KDL::PI, KDL::PI)),
          Vector(chance.normal(0.03), chance.normal(0.03), chance.between(0.03, 0.12))};
}

/// On the flange's side, looking ahead and a little aside.
Frame drawBracket(Chance& chance) {
  const Rotation turned = Rotation::RotZ(chance.between(-KDL::PI, KDL::PI)) * Rotation::RotX(chance.between(-0.5, 0.5));
  return {turned * Rotation::RotZ(chance.between(-KDL::PI, KDL::PI)),
          Vector(chance.normal(0.05), chance.normal(0.05), chance.between(0.02, 0.1))};
}

}  // namespace

void drawSetting(Case& made, const Wishes& wishes, Chance& chance) {
  made.told.arm = drawArm(chance, wishes.family.empty() ? drawFamily(chance) : wishes.family);
  made.told.lens = drawLens(chance);
  made.told.tags = drawTags(wishes.several_tags || chance.happens(kSeveralTags));
  if (wishes.pictures) {
    made.told.lens = halved(made.told.lens);
    made.told.tags = {kTagOfPictures};
  }
  made.told.in_hand = wishes.in_hand;
  if (wishes.in_hand) {
    made.told.T_camera_mount = drawBracket(chance).Inverse();
    placeTarget(made.told, chance);
  } else {
    made.told.T_mount_target = drawGrip(chance);
    placeCamera(made.told, chance);
  }
  made.actual = made.told;
  made.actual.arm = withErrors(made.told.arm, {}, chance);
  if (wishes.masses || chance.happens(kMassesTold)) made.told_masses = made.told.arm.bodies;

  Columns& columns = made.columns;
  columns.dq = wishes.dq || chance.happens(kMoving);
  columns.stamp = wishes.stamp || chance.happens(0.9);
  columns.dir = wishes.dir || chance.happens(0.75);
  columns.temperature = chance.happens(0.5);
  columns.payload = chance.happens(kPayloads);
  columns.still_dq = !columns.dq && chance.happens(0.2);
  columns.pose = !columns.dq && chance.happens(kRepeats);
  if (wishes.bare) columns = {};
  const double drawn = chance.scale(40.0, wishes.pictures ? kMostPictures : kMostShots);
  const std::size_t images = wishes.shots > 0 ? wishes.shots : static_cast<std::size_t>(std::lround(drawn));
  const std::size_t times = columns.pose ? 2 + chance.index(2) : 1;
  made.shots = drawShots(made.actual, std::max<std::size_t>(30, images / times), times, columns.dq, columns.payload, chance);
  if (wishes.bare) comeStraight(made.shots);
  made.noise = {chance.scale(0.05, 0.2), 0.0, 0.0};
}

}  // namespace withheld
