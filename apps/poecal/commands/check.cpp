// poecal check: what a capture has, what is wrong with it, what would help.
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "numbers.hpp"
#include "poecal/calibration/check_capture.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/printable.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
ok: as it should be. advice: it can be calibrated, and better with this. too little: not enough for a calibration (status 4). error: wrong or
missing (status 3). Only the headers of pictures are read. Nothing is written.

Example:
  $ poecal check capture
  ok          robot       cobot6: 6 joints, 5 of them with limits, link masses
  ok          target      4 corners of tags 0.12 m wide
  ok          camera      400 x 300 px, plumb_bob, sees about 32 degrees across
  advice      samples     10 rows, 10 poses, 0 of them taken more than once: 40 poses or more tell effects from the arm's geometry
  ...
  capture can be calibrated
)";

int runCheck(const std::filesystem::path& folder, CheckOptions options, const Common& common) {
  TerminalListener listener(common);
  options.progress = listener.progressFunction();
  const CaptureCheck check = checkCapture(folder, options);
  const int status = check.exitStatus();
  const CheckLevel worst = status == 3 ? CheckLevel::kError : CheckLevel::kTooLittle;
  std::string text, first;
  nlohmann::json items = nlohmann::json::array();
  for (const CheckItem& item : check.items) {
    text += fmt::format("{:11} {:11} {}\n", checkLevelName(item.level), item.topic, printableLine(item.text));
    items.push_back({{"level", checkLevelName(item.level)}, {"topic", item.topic}, {"text", item.text}});
    if (status != 0 && first.empty() && item.level == worst) first = item.text;
  }
  if (status == 0) text += fmt::format("{} can be calibrated\n", folder.string());
  printSummary(common, text, {{"folder", folder.string()}, {"status", status}, {"items", items}});
  if (status != 0) throw Error(first, status);
  return 0;
}

}  // namespace

std::function<int()> setUpCheck(CLI::App& app, const Common& common) {
  struct Options {
    std::filesystem::path folder;
    CheckOptions check;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("CAPTURE", options->folder, "Capture folder")->required();
  app.add_option("--detect", options->check.detect, "Try the detector in this many pictures")->check(nonNegativeNumber())->option_text("N");
  app.footer(kExample);
  return [options, &common] {
    options->check.jobs = common.jobs;
    return runCheck(options->folder, options->check, common);
  };
}

}  // namespace poecal::app
