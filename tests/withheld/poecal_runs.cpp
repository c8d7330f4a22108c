#include "withheld/poecal_runs.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

extern char** environ;

namespace withheld {
namespace {

namespace fs = std::filesystem;

double seconds(const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); }

/// Runs `poecal COMMAND INPUT... --out OUT --quiet --jobs 1` with more options unless `result` is there.
bool runOnce(const std::string& poecal, const std::string& command, const fs::path& folder, const fs::path& out, const fs::path& result,
             const std::vector<std::string>& more = {}) {
  if (fs::exists(result)) return true;
  fs::create_directories(out);
  std::vector<std::string> arguments = {poecal, command};
  const fs::path poses = folder / "poses";
  if (fs::exists(poses)) {
    arguments.insert(arguments.end(), {"--robot", (poses / "robot.yaml").string(), "--poses", (poses / "poses.csv").string()});
  } else {
    arguments.push_back((folder / "capture").string());
  }
  arguments.insert(arguments.end(), {"--out", out.string(), "--quiet", "--jobs", "1"});
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Run run = runProgram(arguments, out / "log");
  std::ofstream(out / "seconds") << run.seconds << '\n';
  return run.status == 0 && fs::exists(result);
}

/// Whether the lens is given without deviations.
bool lensIsStated(const fs::path& folder) {
  std::ifstream in(folder / "capture" / "camera.yaml");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return !text.empty() && text.find("standard_deviation") == std::string::npos;
}

struct Pixel {
  double u = 0.0, v = 0.0;
};

/// Corners by "image,tag,corner". Columns are image, tag, corner, u, v first.
std::map<std::string, Pixel> readCorners(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  std::map<std::string, Pixel> corners;
  std::string line;
  std::getline(in, line);
  if (line.rfind("image,tag,corner,u,v", 0) != 0) throw std::runtime_error(file.string() + ": expected image,tag,corner,u,v");
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    std::string image, tag, corner, u, v;
    std::getline(cells, image, ',') && std::getline(cells, tag, ',') && std::getline(cells, corner, ',') && std::getline(cells, u, ',') &&
        std::getline(cells, v, ',');
    corners[image + ',' + tag + ',' + corner] = {std::stod(u), std::stod(v)};
  }
  return corners;
}

}  // namespace

Run runProgram(const std::vector<std::string>& arguments, const fs::path& log) {
  std::vector<std::string> copies = arguments;
  std::vector<char*> argv;
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t child = 0;
  const int failure = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw std::runtime_error("cannot run " + arguments.front());

  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) < 0) throw std::runtime_error("cannot wait for " + arguments.front());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

bool diagnose(const std::string& poecal, const fs::path& folder, bool identify_too) {
  const bool answered = runOnce(poecal, "diagnose", folder, folder / "out", folder / "out" / "diagnosis.json");
  if (identify_too && fs::exists(folder / "unseen")) {
    // What a diagnosis calls identified has the lens that was stated; left to itself, identify may fit a wrong one again.
    std::vector<std::string> lens;
    if (lensIsStated(folder)) lens = {"--camera", "stated"};
    runOnce(poecal, "identify", folder, folder / "identified", folder / "identified" / "model.yaml", lens);
  }
  return answered;
}

std::optional<double> secondsOf(const fs::path& out) {
  std::ifstream in(out / "seconds");
  double value = 0.0;
  if (in >> value) return value;
  return std::nullopt;
}

std::optional<double> rmsOnUnseen(const std::string& poecal, const fs::path& folder, const std::string& out) {
  if (!fs::exists(folder / "unseen")) return std::nullopt;
  const fs::path model = folder / out / "model.yaml", predicted = folder / out / "unseen.csv";
  if (!fs::exists(predicted)) {
    if (!fs::exists(model)) return std::nullopt;
    const Run run =
        runProgram({poecal, "predict", (folder / "unseen").string(), "--model", model.string(), "--out", predicted.string(), "--quiet"},
                   folder / out / "predict.log");
    if (run.status != 0 || !fs::exists(predicted)) return std::nullopt;
  }
  const std::map<std::string, Pixel> expected = readCorners(predicted);
  double squares = 0.0;
  std::size_t count = 0;
  for (const auto& [name, px] : readCorners(folder / "unseen" / "detections.csv")) {
    const auto found = expected.find(name);
    if (found == expected.end()) continue;
    squares += std::pow(found->second.u - px.u, 2) + std::pow(found->second.v - px.v, 2);
    ++count;
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(squares / static_cast<double>(count));
}

}  // namespace withheld
