// How far corners are from the truth, and from the limit that the picture sets: AprilTag's, those after cv::cornerSubPix, and poecal's, on
// tags drawn by a renderer that shares no code with the refinement.
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "detection/tag_detector.hpp"
#include "detection/tag_refiner.hpp"
#include "poecal/core/parallel.hpp"
#include "support/exact_tag.hpp"

namespace poecal {
namespace {

constexpr const char* kFamily = "tag36h11";

/// What a tag is drawn with.
struct Conditions {
  double size = 0.0;   ///< [px]
  double blur = 0.0;   ///< [px]
  double noise = 0.0;  ///< [grey levels]
  bool aligned = false;
};

/// Errors of one tag; nothing where AprilTag did not find it.
struct TagErrors {
  Conditions conditions;
  test::Quad apriltag, subpixel, ours;
  double outward = 0.0;  ///< mean of ours away from the tag's centre [px]
  double limit = 0.0;    ///< trace of the Cramer-Rao covariance [px^2]
  bool refined = false;
};

test::TagScene sceneOf(const Conditions& conditions, Rng& rng) {
  test::TagScene scene;
  scene.id = static_cast<int>(rng.below(500));
  scene.blur = conditions.blur;
  const int width = static_cast<int>(1.9 * conditions.size) + 40;
  scene.size = {width, width};
  const Eigen::Vector2d centre = Eigen::Vector2d::Constant(0.5 * width) + Eigen::Vector2d(rng.uniform(), rng.uniform());
  const double angle = conditions.aligned ? M_PI_2 * static_cast<double>(rng.below(4)) : rng.uniform(-3.1, 3.1);
  scene.corners = test::tiltedSquare(centre, conditions.size, angle, conditions.aligned ? 0.0 : rng.uniform(0.0, 0.9));
  return scene;
}

test::Quad withCornerSubPix(const cv::Mat& picture, const test::Quad& corners) {
  std::vector<cv::Point2f> points;
  for (int k = 0; k < 4; ++k) points.emplace_back(static_cast<float>(corners(0, k)), static_cast<float>(corners(1, k)));
  cv::cornerSubPix(picture, points, {3, 3}, {-1, -1}, {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 40, 1e-3});
  test::Quad moved;
  for (int k = 0; k < 4; ++k) {
    moved.col(k) << static_cast<double>(points[static_cast<std::size_t>(k)].x), static_cast<double>(points[static_cast<std::size_t>(k)].y);
  }
  return moved;
}

std::optional<TagErrors> measure(const Conditions& conditions, std::uint64_t stream) {
  Rng rng(4, stream);
  const test::TagScene scene = sceneOf(conditions, rng);
  const cv::Mat picture = test::withNoise(test::exactPicture(scene), rng, conditions.noise);
  const std::vector<TagDetection> tags = TagDetector(kFamily).detect(picture, 2.0, true);
  if (tags.size() != 1 || tags.front().id != scene.id) return std::nullopt;
  const std::optional<TagFit> fit = TagRefiner(kFamily, true, std::nullopt).refine(picture, scene.id, tags.front().px);
  TagErrors errors;
  errors.conditions = conditions;
  errors.refined = fit.has_value();
  errors.apriltag = tags.front().px - scene.corners;
  errors.subpixel = withCornerSubPix(picture, tags.front().px) - scene.corners;
  errors.ours = (fit ? fit->px : tags.front().px) - scene.corners;
  const test::Quad from_centre = scene.corners.colwise() - scene.corners.rowwise().mean();
  errors.outward = errors.ours.cwiseProduct(from_centre.colwise().normalized()).sum() / 4.0;
  errors.limit = test::cornerLimit(scene, conditions.noise).trace();
  return errors;
}

/// One row over all tags of a kind.
void printRow(const std::string& name, const std::vector<TagErrors>& all, const std::function<bool(const Conditions&)>& chosen) {
  double apriltag = 0.0, subpixel = 0.0, ours = 0.0, limit = 0.0, outward = 0.0;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  int tags = 0, refined = 0;
  for (const TagErrors& errors : all) {
    if (!chosen(errors.conditions)) continue;
    ++tags;
    refined += errors.refined;
    apriltag += errors.apriltag.squaredNorm();
    subpixel += errors.subpixel.squaredNorm();
    ours += errors.ours.squaredNorm();
    limit += errors.limit;
    shift += errors.ours.rowwise().mean();
    outward += errors.outward;
  }
  if (tags == 0) return;
  const auto rms = [tags](double squares) { return std::sqrt(squares / (8.0 * tags)); };
  const double bias = std::max(shift.cwiseAbs().maxCoeff(), std::abs(outward)) / tags;
  fmt::print("| {} ({}) | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.2f} | {:.2f} | {:.4f} |\n", name,
             refined == tags ? fmt::format("{}", tags) : fmt::format("{}, {} refused", tags, tags - refined), rms(apriltag), rms(subpixel),
             rms(ours), rms(limit), std::sqrt(ours / apriltag), std::sqrt(ours / limit), bias);
}

int run(bool quick) {
  const std::vector<double> sizes = quick ? std::vector<double>{60.0} : std::vector<double>{40.0, 60.0, 80.0, 120.0, 160.0};
  const std::vector<double> blurs = quick ? std::vector<double>{0.7} : std::vector<double>{0.5, 0.8, 1.2};
  const std::vector<double> noises = quick ? std::vector<double>{2.0} : std::vector<double>{1.0, 2.0, 4.0};
  const int turned = quick ? 2 : 4, aligned = quick ? 1 : 2;
  std::vector<Conditions> list;
  for (const double size : sizes) {
    for (const double blur : blurs) {
      for (const double noise : noises) {
        for (int k = 0; k < turned + aligned; ++k) list.push_back({size, blur, noise, k >= turned});
      }
    }
  }
  std::vector<std::optional<TagErrors>> measured(list.size());
  parallelFor(list.size(), 0, [&](std::size_t k) { measured[k] = measure(list[k], k); });
  std::vector<TagErrors> all;
  for (const std::optional<TagErrors>& errors : measured) {
    if (errors) all.push_back(*errors);
  }
  fmt::print("Corners, rms per axis [px]; {} of {} tags found by AprilTag.\n\n", all.size(), list.size());
  fmt::print(
      "| tags | AprilTag | and cornerSubPix | poecal | Cramer-Rao limit | of AprilTag's | of the limit | bias "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const double size : sizes) printRow(fmt::format("{:.0f} px", size), all, [size](const Conditions& c) { return c.size == size; });
  for (const double blur : blurs) {
    printRow(fmt::format("blur {:.1f} px", blur), all, [blur](const Conditions& c) { return c.blur == blur; });
  }
  for (const double noise : noises) {
    printRow(fmt::format("noise {:.0f} grey levels", noise), all, [noise](const Conditions& c) { return c.noise == noise; });
  }
  printRow("along the pixels", all, [](const Conditions& c) { return c.aligned; });
  printRow("turned and tilted", all, [](const Conditions& c) { return !c.aligned; });
  printRow("all", all, [](const Conditions&) { return true; });
  fmt::print("\n");
  return 0;
}

}  // namespace
}  // namespace poecal

int main(int argc, char** argv) { return poecal::run(argc > 1 && std::strcmp(argv[1], "--quick") == 0); }
