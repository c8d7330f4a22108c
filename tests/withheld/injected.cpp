#include "withheld/injected.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <yaml-cpp/yaml.h>

#include "withheld/case.hpp"
#include "withheld/choice.hpp"
#include "withheld/listed_flaws.hpp"
#include "withheld/recording.hpp"

namespace withheld {
namespace {

namespace fs = std::filesystem;

struct Source {
  const char* name;
  bool pictures;  ///< a capture folder, otherwise robot.yaml and poses.csv
  bool in_order;  ///< its rows are in order of time
};
constexpr Source kSources[] = {{"franka-board", false, false}, {"positioner", false, true}, {"irb2400-charuco", true, true}};

constexpr double kLeastS = 20.0, kMostS = 60.0;
constexpr int kDraws = 100;
constexpr double kBetweenRows = 30.0;  // [s]

/// Logged joints with which the flaw moves the arm to where it really was.
Eigen::VectorXd loggedWith(const Cell& cell, const Shot& real, const Flaw& flaw) {
  constexpr int kRounds = 20;  // effects turn a joint by a hundredth of what it turns: each round gains two digits
  Shot logged = real;
  for (int round = 0; round < kRounds; ++round) logged.q -= stateAt(cell, logged, {flaw}).q - real.q;
  return logged.q;
}

void stampRows(std::vector<Shot>& shots) {
  for (std::size_t i = 0; i < shots.size(); ++i) {
    shots[i].stamp = kBetweenRows * static_cast<double>(i);
    shots[i].hours = shots[i].stamp / 3600.0;
  }
}

/// One effect of a joint, S 20 to 60 above the scatter of the recording.
Hidden chooseShift(const Case& made, const Leftover& leftover, Chance& chance) {
  std::vector<std::string> names = {"joint_gain", "joint_eccentricity", "joint_harmonic", "joint_coupling"};
  if (made.columns.stamp) names.insert(names.end(), {"joint_slip", "joint_drift"});
  for (int draw = 0; draw < kDraws; ++draw) {
    std::optional<Hidden> hidden = chooseListed(made, leftover, chance.oneOf(names), chance.scale(kLeastS, kMostS), chance);
    if (!hidden) continue;
    compareWithListed(made, leftover, *hidden);
    return *hidden;
  }
  throw std::runtime_error("no credible effect of a joint shows in " + made.recording);
}

void writePoses(const Recording& recording, const std::vector<Shot>& logged, bool stamps, const fs::path& file) {
  std::ofstream out(file);
  for (Eigen::Index k = 0; k < logged.front().q.size(); ++k) out << 'q' << k + 1 << ',';
  out << recording.head << (stamps ? ",stamp\n" : "\n");
  for (std::size_t i = 0; i < logged.size(); ++i) {
    for (const double q : logged[i].q) out << fmt::format("{:.12g},", q);
    out << recording.rests[i] << (stamps ? fmt::format(",{:g}\n", logged[i].stamp) : "\n");
  }
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

void injectIntoPoses(const fs::path& from, bool nothing, const fs::path& to, Case& made, Chance& chance) {
  Recording recording = readRecording(from);
  if (made.columns.stamp) stampRows(recording.shots);
  std::vector<Shot> logged = recording.shots;
  made.shots = recording.shots;
  if (!nothing) {
    const PoseNoise noise = fit(recording);
    made.actual = recording.cell;
    const Leftover leftover(made.actual, made.shots, poseFactors(made.shots.size(), noise), false, observePoses(recording.poses));
    made.hidden = {chooseShift(made, leftover, chance)};
    for (Shot& shot : logged) shot.q = loggedWith(made.actual, shot, made.hidden.front().flaw);
  }
  fs::create_directories(to / "poses");
  fs::copy_file(from / "robot.yaml", to / "poses" / "robot.yaml", fs::copy_options::overwrite_existing);
  writePoses(recording, logged, made.columns.stamp, to / "poses" / "poses.csv");
}

/// A point p of a picture goes to middle + zoom (p - middle) + shift.
struct Warp {
  double zoom = 1.0;
  cv::Point2d middle, shift;
};

cv::Mat warped(const cv::Mat& picture, const Warp& warp) {
  const cv::Mat map = (cv::Mat_<double>(2, 3) << warp.zoom, 0.0, warp.middle.x * (1.0 - warp.zoom) + warp.shift.x, 0.0, warp.zoom,
                       warp.middle.y * (1.0 - warp.zoom) + warp.shift.y);
  cv::Mat moved;
  cv::warpAffine(picture, moved, map, picture.size(), cv::INTER_LANCZOS4, cv::BORDER_REPLICATE);
  return moved;
}

/// A target that is `scale` larger than target.yaml will say.
void sayTarget(const fs::path& file, double scale) {
  YAML::Node target = YAML::LoadFile(file.string());
  for (const char* length : {"square", "marker"}) target[length] = fmt::format("{:.10g}", target[length].as<double>() / (1.0 + scale));
  std::ofstream(file) << target << '\n';
}

Flaw choosePictureFlaw(Chance& chance) {
  const double sign = chance.sign(), heading = chance.between(0.0, 2.0 * KDL::PI), length = chance.scale(30.0, 60.0);
  const std::vector<Flaw> flaws = {{"target_scale", "target.shape", "none", {{"scale", sign * chance.scale(0.03, 0.06), 5e-3, 0.1}}, {}},
                                   {"focal_length", "camera.lens", "pixel", {{"scale", sign * chance.scale(0.02, 0.04), 2e-3, 0.04}}, {}},
                                   {"principal_point",
                                    "camera.lens",
                                    "pixel",
                                    {{"dx", length * std::cos(heading), 5.0, 60.0}, {"dy", length * std::sin(heading), 5.0, 60.0}},
                                    {}}};
  return chance.oneOf(flaws);
}

void injectIntoPictures(const fs::path& from, bool nothing, const fs::path& to, Case& made, Chance& chance) {
  const fs::path capture = to / "capture";
  fs::create_directories(capture / "images");
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
    if (entry.is_regular_file()) fs::copy_file(entry, capture / entry.path().filename(), fs::copy_options::overwrite_existing);
  }
  Warp warp;
  if (!nothing) {
    const Flaw flaw = choosePictureFlaw(chance);
    made.hidden = {{flaw, 0.0, true, {}, {}, "", 0.0}};
    if (flaw.effect == "target_scale") sayTarget(capture / "target.yaml", flaw[0]);
    if (flaw.effect == "principal_point") warp.shift = {flaw[0], flaw[1]};
    if (flaw.effect == "focal_length") {
      const YAML::Node K = YAML::LoadFile((from / "camera.yaml").string())["camera_matrix"]["data"];
      warp = {1.0 + flaw[0], {K[2].as<double>(), K[5].as<double>()}, {}};
    }
  }
  const bool as_they_are = warp.zoom == 1.0 && warp.shift == cv::Point2d();
  for (const fs::directory_entry& entry : fs::directory_iterator(from / "images")) {
    const fs::path file = capture / "images" / entry.path().filename();
    fs::remove(file);
    if (as_they_are) {
      fs::create_symlink(fs::canonical(entry), file);
    } else if (!cv::imwrite(file.string(), warped(cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE), warp))) {
      throw std::runtime_error("cannot write " + file.string());
    }
    made.shots.emplace_back();
  }
}

}  // namespace

void writeInjectedCase(const fs::path& real, std::uint64_t seed, std::uint64_t number, const std::string& folder) {
  const Source& source = kSources[number % std::size(kSources)];
  const fs::path from = real / source.name;
  if (real.empty() || !fs::exists(from)) {
    throw std::runtime_error(
        fmt::format("the set {} needs --real DIR with the recordings franka-board, positioner and irb2400-charuco; '{}' "
                    "is not there",
                    kInjectedSet, from.string()));
  }
  Case made;
  made.set = kInjectedSet;
  made.seed = seed;
  made.number = number;
  made.recording = source.name;
  made.told.arm.name = source.name;
  made.columns.dir = false;
  made.columns.stamp = source.in_order;
  Chance chance(seed * 1000003 + number * 7919);
  const bool nothing = number < std::size(kSources);
  const fs::path to = fs::path(folder) / fmt::format("{:04}", number);
  (source.pictures ? injectIntoPictures : injectIntoPoses)(from, nothing, to, made, chance);
  writeTruth(made, folder);
}

}  // namespace withheld
