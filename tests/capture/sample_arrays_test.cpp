#include "poecal/capture/sample_arrays.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

SampleArrays twoRows() {
  SampleArrays arrays;
  arrays.q = (Eigen::MatrixXd(2, 2) << 0.1, 0.2, 0.3, 0.4).finished();
  arrays.dir = (Eigen::MatrixXd(2, 2) << 1.0, -1.0, 0.0, 1.0).finished();
  arrays.dq = (Eigen::MatrixXd(2, 2) << 0.5, 0.0, -0.5, 0.25).finished();
  arrays.image = {"a.png", "b.png"};
  arrays.pose = {4, 5};
  arrays.stamp = Eigen::Vector2d(10.0, 20.0);
  arrays.temperature = Eigen::Vector2d(21.5, 22.0);
  arrays.payload = Eigen::Vector2d(0.0, 1.5);
  arrays.other = {{"humidity", Eigen::Vector2d(0.4, 0.5)}};
  return arrays;
}

/// What samples.csv says of a table is all that there is to compare.
TEST(SampleArrays, AreTheTableThatAFileWithTheSameColumnsGives) {
  const test::TempFolder folder;
  const SampleTable table = sampleTable(twoRows());
  const auto file = folder.write("samples.csv",
                                 "image,q1,q2,pose,stamp,dir1,dir2,dq1,dq2,temperature,payload,humidity\n"
                                 "a.png,0.1,0.2,4,10,1,-1,0.5,0,21.5,0,0.4\n"
                                 "b.png,0.3,0.4,5,20,0,1,-0.5,0.25,22,1.5,0.5\n");
  const SampleTable read = readSamples(file, 2, nullptr);
  EXPECT_EQ(samplesCsv(table), samplesCsv(read));
  EXPECT_EQ(table.other_columns, read.other_columns);
  EXPECT_TRUE(table.has_joints);
  EXPECT_FALSE(table.has_flange_poses);
}

TEST(SampleArrays, PosesOfTheControllerAreEnough) {
  SampleArrays arrays;
  arrays.T_base_flange.assign(3, Eigen::Isometry3d(Eigen::Translation3d(1.0, 2.0, 3.0)));
  const SampleTable table = sampleTable(arrays);
  ASSERT_EQ(table.samples.size(), 3u);
  EXPECT_EQ(table.samples.at(1).T_base_flange->translation().y(), 2.0);
  EXPECT_EQ(table.samples.at(1).q.size(), 0);
  EXPECT_FALSE(table.samples.at(1).stamp.has_value());
  EXPECT_FALSE(table.has_joints);
  EXPECT_TRUE(table.has_flange_poses);
}

TEST(SampleArrays, WhatDoesNotFitIsNamed) {
  const auto refuses = [](void (*spoil)(SampleArrays&), const char* words) {
    SampleArrays arrays = twoRows();
    spoil(arrays);
    EXPECT_THAT([&] { sampleTable(arrays); }, ThrowsMessage<InvalidArgument>(HasSubstr(words)));
  };
  refuses([](SampleArrays& a) { a.stamp = Eigen::Vector3d::Zero(); }, "stamp: 3 rows, expected 2");
  refuses([](SampleArrays& a) { a.image = {"a.png"}; }, "image: 1 rows, expected 2");
  refuses([](SampleArrays& a) { a.dir = Eigen::MatrixXd::Zero(2, 3); }, "dir: 3 columns, expected 2");
  refuses([](SampleArrays& a) { a.dir(1, 0) = 0.5; }, "dir: 0.5, expected -1, 0 or 1");
  refuses([](SampleArrays& a) { a.q(0, 1) = std::numeric_limits<double>::quiet_NaN(); }, "q: a value is not finite");
  refuses([](SampleArrays& a) { a.other["empty"] = {}; }, "empty: no rows");
  refuses([](SampleArrays& a) { a = {}; }, "expected q or T_base_flange");
}

}  // namespace
}  // namespace poecal
