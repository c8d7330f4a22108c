#include "target/target_yaml.hpp"

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "support/matchers.hpp"
#include "support/random.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

class TargetYaml : public ::testing::Test {
 protected:
  Target read(const std::string& content) const { return readTarget(folder_.write("target.yaml", content)); }
  std::string messageOf(const std::string& content) const {
    try {
      read(content);
    } catch (const FileError& error) {
      return error.what();
    }
    return "nothing was wrong";
  }
  test::TempFolder folder_;
};

TEST_F(TargetYaml, ASingleTagMayLeaveItsPlaceOut) {
  const Target target = read("type: apriltag\nfamily: tag36h11\ntags:\n- {id: 7, size: 0.08}\n");
  EXPECT_EQ(target.type, TargetType::kAprilTag);
  EXPECT_EQ(target.tags.front().T_target_tag.matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(target.points.size(), 4u);
}

TEST_F(TargetYaml, ATagMayBeTurned) {
  // A quarter turn about z takes the tag's x to the target's y: corner 1, (s/2, s/2), goes to (-s/2, s/2).
  const Target target = read(
      "type: apriltag\nfamily: tag25h9\ntags:\n- {id: 7, size: 0.2, center: [1, 2, 3], quaternion_xyzw: [0, 0, 0.70710678118, "
      "0.70710678118]}\n");
  EXPECT_THAT(target.find({7, 1})->p_target, test::IsNear(Eigen::Vector3d(0.9, 2.1, 3.0), 1e-12));
}

TEST_F(TargetYaml, EveryTypeReadsBackAsItself) {
  Rng rng = test::rngOfThisTest();
  const Target targets[] = {
      apriltagTarget("tag36h11", {{7, 0.08, test::randomPose(rng)}, {3, 1.0 / 3.0, Eigen::Isometry3d::Identity()}}),
      pointsTarget({{{3, 0}, {0.1, 1.0 / 3.0, -2e-7}}, {{1, 0}, {1, 2, 3}}}),
      aprilgridTarget("tag36h11", 6, 4, 0.088, 0.3, 2),
      charucoTarget(5, 7, 0.036195, 0.018256, "DICT_6X6_250"),
      chessboardTarget(9, 6, 0.025),
  };
  for (const Target& target : targets) {
    const Target back = read(targetYaml(target));
    EXPECT_EQ(back.type, target.type);
    EXPECT_EQ(back.family, target.family);
    EXPECT_EQ(back.dictionary, target.dictionary);
    EXPECT_EQ(back.marker, target.marker);
    EXPECT_EQ(targetYaml(back).size(), targetYaml(target).size());
    ASSERT_EQ(back.points.size(), target.points.size());
    for (std::size_t k = 0; k < target.points.size(); ++k) {
      EXPECT_EQ(back.points[k].id, target.points[k].id);
      // A rotation goes through its quaternion: a few roundings of coordinates of about 1 m.
      EXPECT_THAT(back.points[k].p_target, test::IsNear(target.points[k].p_target, 4e-15));
    }
  }
}

TEST_F(TargetYaml, ReadsKalibrsFiles) {
  const Target grid = read("target_type: 'aprilgrid' #gridtype\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\n");
  const Target same = aprilgridTarget("tag36h11", 6, 5, 0.088, 0.3, 0);
  EXPECT_EQ(targetYaml(grid), targetYaml(same));
  EXPECT_EQ(grid.border_bits, 0) << "found from each picture";
  const Target later =
      read("target_type: aprilgrid\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\ncodeOffset: 7\nborderBits: 2\n");
  EXPECT_EQ(later.first_id, 7);
  EXPECT_EQ(later.border_bits, 2);
  EXPECT_EQ(read(targetYaml(later)).border_bits, 2);
  const std::string board = "target_type: checkerboard\ntargetCols: 7\ntargetRows: 6\nrowSpacingMeters: 0.06\ncolSpacingMeters: ";
  EXPECT_EQ(targetYaml(read(board + "0.06\n")), targetYaml(chessboardTarget(7, 6, 0.06)));
  EXPECT_THAT(messageOf(board + "0.05\n"),
              HasSubstr("target.yaml:4: rowSpacingMeters: is 0.06 and colSpacingMeters 0.05, expected squares"));
  EXPECT_THAT(messageOf("target_type: circlegrid\n"), HasSubstr("target.yaml:1: target_type: is 'circlegrid', expected aprilgrid or"));
  EXPECT_THAT(messageOf("type: aprilgrid\nborderBits: 3\n"), HasSubstr("target.yaml:2: borderBits: is 3, expected 1 or 2"));
  EXPECT_THAT(
      messageOf("type: aprilgrid\nfamily: tagStandard41h12\ntagCols: 2\ntagRows: 2\ntagSize: 0.1\ntagSpacing: 0.3\nborderBits: 2\n"),
      HasSubstr("borderBits is 2, which only tags of"));
}

TEST_F(TargetYaml, StandsInsideOtherFilesWithItsIndentation) {
  const std::string content = "target:\n" + targetYamlLines(chessboardTarget(9, 6, 0.025), "  ") + "after: 1\n";
  const YamlNode root = YamlNode::load(folder_.write("model.yaml", content));
  EXPECT_EQ(parseTarget(root["target"]).points.size(), 54u);
}

TEST_F(TargetYaml, ErrorsNameLineAndExpectation) {
  const std::string head = "type: apriltag\nfamily: tag36h11\ntags:\n";
  EXPECT_THAT(messageOf("type: aruco\n"), HasSubstr("target.yaml:1: type: is 'aruco', expected apriltag, points, aprilgrid"));
  EXPECT_THAT(messageOf("type: apriltag\nfamily: tag1\ntags: []\n"), HasSubstr("target.yaml:2: family: tag family 'tag1' is not known"));
  EXPECT_THAT(messageOf(head + "- {id: 7}\n"), HasSubstr("target.yaml:4: tags[0]: key 'size' is missing"));
  EXPECT_THAT(messageOf(head + "- {id: 7, size: -0.1}\n"), HasSubstr("target.yaml:4: tags[0].size: is -0.1, expected a positive number"));
  EXPECT_THAT(messageOf(head + "- {id: 7, size: 0.1, centre: [0, 0, 0]}\n"), HasSubstr("target.yaml:4: unknown key 'centre'"));
  EXPECT_THAT(messageOf(head + "- {id: 7, size: 0.1, center: [0, 0, 0]}\n- {id: 8, size: 0.1}\n"),
              HasSubstr("target.yaml:5: tags[1]: key 'center' is missing"));
  EXPECT_THAT(messageOf(head + "- {id: 7, size: 0.1, center: [0, 0, 0]}\n- {id: 7, size: 0.1, center: [1, 0, 0]}\n"),
              HasSubstr("target.yaml:5: tags[1].id: id 7 is there twice"));
  EXPECT_THAT(messageOf(head + "- {id: 7, size: 0.1, quaternion_xyzw: [0, 0, 1, 1]}\n"),
              HasSubstr("target.yaml:4: tags[0].quaternion_xyzw: length 1.414214"));
  EXPECT_THAT(messageOf(head + "- {id: 999, size: 0.1}\n"), HasSubstr("target.yaml:4: tags[0]: tag id 999 does not exist"));
  EXPECT_THAT(messageOf("type: charuco\ncols: 5\nrows: 7\nsquare: 0.1\nmarker: 0.05\ndictionary: DICT_9\n"),
              HasSubstr("target.yaml:6: dictionary: dictionary 'DICT_9' is not known"));
  EXPECT_THAT(messageOf("type: chessboard\ncols: 9\nrows: 6\n"), HasSubstr("key 'square' is missing"));
  EXPECT_THAT(messageOf("type: aprilgrid\ntagCols: 2\ntagRows: 2\ntagSpacing: 0.3\n"), HasSubstr("key 'tagSize' is missing"));
}

TEST_F(TargetYaml, KalibrsKeysAreEnoughForAGrid) {
  const Target target = read("type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.3\n");
  EXPECT_EQ(target.family, "tag36h11");
  EXPECT_EQ(target.points.size(), 144u);
}

}  // namespace
}  // namespace poecal
