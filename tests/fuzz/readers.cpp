#include "fuzz/readers.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "detection/picture.hpp"
#include "docs/page.hpp"
#include "poecal/calibration/check_capture.hpp"
#include "poecal/calibration/fleet.hpp"
#include "poecal/calibration/results.hpp"
#include "poecal/capture/capture.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/capture/row_order.hpp"
#include "poecal/cell/known_registration.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/printable.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/board_pictures.hpp"
#include "poecal/detection/detector.hpp"
#include "poecal/detection/known_corners.hpp"
#include "poecal/identification/model.hpp"
#include "poecal/planning/plan_files.hpp"
#include "poecal/report/fleet_page.hpp"
#include "poecal/report/report.hpp"
#include "poecal/robot/robot_file.hpp"
#include "poecal/simulation/scene.hpp"

namespace poecal::test {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = POECAL_SOURCE_DIR;

void write(const fs::path& file, std::string_view bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// What was read is written, and that is read again: what poecal says it wrote must be a file that it takes.
template <typename Read>
void readAgain(const fs::path& file, const std::string& text, const Read& read) {
  write(file, text);
  try {
    read(file);
  } catch (const Error& error) {
    throw Fault(fmt::format("what was written of it is not read: {}", error.what()));
  }
}

/// The reader of several files may refuse this one, and the next is still of interest.
template <typename Read>
void attempt(const Read& read) {
  try {
    read();
  } catch (const Error&) {
  }
}

const Arm& armOfCell() {
  static const Arm arm = [] {
    Arm made;
    made.name = "turn-and-slide";
    made.joints = {Joint::revolute("joint_1", Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()),
                   Joint::prismatic("joint_2", Eigen::Vector3d::UnitZ())};
    made.joints[0].limits = JointLimits{-2.8, 2.8};
    made.joints[1].limits = JointLimits{0.0, 0.2};
    made.gamma << 0.0, 0.0, 0.0, 0.25, 0.05, -0.02;
    return made;
  }();
  return arm;
}

const Target& targetOfCell() {
  static const Target target = apriltagTarget("tag36h11", {{.id = 7, .size = 0.08}, {.id = 8, .size = 0.08}});
  return target;
}

const Target& referenceOfCell() {
  static const Target reference = apriltagTarget("tag36h11", {{.id = 40, .size = 0.1}});
  return reference;
}

void readText(const fs::path& file) {
  attempt([&] { printableText(readUtf8File(file)); });
  const CsvTable table = CsvTable::read(file);
  for (std::size_t row = 0; row < table.rowCount(); ++row) table.findNumber(row, 0);
  if (table.rowCount() > 0) attempt([&] { table.integer(0, 0); });
}

void readRobot(const fs::path& file) {
  attempt([&] { readArm(file, "", ""); });
  const Arm arm = readRobotYaml(file);
  readAgain(file, robotYaml(arm), readRobotYaml);
}

void readUrdfAndWriteIt(const fs::path& file) {
  isUrdf(file);
  const UrdfEnds ends = urdfEnds(file);
  attempt([&] { readArm(file, "base_link", "tool0"); });
  const Arm arm = readUrdf(file, ends.root, ends.leaves.empty() ? "" : ends.leaves.front());
  readAgain(file.parent_path() / "of-urdf.yaml", robotYaml(arm), readRobotYaml);
  readAgain(file, correctedUrdf(file, ends.root, ends.leaves.front(), arm),
            [&](const fs::path& again) { readUrdf(again, ends.root, ends.leaves.front()); });
}

void readCameraAndWriteIt(const fs::path& file) {
  attempt([&] { readCameraOfPictures(file); });
  const Camera camera = readCamera(file);
  readAgain(file, cameraYaml(camera), readCamera);
}

void readTargetAndWriteIt(const fs::path& file) { readAgain(file, targetYaml(readTarget(file)), readTarget); }

void readAllOfCapture(const fs::path& folder) {
  checkCapture(folder);
  const Capture capture = readCapture(folder);
  poseGroups(capture.table.samples);
}

void readSamplesAndWriteThem(const fs::path& file) {
  attempt([&] { readSamples(file, 0, nullptr); });
  SampleTable table = readSamples(file, 2, &armOfCell());
  poseGroups(table.samples);
  const std::string text = samplesCsv(table);
  standInByRowOrder(table.samples);
  readAgain(file, text, [](const fs::path& again) { readSamples(again, 2, &armOfCell()); });
}

void readTables(const fs::path& file) {
  attempt([&] { readJoints(file, armOfCell()); });
  attempt([&] { readPoses(file, armOfCell()); });
  attempt([&] { readWantedPoses(file, armOfCell()); });
  const SampleTable table = readJointTable(file, armOfCell());
  if (!table.samples.empty()) {
    readAgain(file, samplesCsv(table), [](const fs::path& again) { readJointTable(again, armOfCell()); });
  }
}

void readCorners(const fs::path& file) {
  attempt([&] { readDetections(file, chessboardTarget(9, 6, 0.03), &targetOfCell()); });
  const ImageSize size{1280, 960};
  const Detections detections = readDetections(file, targetOfCell(), &referenceOfCell(), size);
  readAgain(file, detectionsCsv(detections),
            [&](const fs::path& again) { readDetections(again, targetOfCell(), &referenceOfCell(), size); });
}

void readModelAndWriteIt(const fs::path& file) { readAgain(file, modelYaml(readModel(file)), readModel); }

void readTransforms(const fs::path& file) {
  attempt([&] { readRegistration(file); });
  for (const Setup setup : {Setup::kEyeToHand, Setup::kEyeInHand}) {
    Registration registration;
    registration.setup = setup;
    attempt([&] { readKnownRegistration(file, registration); });
  }
  Registration registration;
  readKnownRegistration(file, registration);
}

void readResultsAndTellThem(const fs::path& folder) {
  const ResultSummary summary = readResults(folder);
  printableText(fleetText({summary}));
  readAgain(folder / "fleet.csv", fleetCsv({summary}), [](const fs::path& file) { CsvTable::read(file); });
  if (reportBuilt()) fleetHtml({summary}, folder / "fleet.html");
}

void readPlan(const fs::path& cell) {
  readResults(cell / "results");
  readPlanningCell({.capture = {cell, {}, {}, {}}, .model = cell / "results/model.yaml"});
}

void readReport(const fs::path& out) {
  fs::remove_all(out / ".stages");
  if (reportBuilt()) renderReport(out, 1);
}

/// Readers of pictures say what is wrong with one, and throw nothing.
void readOnePicture(const fs::path& file) {
  const Picture picture = readPicture(file);
  if (picture.grey.empty() == picture.problem.empty()) throw Fault("neither a picture nor why there is none, or both");
  if (!picture.problem.empty()) throw FileError(file, 0, picture.problem);
}

void readBoard(const fs::path& folder) {
  DetectOptions options;
  options.jobs = 1;
  readBoardPictures(folder, options);
}

void readKnown(const fs::path& file) {
  KnownCorners known(file);
  known.read(file);
  known.finish();
}

}  // namespace

const std::vector<Reader>& readers() {
  static const std::vector<Reader> all{
      {"text",
       "text.csv",
       {"poses.csv", "samples.csv"},
       "readTextFile readUtf8File",
       [](const fs::path& cell) { readText(cell / "text.csv"); }},
      {"robot",
       "fuzzed/robot.yaml",
       {"robot.yaml", "puma560/robot.yaml"},
       "readRobotYaml readArm",
       [](const fs::path& cell) { readRobot(cell / "fuzzed/robot.yaml"); }},
      {"urdf", "fuzzed/arm.urdf", {}, "readUrdf readArm", [](const fs::path& cell) { readUrdfAndWriteIt(cell / "fuzzed/arm.urdf"); }},
      {"camera",
       "fuzzed/camera.yaml",
       {"camera.yaml"},
       "readCamera readCameraOfPictures",
       [](const fs::path& cell) { readCameraAndWriteIt(cell / "fuzzed/camera.yaml"); }},
      {"target",
       "fuzzed/target.yaml",
       {"target.yaml", "target-points.yaml", "target-aprilgrid.yaml", "target-kalibr.yaml", "target-charuco.yaml",
        "target-chessboard.yaml"},
       "readTarget",
       [](const fs::path& cell) { readTargetAndWriteIt(cell / "fuzzed/target.yaml"); }},
      {"capture", "capture.yaml", {"capture.yaml"}, "readCapture", readAllOfCapture},
      {"samples",
       "fuzzed/samples.csv",
       {"samples.csv", "next.csv"},
       "readSamples",
       [](const fs::path& cell) { readSamplesAndWriteThem(cell / "fuzzed/samples.csv"); }},
      {"tables",
       "fuzzed/table.csv",
       {"joints.csv", "poses.csv", "wanted.csv", "flange_poses.csv"},
       "readJoints readJointTable readWantedPoses readPoses",
       [](const fs::path& cell) { readTables(cell / "fuzzed/table.csv"); }},
      {"detections",
       "fuzzed/detections.csv",
       {"detections.csv"},
       "readDetections",
       [](const fs::path& cell) { readCorners(cell / "fuzzed/detections.csv"); }},
      {"picture_looks",
       "fuzzed/looks.csv",
       {"detections-pictures.csv"},
       "readPictureLooks",
       [](const fs::path& cell) { readPictureLooks(cell / "fuzzed/looks.csv"); }},
      {"model",
       "fuzzed/model.yaml",
       {"model.yaml"},
       "readModel",
       [](const fs::path& cell) { readModelAndWriteIt(cell / "fuzzed/model.yaml"); }},
      {"registration",
       "fuzzed/registration.yaml",
       {"registration.yaml", "known.yaml"},
       "readRegistration readKnownRegistration",
       [](const fs::path& cell) { readTransforms(cell / "fuzzed/registration.yaml"); }},
      {"results_registration",
       "fuzzed/out/registration.yaml",
       {"registration.yaml"},
       "readResults",
       [](const fs::path& cell) { readResultsAndTellThem(cell / "fuzzed/out"); }},
      {"identification",
       "fuzzed/identified/identification.json",
       {"identification.json"},
       "readResults",
       [](const fs::path& cell) { readResultsAndTellThem(cell / "fuzzed/identified"); }},
      {"diagnosis",
       "fuzzed/diagnosed/diagnosis.json",
       {"diagnosis.json"},
       "readResults",
       [](const fs::path& cell) { readResultsAndTellThem(cell / "fuzzed/diagnosed"); }},
      {"plan", "results/diagnosis.json", {"diagnosis.json"}, "readPlanningCell readResults", readPlan},
      {"scene",
       "scene.yaml",
       {"scene.yaml", "scene-pictures.yaml"},
       "readScene",
       [](const fs::path& cell) { readScene(cell / "scene.yaml"); }},
      {"report",
       "fuzzed/page/report.json",
       {"report.json"},
       "renderReport",
       [](const fs::path& cell) { readReport(cell / "fuzzed/page"); }},
      {"picture", "fuzzed/picture.png", {}, "readPicture", [](const fs::path& cell) { readOnePicture(cell / "fuzzed/picture.png"); }},
      {"board", "board/0001.png", {}, "readBoardPictures", [](const fs::path& cell) { readBoard(cell / "board"); }, 20},
      {"known_corners", "fuzzed/known.corners", {}, "read", [](const fs::path& cell) { readKnown(cell / "fuzzed/known.corners"); }},
  };
  return all;
}

const Reader& readerNamed(const std::string& name) {
  const auto found = std::find_if(readers().begin(), readers().end(), [&](const Reader& reader) { return reader.name == name; });
  if (found == readers().end()) throw std::runtime_error("no reader is called '" + name + "'");
  return *found;
}

void writeCell(const fs::path& folder) {
  for (const Example& example : readPage(kSource / "calib_data/FORMATS.md").examples) write(folder / example.name, example.text);
  fs::copy_file(kSource / "calib_data/cobot6/cobot6.urdf", folder / "cobot6.urdf", fs::copy_options::overwrite_existing);
  fs::create_directories(folder / "fuzzed");
  Model model;
  model.cell.arm = armOfCell();
  model.cell.camera = readCamera(folder / "camera.yaml");
  model.target = readTarget(folder / "target.yaml");
  write(folder / "results/model.yaml", modelYaml(model));
  write(folder / "board/target.yaml", "type: apriltag\nfamily: tag36h11\ntags:\n  - {id: 12, size: 0.12}\n");
}

std::vector<Seed> seedsOf(const Reader& reader) {
  static const Page page = readPage(kSource / "calib_data/FORMATS.md");
  std::vector<Seed> seeds;
  for (const std::string& name : reader.examples) {
    const bool file = name.find('/') != std::string::npos;
    seeds.push_back({name, file ? readTextFile(kSource / "calib_data" / name) : page.example(name).text});
  }
  const fs::path corpus = kSource / "tests/fuzz/corpus" / reader.name;
  std::vector<fs::path> files;
  if (fs::exists(corpus)) files.assign(fs::directory_iterator(corpus), fs::directory_iterator());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) seeds.push_back({file.filename(), readTextFile(file)});
  return seeds;
}

bool feed(const Reader& reader, const fs::path& cell, std::string_view bytes) {
  write(cell / reader.file, bytes);
  try {
    reader.read(cell);
    return true;
  } catch (const Error& error) {
    const std::string text = error.what();
    if (error.exitStatus() == 2) throw Fault("a file is no wrong command line: " + text);
    if (!text.starts_with(cell.string())) throw Fault("does not name the file: " + text);
    if (printableLine(text) != text) throw Fault("is no line for a terminal: " + printableLine(text));
    return false;
  }
}

}  // namespace poecal::test
