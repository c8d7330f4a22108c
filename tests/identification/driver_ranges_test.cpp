// Where the effects of a model were found, and tables that go beyond.
#include "poecal/identification/driver_ranges.hpp"

#include <gmock/gmock.h>

#include "poecal/core/error.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/identification/model.hpp"
#include "poecal/robot/robot_file.hpp"
#include "robot/urdf_examples.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::ThrowsMessage;
using ::testing::UnorderedElementsAre;

Sample sampleAt(double stamp, double temperature, std::optional<double> payload) {
  Sample sample;
  sample.line = 2;
  sample.stamp = stamp;
  sample.temperature = temperature;
  sample.payload = payload;
  return sample;
}

class DriverRangesOf : public ::testing::Test {
 protected:
  DriverRangesOf() {
    model_.cell.arm = readUrdf(test::kSixJoints.file(), test::kSixJoints.base_link, test::kSixJoints.tip_link);
    add({.effect = "joint_drift", .location = "joint:2", .parameters = {{"rate", 1e-3}}, .driver = "temperature"});
  }
  void add(const EffectSpec& spec) { model_.effects.push_back(makeEffect(spec, model_.cell)); }
  std::vector<std::string> remarks(const Sample& sample) const { return remarksOnDrivers(model_.driver_ranges, "table.csv", {sample}); }

  Model model_;
  std::vector<Sample> seen_{sampleAt(10.0, 20.0, {}), sampleAt(600.0, 29.0, 2.0), sampleAt(300.0, 24.0, 1.5)};
};

TEST_F(DriverRangesOf, HoldWhatSomeEffectFollows) {
  EXPECT_THAT(driverRangesOf(model_.effects, seen_), ElementsAre(Pair("temperature", Pair(20.0, 29.0))));
  add({.effect = "joint_slip", .location = "joint:3", .parameters = {{"offset", 1e-3}, {"time", 1.5}}});
  add({.effect = "joint_compliance", .location = "joint:3", .parameters = {{"compliance", 1e-5}}});
  EXPECT_THAT(driverRangesOf(model_.effects, seen_), UnorderedElementsAre(Pair("payload", Pair(0.0, 2.0)), Pair("stamp", Pair(10.0, 600.0)),
                                                                          Pair("temperature", Pair(20.0, 29.0))));
  EXPECT_THAT(driverRangesOf({}, seen_), IsEmpty());
}

TEST_F(DriverRangesOf, TablesMayGoAsFarBeyondAsTheyAreWide) {
  model_.driver_ranges = driverRangesOf(model_.effects, seen_);
  EXPECT_THAT(remarks(sampleAt(1e9, 37.9, 500.0)), IsEmpty()) << "nothing follows the others";
  EXPECT_THAT(remarks(sampleAt(0.0, 11.1, {})), IsEmpty());
  EXPECT_THAT(remarks(sampleAt(0.0, 297.0, {})),
              ElementsAre(HasSubstr("table.csv:2: temperature is 297.0, far from 20.0 to 29.0, where the model's effects were found")));
  EXPECT_THAT(remarks(sampleAt(0.0, 10.9, {})), ElementsAre(HasSubstr("extrapolated in 1 of 1 rows")));
}

TEST_F(DriverRangesOf, AreKeptInTheModelsFile) {
  const test::TempFolder folder;
  model_.driver_ranges = driverRangesOf(model_.effects, seen_);
  folder.write("model.yaml", modelYaml(model_));
  EXPECT_EQ(readModel(folder.path() / "model.yaml").driver_ranges, model_.driver_ranges);
  std::string text = modelYaml(model_);
  text.replace(text.find("[20.0, 29.0]"), 12, "[29.0, 20.0]");
  folder.write("turned.yaml", text);
  EXPECT_THAT([&] { readModel(folder.path() / "turned.yaml"); }, ThrowsMessage<FileError>(HasSubstr("expected the lower end first")));
}

}  // namespace
}  // namespace poecal
