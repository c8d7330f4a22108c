// poecal target: a target to print at true scale, and its target.yaml.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "numbers.hpp"
#include "poecal/calibration/outputs.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/printing/target_sheet.hpp"
#include "poecal/target/target.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

namespace fs = std::filesystem;

struct TargetOptions {
  std::string type, family = "tag36h11", dictionary, paper = "a4";
  int id = 0, cols = 0, rows = 0, border_bits = 0;
  double size = 0.0, spacing = 0.3, square = 0.0, marker = 0.0;
  fs::path file, out;
};

/// The options that each type needs, as they are called.
struct Needed {
  const char* type;
  std::vector<const char*> options;
};

void requireOptions(const CLI::App& app, const std::string& type) {
  const Needed kinds[] = {{"apriltag", {"--id", "--size"}},
                          {"aprilgrid", {"--cols", "--rows", "--size"}},
                          {"charuco", {"--cols", "--rows", "--square", "--marker", "--dictionary"}},
                          {"chessboard", {"--cols", "--rows", "--square"}}};
  for (const Needed& kind : kinds) {
    if (type != kind.type) continue;
    for (const char* option : kind.options) {
      if (app.count(option) == 0) throw InvalidArgument(fmt::format("--type {} needs {}", type, option));
    }
    return;
  }
  if (type == "points")
    throw InvalidArgument("a target of single points cannot be printed, expected apriltag, aprilgrid, charuco or chessboard");
  throw InvalidArgument(fmt::format("--type '{}', expected apriltag, aprilgrid, charuco or chessboard", type));
}

Target targetOf(const CLI::App& app, const TargetOptions& options) {
  if (options.type.empty() == options.file.empty()) throw InvalidArgument("target needs --type or --file");
  if (!options.file.empty()) {
    Target target = readTarget(options.file);
    if (const std::string small = tooSmallToPrint(target); !small.empty()) throw FileError(options.file, 0, small);
    return target;
  }
  requireOptions(app, options.type);
  if (options.type == "apriltag") return apriltagTarget(options.family, {{.id = options.id, .size = options.size}});
  if (options.type == "aprilgrid") {
    return aprilgridTarget(options.family, options.cols, options.rows, options.size, options.spacing, options.id,
                           options.border_bits > 0 ? options.border_bits : 1);
  }
  if (options.type == "charuco") return charucoTarget(options.cols, options.rows, options.square, options.marker, options.dictionary);
  return chessboardTarget(options.cols, options.rows, options.square);
}

/// FOLDER/target.*, or beside a file of its own name.
fs::path stemOf(const fs::path& out) {
  const std::string ending = out.extension().string();
  if (ending == ".svg" || ending == ".pdf" || ending == ".yaml") return fs::path(out).replace_extension();
  return out / "target";
}

fs::path withEnding(const fs::path& stem, const std::string& ending) { return fs::path(stem.string() + ending); }

int runTarget(const CLI::App& app, const TargetOptions& options, const Common& common) {
  const Target target = targetOf(app, options);
  const TargetSheet sheet = drawTargetSheet(target, paperNamed(options.paper));
  const fs::path stem = stemOf(options.out);
  std::vector<fs::path> drawings;
  for (const SheetPage& page : sheet.pages) {
    drawings.push_back(withEnding(stem, sheet.pages.size() == 1 ? ".svg" : fmt::format("-{}.svg", page.tags.front())));
  }
  std::vector<fs::path> outputs = drawings;
  outputs.insert(outputs.end(), {withEnding(stem, ".pdf"), withEnding(stem, ".yaml")});
  requireOutputs(outputs, {options.file});
  for (std::size_t k = 0; k < drawings.size(); ++k) writeTextFile(drawings[k], sheet.pages[k].svg);
  writeTextFile(withEnding(stem, ".pdf"), sheet.pdf);
  writeTextFile(withEnding(stem, ".yaml"), targetYaml(target));
  const SheetPage& page = sheet.pages.front();
  std::vector<std::string> files;
  for (const fs::path& file : outputs) files.push_back(file.string());
  std::string text;
  for (const std::string& file : files) text += (text.empty() ? "" : ", ") + file;
  text += fmt::format("\n{} page{} of {:.0f} x {:.0f} mm. Print at 100 %, then measure both rulers: {:.0f} mm each\n", sheet.pages.size(),
                      sheet.pages.size() == 1 ? "" : "s", 1e3 * page.width, 1e3 * page.height, 1e3 * page.ruler);
  printSummary(common, text,
               {{"files", files}, {"pages", sheet.pages.size()}, {"width", page.width}, {"height", page.height}, {"ruler", page.ruler}});
  return 0;
}

constexpr const char* kExample = R"(
  --type apriltag    --id N --size M [--family NAME]
  --type aprilgrid   --cols N --rows N --size M [--spacing RATIO] [--id FIRST] [--family NAME] [--border-bits 1|2]
  --type charuco     --cols N --rows N --square M --marker M --dictionary NAME   (squares)
  --type chessboard  --cols N --rows N --square M                                (inner corners)

Example:
  $ poecal target --type apriltag --id 7 --size 0.08 --out tag
  tag/target.svg, tag/target.pdf, tag/target.yaml
  1 page of 210 x 297 mm. Print at 100 %, then measure both rulers: 100 mm each
)";

}  // namespace

std::function<int()> setUpTarget(CLI::App& app, const Common& common) {
  constexpr double kLargestEdge = 3.0;                   // [m] no paper holds it
  constexpr double kLeastGap = 0.05, kLargestGap = 5.0;  // below, borders run into each other
  const CLI::Validator printable = numberFrom(kLeastPrinted, kLargestEdge, "m");
  const auto options = std::make_shared<TargetOptions>();
  app.add_option("--type", options->type, "apriltag, aprilgrid, charuco or chessboard");
  app.add_option("--file", options->file, "Print this target.yaml instead")->option_text("target.yaml");
  app.add_option("--family", options->family, "Of tags")->capture_default_str();
  app.add_option("--id", options->id, "Of the tag, or of an aprilgrid's first tag")->check(nonNegativeNumber());
  app.add_option("--size", options->size, "Edge of a tag between its corners [m]")->check(printable);
  app.add_option("--spacing", options->spacing, "Gap between an aprilgrid's tags, as a part of their size")
      ->capture_default_str()
      ->check(numberFrom(kLeastGap, kLargestGap, "of a tag's size"));
  app.add_option("--border-bits", options->border_bits, "Width of an aprilgrid's black borders in cells (default: 1)")
      ->check(CLI::Range(1, 2));
  app.add_option("--cols", options->cols, "Tags, squares (charuco) or inner corners (chessboard) of a row");
  app.add_option("--rows", options->rows, "Likewise of a column");
  app.add_option("--square", options->square, "Edge of a square [m]")->check(printable);
  app.add_option("--marker", options->marker, "Edge of a charuco board's markers [m]")->check(printable);
  app.add_option("--dictionary", options->dictionary, "Of a charuco board: OpenCV's name, such as DICT_6X6_250");
  app.add_option("--paper", options->paper, "a4, a3, a2, a1, a0, letter, legal, tabloid, or WIDTHxHEIGHT in mm")->capture_default_str();
  app.add_option("--out", options->out, "Folder for target.svg, target.pdf and target.yaml; or FILE.svg, with the others beside it")
      ->required();
  app.footer(kExample);
  return [options, &app, &common] { return runTarget(app, *options, common); };
}

}  // namespace poecal::app
