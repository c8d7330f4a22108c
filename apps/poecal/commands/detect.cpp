// poecal detect: the corners of the target in every picture of a capture.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "inputs.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/detect_capture.hpp"

namespace poecal::app {
namespace {

struct Counts {
  std::size_t pictures = 0;
  std::size_t with_corners = 0;
  std::size_t corners = 0;
};

/// Of the target alone: a reference without the target calibrates nothing.
Counts count(const Detections& detections, const Target& target) {
  Counts counts;
  counts.pictures = detections.images.size();
  for (const ImageCorners& picture : detections.images) {
    const auto found = std::count_if(picture.corners.begin(), picture.corners.end(),
                                     [&](const Corner& corner) { return target.find(corner.id) != nullptr; });
    counts.corners += static_cast<std::size_t>(found);
    counts.with_corners += found > 0;
  }
  return counts;
}

constexpr const char* kExample = R"(
Example:
  $ poecal detect capture --out detections.csv
  60 of 60 pictures show the target, 240 corners in detections.csv
)";

}  // namespace

std::function<int()> setUpDetect(CLI::App& app, const Common& common) {
  struct Options {
    std::filesystem::path capture, out;
    DetectOptions detect;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("CAPTURE", options->capture, "Capture folder")->required();
  app.add_option("--out", options->out, "File for the corners (detections.csv)")->required();
  app.add_option("--quad-decimate", options->detect.quad_decimate,
                 "Look for tags in pictures this much smaller first; edges are refined in the full ones")
      ->capture_default_str();
  app.add_flag("!--no-refine", options->detect.refine, "Leave AprilTag's corners as they are, without fitting the tags to the picture");
  app.footer(kExample);
  return [options, &common] {
    const Capture capture = readCapture(options->capture);
    options->detect.jobs = common.jobs;
    const DetectResult result = detectCapture(capture, options->detect);
    const std::vector<std::string> notes = describe(result.notes);
    warnAll(notes);
    requireTarget(capture, result);
    const Counts counts = count(result.detections, capture.target);
    writeTextFile(options->out, detectionsCsv(result.detections));
    printSummary(common,
                 fmt::format("{} of {} pictures show the target, {} corners in {}\n", counts.with_corners, counts.pictures, counts.corners,
                             options->out.string()),
                 {{"pictures", counts.pictures},
                  {"pictures_with_corners", counts.with_corners},
                  {"corners", counts.corners},
                  {"warnings", notes},
                  {"file", options->out.string()}});
    return 0;
  };
}

}  // namespace poecal::app
