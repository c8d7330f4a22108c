// Printed targets, as real programs show them and poecal's own detector sees them.
#include "poecal/printing/target_sheet.hpp"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/detector.hpp"
#include "support/matchers.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

constexpr int kDpi = 254;  // of which a page has a whole number of pixels
constexpr double kPixelsOfAMetre = 1e4;
constexpr double kPromised = 1e-4;  // [m] over 0.2 m

bool hasProgram(const char* name) { return std::system(("command -v " + std::string(name) + " >/dev/null").c_str()) == 0; }

/// Skips, saying so, where a program that only .ci/run needs is not installed.
#define REQUIRE_PROGRAM(name)                                                          \
  if (!hasProgram(name)) {                                                             \
    GTEST_SKIP() << (name) << " is not installed (apps/install-dependencies.sh --ci)"; \
  }

struct PrintedCase {
  const char* name;
  Target target;
  const char* paper;
};

Target tagsInAPlane() {
  TargetTag left{.id = 3, .size = 0.06}, right{.id = 11, .size = 0.05};
  right.T_target_tag.translation() << 0.09, 0.02, 0.0;
  right.T_target_tag.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return apriltagTarget("tag36h11", {left, right});
}

const std::vector<PrintedCase>& printedCases() {
  static const std::vector<PrintedCase> cases{{"tag36h11", apriltagTarget("tag36h11", {{.id = 7, .size = 0.08}}), "a4"},
                                              {"large", apriltagTarget("tag36h11", {{.id = 12, .size = 0.2}}), "a2"},
                                              {"tag25h9", apriltagTarget("tag25h9", {{.id = 5, .size = 0.1}}), "letter"},
                                              {"tagStandard41h12", apriltagTarget("tagStandard41h12", {{.id = 20, .size = 0.07}}), "a4"},
                                              {"tagCircle21h7", apriltagTarget("tagCircle21h7", {{.id = 2, .size = 0.06}}), "a4"},
                                              {"turned", tagsInAPlane(), "a4"},
                                              {"aprilgrid", aprilgridTarget("tag36h11", 4, 3, 0.05, 0.3, 0), "a3"},
                                              {"kalibr", aprilgridTarget("tag36h11", 4, 3, 0.05, 0.3, 0, 2), "a3"},
                                              {"charuco", charucoTarget(9, 6, 0.025, 0.019, "DICT_6X6_250"), "a4"},
                                              {"chessboard", chessboardTarget(9, 6, 0.025), "a3"}};
  return cases;
}

class PrintedTargets : public ::testing::TestWithParam<std::size_t> {
 protected:
  const PrintedCase& printed() const { return printedCases()[GetParam()]; }
  void shell(const std::string& command) const {
    ASSERT_EQ(std::system(("cd '" + folder_.path().string() + "' && " + command).c_str()), 0) << command;
  }
  /// The detector's corners in the page's picture, against target.yaml seen by a flat camera: pixels are metres times a scale.
  void expectSeen(const SheetPage& page, double tolerance) const {
    folder_.write("target.yaml", targetYaml(printed().target));
    const Target target = readTarget(folder_.path() / "target.yaml");
    const std::string file = (folder_.path() / "page.png").string();
    cv::Mat picture = cv::imread(file, cv::IMREAD_GRAYSCALE);
    EXPECT_NEAR(picture.cols, page.width * kPixelsOfAMetre, 1.01);  // sizes in points are rounded up
    EXPECT_NEAR(picture.rows, page.height * kPixelsOfAMetre, 1.01);
    cv::GaussianBlur(picture, picture, {}, 0.8);  // as a lens would: edges within one pixel have no place to be read from
    cv::imwrite(file, picture);
    const DetectResult seen = detect(folder_.path(), {"page.png"}, target, DetectOptions{});
    const std::vector<Corner>& corners = seen.detections.images.front().corners;
    ASSERT_EQ(corners.size(), target.points.size());
    double largest = 0.0, longest_error = 0.0;
    for (const Corner& corner : corners) {
      const double stated = (target.find(corner.id)->p_target - target.find(corners.front().id)->p_target).norm();
      longest_error = std::max(longest_error, std::abs((corner.px - corners.front().px).norm() / kPixelsOfAMetre - stated));
      const Eigen::Vector3d p_page = page.T_page_target * target.find(corner.id)->p_target;
      largest = std::max(largest, (corner.px + Eigen::Vector2d(0.5, 0.5) - kPixelsOfAMetre * p_page.head<2>()).norm());
    }
    EXPECT_LT(largest, tolerance) << "px";
    EXPECT_LT(longest_error, kPromised);
  }

  test::TempFolder folder_;
};

TEST_P(PrintedTargets, TheDetectorFindsThePdfWhereTheFileSays) {
  REQUIRE_PROGRAM("pdftoppm");
  const TargetSheet sheet = drawTargetSheet(printed().target, paperNamed(printed().paper));
  ASSERT_THAT(sheet.pages, SizeIs(1));
  folder_.write("page.pdf", sheet.pdf);
  shell("pdftoppm -r " + std::to_string(kDpi) + " -gray -png -singlefile page.pdf page");
  // It blackens every pixel that ink touches, which moves an edge by half a pixel at most.
  expectSeen(sheet.pages.front(), 0.5 * std::sqrt(2.0));
}

TEST_P(PrintedTargets, TheDetectorFindsTheSvgWhereTheFileSays) {
  REQUIRE_PROGRAM("rsvg-convert");
  const TargetSheet sheet = drawTargetSheet(printed().target, paperNamed(printed().paper));
  folder_.write("page.svg", sheet.pages.front().svg);
  const std::string dpi = std::to_string(kDpi);
  shell("rsvg-convert --dpi-x " + dpi + " --dpi-y " + dpi + " page.svg -o page.png");
  expectSeen(sheet.pages.front(),
             0.3);  // AprilTag's own corners, where the detector does not fit the whole tag; fitted ones are off by 1e-4 px
}

INSTANTIATE_TEST_SUITE_P(All, PrintedTargets, ::testing::Range<std::size_t>(0, 10),
                         [](const auto& instance) { return std::string(printedCases()[instance.param].name); });

/// Middles of the first and the last run of dark pixels in a line of a picture.
std::pair<double, double> outerTicks(const cv::Mat& line) {
  std::vector<double> middles;
  const auto dark = [&line](int k) { return k < static_cast<int>(line.total()) && line.at<unsigned char>(k) < 128; };
  for (int k = 0, end = 0; k < static_cast<int>(line.total()); k = end + 1) {
    for (end = k; dark(end);) ++end;
    if (end > k) middles.push_back(0.5 * (k + end - 1));
  }
  return {middles.front(), middles.back()};
}

TEST(TargetSheet, BothRulersAreTrue) {
  REQUIRE_PROGRAM("pdftoppm");
  const test::TempFolder folder;
  const TargetSheet sheet = drawTargetSheet(apriltagTarget("tag36h11", {{.id = 7, .size = 0.08}}), paperNamed("a4"));
  const SheetPage& page = sheet.pages.front();
  folder.write("page.pdf", sheet.pdf);
  ASSERT_EQ(std::system(("cd '" + folder.path().string() + "' && pdftoppm -r 600 -gray -png -singlefile page.pdf page").c_str()), 0);
  const cv::Mat picture = cv::imread((folder.path() / "page.png").string(), cv::IMREAD_GRAYSCALE);
  const double scale = 600.0 / 25.4e-3;
  const auto px = [scale](double metres) { return static_cast<int>(std::lround(metres * scale)); };
  EXPECT_EQ(page.ruler, 0.1);
  // 1 mm off the line only the first and last tick of each ruler, and what is far from it, can be dark at its ends.
  const int along = px(page.ruler + 3e-3), margin = px(3e-3);
  const cv::Mat right = picture.row(px(page.ruler_corner.y() + 4.5e-3))
                            .colRange(px(page.ruler_corner.x()) - margin / 3, px(page.ruler_corner.x()) + px(page.ruler + 0.5e-3))
                            .clone();
  const cv::Mat up = picture.col(px(page.ruler_corner.x() - 4.5e-3))
                         .rowRange(px(page.ruler_corner.y()) - along, px(page.ruler_corner.y()) + margin / 3)
                         .clone();
  for (const cv::Mat& line : {right, cv::Mat(up.t())}) {
    const auto [first, last] = outerTicks(line);
    EXPECT_NEAR((last - first) / scale, page.ruler, 0.5 * kPromised);  // it is half as long as what is promised
  }
}

TEST(TargetSheet, TheSameTargetGivesTheSameBytes) {
  for (const PrintedCase& printed : printedCases()) {
    const TargetSheet a = drawTargetSheet(printed.target, paperNamed(printed.paper));
    const TargetSheet b = drawTargetSheet(printed.target, paperNamed(printed.paper));
    EXPECT_EQ(a.pdf, b.pdf) << printed.name;
    EXPECT_EQ(a.pages.front().svg, b.pages.front().svg) << printed.name;
    EXPECT_THAT(a.pdf, ::testing::Not(HasSubstr("CreationDate")));
  }
}

TEST(TargetSheet, TagsOfACubeAreAPageEach) {
  TargetTag front{.id = 1, .size = 0.05}, side{.id = 2, .size = 0.05};
  side.T_target_tag.linear() = Eigen::AngleAxisd(1.57, Eigen::Vector3d::UnitY()).toRotationMatrix();
  side.T_target_tag.translation() << 0.05, 0.0, 0.05;
  const TargetSheet sheet = drawTargetSheet(apriltagTarget("tag36h11", {front, side}), paperNamed("a4"));
  ASSERT_THAT(sheet.pages, SizeIs(2));
  EXPECT_THAT(sheet.pages[0].tags, ElementsAre(1));
  EXPECT_THAT(sheet.pages[1].tags, ElementsAre(2));
}

TEST(TargetSheet, AThingTooLargeNamesThePaperThatHoldsIt) {
  const Target board = chessboardTarget(9, 6, 0.03);
  EXPECT_THAT([&] { drawTargetSheet(board, paperNamed("a4")); }, ThrowsMessage<InvalidArgument>(HasSubstr("--paper a3 holds it")));
  EXPECT_NO_THROW(drawTargetSheet(board, paperNamed("a3")));
  const Target wall = chessboardTarget(30, 20, 0.08);
  try {
    drawTargetSheet(wall, paperNamed("a0"));
    FAIL() << "it does not fit";
  } catch (const InvalidArgument& error) {
    const std::string message = error.what(), before = "--paper ";
    const std::size_t at = message.find(before) + before.size();
    EXPECT_NO_THROW(drawTargetSheet(wall, paperNamed(message.substr(at, message.find(' ', at) - at)))) << message;
  }
}

TEST(TargetSheet, AThingTooSmallForAnyPrinterIsRefused) {
  const auto small = [](const Target& target) { return [&target] { drawTargetSheet(target, paperNamed("a4")); }; };
  const Target tags = apriltagTarget(
      "tag36h11",
      {{.id = 7, .size = 0.08}, {.id = 8, .size = 1e-4, .T_target_tag = Eigen::Isometry3d(Eigen::Translation3d(0.1, 0.0, 0.0))}});
  EXPECT_THAT(small(tags),
              ThrowsMessage<InvalidArgument>("tag 8 of 0.1 mm cannot be printed, expected 2 mm or more; is its size in metres?"));
  const Target board = chessboardTarget(7, 5, 1.5e-3);
  EXPECT_THAT(small(board), ThrowsMessage<InvalidArgument>(HasSubstr("a square of 1.5 mm cannot be printed")));
  EXPECT_EQ(tooSmallToPrint(chessboardTarget(7, 5, 2e-3)), "");
}

TEST(TargetSheet, SinglePointsCannotBePrinted) {
  EXPECT_THAT(
      [] {
        drawTargetSheet(
            pointsTarget({{{1, 0}, Eigen::Vector3d::Zero()}, {{2, 0}, Eigen::Vector3d::UnitX()}, {{3, 0}, Eigen::Vector3d::UnitY()}}),
            paperNamed("a4"));
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("single points")));
}

TEST(PaperNamed, OtherNamesAreRefused) {
  EXPECT_NEAR(paperNamed("700x720.5").height, 0.7205, 1e-12);
  for (const char* name : {"a9", "", "10x10", "700x", "x700", "700x720mm", "6000x700", "nanxnan"}) {
    EXPECT_THAT([&] { paperNamed(name); }, ThrowsMessage<InvalidArgument>(HasSubstr("expected a4, a3"))) << name;
  }
}

}  // namespace
}  // namespace poecal
