// poecal detect: the corners of the target in every picture of a capture.
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "poecal/calibration/load_capture.hpp"
#include "poecal/calibration/outputs.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/detect_capture.hpp"
#include "poecal/detection/known_corners.hpp"
#include "sources.hpp"

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

std::vector<PictureLook> looksOf(const Detections& detections) {
  std::vector<PictureLook> looks;
  for (const ImageCorners& picture : detections.images) {
    if (picture.look) looks.push_back(*picture.look);
  }
  return looks;
}

/// A share of a capture's pictures: the `index`-th of `count`, both from 1; all of them where count is 0.
struct Part {
  std::size_t index = 0, count = 0;
};

/// @throws InvalidArgument unless `text` is K/N with 1 <= K <= N.
Part parsePart(const std::string& text) {
  Part part;
  std::istringstream stream(text);
  char slash = 0;
  const bool digits = text.find_first_not_of("0123456789/") == std::string::npos;
  if (!digits || !(stream >> part.index >> slash >> part.count) || !stream.eof() || slash != '/' || part.index < 1 ||
      part.index > part.count) {
    throw InvalidArgument(fmt::format("--part is '{}', expected K/N, the K-th of N parts", text));
  }
  return part;
}

/// Neighbouring rows, as many in each part as in any other, or one more.
void keepPart(const Part& part, std::vector<Sample>& samples) {
  const std::size_t begin = samples.size() * (part.index - 1) / part.count, end = samples.size() * part.index / part.count;
  samples = std::vector<Sample>(samples.begin() + static_cast<std::ptrdiff_t>(begin), samples.begin() + static_cast<std::ptrdiff_t>(end));
}

struct Arguments {
  CaptureSource capture;
  std::filesystem::path out;
  std::string part;
  std::vector<std::filesystem::path> known;
  DetectOptions detect;
};

constexpr const char* kExample = R"(
Example:
  $ poecal detect capture --out detections.csv
  60 of 60 pictures show the target, 240 corners in detections.csv
  blur 0.70 px, noise 2.0 grey levels

The image quality of each picture (blur, noise, growth of dark into light) is in detections-pictures.csv; a scene can draw pictures like these.
What was found is kept in .stages/ beside the output: the next run searches only new pictures. On several machines:
  $ poecal detect capture --part 1/2 --out 1.corners     # here
  $ poecal detect capture --part 2/2 --out 2.corners     # there
  $ poecal detect capture --known 1.corners 2.corners --out detections.csv
)";

int run(Arguments& arguments, const Common& common) {
  const bool whole = arguments.part.empty();
  Capture capture = openCapture(arguments.capture);
  // Corners found earlier are no input here: they may be what is found again.
  std::vector<std::filesystem::path> inputs = filesOf(capture, false);
  if (!arguments.capture.intrinsics.empty()) inputs.push_back(arguments.capture.intrinsics);
  if (whole) inputs.insert(inputs.end(), arguments.known.begin(), arguments.known.end());
  requireOutputs(whole ? std::vector{arguments.out, picturesFile(arguments.out)} : std::vector{arguments.out}, inputs);
  if (!whole) keepPart(parsePart(arguments.part), capture.table.samples);
  TerminalListener listener(common);
  arguments.detect.jobs = common.jobs;
  arguments.detect.progress = listener.progressFunction();
  KnownCorners known(whole ? knownCornersFile(arguments.out.parent_path()) : arguments.out);
  for (const std::filesystem::path& file : arguments.known) known.read(file);
  const DetectResult result = detectCapture(capture, arguments.detect, &known);
  known.finish();
  const std::vector<std::string> notes = texts(result.notes);
  listener.warnings(notes);
  if (whole) {
    requireTarget(capture, result);
    writeTextFile(arguments.out, detectionsCsv(result.detections));
    writeTextFile(picturesFile(arguments.out), picturesCsv(result.detections));
  }
  const Counts counts = count(result.detections, capture.target);
  std::string text = fmt::format("{} of {} pictures show the target, {} corners in {}\n", counts.with_corners, counts.pictures,
                                 counts.corners, arguments.out.string());
  nlohmann::json json{{"pictures", counts.pictures}, {"pictures_with_corners", counts.with_corners},
                      {"corners", counts.corners},   {"known_before", known.reused()},
                      {"warnings", notes},           {"file", arguments.out.string()}};
  if (const std::optional<PictureLook> look = medianLook(looksOf(result.detections))) {
    text += fmt::format("blur {:.2f} px, noise {:.1f} grey levels\n", look->blur, look->noise);
    json["blur_px"] = look->blur;
    json["noise_grey_levels"] = look->noise;
    json["growth_px"] = look->growth;
  }
  if (whole) json["pictures_file"] = picturesFile(arguments.out).string();
  printSummary(common, text, json);
  return 0;
}

}  // namespace

std::function<int()> setUpDetect(CLI::App& app, const Common& common) {
  const auto arguments = std::make_shared<Arguments>();
  addCaptureOption(app, arguments->capture)->required();
  app.add_option("--out", arguments->out, "File for the corners (detections.csv)")->required();
  app.add_option("--part", arguments->part, "K/N: search only the K-th of N parts of the pictures; --out is then a file for --known");
  app.add_option("--known", arguments->known, "Files that --part wrote: their pictures are not searched again");
  app.add_option("--quad-decimate", arguments->detect.quad_decimate,
                 "First look for tags in pictures reduced by this factor; edges are refined at full size")
      ->capture_default_str();
  app.add_flag("!--no-refine", arguments->detect.refine, "Keep the corners as they are found: do not fit tags and boards to the picture");
  app.footer(kExample);
  return [arguments, &common] { return run(*arguments, common); };
}

}  // namespace poecal::app
