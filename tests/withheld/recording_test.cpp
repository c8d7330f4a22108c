// Does the fit of a recording leave what was put into it?
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "withheld/choice.hpp"
#include "withheld/listed_flaws.hpp"
#include "withheld/recording.hpp"
#include "withheld/setting.hpp"

namespace withheld {
namespace {

using testing::DoubleNear;

constexpr PoseNoise kNoise{1e-3, 5e-4};

/// Poses of an arm with errors, as an instrument would have logged them; the cell is the arm as drawn.
Recording recordingOf(const std::string& family, std::uint64_t seed) {
  Case made;
  Chance chance(seed);
  Wishes wishes;
  wishes.family = family;
  drawSetting(made, wishes, chance);
  Recording recording;
  recording.cell = made.told;
  recording.cell.T_camera_mount = recording.cell.T_mount_target = Frame::Identity();  // nobody told where instrument and tool are
  recording.shots = made.shots;
  for (const Shot& shot : made.shots) {
    const Frame noise = motion(normalVector(chance, kNoise.rotation), normalVector(chance, kNoise.position));
    recording.poses.push_back(targetInCamera(made.actual, flawless(made.actual, shot)) * noise);
  }
  return recording;
}

TEST(RecordingFit, LeavesTheNoise) {
  for (const char* family : {"cobot", "seven"}) {
    Recording recording = recordingOf(family, 3);
    const PoseNoise noise = fit(recording);
    // A median of 3 N numbers is good to 1.2 / sqrt(3 N): 10 % are three sigma at 80 poses.
    EXPECT_THAT(noise.rotation, DoubleNear(kNoise.rotation, 0.1 * kNoise.rotation)) << family;
    EXPECT_THAT(noise.position, DoubleNear(kNoise.position, 0.1 * kNoise.position)) << family;
  }
}

TEST(RecordingFit, DoesNotMindRowsThatDoNotBelong) {
  Recording recording = recordingOf("cobot", 4);
  std::swap(recording.poses[3], recording.poses[20]);
  EXPECT_THAT(fit(recording).position, DoubleNear(kNoise.position, 0.1 * kNoise.position));
}

TEST(RecordingFiles, AreReadAsTheyAreWritten) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "withheld-recording-test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "robot.yaml") << "name: elbow\njoints:\n- {type: revolute, axis: [0, 0, 1], point: [0, 0, 0]}\n- {type: revolute, "
                                          "axis: [0, -1, 0], point: [0.5, 0, 0.2]}\nflange: {position: [0.9, 0, 0.2], quaternion_xyzw: [0, "
                                          "0, 0, 1]}\n";
  std::ofstream(folder / "poses.csv")
      << "q1,q2,x,y,z,qx,qy,qz,qw\n0,1.5707963267948966,0.5,0,0.6,0,-0.70710678118654757,0,0.70710678118654757\n";
  Recording recording = readRecording(folder);
  std::filesystem::remove_all(folder);
  // The forearm, 0.4 m, turned up: by hand.
  const Eigen::VectorXd off = observePoses(recording.poses)(recording.cell, recording.shots, {});
  EXPECT_LT(off.norm(), 1e-12);
  EXPECT_EQ(recording.head, "x,y,z,qx,qy,qz,qw");
}

TEST(UnknownMasses, CanBeTheTrueOnes) {
  Case made;
  Chance chance(5);
  Wishes wishes;
  wishes.family = "cobot";
  drawSetting(made, wishes, chance);
  const Leftover leftover(made.actual, made.shots, made.noise, false);
  int shown = 0;
  for (const Flaw& listed : listedFlaws(made.actual, made.columns, {})) {
    if (!listed.yields) continue;
    Flaw flaw = listed;
    for (Parameter& parameter : flaw.parameters) parameter.value = parameter.usual;
    const Eigen::VectorXd left = leftover.left({flaw});
    if (left.norm() < 1.0) continue;  // below the noise, and second order in the loads
    const Eigen::VectorXd rest = Leftover::besides(left, leftover.columns(withUnknownMasses(made.actual, listed)));
    EXPECT_LT(rest.norm(), 0.01 * left.norm()) << listed.place();
    ++shown;
  }
  EXPECT_GE(shown, 4);
}

}  // namespace
}  // namespace withheld
