#include "detection/tag_family.hpp"

#include <algorithm>
#include <iterator>

#include "target/names.hpp"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
}

namespace poecal {
namespace {

struct FamilyFunctions {
  std::string_view name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
  int correctable_bits;
};

// Two bits where a code differs from all others in nine or more; fewer where a random square would pass too often (tag16h5: one in 30 with
// a bit corrected, one in 500 without) or where the library's table of neighbours, codes x bits^2 / 2 entries, would fill gigabytes.
constexpr FamilyFunctions kFamilies[] = {
    {"tag36h11", tag36h11_create, tag36h11_destroy, 2},
    {"tag36h10", tag36h10_create, tag36h10_destroy, 2},
    {"tag25h9", tag25h9_create, tag25h9_destroy, 2},
    {"tag16h5", tag16h5_create, tag16h5_destroy, 0},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy, 1},
    {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy, 1},
    {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy, 1},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy, 2},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy, 1},
};

const FamilyFunctions& functionsOf(const std::string& family) {
  const std::string_view name = findIdSet(tagFamilies(), family, "tag family").name;
  return *std::find_if(std::begin(kFamilies), std::end(kFamilies), [&](const FamilyFunctions& entry) { return entry.name == name; });
}

}  // namespace

TagFamily makeTagFamily(const std::string& name) {
  const FamilyFunctions& functions = functionsOf(name);
  return {functions.create(), functions.destroy};
}

int correctableBits(const std::string& name) { return functionsOf(name).correctable_bits; }

cv::Ptr<cv::aruco::Dictionary> makeMarkerDictionary(const std::string& name) {
  // The names stand in the order of OpenCV's enumeration.
  const IdSet& set = findIdSet(markerDictionaries(), name, "dictionary");
  return cv::aruco::getPredefinedDictionary(static_cast<int>(&set - markerDictionaries().data()));
}

}  // namespace poecal
