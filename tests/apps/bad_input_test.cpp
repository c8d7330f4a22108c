// What people get wrong, each with the status and the sentence that they are told.
#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/small_cell.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/cell/cell.hpp"
#include "poecal/core/text.hpp"
#include "poecal/robot/robot_file.hpp"
#include "poecal/simulation/simulate.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr int kBadInput = 3;
constexpr int kNotEnough = 4;
constexpr int kPicturesDrawn = 4;  // drawing is what takes time, and refusing needs few

/// The picture of a row of samples.csv, 0 the first.
fs::path pictureOf(const fs::path& capture, std::size_t row) { return capture / readCapture(capture).table.samples.at(row).image; }

std::vector<fs::path> picturesOf(const fs::path& capture) {
  std::vector<fs::path> pictures;
  for (const Sample& sample : readCapture(capture).table.samples) pictures.push_back(capture / sample.image);
  return pictures;
}

void changePicture(const fs::path& file, const std::function<cv::Mat(const cv::Mat&)>& change) {
  cv::imwrite(file.string(), change(cv::imread(file.string(), cv::IMREAD_GRAYSCALE)));
}

cv::Mat blank(const cv::Mat& picture) { return cv::Mat(picture.size(), picture.type(), cv::Scalar(128)); }

cv::Mat mirrored(const cv::Mat& picture) {
  cv::Mat result;
  cv::flip(picture, result, 1);
  return result;
}

/// Puts the arm of the capture's URDF into a robot.yaml.
void useRobotYaml(const fs::path& capture) {
  writeTextFile(capture / "robot.yaml", robotYaml(*readCapture(capture).arm));
  test::replaceInFile(capture / "capture.yaml", "robot: cobot6.urdf", "robot: robot.yaml");
  test::replaceInFile(capture / "capture.yaml", "base_link: base_link\n", "");
  test::replaceInFile(capture / "capture.yaml", "tip_link: flange\n", "");
}

void changeSamples(const fs::path& capture, const std::function<void(test::Rows&)>& change) {
  test::rewriteCsv(capture / "samples.csv", change);
}

void setCell(const fs::path& capture, std::size_t row, const std::string& column, const std::string& text) {
  changeSamples(capture, [&](test::Rows& rows) { rows.at(row).at(test::columnOf(rows, column)) = text; });
}

struct Case {
  const char* name;
  test::SmallCell kind;
  void (*spoil)(const fs::path& capture);
  int status;
  std::vector<std::string> says;  ///< parts of the one line on stderr
};

void PrintTo(const Case& mistake, std::ostream* stream) { *stream << mistake.name; }

constexpr auto kCorners = test::SmallCell::kCorners;
constexpr auto kPictures = test::SmallCell::kPictures;

const Case kCases[] = {
    {"UnknownKey",
     kCorners,
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "setup:", "colour: red\nsetup:"); },
     kBadInput,
     {"capture.yaml:3: ", "unknown key 'colour'", "expected one of: "}},
    {"MissingKey",
     kCorners,
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "target: target.yaml\n", ""); },
     kBadInput,
     {"capture.yaml:", "key 'target' is missing"}},
    {"NotYaml",
     kCorners,
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "setup:", "setup: [\nsetup:"); },
     kBadInput,
     {"capture.yaml:", "not valid YAML"}},
    {"NoCapture", kCorners, [](const fs::path& capture) { fs::remove_all(capture); }, kBadInput, {"capture/capture.yaml: no such file"}},
    {"NamedFileIsNotThere",
     kCorners,
     [](const fs::path& capture) { fs::remove(capture / "target.yaml"); },
     kBadInput,
     {"capture.yaml:", "target.yaml", "expected a file"}},
    {"TagWithoutSize",
     kCorners,
     [](const fs::path& capture) { test::replaceInFile(capture / "target.yaml", "size", "width"); },
     kBadInput,
     {"target.yaml:", "'width'"}},
    {"AxisNotUnit",
     kCorners,
     [](const fs::path& capture) {
       useRobotYaml(capture);
       test::replaceInFile(capture / "robot.yaml", "axis: [0.0", "axis: [0.7");
     },
     kBadInput,
     {"robot.yaml:", "axis", "unit"}},
    {"UrdfWithoutNamedLinks",
     kCorners,
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "tip_link: flange\n", ""); },
     kBadInput,
     {"capture.yaml:", "'tip_link' is missing"}},
    {"UrdfWithoutThatLink",
     kCorners,
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "tip_link: flange", "tip_link: hand"); },
     kBadInput,
     {"cobot6.urdf", "hand", "wrist_3"}},
    {"JointColumnMissing",
     kCorners,
     [](const fs::path& capture) { changeSamples(capture, [](test::Rows& rows) { rows[0].at(test::columnOf(rows, "q3")) = "elbow"; }); },
     kBadInput,
     {"samples.csv:1: ", "q3"}},
    {"JointNotANumber", kCorners, [](const fs::path& capture) { setCell(capture, 4, "q2", "1,2"); }, kBadInput, {"samples.csv:5: "}},
    {"JointIsText", kCorners, [](const fs::path& capture) { setCell(capture, 4, "q2", "home"); }, kBadInput, {"samples.csv:5: ", "'home'"}},
    {"JointNan", kCorners, [](const fs::path& capture) { setCell(capture, 7, "q6", "nan"); }, kBadInput, {"samples.csv:8: ", "q6", "nan"}},
    {"ImageInTwoRows",
     kCorners,
     [](const fs::path& capture) { changeSamples(capture, [](test::Rows& rows) { rows.push_back(rows[2]); }); },
     kBadInput,
     {"samples.csv:12: ", "line 3", "expected one row per image"}},
    {"JointsInDegrees",
     kCorners,
     [](const fs::path& capture) {
       changeSamples(capture, [](test::Rows& rows) {
         for (std::size_t row = 1; row < rows.size(); ++row) {
           for (const char* joint : {"q1", "q2", "q3", "q4", "q5", "q6"}) {
             std::string& cell = rows[row].at(test::columnOf(rows, joint));
             cell = formatNumber(std::stod(cell) * 180.0 / M_PI);
           }
         }
       });
     },
     kBadInput,
     {"samples.csv:2: ", "limits", "degrees"}},
    {"AllPosesEqual",
     kCorners,
     [](const fs::path& capture) {
       changeSamples(capture, [](test::Rows& rows) {
         for (std::size_t row = 2; row < rows.size(); ++row) {
           const std::string image = rows[row][0];
           rows[row] = rows[1];
           rows[row][0] = image;
         }
       });
     },
     kNotEnough,
     {"samples.csv", "expected poses that differ"}},
    {"NoRows",
     kCorners,
     [](const fs::path& capture) { changeSamples(capture, [](test::Rows& rows) { rows.resize(1); }); },
     kNotEnough,
     {"samples.csv", "no rows"}},
    {"CornersOfAnotherOrder",
     kCorners,
     [](const fs::path& capture) {
       test::rewriteCsv(capture / "detections.csv", [](test::Rows& rows) {
         const std::size_t corner = test::columnOf(rows, "corner");
         for (std::size_t row = 1; row < rows.size(); ++row) rows[row].at(corner) = std::to_string(3 - std::stoi(rows[row].at(corner)));
       });
     },
     kBadInput,
     {"flipped (mirrored) tag", "expected the order bottom-left"}},
    {"CornerTwice",
     kCorners,
     [](const fs::path& capture) { test::rewriteCsv(capture / "detections.csv", [](test::Rows& rows) { rows.push_back(rows.back()); }); },
     kBadInput,
     {"detections.csv:42: ", "line 41 already"}},
    {"CornersOfTooFewPictures",
     kCorners,
     [](const fs::path& capture) { test::rewriteCsv(capture / "detections.csv", [](test::Rows& rows) { rows.resize(1 + 2 * 4); }); },
     kNotEnough,
     {"2 pictures", "at least 3"}},
    {"TagInTooFewPictures",
     kPictures,
     [](const fs::path& capture) {
       const std::vector<fs::path> pictures = picturesOf(capture);
       for (std::size_t k = 2; k < pictures.size(); ++k) changePicture(pictures[k], blank);
     },
     kNotEnough,
     {"2 pictures", "at least 3"}},
    {"TagInNoPicture",
     kPictures,
     [](const fs::path& capture) {
       for (const fs::path& picture : picturesOf(capture)) changePicture(picture, blank);
     },
     kNotEnough,
     {"capture: the target was found in none of the 4 pictures"}},
    {"NoPictureIsThere",
     kPictures,
     [](const fs::path& capture) { fs::remove_all(capture / "images"); },
     kNotEnough,
     {"capture: the target was found in none of the 4 pictures"}},
    {"TagOfAnotherFamily",
     kPictures,
     [](const fs::path& capture) { test::replaceInFile(capture / "target.yaml", "tag36h11", "tag25h9"); },
     kNotEnough,
     {"none of the 4 pictures", "tags of family tag36h11 were seen", "tag25h9"}},
    {"MirroredPictures",
     kPictures,
     [](const fs::path& capture) {
       for (const fs::path& picture : picturesOf(capture)) changePicture(picture, mirrored);
     },
     kBadInput,
     {"mirrored", "expected the picture as the camera took it"}},
};

class BadInput : public ::testing::TestWithParam<Case> {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  test::TempFolder folder_;
};

/// One error at the end of stderr, warnings at most before it.
void expectOneErrorLine(const std::string& err) {
  std::istringstream lines(err);
  std::string line, last;
  int errors = 0;
  while (std::getline(lines, line)) {
    const bool error = line.starts_with("poecal: error: ");
    EXPECT_TRUE(error || line.starts_with("poecal: warning: ")) << line;
    errors += error;
    last = line;
  }
  EXPECT_EQ(errors, 1) << err;
  EXPECT_THAT(last, StartsWith("poecal: error: "));
}

TEST_P(BadInput, IsRefusedWithItsReason) {
  const Case& mistake = GetParam();
  test::simulateSmallCell(folder_.path(), mistake.kind, mistake.kind == kPictures ? kPicturesDrawn : test::kSmallCellPoses);
  mistake.spoil(path("capture"));
  const auto before = test::contentOf(folder_.path());
  const test::ProgramRun result = test::runProgram(folder_.path(), "run capture --out out");

  EXPECT_EQ(result.status, mistake.status) << result.err;
  EXPECT_THAT(result.out, IsEmpty());
  expectOneErrorLine(result.err);
  const std::string error = result.err.substr(result.err.rfind("poecal: error: "));
  for (const std::string& part : mistake.says) EXPECT_THAT(error, HasSubstr(part));

  for (const auto& [name, content] : test::contentOf(folder_.path())) {
    if (name == "stdout.txt" || name == "stderr.txt") continue;
    EXPECT_THAT(name, Not(::testing::EndsWith(".part"))) << "half written";
    EXPECT_THAT(name, Not(HasSubstr("model.yaml")));
    if (!name.starts_with("out/")) {
      EXPECT_EQ(content, before.at(name)) << "an input is never changed: " << name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, BadInput, ::testing::ValuesIn(kCases),
                         [](const auto& instance) { return std::string(instance.param.name); });

/// A cell whose last joint stands still.
TEST(BadInputOfAnArm, JointThatNeverMoved) {
  const test::TempFolder folder;
  test::writeSmallScene(folder.path(), test::SmallCell::kCorners);
  SampleTable table = drawSamples(readScene(folder.path() / "scene/scene.yaml"));
  for (Sample& sample : table.samples) sample.q(5) = 0.4;
  folder.write("scene/samples.csv", samplesCsv(table));
  test::writeSmallScene(folder.path(), test::SmallCell::kCorners, "samples: {file: samples.csv}\n");
  simulate(readScene(folder.path() / "scene/scene.yaml"), folder.path() / "capture", {.jobs = 1});

  const test::ProgramRun refused = test::runProgram(folder.path(), "run capture --out out");
  EXPECT_EQ(refused.status, kNotEnough) << refused.err;
  expectOneErrorLine(refused.err);
  EXPECT_THAT(refused.err, HasSubstr("joint 6 (wrist_3_joint) never moved"));
  EXPECT_THAT(refused.err, HasSubstr("--allow-still-joints"));
  EXPECT_FALSE(fs::exists(folder.path() / "out/model.yaml"));
  const test::ProgramRun allowed = test::runProgram(folder.path(), "run capture --out out --allow-still-joints");
  EXPECT_EQ(allowed.status, 0) << allowed.err;
}

struct BadPicture {
  const char* name;
  void (*spoil)(const fs::path& picture);
  std::string says;
};

void PrintTo(const BadPicture& mistake, std::ostream* stream) { *stream << mistake.name; }

const BadPicture kBadPictures[] = {
    {"Missing", [](const fs::path& picture) { fs::remove(picture); }, "no such file"},
    {"Truncated", [](const fs::path& picture) { fs::resize_file(picture, fs::file_size(picture) / 2); }, "cut short"},
    {"OfAnotherSize",
     [](const fs::path& picture) {
       changePicture(picture, [](const cv::Mat& whole) { return cv::Mat(whole, cv::Rect(0, 0, 300, 200)).clone(); });
     },
     "is 300 x 200 pixels, expected 400 x 300"},
    {"NoPicture", [](const fs::path& picture) { writeTextFile(picture, "a note"); }, "picture"},
    {"WithoutTag", [](const fs::path& picture) { changePicture(picture, blank); }, "no tag"},
};

class OneBadPicture : public ::testing::TestWithParam<BadPicture> {};

TEST_P(OneBadPicture, IsNamedAndTheRestGoesOn) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), kPictures, kPicturesDrawn);
  const fs::path picture = pictureOf(folder.path() / "capture", 3);
  GetParam().spoil(picture);
  const test::ProgramRun result = test::runProgram(folder.path(), "detect capture --out detections.csv");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("3 of 4 pictures"));
  EXPECT_THAT(result.err, StartsWith("poecal: warning: "));
  EXPECT_THAT(result.err, HasSubstr(picture.filename().string() + ": "));
  EXPECT_THAT(result.err, HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(Each, OneBadPicture, ::testing::ValuesIn(kBadPictures),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace poecal
