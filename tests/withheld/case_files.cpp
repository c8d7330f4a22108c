// Writes cases as the folders that poecal reads, and their sealed answers.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "withheld/case.hpp"

namespace withheld {
namespace {

namespace fs = std::filesystem;

void writeText(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

std::string numbers(const Vector& v) { return fmt::format("[{:.12g}, {:.12g}, {:.12g}]", v.x(), v.y(), v.z()); }

std::string manifest(const std::string& name, bool in_hand, bool detections) {
  return fmt::format(
      "format: poecal-capture/1\nname: {}\nsetup: {}\nrobot: robot.yaml\ncamera: camera.yaml\ntarget: target.yaml\nsamples: "
      "samples.csv\n"
      "{}",
      name, in_hand ? "eye_in_hand" : "eye_to_hand", detections ? "detections: detections.csv\n" : "");
}

std::string robotYaml(const Case& made) {
  const Arm& arm = made.told.arm;
  const std::vector<Frame> frames = framesAtRest(arm);
  std::string text = fmt::format("format: poecal-robot/1\nname: {}\njoints:\n", arm.name);
  for (std::size_t k = 0; k < arm.size(); ++k) {
    const Joint& joint = arm.joints[k];
    text += fmt::format("  - {{name: joint_{}, type: {}, axis: {}, point: {}, limits: [{:.6g}, {:.6g}]}}\n", k + 1,
                        joint.slides ? "prismatic" : "revolute", numbers(frames[k].M.UnitZ()), numbers(frames[k].p), joint.low, joint.high);
  }
  double x = 0, y = 0, z = 0, w = 1;
  frames.back().M.GetQuaternion(x, y, z, w);
  text += fmt::format("flange: {{position: {}, quaternion_xyzw: [{:.15g}, {:.15g}, {:.15g}, {:.15g}]}}\n", numbers(frames.back().p), x, y,
                      z, w);
  if (made.told_masses) {
    text += "links:\n";
    for (std::size_t k = 0; k < arm.size(); ++k) {
      const Body& body = (*made.told_masses)[k];
      text += fmt::format("  - {{mass: {:.6g}, com: {}}}\n", body.mass, numbers(frames[k] * body.com));
    }
  }
  return text;
}

std::string cameraYaml(const Case& made) {
  const Lens& lens = made.told.lens;
  std::string text = fmt::format(
      "image_width: {}\nimage_height: {}\ncamera_name: withheld\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [{:.10g}, 0, {:.10g}, 0, "
      "{:.10g}, {:.10g}, 0, 0, 1]\n"
      "distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [{:.10g}, {:.10g}, {:.10g}, {:.10g}, 0]\n",
      lens.width, lens.height, lens.fx, lens.cx, lens.fy, lens.cy, lens.k1, lens.k2, lens.p1, lens.p2);
  if (made.lens_deviation) {
    const LensDeviation& d = *made.lens_deviation;
    text += fmt::format("standard_deviation: {{fx: {:.6g}, fy: {:.6g}, cx: {:.6g}, cy: {:.6g}, k1: {:.6g}, k2: {:.6g}}}\n", d.f, d.f, d.c,
                        d.c, d.k1, d.k2);
  }
  return text;
}

std::string targetYaml(const std::vector<Tag>& tags) {
  std::string text = "type: apriltag\nfamily: tag36h11\ntags:\n";
  for (const Tag& tag : tags) text += fmt::format("  - {{id: {}, size: {:.10g}, center: {}}}\n", tag.id, tag.size, numbers(tag.center));
  return text;
}

std::string samplesCsv(const std::vector<Shot>& shots, const Columns& columns) {
  const Eigen::Index n = shots.front().q.size();
  std::string text = "image";
  const auto heads = [&](const char* word) {
    for (Eigen::Index k = 0; k < n; ++k) text += fmt::format(",{}{}", word, k + 1);
  };
  heads("q");
  if (columns.pose) text += ",pose";
  if (columns.stamp) text += ",stamp";
  if (columns.dir) heads("dir");
  if (columns.dq || columns.still_dq) heads("dq");
  if (columns.temperature) text += ",temperature";
  if (columns.payload) text += ",payload";
  text += '\n';
  for (const Shot& shot : shots) {
    text += shot.image;
    for (const double q : shot.q) text += fmt::format(",{:.10g}", q);
    if (columns.pose) text += fmt::format(",{}", shot.pose);
    if (columns.stamp) text += fmt::format(",{:.3f}", shot.stamp);
    if (columns.dir) {
      for (const double dir : shot.dir) text += fmt::format(",{:g}", dir);
    }
    if (columns.dq || columns.still_dq) {
      for (const double dq : shot.dq) text += fmt::format(",{:.8g}", dq);
    }
    if (columns.temperature) text += fmt::format(",{:.4f}", shot.temperature);
    if (columns.payload) text += fmt::format(",{:g}", shot.payload);
    text += '\n';
  }
  return text;
}

void addCorner(std::string& text, const std::string& image, int tag, int corner, const Eigen::Vector2d& px, double sigma) {
  text += fmt::format("{},{},{},{:.6f},{:.6f}", image, tag, corner, px.x(), px.y());
  text += sigma > 0.0 ? fmt::format(",{:.4g}\n", sigma) : "\n";
}

std::string detectionsHead(bool sigma) { return sigma ? "image,tag,corner,u,v,sigma\n" : "image,tag,corner,u,v\n"; }

std::string detectionsCsv(const Case& made) {
  std::string text = detectionsHead(made.sigma_told);
  for (const Sighting& sighting : made.sightings) {
    for (int corner = 0; corner < 4; ++corner) {
      addCorner(text, made.shots[sighting.shot].image, sighting.tag, corner, sighting.pixels.col(corner),
                made.sigma_told ? made.noise.corner : 0.0);
    }
  }
  return text;
}

std::string unseenCsv(const Case& made) {
  std::string text = detectionsHead(false);
  Eigen::Index row = 0;
  for (const Shot& shot : made.unseen) {
    for (const Tag& tag : made.actual.tags) {
      for (int corner = 0; corner < 4; ++corner, row += 2) {
        addCorner(text, shot.image, tag.id, corner, made.unseen_corners.segment<2>(row), 0.0);
      }
    }
  }
  return text;
}

/// @param detections  no line in the manifest where there are none
void writeFolder(const fs::path& folder, const Case& made, const std::vector<Shot>& shots, const std::optional<std::string>& detections) {
  fs::create_directories(folder);
  writeText(folder / "capture.yaml", manifest(fmt::format("withheld-{:04}", made.number), made.told.in_hand, detections.has_value()));
  writeText(folder / "robot.yaml", robotYaml(made));
  writeText(folder / "camera.yaml", cameraYaml(made));
  writeText(folder / "target.yaml", targetYaml(made.told.tags));
  writeText(folder / "samples.csv", samplesCsv(shots, made.columns));
  if (detections) writeText(folder / "detections.csv", *detections);
}

void writePictures(const fs::path& folder, const Case& made) {
  fs::create_directories(folder / "images");
  const std::vector<Flaw> flaws = made.flaws();
  for (const Shot& shot : made.shots) drawPicture(made.actual, shot, flaws, *made.look, folder / shot.image);
}

std::string numbered(const Case& made) { return fmt::format("{:04}", made.number); }

nlohmann::ordered_json truth(const Case& made) {
  nlohmann::ordered_json json;
  json["set"] = made.set;
  json["seed"] = made.seed;
  json["number"] = made.number;
  json["family"] = made.family == Family::first ? "first" : "second";
  if (!made.recording.empty()) json["recording"] = made.recording;
  json["effects"] = nlohmann::ordered_json::array();
  for (const Hidden& hidden : made.hidden) {
    nlohmann::ordered_json effect = {{"effect", hidden.flaw.effect}, {"location", hidden.flaw.location}, {"driver", hidden.flaw.driver}};
    for (const Parameter& parameter : hidden.flaw.parameters) effect["parameters"][parameter.name] = parameter.value;
    effect["listed"] = hidden.listed;
    effect["S"] = hidden.S;
    effect["aliases"] = hidden.aliases;
    effect["close"] = hidden.close;
    effect["nearest"] = hidden.nearest;
    effect["left_by_nearest"] = hidden.left_by_nearest;
    json["effects"].push_back(effect);
  }
  if (made.unfindable) json["unfindable"] = made.unfindable->place();
  json["silent"] = made.silent;
  json["arm"] = made.told.arm.name;
  json["in_hand"] = made.told.in_hand;
  json["shots"] = made.shots.size();
  json["targets"] = made.told.tags.size();
  json["masses"] = made.told_masses.has_value();
  json["sigma"] = made.noise.corner;
  json["sigma_common"] = made.noise.common;
  json["repeatability"] = made.noise.repeatability;
  json["lens_deviation"] = made.lens_deviation.has_value();
  if (made.look) json["blur"] = made.look->blur;
  if (made.look) json["noise"] = made.look->noise;
  json["wild"] = made.wild;
  json["missing"] = made.missing;
  if (made.oracle_px) json["oracle_px"] = *made.oracle_px;
  if (!made.baselines.empty()) json["baselines"] = made.baselines;
  return json;
}

}  // namespace

void writeCase(const Case& made, const std::string& folder) {
  const fs::path root = fs::path(folder) / numbered(made);
  writeFolder(root / "capture", made, made.shots, made.look ? std::nullopt : std::optional(detectionsCsv(made)));
  if (made.look) writePictures(root / "capture", made);
  writeFolder(root / "unseen", made, made.unseen, unseenCsv(made));
  writeTruth(made, folder);
}

void writeTruth(const Case& made, const std::string& folder) {
  writeText(fs::path(folder) / (numbered(made) + ".truth.json"), truth(made).dump(2) + "\n");
}

}  // namespace withheld
