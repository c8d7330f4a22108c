#include "poecal/simulation/scene.hpp"

#include <limits>

#include <fmt/format.h>

#include "capture/manifest.hpp"
#include "cell/transform_names.hpp"
#include "core/yaml.hpp"
#include "effects/effect_yaml.hpp"
#include "geometry/pose_yaml.hpp"
#include "poecal/capture/detections.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/random.hpp"
#include "poecal/core/text.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/robot/robot_file.hpp"
#include "simulation/streams.hpp"

namespace poecal {
namespace {

// Larger figures nobody means, and they fill the memory or keep the program for days.
constexpr int kMostSamples = 1'000'000, kMostBoards = 10'000;
constexpr double kLargestError = 1.0;           ///< of an axis [m], [rad]
constexpr double kLargestCornerSigma = 1000.0;  ///< [px]

double notNegative(const YamlNode& node, double largest) {
  const double value = node.number();
  if (value < 0.0 || value > largest) node.fail(fmt::format("is {}, expected 0 to {}", formatNumber(value), formatNumber(largest)));
  return value;
}

int integerWithin(const YamlNode& node, int smallest, int largest) {
  const int value = node.integer();
  if (value < smallest || value > largest) node.fail(fmt::format("is {}, expected {} to {}", value, smallest, largest));
  return value;
}

std::uint64_t seedOf(const YamlNode& node) { return static_cast<std::uint64_t>(integerWithin(node, 0, std::numeric_limits<int>::max())); }

/// The nominal arm with every axis a little off: normal tilts and shifts in the directions that move it.
Arm drawErrors(const YamlNode& errors, const Arm& nominal) {
  errors.checkKeys({"seed", "position", "rotation"});
  const double position = notNegative(errors["position"], kLargestError);
  const double rotation = notNegative(errors["rotation"], kLargestError);
  Rng rng(seedOf(errors["seed"]), streamOf(Purpose::kErrors));
  Eigen::VectorXd beta(twistParameterCount(nominal));
  Eigen::Index k = 0;
  for (const Joint& joint : nominal.joints) {
    // Columns of twistBasis: two tilts, then, for a revolute joint, two shifts.
    for (int column = 0; column < twistParameterCount(joint); ++column) beta(k++) = (column < 2 ? rotation : position) * rng.normal();
  }
  return displaceTwists(nominal, beta);
}

Arm readActual(const YamlNode& node, const Arm& nominal) {
  const Arm actual = readRobotYaml(namedFile(node));
  if (actual.jointCount() != nominal.jointCount()) {
    node.fail(fmt::format("has {} joints, expected {} as the robot", actual.jointCount(), nominal.jointCount()));
  }
  for (std::size_t k = 0; k < nominal.joints.size(); ++k) {
    if (actual.joints[k].type != nominal.joints[k].type) {
      node.fail(fmt::format("joint {} is of another type, expected that of the robot", k + 1));
    }
  }
  return actual;
}

void readArms(const YamlNode& root, Scene& scene) {
  const auto robot = readNamedRobot(root);
  if (!robot) root.fail("key 'robot' is missing, expected the nominal arm");
  scene.nominal = robot->arm;
  scene.robot_file = robot->file;
  scene.base_link = robot->base_link;
  scene.tip_link = robot->tip_link;
  scene.actual = scene.nominal;
  const auto errors = root.find("errors");
  const auto actual = root.find("actual");
  if (errors && actual) actual->fail("stands beside errors, expected one of the two");
  if (errors) scene.actual = drawErrors(*errors, scene.nominal);
  if (actual) scene.actual = readActual(*actual, scene.nominal);
}

Registration readRegistration(const YamlNode& root) {
  Registration registration;
  if (const auto setup = root.find("setup")) registration.setup = readSetup(*setup);
  const std::string near_key = nearName(registration), far_key = farName(registration);
  const YamlNode node = root["registration"];
  node.checkKeys({near_key.c_str(), far_key.c_str()});
  registration.T_camera_near = readPose(node[near_key.c_str()]);
  registration.T_far_target = readPose(node[far_key.c_str()]);
  return registration;
}

void readSamplesPart(const YamlNode& root, Scene& scene) {
  const auto samples = root.find("samples");
  if (!samples) return;
  if (const auto file = samples->find("file")) {
    samples->checkKeys({"file", "seed"});
    scene.samples_file = namedFile(*file);
  } else {
    samples->checkKeys({"count", "seed", "repeats"});
    if (const auto count = samples->find("count")) scene.count = integerWithin(*count, 1, kMostSamples);
    // The shots of all poses together.
    if (const auto repeats = samples->find("repeats")) scene.repeats = integerWithin(*repeats, 1, kMostSamples / scene.count);
  }
  if (const auto seed = samples->find("seed")) scene.seed = seedOf(*seed);
}

void readImage(const YamlNode& node, Scene& scene) {
  node.checkKeys({"blur", "noise", "like", "background"});
  ImageOptions& image = *scene.image;
  const auto blur = node.find("blur"), noise = node.find("noise");
  if (const auto like = node.find("like")) {
    if (blur || noise) like->fail(fmt::format("stands beside {}, expected one of the two", blur ? "blur" : "noise"));
    scene.looks = readPictureLooks(namedFile(*like));
  }
  if (blur) image.blur = notNegative(*blur, kLargestBlur);
  if (noise) image.noise = notNegative(*noise, kLargestNoise);
  if (const auto background = node.find("background")) image.background = background->text();
  try {
    image.validate();
  } catch (const InvalidArgument& error) {
    node.fail(error.what());
  }
}

/// How the corners reach the capture: pictures (the default) or detections, and pictures of a board for the intrinsics.
void readOutput(const YamlNode& root, Scene& scene) {
  const auto image = root.find("image");
  const auto corners = root.find("corners");
  if (image && corners) corners->fail("stands beside image, expected one of the two");
  if (corners) {
    corners->checkKeys({"sigma"});
    scene.corner_sigma = notNegative((*corners)["sigma"], kLargestCornerSigma);
  } else {
    scene.image.emplace();
    if (image) readImage(*image, scene);
    if (scene.target.type == TargetType::kPoints) {
      root["target"].fail("single points cannot be drawn, expected tags, a board, or corners: {sigma: ...}");
    }
  }
  if (const auto intrinsics = root.find("intrinsics")) {
    if (corners) intrinsics->fail("needs pictures, expected no corners: beside it");
    intrinsics->checkKeys({"target", "count"});
    const YamlNode target = (*intrinsics)["target"];
    scene.board = readTarget(namedFile(target));
    if (scene.board->type == TargetType::kPoints) target.fail("single points cannot be drawn, expected tags or a board");
    scene.board_count = integerWithin((*intrinsics)["count"], 1, kMostBoards);
  }
}

void readEffectsPart(const YamlNode& root, Scene& scene) {
  const auto list = root.find("effects");
  if (!list) return;
  scene.effects = readEffects(*list, {.arm = scene.actual, .camera = scene.camera, .registration = scene.registration});
  for (const AppliedEffect& applied : scene.effects) {
    if (scene.image && applied.effect.kind().moves_points) {
      list->fail(
          fmt::format("{} moves single points, which pictures cannot show, expected corners: {{sigma: ...}}", applied.effect.name()));
    }
  }
}

}  // namespace

void ImageOptions::validate() const {
  const auto check = [](const char* name, double value, double largest) {
    if (!(value >= 0.0 && value <= largest)) {
      throw InvalidArgument(fmt::format("{} is {}, expected 0 to {}", name, formatNumber(value), formatNumber(largest)));
    }
  };
  check("blur", blur, kLargestBlur);
  check("noise", noise, kLargestNoise);
  if (background != "clutter" && background != "plain") {
    throw InvalidArgument(fmt::format("background '{}' is not known, expected clutter or plain", background));
  }
}

ImageOptions imageOptions(const Scene& scene, std::size_t index) {
  ImageOptions options = *scene.image;
  if (scene.looks.empty()) return options;
  const PictureLook& look = scene.looks[index % scene.looks.size()];
  options.blur = look.blur;
  options.noise = look.noise;
  return options;
}

Scene readScene(const std::filesystem::path& file) {
  const YamlNode root = YamlNode::load(file);
  root.checkFormat("poecal-scene/1");
  root.checkKeys({"format", "name", "setup", "robot", "base_link", "tip_link", "errors", "actual", "camera", "stated", "target",
                  "stated_target", "registration", "samples", "effects", "image", "corners", "intrinsics"});
  Scene scene;
  scene.file = file;
  scene.name = file.stem().string();
  if (const auto name = root.find("name")) scene.name = name->text();
  readArms(root, scene);
  scene.camera = readCamera(namedFile(root["camera"]));
  if (ImageSize{scene.camera.width, scene.camera.height}.pixels() > kMostPixels) {
    root["camera"].fail(
        fmt::format("has {} x {} pixels, expected at most {} million", scene.camera.width, scene.camera.height, 1e-6 * kMostPixels));
  }
  scene.stated_camera = scene.camera;
  if (const auto stated = root.find("stated")) scene.stated_camera = readCamera(namedFile(*stated));
  scene.target = readTarget(namedFile(root["target"]));
  scene.stated_target = scene.target;
  if (const auto stated = root.find("stated_target")) scene.stated_target = readTarget(namedFile(*stated));
  scene.registration = readRegistration(root);
  readSamplesPart(root, scene);
  readOutput(root, scene);
  readEffectsPart(root, scene);
  return scene;
}

}  // namespace poecal
