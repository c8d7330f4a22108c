#include "identification/simulated_cell.hpp"

#include "support/random.hpp"

namespace poecal::test {

std::vector<Observation> observe(const Scene& scene, std::uint64_t seed, int count, double sigma) {
  Scene drawn = scene;
  drawn.seed = seed;
  drawn.count = count;
  drawn.repeats = 1;
  const SampleTable samples = drawSamples(drawn);
  Detections detections;
  detections.images = trueCorners(drawn, samples);
  Rng rng(seed, 99);
  for (ImageCorners& image : detections.images) {
    for (Corner& corner : image.corners) {
      corner.px += sigma * Eigen::Vector2d(rng.normal(), rng.normal());
      corner.sigma = kSigma;
    }
  }
  return cornerObservations(samples, detections, scene.target);
}

Simulated simulated(const std::string& name, std::uint64_t seed, int poses, int unseen) {
  Scene scene = readScene(std::filesystem::path(POECAL_SOURCE_DIR) / "calib_data" / name / "scene-corners.yaml");
  Rng rng(seed, 7);
  Eigen::VectorXd beta(twistParameterCount(scene.nominal));
  int column = 0;
  for (const Joint& joint : scene.nominal.joints) {
    for (int k = 0; k < twistParameterCount(joint); ++k) beta(column++) = (k < 2 ? 2e-3 : 6e-4) * rng.normal();
  }
  scene.actual = displaceTwists(scene.nominal, beta);
  Simulated result;
  result.truth.arm = scene.actual;
  result.truth.camera = scene.camera;
  result.truth.registration = scene.registration;
  result.nominal = result.truth;
  result.nominal.arm = scene.nominal;
  result.nominal.registration = Registration{};
  result.nominal.registration.setup = scene.registration.setup;
  result.target = scene.target;
  result.calibration = observe(scene, 1000 + seed, poses, kSigma);
  if (unseen > 0) result.unseen = observe(scene, 5000 + seed, unseen, 0.0);
  return result;
}

Measurements Simulated::measurements() const {
  Measurements measured;
  measured.setup = nominal.registration.setup;
  measured.target = target;
  measured.observations = calibration;
  for (std::size_t k = 0; k < calibration.size(); ++k) measured.groups.push_back({k});
  return measured;
}

IdentifyOptions plainBundle() {
  IdentifyOptions options;
  options.hold_out_every = 0;
  options.camera = CameraChoice::kStated;
  return options;
}

}  // namespace poecal::test
