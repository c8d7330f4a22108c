// poecal effects: the catalogue in words and in JSON.
#include <algorithm>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using testing::HasSubstr;

test::ProgramRun run(const std::string& arguments) {
  const test::TempFolder folder;
  return test::runProgram(folder.path(), "effects " + arguments);
}

TEST(Effects, OneIsToldInFull) {
  const test::ProgramRun result = run("joint_backlash");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out,
            "joint_backlash: the joint rests on either side of a gap, by where it came from\n"
            "  where       joint:K\n"
            "  driven by   dirK\n"
            "  formula     d_K = half_gap dir_K\n"
            "  parameters  half_gap [rad], typically 0.0002\n"
            "  looks like  joint_compliance\n"
            "  told apart  the same poses reached from both sides\n"
            "  at the cell come to every pose from the same side, preload or replace the gear\n");
}

TEST(Effects, AllAreListed) {
  const nlohmann::json all = nlohmann::json::parse(run("--json").out);
  ASSERT_EQ(all.size(), 29u);
  EXPECT_EQ(all.front().at("effect"), "joint_gain");
  EXPECT_EQ(all.back().at("effect"), "bad_samples");
  const auto slip = std::find_if(all.begin(), all.end(), [](const nlohmann::json& effect) { return effect.at("effect") == "joint_slip"; });
  ASSERT_NE(slip, all.end());
  EXPECT_EQ(slip->at("parameters").at(0).at("role"), "scanned") << "its time";
  EXPECT_THAT(run("").out, HasSubstr("\nlink_bending        link:K         the link bends across its joint's axis"));
}

TEST(Effects, UnknownNameIsStatusTwo) {
  const test::ProgramRun result = run("wear");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("poecal: error: effect 'wear' is not known, expected joint_gain, "));
}

}  // namespace
}  // namespace poecal
