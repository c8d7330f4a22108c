// Camera, transforms and joints as other programs read them.
#include "poecal/exporting/for_ros.hpp"

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include "effects/rich_cell.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "support/matchers.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Eigen::Isometry3d poseOf(const YAML::Node& transform) {
  const YAML::Node t = transform["translation"], r = transform["rotation"];
  const Eigen::Quaterniond rotation(r["w"].as<double>(), r["x"].as<double>(), r["y"].as<double>(), r["z"].as<double>());
  return Eigen::Translation3d(t["x"].as<double>(), t["y"].as<double>(), t["z"].as<double>()) * rotation;
}

class ForRos : public ::testing::Test {
 protected:
  ForRos() : rich_(test::richCell(rng_)) {
    model_.cell = rich_.cell;
    model_.target = rich_.target;
  }

  Rng rng_{5};
  test::RichCell rich_;
  Model model_;
};

TEST_F(ForRos, TransformsAreThoseOfTheCellBothWays) {
  for (const poecal::Setup setup : {poecal::Setup::kEyeToHand, poecal::Setup::kEyeInHand}) {
    model_.cell.registration.setup = setup;
    const YAML::Node root = YAML::Load(transformsYaml(model_, {.base = "base_link", .flange = "tool0"}));
    const YAML::Node list = root["transforms"];
    ASSERT_EQ(list.size(), 4u);
    // A point on the target, from base: over the camera, and over the flange at some joints.
    std::map<std::string, Eigen::Isometry3d> T;
    for (const YAML::Node& one : list) {
      T[one["header"]["frame_id"].as<std::string>() + ">" + one["child_frame_id"].as<std::string>()] = poseOf(one["transform"]);
    }
    const Eigen::Isometry3d T_base_flange = forwardKinematics(*model_.cell.arm, rich_.samples[0].q);
    const Eigen::Isometry3d T_camera_target = model_.cell.registration.cameraTarget(T_base_flange);
    const bool in_hand = setup == poecal::Setup::kEyeInHand;
    const Eigen::Isometry3d by_ros = in_hand ? T.at("camera>tool0") * T_base_flange.inverse() * T.at("base_link>target")
                                             : T.at("camera>base_link") * T_base_flange * T.at("tool0>target");
    EXPECT_THAT(by_ros, test::PoseIsNear(T_camera_target, 1e-12));
    const std::string near = in_hand ? "tool0" : "base_link", far = in_hand ? "base_link" : "tool0";
    EXPECT_THAT(T.at(near + ">camera") * T.at("camera>" + near), test::PoseIsNear(Eigen::Isometry3d::Identity(), 1e-12));
    EXPECT_THAT(T.at(far + ">target") * T.at("target>" + far), test::PoseIsNear(Eigen::Isometry3d::Identity(), 1e-12));
  }
  EXPECT_THAT(transformsYaml(model_, {}), HasSubstr("# ros2 run tf2_ros static_transform_publisher --x "));
}

TEST_F(ForRos, NamesAreWordsOfTheShell) {
  const std::string text = transformsYaml(model_, {.base = "base; rm -rf ~", .flange = "tool's\nend"});
  EXPECT_THAT(text, HasSubstr("--frame-id 'base; rm -rf ~' --child-frame-id camera\n"));
  EXPECT_THAT(text, HasSubstr("--frame-id 'tool'\\''s\\nend' --child-frame-id target\n")) << "one line, so that no comment ends early";
  EXPECT_EQ(YAML::Load(text)["transforms"][0]["header"]["frame_id"].as<std::string>(), "base; rm -rf ~");
}

TEST_F(ForRos, TheCameraIsReadBackWithoutOwnKeys) {
  model_.cell.camera->standard_deviation = Eigen::VectorXd::Constant(model_.cell.camera->parameterCount(), 1e-3);
  const std::string text = cameraInfoYaml(model_);
  EXPECT_THAT(text, ::testing::Not(HasSubstr("standard_deviation")));
  const test::TempFolder folder;
  EXPECT_EQ(readCamera(folder.write("camera.yaml", text)).parameters(), model_.cell.camera->parameters());
}

TEST_F(ForRos, WhatRosDoesNotHaveIsRefused) {
  model_.cell.camera->model = DistortionModel::kThinPrism;
  EXPECT_THAT([this] { cameraInfoYaml(model_); }, ThrowsMessage<InvalidArgument>(HasSubstr("thin_prism")));
  model_.cell.camera.reset();
  EXPECT_THAT([this] { cameraInfoYaml(model_); }, ThrowsMessage<InvalidArgument>(HasSubstr("no camera")));
  EXPECT_THAT([this] { transformsYaml(model_, {}); }, ThrowsMessage<InvalidArgument>(HasSubstr("no camera")));
}

TEST_F(ForRos, EachJointHasARowWithWhatItDoes) {
  const Arm nominal = displaceTwists(*model_.cell.arm, test::uniformVector(rng_, twistParameterCount(*model_.cell.arm), 2e-3));
  model_.effects = {test::effectOf(rich_, "joint_gain", "joint:2", {{"gain", 2e-3}}),
                    test::effectOf(rich_, "joint_coupling", "joint:6", {{"source", 5.0}, {"ratio", 4e-3}}),
                    test::effectOf(rich_, "camera_drift", "camera.mount", {{"tx", 0.1}})};
  const test::TempFolder folder;
  const CsvTable table = CsvTable::read(folder.write("joints.csv", jointTableCsv(model_, nominal)));
  ASSERT_EQ(table.rowCount(), 6u);
  for (std::size_t k = 0; k < 6; ++k) {
    const Joint& joint = model_.cell.arm->joints[k];
    EXPECT_EQ(table.integer(k, table.column("joint")), static_cast<long>(k + 1));
    EXPECT_EQ(table.text(k, table.column("name")), joint.name);
    EXPECT_EQ(table.number(k, table.column("calibrated_axis_y")), joint.axis().y());
    EXPECT_EQ(table.number(k, table.column("tilt")), axisOffset(nominal.joints[k], joint).tilt);
    EXPECT_EQ(table.number(k, table.column("gain")), k == 1 ? 2e-3 : 0.0);
  }
  EXPECT_THAT(table.text(5, table.column("other_effects")), HasSubstr("joint_coupling by q5: source 5.0, ratio 0.004"));
  EXPECT_EQ(table.text(0, table.column("other_effects")), "");
}

TEST_F(ForRos, AZeroThatMovedIsAnOffset) {
  // The last joint's zero alone: it turns the flange about its axis.
  Arm nominal = *model_.cell.arm;
  constexpr double kZero = 3e-3;
  const Eigen::Isometry3d turned = expSe3(nominal.joints[5].xi * kZero) * expSe3(nominal.gamma);
  model_.cell.arm->gamma = logSe3(turned);
  const test::TempFolder folder;
  const CsvTable table = CsvTable::read(folder.write("joints.csv", jointTableCsv(model_, nominal)));
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(table.number(k, table.column("zero_offset")), k == 5 ? kZero : 0.0, 1e-12) << k;
}

}  // namespace
}  // namespace poecal
