// A new capture folder, filled in step by step and wrongly, as `check` judges it.
#include "poecal/calibration/check_capture.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "diagnosis/small_cell.hpp"
#include "poecal/calibration/new_capture.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/robot/robot_file.hpp"
#include "support/random.hpp"
#include "support/temp_folder.hpp"

namespace poecal {

// Without it GoogleTest prints bytes.
void PrintTo(const CheckItem& item, std::ostream* out) { *out << checkLevelName(item.level) << " " << item.topic << ": " << item.text; }

namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

const fs::path kCobot = fs::path(POECAL_SOURCE_DIR) / "calib_data/cobot6";

auto says(CheckLevel level, const std::string& topic, const std::string& text) {
  return AllOf(Field(&CheckItem::level, level), Field(&CheckItem::topic, topic), Field(&CheckItem::text, HasSubstr(text)));
}

/// What a PNG begins with: all that is read of a picture.
std::string pngHeader(unsigned width, unsigned height) {
  std::string bytes = std::string("\x89PNG\r\n\x1a\n") + std::string("\0\0\0\rIHDR", 8);
  for (const unsigned side : {width, height}) {
    for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes += static_cast<char>(side >> shift & 0xffU);
  }
  return bytes + std::string("\x08\0\0\0\0", 5) + std::string(4, '\0');
}

class CheckCapture : public ::testing::Test {
 protected:
  void create(const fs::path& camera = kCobot / "camera.yaml") {
    createCapture({.folder = folder_.path() / "capture",
                   .robot = kCobot / "cobot6.urdf",
                   .base_link = "",
                   .tip_link = "flange",
                   .target = kCobot / "target.yaml",
                   .camera = camera});
  }
  /// Rows below the header that is there; joints within the limits, times `scale`.
  void fill(int rows, double scale = 1.0, const std::string& stamp = "1.5") {
    Rng rng(4);
    std::string text = readTextFile(file("samples.csv"));
    for (int row = 0; row < rows; ++row) {
      text += fmt::format("images/{:04}.png", row);
      for (const double middle : {0.0, -1.3, 0.0, 0.0, 0.0, 0.0}) text += fmt::format(",{}", scale * (middle + rng.uniform(-1.2, 1.2)));
      text += "," + stamp + "\n";
    }
    folder_.write("capture/samples.csv", text);
  }
  void takePictures(int count, unsigned width = 1280, unsigned height = 960) {
    for (int k = 0; k < count; ++k) folder_.write(fmt::format("capture/images/{:04}.png", k), pngHeader(width, height) + std::to_string(k));
  }
  /// A new folder with so many rows and their pictures.
  void createFilled(int rows) {
    create();
    fill(rows);
    takePictures(rows);
  }
  /// A capture.yaml that names no robot, with `more` keys.
  void forgetRobot(const std::string& more = "") {
    folder_.write("capture/capture.yaml", "setup: eye_to_hand\ncamera: camera.yaml\ntarget: target.yaml\nsamples: samples.csv\n" + more);
  }
  /// What is said where the registration's transforms of these names are known.
  std::vector<CheckItem> itemsWhereKnown(const std::vector<std::string>& transforms) {
    std::string text = "format: poecal-registration/1\n";
    for (const std::string& transform : transforms) {
      text += transform + ": {position: [0.0, 0.0, 1.0], quaternion_xyzw: [0.0, 0.0, 0.0, 1.0], fixed: true}\n";
    }
    folder_.write("capture/known.yaml", text);
    return check().items;
  }
  fs::path file(const std::string& name) const { return folder_.path() / "capture" / name; }
  CaptureCheck check() const { return checkCapture(folder_.path() / "capture"); }

  test::TempFolder folder_;
};

TEST_F(CheckCapture, ANewFolderSaysWhatIsStillEmpty) {
  create({});
  const CaptureCheck empty = check();
  EXPECT_EQ(empty.exitStatus(), 3);
  EXPECT_THAT(empty.items, Contains(says(CheckLevel::kError, "intrinsics", "target.yaml:1: ")));
  EXPECT_THAT(empty.items, Contains(says(CheckLevel::kTooLittle, "intrinsics", "0 pictures")));
  EXPECT_THAT(empty.items, Contains(says(CheckLevel::kTooLittle, "samples", "no rows")));
  EXPECT_THAT(empty.items, Contains(says(CheckLevel::kOk, "robot", "6 joints, 5 of them with limits, link masses")));
}

TEST_F(CheckCapture, AFilledOneCanBeCalibrated) {
  createFilled(45);
  const CaptureCheck good = check();
  EXPECT_EQ(good.exitStatus(), 0);
  EXPECT_THAT(good.items, Contains(says(CheckLevel::kOk, "samples", "45 rows, 45 poses, 0 of them taken more than once")));
  EXPECT_THAT(good.items, Contains(says(CheckLevel::kOk, "pictures", "45 of 1280 x 960 px")));
  EXPECT_THAT(good.items, Contains(says(CheckLevel::kAdvice, "columns", "no dir1..")));
  EXPECT_THAT(good.items, Contains(says(CheckLevel::kAdvice, "columns", "joint_backlash")));
  EXPECT_THAT(good.items, Not(Contains(says(CheckLevel::kAdvice, "columns", "no stamp"))));
}

TEST_F(CheckCapture, FewPosesAreTooFewOrSaidToBe) {
  createFilled(4);
  EXPECT_EQ(check().exitStatus(), 4);
  EXPECT_THAT(check().items, Contains(says(CheckLevel::kTooLittle, "samples", "at least 7 poses are needed")));
  folder_.write("capture/samples.csv",
                readTextFile(file("samples.csv")).substr(0, readTextFile(file("samples.csv")).find("images/0000.png,")));
  fill(20);
  takePictures(20);
  EXPECT_EQ(check().exitStatus(), 0);
  EXPECT_THAT(check().items, Contains(says(CheckLevel::kAdvice, "samples", "40 poses or more")));
}

TEST_F(CheckCapture, DegreesAreNamed) {
  create();
  fill(10, 57.29578);
  EXPECT_EQ(check().exitStatus(), 3);
  EXPECT_THAT(check().items, Contains(says(CheckLevel::kError, "samples", "are the readings in degrees?")));
}

TEST_F(CheckCapture, OneMistakeDoesNotHideTheNext) {
  create();
  folder_.write("capture/target.yaml", "type: apriltag\nfamily: tag36h11\ntags:\n  - {id: 7}\n");
  folder_.write("capture/camera.yaml", "image_width: 10\n");
  fill(10, 57.29578);
  const CaptureCheck bad = check();
  for (const char* topic : {"target", "camera", "samples"}) EXPECT_THAT(bad.items, Contains(says(CheckLevel::kError, topic, ".")));
  std::vector<std::string> texts;
  for (const CheckItem& item : bad.items) texts.push_back(item.text);
  std::sort(texts.begin(), texts.end());
  EXPECT_EQ(std::adjacent_find(texts.begin(), texts.end()), texts.end()) << "the same is said twice";
}

TEST_F(CheckCapture, PicturesThatAreMissingOtherOrNoneAreCounted) {
  create();
  fill(20);
  takePictures(10);
  folder_.write("capture/images/0003.png", "no picture");
  folder_.write("capture/images/0004.png", pngHeader(640, 480));
  const CaptureCheck bad = check();
  EXPECT_EQ(bad.exitStatus(), 3);
  EXPECT_THAT(bad.items, Contains(says(CheckLevel::kError, "pictures", "10 pictures named in samples.csv but missing: images/0010.png")));
  EXPECT_THAT(bad.items,
              Contains(says(CheckLevel::kError, "pictures", "1 picture cannot be read, expected PNG, JPEG or TIFF: images/0003.png")));
  EXPECT_THAT(bad.items, Contains(says(CheckLevel::kError, "pictures", "images/0004.png (640 x 480 px)")));
  EXPECT_THAT(bad.items, Contains(says(CheckLevel::kOk, "pictures", "8 of 1280 x 960 px")));
}

TEST_F(CheckCapture, AStillJointAndMillimetresAreNamed) {
  create();
  folder_.write("capture/target.yaml", "type: apriltag\nfamily: tag36h11\ntags:\n  - {id: 7, size: 80}\n");
  std::string text = readTextFile(file("samples.csv"));
  for (int row = 0; row < 10; ++row)
    text += fmt::format("images/{}.png,{},-1,{},0.3,{},{},\n", row, 0.1 * row, 0.2 * row, -0.1 * row, 0.02 * row);
  folder_.write("capture/samples.csv", text);
  const CaptureCheck bad = check();
  EXPECT_THAT(bad.items, Contains(says(CheckLevel::kError, "target", "millimetres?")));
  EXPECT_THAT(bad.items, Contains(says(CheckLevel::kTooLittle, "joints", "q2 (shoulder_lift) never moved")));
  EXPECT_THAT(bad.items, Contains(says(CheckLevel::kTooLittle, "joints", "q4 (wrist_1_joint) never moved")));
  EXPECT_THAT(bad.items, Contains(says(CheckLevel::kAdvice, "joints", "q6 (wrist_3_joint) moved by only 10.3 degrees")));
}

TEST_F(CheckCapture, AFlangeThatNeverTurnsAsksForTheRegistration) {
  create();
  forgetRobot();
  std::string text = "image,x,y,z,qx,qy,qz,qw\n";
  for (int row = 0; row < 10; ++row) text += fmt::format("images/{}.png,0.{},0.2,0.3,0,0,0,1\n", row, row);
  folder_.write("capture/samples.csv", text);
  EXPECT_THAT(check().items, Contains(says(CheckLevel::kTooLittle, "samples", "never turned by more than half a degree")));

  forgetRobot("registration: known.yaml\n");
  EXPECT_THAT(itemsWhereKnown({"T_camera_base"}), AllOf(Contains(says(CheckLevel::kOk, "registration", "T_camera_base known beforehand")),
                                                        Contains(says(CheckLevel::kTooLittle, "samples", "both of its transforms known"))));
  EXPECT_THAT(itemsWhereKnown({"T_camera_base", "T_flange_target"}),
              AllOf(Contains(says(CheckLevel::kOk, "registration", "T_camera_base and T_flange_target known beforehand")),
                    Not(Contains(Field(&CheckItem::level, CheckLevel::kTooLittle)))));
  EXPECT_THAT(itemsWhereKnown({"T_flange_camera"}), Contains(says(CheckLevel::kError, "registration", "known.yaml")));
}

/// A small cell's files beside its corners, as `spoil` leaves them.
class CheckCorners : public ::testing::Test {
 protected:
  CheckCorners() {
    for (std::size_t k = 0; k < small_.samples.size(); ++k) {
      small_.samples[k].image = fmt::format("p{:02}.png", k);
      small_.samples[k].stamp.reset();
      small_.samples[k].dir.resize(0);
    }
  }
  CaptureCheck check() const {
    folder_.write("robot.yaml", robotYaml(small_.nominal));
    folder_.write("camera.yaml", cameraYaml(*small_.cell.camera));
    folder_.write("target.yaml", targetYaml(small_.target));
    folder_.write("samples.csv", samplesCsv({.file = {}, .samples = small_.samples, .other_columns = {}, .has_joints = true}));
    Detections detections;
    for (const Observation& observation : small_.observations) {
      ImageCorners& image = detections.images.emplace_back();
      image.image = small_.samples[observation.sample].image;
      for (const CornerMeasurement& corner : observation.corners) image.corners.push_back({.id = corner.id, .px = corner.px});
    }
    folder_.write("detections.csv", detectionsCsv(detections));
    folder_.write("capture.yaml",
                  "format: poecal-capture/1\nname: small\nsetup: eye_to_hand\nrobot: robot.yaml\ncamera: camera.yaml\ntarget: target.yaml\n"
                  "samples: samples.csv\ndetections: detections.csv\n");
    return checkCapture(folder_.path());
  }
  test::SmallCell small_ = test::smallCell(5, 40, 0.1, {});
  test::TempFolder folder_;
};

TEST_F(CheckCorners, WhatWasFoundEarlierTellsWhatWasSeen) {
  const CaptureCheck seen = check();
  EXPECT_EQ(seen.exitStatus(), 0);
  EXPECT_THAT(seen.items, Contains(says(CheckLevel::kOk, "corners", "160 corners in 40 pictures, found earlier")));
  EXPECT_THAT(seen.items, Contains(says(CheckLevel::kOk, "registration", "the readings explain the corners to")));
  EXPECT_THAT(seen.items, Each(Field(&CheckItem::topic, Not("pictures"))));
}

TEST_F(CheckCorners, SmallTargetsInOnePlaceAreSaid) {
  // As if the target stood a hundred times as far away, in the corner of the picture.
  for (Observation& observation : small_.observations) {
    for (CornerMeasurement& corner : observation.corners) corner.px = Eigen::Vector2d(300.0, 300.0) + 0.01 * corner.px;
  }
  const CaptureCheck seen = check();
  // One of the 24 parts of the picture.
  EXPECT_THAT(seen.items,
              Contains(says(CheckLevel::kAdvice, "corners", "seen in 4 % of the picture: also move the target near its edges")));
  EXPECT_THAT(seen.items, Contains(says(CheckLevel::kAdvice, "corners", "2 px wide in the median picture: go nearer")));
}

TEST_F(CheckCorners, AStuckReadingIsToldFromAParkedJoint) {
  for (std::size_t k = 25; k < 40; ++k) small_.samples[k].q(1) = small_.samples[25].q(1);
  const CaptureCheck stuck = check();
  EXPECT_EQ(stuck.exitStatus(), 3);
  EXPECT_THAT(stuck.items, Contains(says(CheckLevel::kAdvice, "samples", "samples.csv:27: q2 stays at exactly")));
  EXPECT_THAT(stuck.items, Contains(says(CheckLevel::kError, "registration", "samples.csv:27: q2 stays at exactly")));
}

TEST_F(CheckCorners, PicturesOfOnePlaceWithOtherReadingsAreRefused) {
  for (std::size_t k = 4; k < 9; ++k) small_.observations[k].corners = small_.observations[3].corners;
  const CaptureCheck doubled = check();
  EXPECT_EQ(doubled.exitStatus(), 3);
  EXPECT_THAT(doubled.items, Contains(says(CheckLevel::kError, "corners", "samples.csv:10: p08.png has exactly the corners of p03.png")));
}

TEST_F(CheckCorners, RoundedReadingsAreSaid) {
  for (Sample& sample : small_.samples) sample.q = (sample.q * 100.0).array().round() / 100.0;
  EXPECT_THAT(check().items, Contains(says(CheckLevel::kAdvice, "samples", "q1 to q6 hold multiples of 0.01 rad")));
}

/// Hears everything, and stops the check at one call.
struct Hearing {
  std::vector<std::string> labels = {};
  std::size_t left = 0, calls = 0, stop_at = 0;
  ProgressFunction function() {
    return [this](const std::string& label, std::size_t done, std::size_t total) {
      if (++calls == stop_at) throw InvalidArgument("the listener has enough");
      if (labels.empty() || labels.back() != label) labels.push_back(label);
      left = total - done;
    };
  }
};

TEST_F(CheckCapture, TellsOfEachPicture) {
  create();
  fill(5);
  takePictures(5);
  Hearing hearing;
  checkCapture(folder_.path() / "capture", {.progress = hearing.function()});
  EXPECT_THAT(hearing.labels, ::testing::ElementsAre("looking at pictures", "comparing pictures"));
  EXPECT_EQ(hearing.left, 0u);
  EXPECT_EQ(hearing.calls, 10u);
}

// What a check finds wrong it says; what its listener throws is nothing that it found.
TEST_F(CheckCorners, AListenerThatThrowsStopsIt) {
  check();
  Hearing all;
  const CaptureCheck told = checkCapture(folder_.path(), {.progress = all.function()});
  EXPECT_THAT(all.labels, Contains("registering"));
  EXPECT_EQ(all.left, 0u);
  EXPECT_EQ(told.items.size(), check().items.size());
  for (const std::size_t stop : {std::size_t{1}, all.calls / 2, all.calls}) {
    Hearing stopping{.stop_at = stop};
    EXPECT_THAT([&] { checkCapture(folder_.path(), {.progress = stopping.function()}); },
                ThrowsMessage<InvalidArgument>("the listener has enough"));
  }
}

TEST_F(CheckCapture, NothingIsReplaced) {
  create();
  EXPECT_THAT([this] { create(); }, ThrowsMessage<InvalidArgument>(HasSubstr("is there already, expected a new folder")));
}

TEST_F(CheckCapture, WhatIsNamedWronglyLeavesNoFolder) {
  const NewCapture wrong{.folder = folder_.path() / "capture",
                         .robot = kCobot / "cobot6.urdf",
                         .base_link = "",
                         .tip_link = "",
                         .target = kCobot / "target.yaml"};
  EXPECT_THAT([&] { createCapture(wrong); }, ThrowsMessage<InvalidArgument>(HasSubstr("expected --tip-link")));
  EXPECT_FALSE(fs::exists(folder_.path() / "capture"));
}

TEST_F(CheckCapture, EveryJointIsExplainedWithItsUnitAndRange) {
  create();
  EXPECT_THAT(readTextFile(file("samples.csv")), HasSubstr("#   q2           shoulder_lift [rad], -2.6 to 0\n"));
  EXPECT_THAT(readTextFile(file("samples.csv")), HasSubstr("\nimage,q1,q2,q3,q4,q5,q6,stamp\n"));
}

}  // namespace
}  // namespace poecal
