// poecal: a table of commands. Each parses, loads, calls one library function, writes and returns.
#include <fcntl.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <iterator>
#include <new>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "numbers.hpp"
#include "poecal/core/choices.hpp"
#include "poecal/core/error.hpp"
#include "poecal/detection/decoder_log.hpp"
#include "terminal.hpp"

namespace poecal::app {

namespace {

constexpr Command kCommands[] = {
    {"run", "the main job: lens if needed, corners, registration, identification, diagnosis, report", setUpRun},
    {"target", "a tag or board to print at true scale, and its target.yaml", setUpTarget},
    {"new", "a capture folder to fill in", setUpNew},
    {"check", "judge a capture before anything is fitted", setUpCheck},
    {"simulate", "draw a capture whose truth is known", setUpSimulate},
    {"intrinsics", "find the lens from pictures of a board", setUpIntrinsics},
    {"detect", "find the target's corners in every picture", setUpDetect},
    {"measure", "find where camera and target are, then measure the poses of the flange", setUpMeasure},
    {"identify", "find the arm's axes", setUpIdentify},
    {"predict", "write the corners or flange poses that a model expects", setUpPredict},
    {"compensate", "the joints to command so that the real arm goes where it should", setUpCompensate},
    {"effects", "list the effects: what each is, how it shows, what to do about it", setUpEffects},
    {"export", "write the calibrated geometry into a URDF", setUpExport},
    {"paper", "repeat the experiment of Gao, Wang and Jiang (2013), section 4", setUpPaper},
    {"plan", "the next poses worth taking, or a whole first capture", setUpPlan},
    {"diagnose", "find where the gap lies, which effect causes it, how much it shrinks", setUpDiagnose},
    {"fleet", "put the results of many captures into one table", setUpFleet},
    {"report", "the results of a capture as one page that opens in any browser", setUpReport},
    {"completion", "what a shell completes, and the manual page", setUpCompletion},
};

std::string nearestCommand(const std::string& word) {
  const auto nearer = [&word](const Command& a, const Command& b) { return editDistance(word, a.name) < editDistance(word, b.name); };
  return std::min_element(std::begin(kCommands), std::end(kCommands), nearer)->name;
}

/// CLI11 takes nan, inf and 1e300 for numbers, and none of the commands has a use for those.
void requireUsableNumbers(const CLI::App& command) {
  constexpr double kLargest = 1e9;
  for (const CLI::Option* option : command.get_options()) {
    const std::string type = option->get_type_name();
    if (type.find("FLOAT") == std::string::npos && type != "X Y Z" && type != "EFFECT@PLACE SIZE") continue;
    for (const std::string& word : option->results()) {
      double number = 0.0;
      if (CLI::detail::lexical_cast(word, number) && !(std::abs(number) <= kLargest)) {
        throw InvalidArgument(
            fmt::format("{}: '{}': expected a number from -1e9 to 1e9 (--help shows the options)", option->get_name(), word));
      }
    }
  }
}

int runProgram(int argc, char** argv) {
  CLI::App app{"Calibrates serial arms from pictures of a tag, and says what the model still leaves out.", "poecal"};
  app.set_version_flag("--version", "poecal " POECAL_VERSION);
  app.require_subcommand(0, 1);  // none is said below, after a word that is no command
  app.fallthrough();
  Common common;
  app.add_option("--jobs", common.jobs, "Pictures and fits worked on at a time (0: one per core)")->check(nonNegativeNumber());
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
    std::ostringstream text;
    const int status = app.exit(success, text, text);
    printOut(text.str());
    return status;
  } catch (const CLI::ParseError& error) {
    const std::vector<std::string> words = app.remaining();
    if (app.get_subcommands().empty() && !words.empty() && !words.front().starts_with("-")) {
      throw InvalidArgument(
          fmt::format("'{}' is no command, did you mean {}? (--help lists them)", words.front(), nearestCommand(words.front())));
    }
    throw InvalidArgument(std::string(error.what()) + " (--help shows the options)");
  }
  for (const auto& [sub, run] : commands) {
    if (!sub->parsed()) continue;
    requireUsableNumbers(*sub);
    return run();
  }
  throw InvalidArgument("a command is missing (--help lists them)");
}

/// A standard stream that is closed leaves its number to the next file that is opened, which would then take what is printed. What is put
/// there instead refuses to be written, as a closed stream does.
void holdStandardStreams() {
  for (int stream = 0; stream <= 2; ++stream) {
    if (::fcntl(stream, F_GETFD) == -1) static_cast<void>(::open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY));
  }
}

/// The exit status of the program, after the one line that says why.
int runGuarded(int argc, char** argv) {
  try {
    return runProgram(argc, argv);
  } catch (const Error& error) {
    printError("error", error.what());
    return error.exitStatus();
  } catch (const std::bad_alloc&) {
    const OutOfMemory error("for this");
    printError("error", error.what());
    return error.exitStatus();
  } catch (const std::filesystem::filesystem_error& problem) {
    const FileError error(problem.path1(), 0, "cannot be read: " + problem.code().message());
    printError("error", error.what());
    return error.exitStatus();
  } catch (const std::exception& error) {
    printError("error", std::string("internal: ") + error.what());
    return 1;
  }
}

}  // namespace
}  // namespace poecal::app

int main(int argc, char** argv) {
  poecal::app::holdStandardStreams();
  poecal::silenceDecoders();
  return poecal::app::runGuarded(argc, argv);
}
