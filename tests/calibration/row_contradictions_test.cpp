// Flange poses against joint readings, and pictures that are one file.
#include "calibration/row_contradictions.hpp"

#include <gmock/gmock.h>

#include "diagnosis/small_cell.hpp"
#include "poecal/core/error.hpp"
#include "support/random.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

Eigen::Isometry3d poseOf(const Eigen::Vector3d& turn, const Eigen::Vector3d& place) {
  Vector6d twist;
  twist << turn, place;
  return expSe3(twist);
}

/// A controller that reports a tool, from a frame of its own, by an arm that is not quite the drawn one.
class FlangePoses : public ::testing::Test {
 protected:
  FlangePoses() {
    table_.file = "rows.csv";
    table_.has_joints = table_.has_flange_poses = true;
    table_.samples = small_.samples;
    const Eigen::Isometry3d frame = poseOf({0.4, -0.2, 2.0}, {1.0, 0.3, -0.2}), tool = poseOf({0.0, 1.0, 0.3}, {0.0, 0.1, 0.25});
    int line = 2;
    for (Sample& sample : table_.samples) {
      sample.line = line++;
      sample.T_base_flange = frame * forwardKinematics(*small_.cell.arm, sample.q) * tool;
    }
  }
  std::vector<std::string> compare() const { return compareFlangePoses(small_.nominal, table_); }
  void expectRefused(const std::string& message) const {
    EXPECT_THAT([this] { compare(); }, ThrowsMessage<FileError>(HasSubstr(message)));
  }

  test::SmallCell small_ = test::smallCell(21, 20, 0.1, {});
  SampleTable table_;
};

TEST_F(FlangePoses, AFrameAndAToolAreNoContradiction) { EXPECT_THAT(compare(), IsEmpty()); }

TEST_F(FlangePoses, MillimetresAreNamed) {
  for (Sample& sample : table_.samples) sample.T_base_flange->translation() *= 1e3;
  expectRefused("expected metres; are they in millimetres?");
}

TEST_F(FlangePoses, ShiftedRowsAreRefused) {
  const SampleTable whole = table_;
  for (std::size_t k = 1; k < whole.samples.size(); ++k) table_.samples[k].T_base_flange = whole.samples[k - 1].T_base_flange;
  expectRefused("rows.csv:3: from line 2 to here qx.. turn by 0 rad and the joint readings by");
  table_ = whole;
  for (std::size_t k = 1; k < whole.samples.size(); ++k) {
    table_.samples[k].T_base_flange->translation() = whole.samples[k - 1].T_base_flange->translation();
  }
  expectRefused("from where the joint readings put them, up to a frame and a tool, expected rows of one arm and moment");
}

TEST_F(FlangePoses, OneRowIsTold) {
  table_.samples.back().T_base_flange->translation().x() += 0.4;
  EXPECT_THAT(compare(), ElementsAre(HasSubstr("rows.csv:21: x, y, z are 0.3")));
}

/// A picture of 2 x 1 pixels.
std::string greys(const std::string& left, int right) { return "P2\n2 1\n255\n" + left + " " + std::to_string(right) + "\n"; }

TEST(PicturesOfRows, OneFileUnderTwoNamesIsRefusedWhereTheArmMoved) {
  const test::TempFolder folder;
  Capture capture;
  capture.folder = folder.path();
  capture.table.file = "rows.csv";
  for (int row = 0; row < 4; ++row) {
    Sample sample;
    sample.line = row + 2;
    sample.image = "p" + std::to_string(row) + ".png";
    sample.q = Eigen::Vector2d(0.1 * row, 0.5);
    folder.write(sample.image, greys("8", row < 2 ? 0 : row));
    capture.table.samples.push_back(sample);
  }
  EXPECT_THAT([&] { compareBytesOfPictures(capture); },
              ThrowsMessage<FileError>("rows.csv:3: p1.png is the same picture as p0.png of line 2, but the readings differ: expected one "
                                       "picture for each row"));
  capture.table.samples[1].q = capture.table.samples[0].q;
  std::vector<std::size_t> left;
  const auto told = [&left](const std::string&, std::size_t done, std::size_t total) { left.push_back(total - done); };
  EXPECT_THAT(compareBytesOfPictures(capture, told),
              ElementsAre("rows.csv:3: p1.png is the same picture as p0.png of line 2: one shot counts twice"));
  EXPECT_THAT(left, ElementsAre(3, 2, 1, 0));
  folder.write("p1.png", greys("8", 9));
  EXPECT_THAT(compareBytesOfPictures(capture), IsEmpty());
  for (const Sample& sample : capture.table.samples) folder.write(sample.image, greys("0", 0));
  EXPECT_THAT(compareBytesOfPictures(capture), IsEmpty()) << "a black picture shows no other place";
  for (const Sample& sample : capture.table.samples) folder.write(sample.image, "no picture");
  EXPECT_THAT(compareBytesOfPictures(capture), IsEmpty());
}

TEST(CornersOfRows, ThoseOfOnePictureUnderTwoNamesAreRefusedWhereTheArmMoved) {
  SampleTable table{.file = "rows.csv", .samples = {}, .other_columns = {}};
  Detections detections;
  constexpr int kRows = 20;
  for (int row = 0; row < kRows; ++row) {
    Sample& sample = table.samples.emplace_back();
    sample.line = row + 2;
    sample.image = "p" + std::to_string(row) + ".png";
    sample.q = Eigen::Vector2d(0.1 * row, 0.5);
    ImageCorners& image = detections.images.emplace_back();
    image.image = sample.image;
    for (int corner = 0; corner < 4; ++corner) image.corners.push_back({.id = {1, corner}, .px = {10.25 * corner, 3.5 + row}});
  }
  EXPECT_THAT(compareCornersOfPictures(table, detections), IsEmpty());
  for (std::size_t k = 1; k < 4; ++k) detections.images[k].corners = detections.images[0].corners;
  EXPECT_THAT([&] { compareCornersOfPictures(table, detections); },
              ThrowsMessage<FileError>("rows.csv:5: p3.png has exactly the corners of p0.png of line 2, but the readings differ: expected "
                                       "one picture for each row"));
  for (const std::size_t k : {0, 2}) detections.images[k].corners.clear();
  EXPECT_THAT(compareCornersOfPictures(table, detections),
              ElementsAre("rows.csv:5: p3.png has exactly the corners of p1.png of line 3, but the readings differ: expected one picture "
                          "for each row"))
      << "a single one is told, and the fit leaves it out";
  table.samples[3].q = table.samples[1].q;
  EXPECT_THAT(compareCornersOfPictures(table, detections),
              ElementsAre("rows.csv:5: p3.png has exactly the corners of p1.png of line 3: one shot counts twice"));
  detections.images[3].corners.clear();
  detections.images[1].corners.clear();
  EXPECT_THAT(compareCornersOfPictures(table, detections), IsEmpty()) << "a picture that shows nothing";
}

TEST(RemarksOnCorners, ThatWereRoundedAreSaid) {
  Rng rng = test::rngOfThisTest();
  Detections detections;
  for (int picture = 0; picture < 20; ++picture) {
    ImageCorners& image = detections.images.emplace_back();
    for (int k = 0; k < 4; ++k) image.corners.push_back({{1, k}, {rng.uniform(0.0, 640.0), rng.uniform(0.0, 480.0)}});
  }
  detections.images[0].corners[0].px = {12.0, 30.0};
  EXPECT_THAT(remarksOnCorners("detections.csv", detections), IsEmpty());
  for (std::size_t picture = 10; picture < 20; ++picture) {
    for (Corner& corner : detections.images[picture].corners) corner.px = corner.px.array().round();
  }
  EXPECT_THAT(remarksOnCorners("detections.csv", detections),
              ElementsAre(HasSubstr("detections.csv: 41 of 80 corners lie at whole pixels")));
}

TEST(RemarksOnRows, RoundedReadingsAreSaidWithWhatTheyCost) {
  test::SmallCell small = test::smallCell(21, 20, 0.1, {});
  EXPECT_THAT(remarksOnRows("rows.csv", small.samples, &small.nominal), IsEmpty());
  for (Sample& sample : small.samples) sample.q = (sample.q * 100.0).array().round() / 100.0;
  EXPECT_THAT(remarksOnRows("rows.csv", small.samples, &small.nominal),
              ElementsAre(HasSubstr("rows.csv: q1 to q6 hold multiples of 0.01 rad: rounded so, the flange is off by up to")));
  EXPECT_THAT(remarksOnRows("rows.csv", small.samples, nullptr), IsEmpty());
}

}  // namespace
}  // namespace poecal
