// What pictures look like: detect says it, and simulate draws others like them.
#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/small_cell.hpp"
#include "poecal/capture/picture_look.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;

class Look : public ::testing::Test {
 protected:
  // The median of some 1500 residuals is good to 1.17 / sqrt(1500) = 3 %: four of these.
  static constexpr double kNoise = 0.12;
  // [px]; four of the 0.008 px that noise of 4 grey levels leaves of a blur of 1.1 px in tags of 50 px.
  static constexpr double kBlur = 0.03;
  // The median of ten scatters by 1.25 / sqrt(10) of one, and what was drawn like what was found by sqrt(2) more.
  static constexpr double kMedianOfMedians = 0.56;

  fs::path path(const std::string& name) const { return folder_.path() / name; }
  test::ProgramRun run(const std::string& arguments) const {
    test::ProgramRun result = test::runProgram(folder_.path(), arguments);
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    return result;
  }
  /// A capture whose pictures are drawn as `image` says, and what is found in it.
  std::vector<PictureLook> drawnAndFound(const std::string& image, const std::string& capture) const {
    test::writeSmallScene(folder_.path(), test::SmallCell::kPictures);
    test::replaceInFile(path("scene/scene.yaml"), "blur: 0.7, noise: 2.0", image);
    run("simulate scene/scene.yaml --out " + capture);
    run("detect " + capture + " --out " + capture + "-out/detections.csv");
    return readPictureLooks(path(capture + "-out/detections-pictures.csv"));
  }
  static void expectAlike(const PictureLook& found, const PictureLook& drawn) {
    EXPECT_NEAR(found.blur, drawn.blur, kBlur);
    EXPECT_NEAR(found.noise / drawn.noise, 1.0, kNoise);
    EXPECT_NEAR(found.growth, 0.0, kBlur);
  }

  test::TempFolder folder_;
};

TEST_F(Look, OfEachPictureIsAsItWasDrawnAndPicturesDrawnLikeItLookTheSame) {
  const PictureLook truth{.blur = 0.9, .noise = 3.0};
  const std::vector<PictureLook> found = drawnAndFound("blur: 0.9, noise: 3.0", "first");
  ASSERT_EQ(found.size(), test::kSmallCellPoses);
  for (const PictureLook& look : found) expectAlike(look, truth);
  const std::vector<PictureLook> again = drawnAndFound("like: ../first-out/detections-pictures.csv", "second");
  ASSERT_EQ(again.size(), found.size());
  for (std::size_t k = 0; k < found.size(); ++k) expectAlike(again[k], found[k]);
  const PictureLook median = *medianLook(again);
  EXPECT_NEAR(median.blur, truth.blur, kMedianOfMedians * kBlur);
  EXPECT_NEAR(median.noise / truth.noise, 1.0, kMedianOfMedians * kNoise);
}

TEST_F(Look, ATableIsUsedInOrderAndFromTheStartAgain) {
  folder_.write("scene/looks.csv", "blur,noise\n0.5,1\n1.1,4\n0.8,2\n");
  const std::vector<PictureLook> given = readPictureLooks(path("scene/looks.csv"));
  const std::vector<PictureLook> found = drawnAndFound("like: looks.csv", "capture");
  const std::vector<PictureLook> truth = readPictureLooks(path("capture-truth/pictures.csv"));
  ASSERT_EQ(found.size(), test::kSmallCellPoses);
  ASSERT_EQ(truth.size(), test::kSmallCellPoses);
  for (std::size_t k = 0; k < found.size(); ++k) {
    expectAlike(found[k], given[k % given.size()]);
    EXPECT_EQ(truth[k].blur, given[k % given.size()].blur);
    EXPECT_EQ(truth[k].noise, given[k % given.size()].noise);
  }
}

TEST_F(Look, StandsInTheSummaryAndBesideTheCornersOfEveryCommand) {
  const std::vector<PictureLook> found = drawnAndFound("blur: 0.7, noise: 2.0", "capture");
  const test::ProgramRun detect = run("detect capture --out out/corners.csv");
  EXPECT_THAT(detect.out, ::testing::ContainsRegex("blur 0\\.[67][0-9] px, noise [12]\\.[0-9] grey levels"));
  const auto json = nlohmann::json::parse(run("detect capture --out out/corners.csv --json").out);
  const PictureLook median = *medianLook(found);
  EXPECT_EQ(json["blur_px"], median.blur);
  EXPECT_EQ(json["noise_grey_levels"], median.noise);
  EXPECT_EQ(json["growth_px"], median.growth);
  const std::string table = readTextFile(path("out/corners-pictures.csv"));
  EXPECT_EQ(table, readTextFile(path("capture-out/detections-pictures.csv")));
  run("measure capture --out measured");
  EXPECT_EQ(readTextFile(path("measured/detections-pictures.csv")), table);
}

TEST_F(Look, IsNotKnownOfTagsThatWereNotFitted) {
  test::simulateSmallCell(folder_.path(), test::SmallCell::kPictures);
  EXPECT_THAT(run("detect capture --out detections.csv --no-refine").out, ::testing::Not(HasSubstr("blur")));
  EXPECT_EQ(readTextFile(path("detections-pictures.csv")), "image,blur,noise,growth\n");
}

}  // namespace
}  // namespace poecal
