// Small captures of arms that err as arms do, good ones and spoilt ones.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "poecal/cell/cell.hpp"
#include "poecal/cell/observation.hpp"
#include "support/random.hpp"

namespace poecal::test {

enum class Readings { kJoints, kFlangePoses, kTracker };  ///< tracker: joints, and poses of an instrument instead of pictures
enum class View { kWide, kLookAt };                       ///< look-at: the target stays near the middle of the picture

struct CaptureKind {
  std::string arm;  ///< "elbow", "seven", "scara", "shoulder"
  Setup setup = Setup::kEyeToHand;
  Readings readings = Readings::kJoints;
  View view = View::kWide;
  int pictures = 40;
  double tilt = 1e-3, shift = 3e-4;  ///< 1 sigma of the arm's axes [rad], [m]
  double sigma_px = 0.1;
};

std::string nameOf(const CaptureKind& kind);
void PrintTo(const CaptureKind& kind, std::ostream* stream);  ///< for GoogleTest

struct MadeCapture {
  Cell told;   ///< as a user states it: nominal arm or none, camera, setup
  Cell truth;  ///< registration and arm as they are
  std::vector<Observation> observations;
};

/// Always the same for a kind and a state of the generator.
MadeCapture makeCapture(const CaptureKind& kind, Rng& rng);

/// The capture with the camera moved by T_new_old from a row on.
MadeCapture movedFrom(const MadeCapture& capture, std::size_t row, const Eigen::Isometry3d& T_new_old);

/// The capture with a joint that was driven to where it stands in a row, and stays there from then on.
MadeCapture parkedFrom(const MadeCapture& capture, std::size_t row, Eigen::Index joint);

/// The capture's pictures of a grid of tags, counted along its rows from below; cell: from centre to centre.
MadeCapture withGrid(const MadeCapture& capture, int columns, int rows, double cell);

/// What is said of a capture: an error's message, or its warnings; empty where there is nothing to say.
struct Said {
  bool refused = false;
  std::string message;
};
Said said(const MadeCapture& capture);

/// One way to spoil a capture, and what must be said of it.
struct Spoilt {
  std::string name;
  std::string said;  ///< part of the message
  MadeCapture capture;
};

/// Every single mistake that a capture of its kind can have, where it is one (a sign of a joint that the registration takes up is none).
std::vector<Spoilt> spoiltCaptures(const CaptureKind& kind, const MadeCapture& good);

}  // namespace poecal::test
