// poecal: a table of commands. Each parses, loads, calls one library function, writes and returns.
#include <cstdio>
#include <exception>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "poecal/core/error.hpp"

namespace poecal::app {

namespace {

/// A command of the contract whose work is not written yet says so, whatever its options.
std::function<int()> setUpNotBuilt(CLI::App& app, const Common&) {
  app.allow_extras();
  app.fallthrough(false);  // what falls through to the program is held against its options
  return [&app]() -> int { throw InvalidArgument(app.get_name() + " is not built yet"); };
}

constexpr Command kCommands[] = {
    {"run", "the main job: lens if needed, corners, registration, identification, diagnosis", setUpRun},
    {"simulate", "draw a capture whose truth is known", setUpSimulate},
    {"intrinsics", "find the lens from pictures of a board", setUpIntrinsics},
    {"detect", "find the target's corners in every picture", setUpDetect},
    {"measure", "find where camera and target are, then measure the poses of the flange", setUpMeasure},
    {"identify", "find the arm's axes", setUpIdentify},
    {"predict", "write the corners or flange poses that a model expects", setUpPredict},
    {"effects", "list the effects: what each is, how it shows, what to do about it", setUpEffects},
    {"export", "write the calibrated geometry into a URDF", setUpExport},
    {"paper", "repeat the experiment of Gao, Wang and Jiang (2013), section 4", setUpPaper},
    {"plan", "the next poses worth taking (not built yet)", setUpNotBuilt},
    {"diagnose", "find where the gap lies, which effect causes it, how much it shrinks", setUpDiagnose},
    {"fleet", "put the results of many captures into one table", setUpFleet},
    {"report", "one self-contained page (not built yet)", setUpNotBuilt},
};

int runProgram(int argc, char** argv) {
  CLI::App app{"Calibrates serial arms from pictures of a tag, and says what the model still leaves out.", "poecal"};
  app.set_version_flag("--version", "poecal " POECAL_VERSION);
  app.require_subcommand(0, 1);  // none is said below, after a word that is no command
  app.fallthrough();
  Common common;
  app.add_option("--jobs", common.jobs, "Pictures and fits worked on at a time (0: one per core)")->check(CLI::NonNegativeNumber);
  app.add_flag("--quiet", common.quiet, "No summary and no progress");
  app.add_flag("--json", common.json, "The summary as JSON on stdout");
  std::vector<std::pair<CLI::App*, std::function<int()>>> commands;
  for (const Command& command : kCommands) {
    CLI::App* sub = app.add_subcommand(command.name, command.summary);
    commands.emplace_back(sub, command.setUp(*sub, common));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "poecal: error: {} (--help shows the options)\n", error.what());
    return 2;
  }
  for (const auto& [sub, run] : commands) {
    if (sub->parsed()) return run();
  }
  throw InvalidArgument("a command is missing (--help lists them)");
}

}  // namespace
}  // namespace poecal::app

int main(int argc, char** argv) {
  try {
    return poecal::app::runProgram(argc, argv);
  } catch (const poecal::Error& error) {
    fmt::print(stderr, "poecal: error: {}\n", error.what());
    return error.exitStatus();
  } catch (const std::exception& error) {
    fmt::print(stderr, "poecal: error: internal: {}\n", error.what());
    return 1;
  }
}
