// Files that nobody means well with, and files that had bad luck: each is refused with its name, and nothing in it reaches the terminal.
#include <algorithm>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/small_cell.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/robot/robot_file.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::Le;
using ::testing::Not;
using ::testing::SizeIs;

struct Case {
  const char* name;
  void (*spoil)(const fs::path& capture);
  std::vector<std::string> says;
};

void PrintTo(const Case& hostile, std::ostream* stream) { *stream << hostile.name; }

void linkInstead(const fs::path& file, const fs::path& target) {
  fs::remove(file);
  fs::create_symlink(target, file);
}

void setCorner(const fs::path& capture, std::size_t row, const char* column, const std::string& value) {
  test::rewriteCsv(capture / "detections.csv", [&](test::Rows& rows) { rows.at(row).at(test::columnOf(rows, column)) = value; });
}

const Case kCases[] = {
    {"LinkToItself",
     [](const fs::path& capture) { linkInstead(capture / "target.yaml", "target.yaml"); },
     {"capture.yaml:", "target.yaml", "cannot be read: Too many levels of symbolic links"}},
    {"SamplesAreALinkToItself",
     [](const fs::path& capture) { linkInstead(capture / "samples.csv", "samples.csv"); },
     {"samples.csv", "cannot be read: Too many levels"}},
    {"CaptureIsALinkToItself",
     [](const fs::path& capture) { linkInstead(capture / "capture.yaml", "capture.yaml"); },
     {"capture.yaml: cannot be read: Too many levels"}},
    {"CannotBeRead",
     [](const fs::path& capture) { linkInstead(capture / "target.yaml", "/proc/self/mem"); },
     {"target.yaml: cannot be read: Input/output error"}},
    {"Device", [](const fs::path& capture) { linkInstead(capture / "detections.csv", "/dev/zero"); }, {"capture.yaml:", "no file"}},
    {"Folder",
     [](const fs::path& capture) {
       fs::remove(capture / "camera.yaml");
       fs::create_directory(capture / "camera.yaml");
     },
     {"capture.yaml:", "'camera.yaml' is no file"}},
    {"LongName",
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "target.yaml", std::string(100'000, 'x')); },
     {"capture.yaml:", "File name too long"}},
    {"KeyTwice",
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "target:", "setup: eye_in_hand\ntarget:"); },
     {"capture.yaml:", "key 'setup' is there twice"}},
    {"SizeTwice",
     [](const fs::path& capture) { test::replaceInFile(capture / "target.yaml", "size: 0.12", "size: 0.12, size: 0.24"); },
     {"target.yaml:", "key 'size' is there twice"}},
    {"NotUtf8",
     [](const fs::path& capture) { test::replaceInFile(capture / "cobot6.urdf", "elbow", "Schw\xe4nker"); },
     {"cobot6.urdf:", "byte 0xE4 is not UTF-8"}},
    {"HugeCorner", [](const fs::path& capture) { setCorner(capture, 6, "u", "1e308"); }, {"detections.csv:7: u is '1e308', expected"}},
    {"LargeCorner",
     [](const fs::path& capture) { setCorner(capture, 6, "u", "1e20"); },
     {"detections.csv:7: u is 1.0e+20, expected -0.5 to 399.5"}},
    {"WildCorner",
     [](const fs::path& capture) { setCorner(capture, 9, "v", "-7000.5"); },
     {"detections.csv:10: v is -7000.5, expected -0.5 to 299.5"}},
    {"CornersOfLargerPictures",
     [](const fs::path& capture) { test::replaceInFile(capture / "camera.yaml", "image_width: 400", "image_width: 320"); },
     {"detections.csv:", "expected -0.5 to 319.5 (a picture of 320 px)"}},
    {"NamesDoNotMeet",
     [](const fs::path& capture) {
       test::rewriteCsv(capture / "samples.csv", [](test::Rows& rows) {
         for (std::size_t row = 1; row < rows.size(); ++row) rows[row][0] = "pictures/" + fs::path(rows[row][0]).filename().string();
       });
     },
     {"samples.csv:2: 'pictures/0000.png' is not in detections.csv (which has 'images/0000.png')"}},
    {"TagOfEightyMetres",
     [](const fs::path& capture) { test::replaceInFile(capture / "target.yaml", "size: 0.12", "size: 120"); },
     {"target.yaml:", "is 120 m, expected at most 3 m: millimetres?"}},
    {"ArmInMillimetres",
     [](const fs::path& capture) { test::replaceInFile(capture / "cobot6.urdf", "<origin xyz=\"0 0.13 0\"", "<origin xyz=\"0 130 0\""); },
     {"cobot6.urdf:", "km from the base, expected metres: an arm in millimetres?"}},
    {"RobotIsAXacro",
     [](const fs::path& capture) {
       fs::rename(capture / "cobot6.urdf", capture / "cobot6.urdf.xacro");
       test::replaceInFile(capture / "cobot6.urdf.xacro", "<link name", "<xacro:property name=\"reach\" value=\"1\"/>\n<link name");
       test::replaceInFile(capture / "capture.yaml", "cobot6.urdf\nbase_link: base_link\ntip_link: flange\n", "cobot6.urdf.xacro\n");
     },
     {"cobot6.urdf.xacro:", "is a xacro, expected it expanded: xacro arm.urdf.xacro > arm.urdf"}},
    {"EscapeInAKey",
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "setup:", "\"\\e]0;title\\a\": 1\nsetup:"); },
     {"capture.yaml:3: unknown key '\\x1b]0;title\\x07'"}},
    {"EscapeInAColumn",
     [](const fs::path& capture) {
       test::rewriteCsv(capture / "samples.csv", [](test::Rows& rows) { rows[0].at(test::columnOf(rows, "q3")) = "\x1b[2J"; });
     },
     {"samples.csv:1: ", "\\x1b[2J"}},
    {"LineInAKey",
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "setup:", "\"a\\npoecal: error: forged\": 1\nsetup:"); },
     {"unknown key 'a\\npoecal: error: forged'"}},
    {"TurnedAround",
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "eye_to_hand", "eye\u202eto_hand"); },
     {"capture.yaml:3: setup: is 'eye\\u202eto_hand', expected"}},
    {"NameOfTwoMegabytes",
     [](const fs::path& capture) { test::replaceInFile(capture / "capture.yaml", "eye_to_hand", std::string(2'000'000, 'y')); },
     {"capture.yaml:3: setup: is 'yyy", "yyy', expected eye_to_hand or eye_in_hand"}},
};

class HostileFile : public ::testing::TestWithParam<Case> {};

TEST_P(HostileFile, IsRefusedInOneLine) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kCorners);
  GetParam().spoil(folder.path() / "capture");
  const test::ProgramRun run = test::runProgram(folder.path(), "measure capture --out out");
  EXPECT_EQ(run.status, 3) << run.err;
  EXPECT_EQ(run.out, "");
  for (const std::string& part : GetParam().says) EXPECT_THAT(run.err, HasSubstr(part));
  EXPECT_THAT(run.err, SizeIs(Le(1000u)));
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_EQ(run.err.find_first_of("\x1b\x07\x7f"), std::string::npos) << run.err;
  EXPECT_FALSE(fs::exists(folder.path() / "out/registration.yaml"));
}

INSTANTIATE_TEST_SUITE_P(Each, HostileFile, ::testing::ValuesIn(kCases),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(HostileNames, AreEscapedInSummariesAndWarnings) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kCorners);
  const fs::path capture = folder.path() / "capture";
  std::string robot = robotYaml(*readCapture(capture).arm);
  robot.replace(robot.find("name: "), robot.find("joints:") - robot.find("name: "), "name: \"\\e[31mRED\\x9b\\u202e\\nforged\"\n");
  writeTextFile(capture / "robot.yaml", robot);
  test::replaceInFile(capture / "capture.yaml", "cobot6.urdf\nbase_link: base_link\ntip_link: flange\n", "robot.yaml\n");
  const test::ProgramRun text = test::runProgram(folder.path(), "identify capture --out out");
  ASSERT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("identified \\x1b[31mRED\\u009b\\u202e"));
  EXPECT_THAT(text.out, Not(HasSubstr("\nforged")));
  const test::ProgramRun json = test::runProgram(folder.path(), "identify capture --out out --json");
  EXPECT_EQ(nlohmann::json::parse(json.out), nlohmann::json::parse(readTextFile(folder.path() / "out/identification.json")));
  for (const std::string& printed : {text.out, text.err, json.out, json.err}) {
    for (const char c : printed) EXPECT_TRUE(c == '\n' || (c >= 0x20 && c < 0x7f)) << static_cast<int>(c);
  }
}

TEST(HostileNames, SomeThatDoNotMeetAreWarnedOf) {
  const test::TempFolder folder;
  test::simulateSmallCell(folder.path(), test::SmallCell::kCorners);
  test::rewriteCsv(folder.path() / "capture/samples.csv", [](test::Rows& rows) {
    rows[4][0] = "pictures/0003.png";
    rows[7][0] = "pictures/0006.png";
    rows[8][0] = ".\\images\\0007.png";
  });
  const test::ProgramRun run = test::runProgram(folder.path(), "measure capture --out out");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err,
            "poecal: warning: 2 pictures of detections.csv without a row in samples.csv (the first: 'images/0003.png'), "
            "2 rows of samples.csv without corners (the first: line 5, 'pictures/0003.png')\n");
  EXPECT_THAT(run.out, HasSubstr("registered 8 pictures"));
}

}  // namespace
}  // namespace poecal
