// Names of places and drivers in files, and what they stand for.
#include "poecal/effects/place.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "poecal/effects/catalogue.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Place, IsFoundByItsName) {
  for (int kind = 0; kind <= static_cast<int>(PlaceKind::kSamples); ++kind) {
    const Place place{static_cast<PlaceKind>(kind), isNumbered(static_cast<PlaceKind>(kind)) ? 11U : 0U};
    const std::optional<Place> found = Place::of(place.name());
    ASSERT_TRUE(found) << place.name();
    EXPECT_EQ(*found, place) << place.name();
  }
  EXPECT_EQ((Place{PlaceKind::kJoint, 2}).name(), "joint:3");
}

TEST(Place, OtherWordsAreNone) {
  for (const char* word :
       {"", "joint", "joint:", "joint:0", "joint:-1", "joint:3x", "base:1", "camera", "Joint:3", "link:99999999999999999999"}) {
    EXPECT_FALSE(Place::of(word)) << word;
  }
}

struct Named {
  const char* name;
  DriverKind kind;
  std::size_t joint;
};

TEST(Driver, IsWhatItsNameSays) {
  for (const Named& each :
       {Named{"q3", DriverKind::kReading, 2}, Named{"tau12", DriverKind::kTorque, 11}, Named{"dir1", DriverKind::kDirection, 0},
        Named{"q1,q3,q4", DriverKind::kReadings, 0}, Named{"dq", DriverKind::kVelocity, 0}, Named{"gravity", DriverKind::kGravity, 0},
        Named{"stamp", DriverKind::kStamp, 0}, Named{"temperature", DriverKind::kTemperature, 0}, Named{"pixel", DriverKind::kPixel, 0},
        Named{"none", DriverKind::kNone, 0}, Named{"", DriverKind::kNone, 0}, Named{"load", DriverKind::kColumn, 0},
        Named{"q0", DriverKind::kColumn, 0}, Named{"q1,load", DriverKind::kColumn, 0}, Named{"q1,", DriverKind::kColumn, 0},
        Named{"quality", DriverKind::kColumn, 0}}) {
    const Driver driver(each.name);
    EXPECT_EQ(driver.kind(), each.kind) << each.name;
    EXPECT_EQ(driver.joint(), each.joint) << each.name;
    EXPECT_EQ(driver.name(), each.name);
  }
}

TEST(Driver, OfSeveralReadingsNamesTheirJoints) {
  EXPECT_THAT(Driver("q1,q4,q12").joints(), ElementsAre(0, 3, 11));
  for (const char* other : {"q3", "tau2", "load", "q1,load", "q1,", ""}) EXPECT_THAT(Driver(other).joints(), IsEmpty()) << other;
}

TEST(Driver, EveryDriverOfTheCatalogueIsNoColumn) {
  for (const EffectKind& kind : effectKinds()) {
    for (std::string pattern : kind.drivers) {
      for (char& letter : pattern) {
        if (letter == 'K' || letter == 'J') letter = '2';
      }
      EXPECT_NE(Driver(pattern).kind(), DriverKind::kColumn) << kind.name << " " << pattern;
    }
  }
}

}  // namespace
}  // namespace poecal
