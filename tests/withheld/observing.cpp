#include "withheld/observing.hpp"

#include <algorithm>
#include <map>

#include "withheld/shots.hpp"

namespace withheld {
namespace {

constexpr std::size_t kUnseen = 60;

/// Shots as the arm really took them: at each pose the joints come to rest a little elsewhere; repeats do not move.
std::vector<Shot> atRest(const Case& made, Chance& chance) {
  std::vector<Shot> shots = made.shots;
  std::map<int, Eigen::VectorXd> rest;
  for (Shot& shot : shots) {
    Eigen::VectorXd& off = rest[shot.pose];
    if (off.size() == 0) {
      off.resize(shot.q.size());
      for (Eigen::Index k = 0; k < off.size(); ++k) {
        off[k] = chance.normal(repeatabilityOf(made.actual.arm.joints[static_cast<std::size_t>(k)], made.noise));
      }
    }
    shot.q += off;
  }
  return shots;
}

/// The corners of some rows become those of another row, or all of them move by 5 to 50 px.
void makeWild(Case& made, std::vector<Eigen::VectorXd>& pixels, double share, Chance& chance) {
  const std::vector<Eigen::VectorXd> right = pixels;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!chance.happens(share)) continue;
    if (chance.happens(0.5)) {
      // Of another pose: a repeat's corners would belong here too.
      std::size_t other = chance.index(right.size());
      while (made.shots[other].pose == made.shots[i].pose) other = chance.index(right.size());
      pixels[i] = right[other];
    } else {
      const double length = chance.scale(5.0, 50.0), heading = chance.between(0.0, 2.0 * KDL::PI);
      for (Eigen::Index c = 0; c < pixels[i].size(); c += 2) {
        pixels[i].segment<2>(c) += length * Eigen::Vector2d(std::cos(heading), std::sin(heading));
      }
    }
    made.wild.push_back(made.shots[i].image);
  }
}

void observeUnseen(Case& made, Chance& chance) {
  made.unseen = drawUnseen(made.actual, made.shots, kUnseen, chance);
  std::vector<Flaw> predictable = made.flaws();
  std::erase_if(predictable, [](const Flaw& flaw) { return flaw.at_random; });
  made.unseen_corners = corners(made.actual, made.unseen, predictable);
}

}  // namespace

void observe(Case& made, const Disorder& disorder, Chance& chance) {
  const std::vector<Flaw> flaws = made.flaws();
  const std::vector<Shot> shots = atRest(made, chance);
  std::vector<Eigen::VectorXd> pixels;
  for (const Shot& shot : shots) {
    pixels.push_back(corners(made.actual, shot, flaws));
    for (Eigen::Index tag = 0; tag < pixels.back().size(); tag += 8) {
      const Eigen::Vector2d common(chance.normal(made.noise.common), chance.normal(made.noise.common));
      for (Eigen::Index c = tag; c < tag + 8; ++c) pixels.back()[c] += common[c % 2] + chance.normal(made.noise.corner);
    }
  }
  if (disorder.wild_share > 0.0) makeWild(made, pixels, disorder.wild_share, chance);

  for (std::size_t i = 0; i < shots.size(); ++i) {
    for (std::size_t tag = 0; tag < made.actual.tags.size(); ++tag) {
      if (chance.happens(disorder.missing_share)) {
        ++made.missing;
        continue;
      }
      Sighting sighting{i, made.actual.tags[tag].id, {}};
      bool inside = true;
      for (int c = 0; c < 4; ++c) {
        sighting.pixels.col(c) = pixels[i].segment<2>(8 * static_cast<Eigen::Index>(tag) + 2 * c);
        inside = inside && made.actual.lens.shows(sighting.pixels.col(c), 0.0);
      }
      // A large effect carries a tag out of the picture.
      if (!inside) {
        ++made.missing;
        continue;
      }
      made.sightings.push_back(sighting);
    }
  }
  observeUnseen(made, chance);
}

void observeByPictures(Case& made, Chance& chance) {
  Look look;
  look.dark = chance.between(20.0, 45.0);
  look.bright = chance.between(190.0, 235.0);
  look.blur = chance.between(0.5, 1.0);
  look.noise = chance.between(1.0, 3.0);
  look.seed = chance.index(1U << 30U);
  made.look = look;
  observeUnseen(made, chance);
}

}  // namespace withheld
