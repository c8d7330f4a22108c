#include "calibration/row_contradictions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "capture/motion_checks.hpp"
#include "capture/reading_steps.hpp"
#include "capture/row_checks.hpp"
#include "detection/picture.hpp"
#include "poecal/core/content_key.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/geometry/se3.hpp"
#include "poecal/registration/hand_eye.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

/// A drawn arm is off by millimetres and milliradians; other units, rows or arms are by many times more.
constexpr double kFarTurn = 0.05;   // [rad]
constexpr double kFarPlace = 0.05;  // [m]
constexpr double kMany = 0.1;       // of the rows: fewer are mistakes of theirs, not of the columns

/// A row that disagrees, and how.
struct Disagreement {
  int line = 0;
  std::string text;
};

double spreadOf(const std::vector<Eigen::Isometry3d>& poses) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Isometry3d& T : poses) mean += T.translation() / static_cast<double>(poses.size());
  double sum = 0.0;
  for (const Eigen::Isometry3d& T : poses) sum += (T.translation() - mean).squaredNorm();
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

/// Frames and tools change no angle by which two poses are turned from each other.
std::vector<Disagreement> compareTurns(const SampleTable& table, const std::vector<Eigen::Isometry3d>& expected) {
  std::vector<Disagreement> found;
  for (std::size_t k = 1; k < expected.size(); ++k) {
    const Sample &before = table.samples[k - 1], &here = table.samples[k];
    const double by_joints = rotationAngle(expected[k - 1].linear().transpose() * expected[k].linear());
    const double by_pose = rotationAngle(before.T_base_flange->linear().transpose() * here.T_base_flange->linear());
    if (std::abs(by_joints - by_pose) <= kFarTurn) continue;
    found.push_back(
        {here.line, fmt::format("from line {} to here qx.. turn by {:.3g} rad and the joint readings by {:.3g}, expected rows of "
                                "one arm and moment",
                                before.line, by_pose, by_joints)});
  }
  return found;
}

/// Where the angles agree a tool and a frame are fitted; places must follow.
std::vector<Disagreement> comparePlaces(const SampleTable& table, const std::vector<Eigen::Isometry3d>& expected) {
  std::vector<Eigen::Isometry3d> stated;
  for (const Sample& sample : table.samples) stated.push_back(*sample.T_base_flange);
  const double ratio = spreadOf(stated) / std::max(spreadOf(expected), kFarPlace);
  constexpr double kThousandfold = 100.0;  // a tool of some length makes less of it
  const char* hint = ratio > kThousandfold ? "metres; are they in millimetres?" : "rows of one arm and moment";
  std::vector<Disagreement> found;
  const std::optional<HandEye> fitted = solveHandEye(expected, stated, Setup::kEyeToHand);
  for (std::size_t k = fitted ? 0 : 1; k < stated.size(); ++k) {
    double off = 0.0;
    if (fitted) {
      off = (fitted->T_camera_near * expected[k] * fitted->T_far_target.translation() - stated[k].translation()).norm();
    } else {
      off = std::abs((expected[k].translation() - expected[k - 1].translation()).norm() -
                     (stated[k].translation() - stated[k - 1].translation()).norm());
    }
    if (off <= kFarPlace) continue;
    found.push_back({table.samples[k].line, fmt::format("x, y, z are {:.3g} m from where the joint readings put them, up to a frame and a "
                                                        "tool, expected {}",
                                                        off, hint)});
  }
  return found;
}

/// A camera that dropped frames, or a file that is no picture: both are told where targets are searched.
bool showsNothing(const fs::path& file) {
  const Picture picture = readPicture(file);
  if (picture.grey.empty()) return true;
  double darkest = 0.0, brightest = 0.0;
  cv::minMaxLoc(picture.grey, &darkest, &brightest);
  return darkest == brightest;
}

/// Rows of equal pictures, by what they hold: pictures of other sizes are never read.
std::vector<std::pair<std::size_t, std::size_t>> equalPictures(const Capture& capture, const ProgressFunction& progress) {
  std::map<std::uintmax_t, std::vector<std::size_t>> by_size;
  for (std::size_t k = 0; k < capture.table.samples.size(); ++k) {
    std::error_code status;
    const std::uintmax_t size = fs::file_size(capture.folder / capture.table.samples[k].image, status);
    if (!status && size > 0) by_size[size].push_back(k);
  }
  std::size_t compared = 0;
  for (const auto& [size, rows] : by_size) compared += rows.size() < 2 ? 0 : rows.size();
  Progress told(progress, "comparing pictures", compared);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [size, rows] : by_size) {
    if (rows.size() < 2) continue;
    std::map<std::string, std::size_t> first_of;
    for (const std::size_t row : rows) {
      const std::string sum = checksum(readTextFile(capture.folder / capture.table.samples[row].image));
      const auto [first, fresh] = first_of.emplace(sum, row);
      if (!fresh && !showsNothing(capture.folder / capture.table.samples[row].image)) pairs.emplace_back(first->second, row);
      told.advance();
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return pairs;
}

/// "p7.png is the same picture as p3.png of line 5".
std::string sameText(const SampleTable& table, const std::pair<std::size_t, std::size_t>& rows, const char* shows) {
  const Sample &first = table.samples[rows.first], &second = table.samples[rows.second];
  return fmt::format("{} {} {} of line {}", second.image, shows, first.image, first.line);
}

constexpr const char* kOneEach = ", but the readings differ: expected one picture for each row";

/// An arm at rest; no camera takes the same twice, but a drawn picture may be the same.
bool readsTheSame(const SampleTable& table, const std::pair<std::size_t, std::size_t>& rows) {
  constexpr double kMoved = 1e-3;  // [rad], [m]
  return distanceOfRows(table.samples[rows.first], table.samples[rows.second]) <= kMoved;
}

std::string remarkOn(const SampleTable& table, std::size_t row, const std::string& text) {
  return fmt::format("{}:{}: {}", table.file.string(), table.samples[row].line, text);
}

}  // namespace

std::vector<std::string> compareFlangePoses(const Arm& arm, const SampleTable& table) {
  if (!table.has_joints || !table.has_flange_poses || table.samples.size() < 2) return {};
  std::vector<Eigen::Isometry3d> expected;
  for (const Sample& sample : table.samples) expected.push_back(forwardKinematics(arm, sample.q));
  std::vector<std::string> remarks;
  const auto judge = [&](const std::vector<Disagreement>& found) {
    if (static_cast<double>(found.size()) > kMany * static_cast<double>(table.samples.size())) {
      throw FileError(table.file, found.front().line, found.front().text);
    }
    for (const Disagreement& one : found) remarks.push_back(fmt::format("{}:{}: {}", table.file.string(), one.line, one.text));
  };
  judge(compareTurns(table, expected));
  if (remarks.empty()) judge(comparePlaces(table, expected));
  return remarks;
}

std::vector<std::string> compareBytesOfPictures(const Capture& capture, const ProgressFunction& progress) {
  std::vector<std::string> remarks;
  for (const auto& rows : equalPictures(capture, progress)) {
    const std::string same = sameText(capture.table, rows, "is the same picture as");
    if (!readsTheSame(capture.table, rows)) throw FileError(capture.table.file, capture.table.samples[rows.second].line, same + kOneEach);
    remarks.push_back(remarkOn(capture.table, rows.second, same + ": one shot counts twice"));
  }
  return remarks;
}

std::vector<std::string> compareCornersOfPictures(const SampleTable& table, const Detections& detections) {
  std::map<std::string, std::size_t> row_of;
  for (std::size_t k = 0; k < table.samples.size(); ++k) row_of.emplace(table.samples[k].image, k);
  using Place = std::tuple<int, int, double, double>;
  std::map<std::vector<Place>, std::size_t> first_of;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const ImageCorners& image : detections.images) {
    const auto row = row_of.find(image.image);
    if (row == row_of.end() || image.corners.empty()) continue;
    std::vector<Place> places;
    for (const Corner& corner : image.corners) places.emplace_back(corner.id.tag, corner.id.corner, corner.px.x(), corner.px.y());
    const auto [first, fresh] = first_of.emplace(std::move(places), row->second);
    if (!fresh) pairs.emplace_back(std::minmax(first->second, row->second));
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<std::string> remarks;
  double moved = 0.0;
  for (const auto& rows : pairs) {
    const std::string same = sameText(table, rows, "has exactly the corners of");
    const bool at_rest = readsTheSame(table, rows);
    moved += at_rest ? 0.0 : 1.0;
    if (moved > kMany * static_cast<double>(row_of.size())) throw FileError(table.file, table.samples[rows.second].line, same + kOneEach);
    remarks.push_back(remarkOn(table, rows.second, same + (at_rest ? ": one shot counts twice" : kOneEach)));
  }
  return remarks;
}

std::vector<std::string> remarksOnCorners(const std::filesystem::path& file, const Detections& detections) {
  constexpr double kFew = 0.1;  // by chance next to none does
  constexpr std::size_t kFewest = 20;
  std::size_t corners = 0, whole = 0;
  for (const ImageCorners& image : detections.images) {
    for (const Corner& corner : image.corners) {
      ++corners;
      whole += corner.px == Eigen::Vector2d(corner.px.array().round());
    }
  }
  if (whole < kFewest || static_cast<double>(whole) <= kFew * static_cast<double>(corners)) return {};
  return {
      fmt::format("{}: {} of {} corners lie at whole pixels: rounding takes 0.3 px from each, expected corners as exact as the picture "
                  "gives them",
                  file.string(), whole, corners)};
}

std::vector<std::string> remarksOnRows(const std::filesystem::path& file, const std::vector<Sample>& samples, const Arm* arm) {
  std::vector<std::string> remarks = stampRemarks(file, samples);
  for (std::string& remark : temperatureRemarks(file, samples)) remarks.push_back(std::move(remark));
  if (arm == nullptr) return remarks;
  for (auto* of : {payloadRemarks, turnRemarks, speedRemarks, directionRemarks}) {
    for (std::string& remark : of(file, samples, *arm)) remarks.push_back(std::move(remark));
  }
  const Rounding rounding = roundingOf(*arm, samples);
  if (rounding.isCoarse()) remarks.push_back(fmt::format("{}: {}", file.string(), rounding.text()));
  return remarks;
}

}  // namespace poecal
