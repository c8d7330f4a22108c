#include "poecal/simulation/simulate.hpp"

#include <functional>
#include <system_error>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "cell/transform_names.hpp"
#include "core/yaml.hpp"
#include "effects/effect_yaml.hpp"
#include "geometry/pose_yaml.hpp"
#include "poecal/core/content_key.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/parallel.hpp"
#include "poecal/core/progress.hpp"
#include "poecal/core/random.hpp"
#include "poecal/core/text.hpp"
#include "poecal/robot/robot_file.hpp"
#include "poecal/simulation/renderer.hpp"
#include "simulation/board_poses.hpp"
#include "simulation/streams.hpp"
#include "simulation/true_cell.hpp"

namespace poecal {
namespace {

/// Everything that the files are made of; nothing is written before all of it is there.
struct Simulation {
  const Scene& scene;
  SampleTable samples;
  std::vector<Disturbance> disturbances;          ///< by the scene's effects, one entry per sample
  std::vector<ImageCorners> corners;              ///< exact, one entry per sample
  std::vector<Eigen::Isometry3d> T_camera_board;  ///< of the intrinsics pictures
};

/// In the capture folder while it is being written: the key of what is drawn there.
constexpr const char* kUnfinished = ".unfinished";

bool isEmpty(const std::filesystem::path& folder) {
  std::error_code status;
  for (const auto& entry : std::filesystem::directory_iterator(folder, status)) {
    // A program that was killed in its first moment leaves a part of the mark alone.
    if (entry.path().filename() != std::string(kUnfinished) + ".part") return false;
  }
  return !status;
}

void requireEmpty(const std::filesystem::path& folder) {
  std::error_code status;
  const std::filesystem::file_type type = std::filesystem::status(folder, status).type();
  if (type == std::filesystem::file_type::not_found) return;
  if (type != std::filesystem::file_type::directory || !isEmpty(folder)) {
    throw FileError(folder, 0, "is there already and not empty, expected a new folder");
  }
}

/// The folder's name without a slash at its end, so that -truth can follow it.
std::filesystem::path plainPath(const std::filesystem::path& folder) {
  const std::filesystem::path normal = folder.lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

/// Draws a picture where it is not there yet: one that a killed program wrote is whole.
void writePicture(const std::filesystem::path& file, const std::function<cv::Mat()>& draw) {
  std::error_code status;
  if (std::filesystem::is_regular_file(file, status)) return;
  std::vector<unsigned char> png;
  cv::imencode(".png", draw(), png);
  writeTextFile(file, std::string(png.begin(), png.end()));
}

std::string boardPictureName(std::size_t index) { return fmt::format("{:04}.png", index); }

void writePictures(const Simulation& simulation, const std::filesystem::path& folder, const SimulateOptions& options) {
  const Scene& scene = simulation.scene;
  const Cell cell = trueCell(scene);
  Progress progress(options.progress, "drawing", simulation.samples.samples.size());
  parallelFor(simulation.samples.samples.size(), options.jobs, [&](std::size_t k) {
    const Sample& sample = simulation.samples.samples[k];
    const Disturbance& disturbance = simulation.disturbances[k];
    writePicture(folder / sample.image, [&] {
      return renderTarget(disturbedCamera(cell, disturbance), scene.target, disturbedTarget(cell, sample, disturbance),
                          imageOptions(scene, k), scene.seed, streamOf(Purpose::kPicture, k));
    });
    progress.advance();
  });
}

void writeBoardPictures(const Simulation& simulation, const std::filesystem::path& folder, const SimulateOptions& options) {
  const Scene& scene = simulation.scene;
  Progress progress(options.progress, "drawing boards", simulation.T_camera_board.size());
  parallelFor(simulation.T_camera_board.size(), options.jobs, [&](std::size_t k) {
    writePicture(folder / boardPictureName(k), [&] {
      return renderTarget(scene.camera, *scene.board, simulation.T_camera_board[k], imageOptions(scene, k), scene.seed,
                          streamOf(Purpose::kBoardPicture, k));
    });
    progress.advance();
  });
  writeTextFile(folder / "target.yaml", targetYaml(*scene.board));
}

/// The exact corners with normal noise on each coordinate.
Detections noisyCorners(const Simulation& simulation) {
  Detections detections{simulation.corners};
  for (std::size_t k = 0; k < detections.images.size(); ++k) {
    Rng rng(simulation.scene.seed, streamOf(Purpose::kCornerNoise, k));
    for (Corner& corner : detections.images[k].corners) {
      const double du = rng.normal();
      const double dv = rng.normal();
      corner.px += *simulation.scene.corner_sigma * Eigen::Vector2d(du, dv);
      corner.sigma = *simulation.scene.corner_sigma;
    }
  }
  return detections;
}

/// A URDF keeps its name; robot.yaml is robot.yaml in every capture.
std::string robotName(const Scene& scene) { return scene.base_link.empty() ? "robot.yaml" : scene.robot_file.filename().string(); }

std::string captureYaml(const Scene& scene) {
  std::string text = fmt::format("format: poecal-capture/1\nname: {}\nsetup: {}\nrobot: {}\n", yamlText(scene.name),
                                 setupName(scene.registration.setup), yamlText(robotName(scene)));
  if (!scene.base_link.empty()) text += fmt::format("base_link: {}\ntip_link: {}\n", yamlText(scene.base_link), yamlText(scene.tip_link));
  text += scene.board ? "intrinsics: intrinsics\n" : "camera: camera.yaml\n";
  text += "target: target.yaml\nsamples: samples.csv\n";
  if (scene.corner_sigma) text += "detections: detections.csv\n";
  return text;
}

void writeCapture(const Simulation& simulation, const std::filesystem::path& folder, const SimulateOptions& options) {
  const Scene& scene = simulation.scene;
  if (scene.image) {
    writePictures(simulation, folder, options);
  } else {
    writeTextFile(folder / "detections.csv", detectionsCsv(noisyCorners(simulation)));
  }
  if (scene.board) {
    writeBoardPictures(simulation, folder / "intrinsics", options);
  } else {
    writeTextFile(folder / "camera.yaml", cameraYaml(scene.stated_camera));
  }
  writeTextFile(folder / robotName(scene), readTextFile(scene.robot_file));
  writeTextFile(folder / "target.yaml", targetYaml(scene.stated_target));
  writeTextFile(folder / "samples.csv", samplesCsv(simulation.samples));
  writeTextFile(folder / "capture.yaml", captureYaml(scene));
}

std::string truthYaml(const Scene& scene) {
  const Registration& registration = scene.registration;
  std::string text = fmt::format("format: poecal-truth/1\nname: {}\nsetup: {}\n", yamlText(scene.name), setupName(registration.setup));
  text += fmt::format("registration:\n  {}: {}\n  {}: {}\n", nearName(registration), yamlPose(registration.T_camera_near),
                      farName(registration), yamlPose(registration.T_far_target));
  text += fmt::format("seed: {}\n", scene.seed) + effectsYaml(scene.effects);
  if (scene.image && !scene.looks.empty()) {
    text += fmt::format("image: {{like: pictures.csv, background: {}}}\n", scene.image->background);
  } else if (scene.image) {
    text += fmt::format("image: {{blur: {}, noise: {}, background: {}}}\n", formatNumber(scene.image->blur),
                        formatNumber(scene.image->noise), scene.image->background);
  } else {
    text += fmt::format("corners: {{sigma: {}}}\n", formatNumber(*scene.corner_sigma));
  }
  return text;
}

/// The samples with the joints that the arm really had.
SampleTable trueSamples(const Simulation& simulation) {
  SampleTable table = simulation.samples;
  for (std::size_t k = 0; k < table.samples.size(); ++k) {
    const Eigen::VectorXd& offsets = simulation.disturbances[k].joints;
    if (offsets.size() > 0) table.samples[k].q += offsets;
  }
  return table;
}

/// Exact corners of the intrinsics pictures.
Detections boardCorners(const Simulation& simulation) {
  const Scene& scene = simulation.scene;
  Detections detections;
  for (std::size_t k = 0; k < simulation.T_camera_board.size(); ++k) {
    Cell cell;
    cell.camera = scene.camera;
    cell.registration.T_camera_near = simulation.T_camera_board[k];
    detections.images.push_back({boardPictureName(k), predictCorners(cell, *scene.board, Eigen::Isometry3d::Identity())});
  }
  return detections;
}

/// What each picture is drawn with.
Detections drawnLooks(const Simulation& simulation) {
  Detections looks{simulation.corners};
  for (std::size_t k = 0; k < looks.images.size(); ++k) {
    const ImageOptions options = imageOptions(simulation.scene, k);
    looks.images[k].look = PictureLook{.blur = options.blur, .noise = options.noise, .growth = 0.0};
  }
  return looks;
}

void writeTruth(const Simulation& simulation, const std::filesystem::path& folder) {
  const Scene& scene = simulation.scene;
  writeTextFile(folder / "actual.yaml", robotYaml(scene.actual));
  writeTextFile(folder / "camera.yaml", cameraYaml(scene.camera));
  writeTextFile(folder / "target.yaml", targetYaml(scene.target));
  writeTextFile(folder / "corners.csv", detectionsCsv({simulation.corners}));
  writeTextFile(folder / "samples.csv", samplesCsv(trueSamples(simulation)));
  if (!scene.looks.empty()) writeTextFile(folder / "pictures.csv", picturesCsv(drawnLooks(simulation)));
  if (scene.board) writeTextFile(folder / "intrinsics_corners.csv", detectionsCsv(boardCorners(simulation)));
  writeTextFile(folder / "truth.yaml", truthYaml(scene));
}

/// Of everything that the files are made of.
std::string keyOf(const Simulation& simulation) {
  const Scene& scene = simulation.scene;
  ContentKey key;
  key.add(captureYaml(scene)).add(truthYaml(scene)).add(robotYaml(scene.actual)).add(readTextFile(scene.robot_file));
  key.add(cameraYaml(scene.camera)).add(cameraYaml(scene.stated_camera)).add(targetYaml(scene.target)).add(targetYaml(scene.stated_target));
  key.add(samplesCsv(simulation.samples)).add(detectionsCsv({simulation.corners}));
  if (scene.board) key.add(targetYaml(*scene.board)).add(std::to_string(scene.board_count));
  if (!scene.looks.empty()) key.add(picturesCsv(drawnLooks(simulation)));
  return key.text() + "\n";
}

/// Whether a killed program has begun to write there.
bool isBegun(const std::filesystem::path& folder) {
  std::error_code status;
  return std::filesystem::is_regular_file(folder / kUnfinished, status);
}

SimulateSummary summaryOf(const Simulation& simulation) {
  SimulateSummary summary;
  summary.poses = poseGroups(simulation.samples.samples).size();
  summary.samples = simulation.samples.samples.size();
  for (const ImageCorners& image : simulation.corners) {
    summary.corners += image.corners.size();
    summary.without_target += image.corners.empty() ? 1 : 0;
  }
  summary.pictures = simulation.scene.image.has_value();
  summary.boards = simulation.T_camera_board.size();
  return summary;
}

}  // namespace

SimulateSummary simulate(const Scene& scene, const std::filesystem::path& capture, const SimulateOptions& options) {
  const std::filesystem::path folder = plainPath(capture);
  const std::filesystem::path truth = folder.string() + "-truth";
  const bool begun = isBegun(folder);
  if (!begun) {
    requireEmpty(folder);
    requireEmpty(truth);
  }
  Simulation simulation{.scene = scene, .samples = drawSamples(scene, options), .disturbances = {}, .corners = {}, .T_camera_board = {}};
  simulation.disturbances = trueDisturbances(scene, simulation.samples.samples);
  simulation.corners = trueCorners(scene, simulation.samples);
  if (scene.board) simulation.T_camera_board = drawBoardPoses(scene.camera, *scene.board, scene.board_count, scene.seed);
  const std::string key = keyOf(simulation);
  if (begun && readTextFile(folder / kUnfinished) != key) {
    throw FileError(folder, 0, "holds what is unfinished of another scene, expected a new folder");
  }
  if (!begun) writeTextFile(folder / kUnfinished, key);
  writeTruth(simulation, truth);
  writeCapture(simulation, folder, options);
  std::filesystem::remove(folder / kUnfinished);
  SimulateSummary summary = summaryOf(simulation);
  summary.truth = truth;
  return summary;
}

}  // namespace poecal
