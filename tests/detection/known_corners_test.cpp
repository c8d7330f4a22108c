// What was detected is not detected again; a journal that was cut anywhere costs time and changes nothing.
#include "poecal/detection/known_corners.hpp"

#include <bit>
#include <cstdint>
#include <set>

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "poecal/core/content_key.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/detector.hpp"
#include "support/cameras.hpp"
#include "support/rendering.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

namespace fs = std::filesystem;

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Camera camera(double focal_length) { return test::plumbBob(160, 120, {focal_length, focal_length}, {79.5, 59.5}); }

std::string keyOf(int number) { return pictureKey("a test", std::to_string(number)); }

/// Numbers that a careless text would not bring back, a missing sigma and awkward notes.
PictureFinding awkward(int number) {
  PictureFinding finding;
  finding.corners.push_back({{number, 0}, {1.0 / 3.0 + number, -1e-300}, 0.1});
  finding.corners.push_back({{number, 3}, {0.1 + 0.2, 1e17}});
  finding.notes = {"a \"quoted\" note,\nin two lines", "tag " + std::to_string(number)};
  finding.width = 160;
  finding.height = 120 + number;
  if (number != 1) finding.look = PictureLook{0.1 + number, 2.0 / 3.0, -1e-300};
  return finding;
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

void expectSame(const PictureFinding& a, const PictureFinding& b) {
  ASSERT_EQ(a.corners.size(), b.corners.size());
  for (std::size_t k = 0; k < a.corners.size(); ++k) {
    EXPECT_EQ(a.corners[k].id, b.corners[k].id);
    EXPECT_EQ(bits(a.corners[k].px.x()), bits(b.corners[k].px.x()));
    EXPECT_EQ(bits(a.corners[k].px.y()), bits(b.corners[k].px.y()));
    EXPECT_EQ(bits(a.corners[k].sigma), bits(b.corners[k].sigma));
  }
  ASSERT_EQ(a.look.has_value(), b.look.has_value());
  if (a.look) {
    EXPECT_EQ(bits(a.look->blur), bits(b.look->blur));
    EXPECT_EQ(bits(a.look->noise), bits(b.look->noise));
    EXPECT_EQ(bits(a.look->growth), bits(b.look->growth));
  }
  EXPECT_EQ(a.notes, b.notes);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
}

class KnownCornersFile : public ::testing::Test {
 protected:
  static constexpr int kEntries = 3;

  KnownCornersFile() {
    KnownCorners known(file_);
    for (int k = 0; k < kEntries; ++k) known.add(keyOf(k), awkward(k));
  }
  /// How many of the entries a file still gives; each must be as it went in.
  int countKnown() const {
    KnownCorners known(file_);
    int count = 0;
    for (int k = 0; k < kEntries; ++k) {
      const auto finding = known.find(keyOf(k));
      if (!finding) continue;
      expectSame(*finding, awkward(k));
      ++count;
    }
    return count;
  }

  test::TempFolder folder_;
  fs::path file_ = folder_.path() / "deep" / "corners";
};

TEST_F(KnownCornersFile, GivesTheSameBits) {
  EXPECT_EQ(countKnown(), kEntries);
  EXPECT_FALSE(KnownCorners(file_).find(keyOf(kEntries)));
}

TEST_F(KnownCornersFile, CutAnywhereItGivesItsWholeLinesAndGoesOn) {
  const std::string whole = readTextFile(file_);
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const std::string cut = whole.substr(0, size);
    writeTextFile(file_, cut);
    // The last line is whole without its line end too.
    const auto ended = static_cast<int>(std::count(cut.begin(), cut.end(), '\n'));
    const bool at_line_end = size < whole.size() && whole[size] == '\n';
    const int expected = std::max(0, ended - 1 + (at_line_end && ended > 0 ? 1 : 0));
    ASSERT_EQ(countKnown(), expected) << "cut at " << size;
    KnownCorners(file_).add(keyOf(kEntries), awkward(kEntries));
    ASSERT_EQ(countKnown(), expected) << "cut at " << size << " and gone on";
    const auto added = KnownCorners(file_).find(keyOf(kEntries));
    ASSERT_TRUE(added) << "cut at " << size;
    expectSame(*added, awkward(kEntries));
  }
}

TEST_F(KnownCornersFile, ASpoiltByteIsNeverAWrongFinding) {
  const std::string whole = readTextFile(file_);
  const std::size_t body = whole.find('\n') + 1;
  for (std::size_t at = body; at < whole.size(); ++at) {
    std::string spoilt = whole;
    spoilt[at] = spoilt[at] == '7' ? '8' : '7';
    writeTextFile(file_, spoilt);
    const int lost = whole[at] == '\n' ? 2 : 1;  // two lines that became one
    ASSERT_GE(countKnown(), kEntries - lost) << "at " << at;
    ASSERT_LT(countKnown(), kEntries) << "at " << at;
  }
}

TEST_F(KnownCornersFile, ALineWithoutALookIsOfAnEarlierVersionAndCountsForNothing) {
  const std::string content = R"({"size":[160,120],"corners":[],"notes":["no tag"]})";
  const std::string earlier = keyOf(9) + " " + ContentKey().add(keyOf(9) + content).text() + " " + content + "\n";
  writeTextFile(file_, readTextFile(file_) + earlier);
  EXPECT_FALSE(KnownCorners(file_).find(keyOf(9)));
  EXPECT_EQ(countKnown(), kEntries);
}

TEST_F(KnownCornersFile, FinishedItHoldsWhatWasUsedInAnOrderOfItsOwn) {
  {
    KnownCorners known(file_);
    known.find(keyOf(2));
    known.add(keyOf(7), awkward(7));
    known.find(keyOf(0));
    EXPECT_EQ(known.reused(), 2u);
    known.finish();
  }
  const fs::path other = folder_.path() / "other";
  {
    KnownCorners known(other);
    for (const int k : {7, 0, 2}) known.add(keyOf(k), awkward(k));
    known.find(keyOf(0));
    EXPECT_EQ(known.reused(), 0u) << "what was added here";
    known.finish();
    known.add(keyOf(8), awkward(8));
  }
  EXPECT_EQ(countKnown(), 2) << "nobody asked for the second entry";
  EXPECT_THAT(readTextFile(other), HasSubstr(readTextFile(file_).substr(0, readTextFile(file_).size() - 1)));
  EXPECT_TRUE(KnownCorners(other).find(keyOf(8))) << "finished is not closed";
}

TEST_F(KnownCornersFile, TakesInOthersAndLeavesThemAlone) {
  const std::string before = readTextFile(file_);
  const fs::path other = folder_.path() / "other";
  KnownCorners known(other);
  known.read(file_);
  ASSERT_TRUE(known.find(keyOf(1)));
  known.finish();
  EXPECT_EQ(readTextFile(file_), before);
  EXPECT_TRUE(KnownCorners(other).find(keyOf(1)));
  EXPECT_THROW(known.read(folder_.path() / "none"), FileError);
}

TEST_F(KnownCornersFile, AFileOfAnotherKindIsRefusedAndKept) {
  const fs::path csv = folder_.write("detections.csv", "image,tag,corner,u,v\n");
  try {
    KnownCorners known(csv);
    FAIL() << "a table is no file of known corners";
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("detections.csv:1: is not a file of known corners, expected poecal-corners/1"));
  }
  EXPECT_EQ(readTextFile(csv), "image,tag,corner,u,v\n");
}

TEST(DetectionKey, ChangesWithAllThatDecidesTheCornersAndWithNothingElse) {
  const auto target = [](double size, int id) { return apriltagTarget("tag36h11", {{id, size, Eigen::Isometry3d::Identity()}}); };
  const std::string plain = detectionKey(target(0.08, 7), {});
  DetectOptions unrefined, coarse, lens, other_lens, others;
  unrefined.refine = false;
  coarse.quad_decimate = 3.0;
  lens.camera = camera(150.0);
  other_lens.camera = camera(151.0);
  others.other_tags = {9};
  const std::set<std::string> keys{plain,
                                   detectionKey(target(0.08, 8), {}),
                                   detectionKey(target(0.09, 7), {}),
                                   detectionKey(target(0.08, 7), unrefined),
                                   detectionKey(target(0.08, 7), coarse),
                                   detectionKey(target(0.08, 7), lens),
                                   detectionKey(target(0.08, 7), other_lens),
                                   detectionKey(target(0.08, 7), others)};
  EXPECT_EQ(keys.size(), 8u);
  DetectOptions elsewhere;
  elsewhere.jobs = 3;
  elsewhere.expected_width = 640;
  elsewhere.expected_height = 480;
  EXPECT_EQ(detectionKey(target(0.08, 7), elsewhere), plain);
}

/// Pictures of a tag: two that show it, one of another tag, one of another size, one without any, and files that are none.
class KnownPictures : public ::testing::Test {
 protected:
  KnownPictures() {
    draw("a.png", 7, 50.0);
    draw("b.png", 7, 55.0);
    draw("other.png", 9, 50.0);
    draw("large.png", 7, 50.0, {200, 150});
    cv::imwrite((folder_.path() / "blank.png").string(), cv::Mat(120, 160, CV_8UC1, cv::Scalar(128)));
    folder_.write("broken.png", "no picture");
  }
  void draw(const std::string& name, int id, double side, cv::Size size = {160, 120}) const {
    cv::imwrite((folder_.path() / name).string(), test::tagPicture("tag36h11", id, test::tiltedSquare({80, 60}, side, 0.2, 0.3), size));
  }
  fs::path journal() const { return folder_.path() / "corners"; }
  std::string key(const std::string& image, const DetectOptions& options = {}) const {
    return pictureKey(detectionKey(target_, options), readTextFile(folder_.path() / image));
  }
  /// What no detector would say of a picture.
  static PictureFinding planted() { return {{{{7, 0}, {-1234.5, 0.25}}}, {"planted"}, 160, 120}; }
  void plant(const std::vector<std::string>& images, const DetectOptions& options = {}) const {
    KnownCorners known(journal());
    for (const std::string& image : images) known.add(key(image, options), planted());
  }
  /// Corners and notes as one text.
  static std::string text(const DetectResult& result) {
    std::string text = detectionsCsv(result.detections);
    for (const PictureNote& note : result.notes) text += note.image + ": " + note.message + (note.failed ? " (failed)\n" : "\n");
    return text + picturesCsv(result.detections) + std::to_string(result.width) + " x " + std::to_string(result.height);
  }
  std::string detectWith(KnownCorners* known, int jobs = 1) const {
    DetectOptions options;
    options.jobs = jobs;
    return text(detect(folder_.path(), images_, target_, options, known));
  }
  /// Which pictures a detection takes from what was planted.
  std::vector<std::string> takenFromPlanted(const DetectOptions& options = {}) const {
    KnownCorners known(journal());
    std::vector<std::string> taken;
    for (const PictureNote& note : detect(folder_.path(), images_, target_, options, &known).notes) {
      if (note.message == "planted") taken.push_back(note.image);
    }
    EXPECT_EQ(known.reused(), taken.size());
    return taken;
  }

  test::TempFolder folder_;
  Target target_ = apriltagTarget("tag36h11", {{7, 0.08, Eigen::Isometry3d::Identity()}});
  std::vector<std::string> images_{"a.png", "broken.png", "other.png", "large.png", "blank.png", "missing.png", "b.png"};
};

TEST_F(KnownPictures, AreNotSearchedAgain) {
  plant({"a.png", "other.png"});
  EXPECT_THAT(takenFromPlanted(), ElementsAre("a.png", "other.png"));
}

TEST_F(KnownPictures, AreSearchedAgainWhereTheirBytesChange) {
  plant({"a.png", "other.png", "b.png"});
  draw("a.png", 7, 51.0);
  EXPECT_THAT(takenFromPlanted(), ElementsAre("other.png", "b.png"));
}

TEST_F(KnownPictures, AreKnownUnderAnotherNameToo) {
  plant({"a.png"});
  fs::rename(folder_.path() / "a.png", folder_.path() / "missing.png");
  EXPECT_THAT(takenFromPlanted(), ElementsAre("missing.png"));
}

TEST_F(KnownPictures, AreSearchedAgainWithOtherOptions) {
  DetectOptions lens;
  lens.camera = camera(150.0);
  plant({"a.png"}, lens);
  plant({"b.png"});
  EXPECT_THAT(takenFromPlanted(lens), ElementsAre("a.png"));
  DetectOptions unrefined = lens;
  unrefined.refine = false;
  EXPECT_THAT(takenFromPlanted(unrefined), ElementsAre());
  EXPECT_THAT(takenFromPlanted(), ElementsAre("b.png"));
}

TEST_F(KnownPictures, GiveTheSameResultAndTheSameFileWhereverARunWasCut) {
  const std::string fresh = detectWith(nullptr);
  EXPECT_THAT(fresh, HasSubstr("large.png: is 200 x 150 pixels, expected 160 x 120 (failed)"));
  EXPECT_THAT(fresh, HasSubstr("other.png: tag 9 is not the target's (failed)"));
  {
    KnownCorners known(journal());
    ASSERT_EQ(detectWith(&known), fresh);
  }
  const std::string unfinished = readTextFile(journal());
  const auto lines = std::count(unfinished.begin(), unfinished.end(), '\n');
  ASSERT_EQ(lines, 1 + 4) << "a line for each picture that could be read; one of another size is not";
  {
    KnownCorners known(journal());
    ASSERT_EQ(detectWith(&known), fresh);
    EXPECT_EQ(known.reused(), 4u);
    known.finish();
  }
  const std::string finished = readTextFile(journal());
  // Inside of the first line, at line ends, beside them and inside of lines.
  std::set<std::size_t> cuts{0, 5, unfinished.size()};
  for (std::size_t at = unfinished.find('\n'); at != std::string::npos; at = unfinished.find('\n', at + 1)) {
    cuts.insert({at, at + 1, at + 40, at + 90});
  }
  for (const std::size_t cut : cuts) {
    for (const int jobs : {1, 2}) {
      writeTextFile(journal(), unfinished.substr(0, cut));
      KnownCorners known(journal());
      ASSERT_EQ(detectWith(&known, jobs), fresh) << "cut at " << cut << ", jobs " << jobs;
      known.finish();
      ASSERT_EQ(readTextFile(journal()), finished) << "cut at " << cut << ", jobs " << jobs;
    }
  }
}

}  // namespace
}  // namespace poecal
