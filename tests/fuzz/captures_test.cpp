// Whole folders against the program: of each trial one file is changed, and whatever comes of it, the program ends by itself with a status
// that it explains, leaves what it read as it was, and leaves what it wrote whole.
#include <algorithm>
#include <cstdlib>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "apps/small_cell.hpp"
#include "fuzz/mutator.hpp"
#include "poecal/calibration/results.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/printable.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/identification/model.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal::test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSeed = 20261127;
constexpr int kParts = 2;  // tests that run side by side

std::size_t asked(const char* name, std::size_t usual) {
  const char* value = std::getenv(name);
  return value != nullptr ? std::stoul(value) : usual;
}

/// $POECAL_FUZZ_PROGRAM, or that of this build.
std::string program() {
  const char* given = std::getenv("POECAL_FUZZ_PROGRAM");
  return given != nullptr ? given : POECAL_PROGRAM;
}

/// A command and the folders that it reads; what it writes goes into new/, and beside that into `own`.
struct Call {
  const char* arguments;
  std::vector<std::string> reads;
  std::string own = {};
};

const Call kCalls[] = {
    {"check capture", {"capture"}},
    {"check pictures --detect 2", {"pictures"}},
    {"measure capture --out new", {"capture"}},
    {"identify capture --out new --json", {"capture"}},
    {"identify --robot capture/cobot6.urdf --base-link base_link --tip-link flange --poses out/flange_poses.csv --registered --out new",
     {"out", "capture"}},
    {"diagnose capture --out new --json", {"capture"}},
    {"run capture --out new", {"capture"}},
    {"run pictures --out new", {"pictures"}},
    {"detect pictures --out new/detections.csv", {"pictures"}},
    {"detect pictures --known tables/1.corners --out new/detections.csv", {"tables", "pictures"}},
    {"intrinsics pictures/intrinsics --out new/camera.yaml", {"pictures"}},
    {"plan capture --model out/model.yaml --out new/next.csv --count 2 --candidates 20", {"capture", "out"}},
    {"plan capture --model out/model.yaml --out new/next.csv --count 2 --candidates 20 --separate", {"out"}},
    {"predict capture --model out/model.yaml --out new/corners.csv", {"capture", "out"}},
    {"predict --joints tables/joints.csv --model tables/model.yaml --out new/poses.csv", {"tables"}},
    {"compensate --model tables/model.yaml --joints tables/joints.csv --robot capture/cobot6.urdf --out new/commands.csv", {"tables"}},
    {"compensate --model tables/model.yaml --poses tables/wanted.csv --out new/commands.csv --leave-out", {"tables"}},
    {"export tables/model.yaml --urdf capture/cobot6.urdf --out new/arm.urdf --camera-info new/info.yaml --transforms new/tf.yaml "
     "--joint-table new/joints.csv --dh new/dh.yaml",
     {"tables", "capture"}},
    {"fleet out out --out new/fleet.csv --page new/fleet.html", {"out"}},
    {"report out", {"out"}, "out"},
    {"run capture --out out", {"capture", "out"}, "out"},
    {"simulate scene/scene.yaml --out new/capture", {"scene"}},
    {"new new/capture --robot capture/cobot6.urdf --base-link base_link --tip-link flange --target capture/target.yaml", {"capture"}},
};

const char* const kFolders[] = {"capture", "pictures", "out", "tables", "scene"};

/// A model with every effect that joints alone can show, at its usual size.
Model withEffects(Model model) {
  const std::map<std::string, double> of_their_own{{"order", 5.0}, {"source", 6.0}, {"time", 50.0}, {"seed", 3.0}};
  int joint = 0;
  for (const EffectKind& kind : effectKinds()) {
    if (kind.name == "target_layout" || kind.parameters.empty()) continue;  // one tag has no layout
    EffectSpec spec{.effect = kind.name, .location = placeName(kind.place), .parameters = {}, .driver = ""};
    if (isNumbered(kind.place)) spec.location += fmt::format(":{}", 2 + joint++ % 4);
    for (const EffectParameter& parameter : kind.parameters) {
      const auto own = of_their_own.find(parameter.name);
      spec.parameters[parameter.name] = own != of_their_own.end() ? own->second : parameter.typical;
    }
    model.effects.push_back(makeEffect(spec, model.cell));
  }
  return model;
}

/// Gives a table the columns that effects follow.
void addColumns(const fs::path& file) {
  std::vector<std::pair<std::string, std::string>> more{{"temperature", "21.5"}, {"payload", "1.5"}, {"stamp", "70"}};
  for (int k = 1; k <= 6; ++k) {
    more.emplace_back(fmt::format("dq{}", k), "0.01");
    more.emplace_back(fmt::format("dir{}", k), "1");
  }
  rewriteCsv(file, [&](Rows& rows) {
    for (const auto& [name, value] : more) {
      if (std::find(rows[0].begin(), rows[0].end(), name) != rows[0].end()) continue;
      for (std::size_t k = 0; k < rows.size(); ++k) rows[k].push_back(k == 0 ? name : value);
    }
  });
}

/// Everything that the calls read, made once.
const std::map<std::string, std::string>& wholeFolders() {
  static const std::map<std::string, std::string> files = [] {
    const TempFolder folder;
    simulateSmallCell(folder.path(), SmallCell::kCorners, 12);
    const TempFolder pictures;
    writeSmallScene(pictures.path(), SmallCell::kPictures, "intrinsics: {target: board.yaml, count: 2}\n", 3);
    runProgram(pictures.path(), "simulate scene/scene.yaml --out pictures");
    fs::copy(pictures.path() / "pictures", folder.path() / "pictures", fs::copy_options::recursive);
    const ProgramRun run = runProgram(folder.path(), "run capture --out out");
    if (run.status != 0) throw std::runtime_error("the capture is no good: " + run.err);
    runProgram(folder.path(), "predict capture --model out/model.yaml --out tables/wanted.csv --poses");
    fs::copy_file(folder.path() / "capture/samples.csv", folder.path() / "tables/joints.csv");
    runProgram(folder.path(), "detect pictures --part 1/1 --out tables/1.corners");
    for (const char* table : {"wanted.csv", "joints.csv"}) addColumns(folder.path() / "tables" / table);
    writeTextFile(folder.path() / "tables/model.yaml", modelYaml(withEffects(readModel(folder.path() / "out/model.yaml"))));
    fs::remove_all(folder.path() / "capture-truth");
    fs::remove(folder.path() / "stdout.txt");
    fs::remove(folder.path() / "stderr.txt");
    return contentOf(folder.path());
  }();
  return files;
}

bool isBelow(const std::string& name, const std::string& folder) { return name.starts_with(folder + "/"); }

/// Changes one file that the call reads, or puts something else in its place. @returns what was done.
std::string spoil(const fs::path& folder, const Call& call, Rng& rng) {
  std::vector<std::string> names, of_its_kind;
  for (const auto& [name, content] : wholeFolders()) {
    if (std::any_of(call.reads.begin(), call.reads.end(), [&, &file = name](const std::string& read) { return isBelow(file, read); })) {
      names.push_back(name);
    }
  }
  const std::string name = names[rng.below(names.size())];
  const fs::path file = folder / name;
  switch (rng.below(16)) {
    case 0:
      fs::remove(file);
      fs::create_directory(file);
      return name + " is a folder";
    case 1:
      fs::resize_file(file, 0);
      return name + " is empty";
    case 2:
      fs::remove(file);
      if (rng.below(2) == 0) fs::create_symlink(file.filename(), file);
      return name + " is not there, or a link to itself";
    case 3: {
      const std::string other = names[rng.below(names.size())];
      writeTextFile(file, wholeFolders().at(other));
      return name + " is " + other;
    }
    default:
      break;
  }
  for (const auto& [other, content] : wholeFolders()) {
    if (fs::path(other).extension() == file.extension()) of_its_kind.push_back(content);
  }
  const Mutator mutator(of_its_kind);
  std::string content = wholeFolders().at(name);
  for (std::size_t k = 0, changes = 1 + rng.below(3); k < changes; ++k) content = mutator.changed(content, rng);
  writeTextFile(file, content);
  return name + " is changed";
}

/// What is wrong with a file that the program wrote; empty where nothing is.
std::string problemOf(const fs::path& file) {
  const std::string kind = file.extension();
  if (kind == ".part") return "is left half written";
  try {
    const std::string text = readTextFile(file);
    if (kind == ".csv") CsvTable::read(file);
    if (kind == ".yaml") YAML::Load(text);
    if (kind == ".json" && !nlohmann::json::accept(text)) return "is no JSON";
    if (kind == ".html" && text.find("</html>") == std::string::npos) return "does not end";
    if (kind == ".urdf" && text.find("</robot>") == std::string::npos) return "does not end";
  } catch (const std::exception& error) {
    return std::string("is not whole: ") + error.what();
  }
  return "";
}

/// What the run did that it must not, one line each.
std::vector<std::string> faultsOf(const ProgramRun& run, const Call& call, const fs::path& folder,
                                  const std::map<std::string, std::string>& before) {
  std::vector<std::string> faults;
  if (!std::set{0, 2, 3, 4}.contains(run.status)) faults.push_back(fmt::format("status {}", run.status));
  for (const char* word : {"Sanitizer", "runtime error", "internal:", "terminate called"}) {
    if (run.err.find(word) != std::string::npos) faults.push_back(fmt::format("stderr says {}", word));
  }
  constexpr std::size_t kLongestLine = 1000, kLongestText = 30'000;
  if (printableText(run.err, kLongestLine) != run.err) faults.emplace_back("stderr holds what a terminal obeys, or long lines");
  if (printableText(run.out, kLongestText) != run.out) faults.emplace_back("stdout holds what a terminal obeys");
  if (run.err.size() > kLongestText) faults.emplace_back("stderr is long");
  if (run.status != 0 && run.err.empty() && run.out.empty()) faults.emplace_back("fails without a word");
  const std::map<std::string, std::string> after = contentOf(folder);
  for (const auto& [name, content] : before) {
    if (!call.own.empty() && isBelow(name, call.own)) continue;
    const auto found = after.find(name);
    if (found == after.end() || found->second != content) faults.push_back("changed its input " + name);
  }
  for (const auto& [name, content] : after) {
    const bool written = isBelow(name, "new") || (!call.own.empty() && isBelow(name, call.own) && before.count(name) == 0);
    const bool copied = name.find(".edited") != std::string::npos;  // what the change made of a result, kept for the person who made it
    const std::string problem = written && !copied ? problemOf(folder / name) : "";
    if (!problem.empty()) faults.push_back(name + " " + problem);
    if (!written && before.count(name) == 0 && name != "stdout.txt" && name != "stderr.txt") faults.push_back("wrote " + name);
  }
  return faults;
}

/// One trial in a fresh copy of the folders. @returns its faults.
std::vector<std::string> tryOne(const fs::path& folder, std::size_t number) {
  Rng rng(kSeed, number);
  const Call& call = kCalls[number % std::size(kCalls)];
  for (const char* name : kFolders) fs::remove_all(folder / name);
  fs::remove_all(folder / "new");
  for (const auto& [name, content] : wholeFolders()) {
    fs::create_directories((folder / name).parent_path());
    writeTextFile(folder / name, content);
  }
  const std::string change = spoil(folder, call, rng);
  fs::remove(folder / "stdout.txt");
  fs::remove(folder / "stderr.txt");
  const std::map<std::string, std::string> before = contentOf(folder);
  // A minute of processor time where seconds are usual: what takes longer hangs.
  const ProgramRun run = runShell(folder, fmt::format("ulimit -t 60 && '{}' --jobs 1 {}", program(), call.arguments));
  std::vector<std::string> faults = faultsOf(run, call, folder, before);
  for (std::string& fault : faults)
    fault = fmt::format("trial {}: {}: {}: {}\n{}", number, call.arguments, change, fault, run.err.substr(0, 3000));
  return faults;
}

class SpoiltFolders : public ::testing::TestWithParam<int> {};

TEST(WholeFolders, AreServed) {
  const TempFolder folder;
  for (std::size_t number = 0; number < std::size(kCalls); ++number) {
    for (const auto& [name, content] : wholeFolders()) writeTextFile(folder.path() / name, content);
    fs::remove_all(folder.path() / "new");
    const ProgramRun run = runProgram(folder.path(), kCalls[number].arguments);
    // What is too little of so small a capture is 4; whatever is refused as wrong would show nothing.
    EXPECT_TRUE(run.status == 0 || run.status == 4) << kCalls[number].arguments << "\n" << run.err;
  }
}

TEST_P(SpoiltFolders, AreRefusedOrServed) {
  const TempFolder folder;
  const std::size_t first = asked("POECAL_FUZZ_FIRST", 0), count = asked("POECAL_FUZZ_TRIALS", 120);
  for (std::size_t number = first + static_cast<std::size_t>(GetParam()); number < first + count; number += kParts) {
    const std::vector<std::string> faults = tryOne(folder.path(), number);
    EXPECT_THAT(faults, ::testing::IsEmpty());
    if (faults.empty()) continue;
    const fs::path kept = fs::path(::testing::TempDir()) / fmt::format("poecal-trial-{}", number);
    fs::remove_all(kept);
    fs::copy(folder.path(), kept, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  }
}

INSTANTIATE_TEST_SUITE_P(Part, SpoiltFolders, ::testing::Range(0, kParts));

}  // namespace
}  // namespace poecal::test
