// Cells whose truth is known: scenes, captures drawn of them, and single pictures.
#include "poecal/simulation/simulate.hpp"

#include <algorithm>
#include <cstdint>

#include <opencv2/core.hpp>

#include "binding.hpp"
#include "poecal/simulation/renderer.hpp"

namespace poecal::python {
namespace {

py::array_t<std::uint8_t> arrayOf(const cv::Mat& picture) {
  py::array_t<std::uint8_t> pixels({picture.rows, picture.cols});
  for (int row = 0; row < picture.rows; ++row) std::copy_n(picture.ptr(row), picture.cols, pixels.mutable_data(row, 0));
  return pixels;
}

py::array_t<std::uint8_t> renderedTarget(const Camera& camera, const Target& target, const Eigen::Isometry3d& T_camera_target,
                                         const ImageOptions& options, std::uint64_t seed, std::uint64_t stream) {
  cv::Mat picture;
  {
    const py::gil_scoped_release unlocked;
    picture = renderTarget(camera, target, T_camera_target, options, seed, stream);
  }
  return arrayOf(picture);
}

void bindScene(py::module_& module) {
  Struct<ImageOptions>(module, "ImageOptions",
                       "How pictures are drawn: blur [px] and noise [grey levels of 255], 1 sigma; background \"clutter\" or \"plain\".")
      .made()
      .member("blur", &ImageOptions::blur)
      .member("noise", &ImageOptions::noise)
      .member("background", &ImageOptions::background);
  Struct<Scene>(module, "Scene", "A cell whose truth is known: what is true, what the capture is told, and what is drawn.")
      .made()
      .member("file", &Scene::file)
      .member("name", &Scene::name)
      .member("nominal", &Scene::nominal)
      .member("robot_file", &Scene::robot_file)
      .member("base_link", &Scene::base_link)
      .member("tip_link", &Scene::tip_link)
      .member("actual", &Scene::actual)
      .member("camera", &Scene::camera)
      .member("stated_camera", &Scene::stated_camera)
      .member("target", &Scene::target)
      .member("stated_target", &Scene::stated_target)
      .member("registration", &Scene::registration)
      .member("effects", &Scene::effects)
      .member("count", &Scene::count)
      .member("seed", &Scene::seed)
      .member("repeats", &Scene::repeats)
      .member("samples_file", &Scene::samples_file)
      .member("image", &Scene::image)
      .member("looks", &Scene::looks)
      .member("corner_sigma", &Scene::corner_sigma)
      .member("board", &Scene::board)
      .member("board_count", &Scene::board_count);
  module.def("readScene", readScene, py::arg("file"), "Reads scene.yaml.");
  module.def("imageOptions", imageOptions, py::arg("scene"), py::arg("index"), "How a scene's picture of this number is drawn.");
}

}  // namespace

void bindSimulation(py::module_& module) {
  bindScene(module);
  Struct<SimulateOptions>(module, "SimulateOptions", "Options of a simulation; the result does not depend on `jobs`.")
      .made()
      .member("jobs", &SimulateOptions::jobs)
      .member("progress", &SimulateOptions::progress);
  Struct<SimulateSummary>(module, "SimulateSummary", "What a simulation wrote; `truth` is the truth's folder.")
      .result("poses", &SimulateSummary::poses)
      .result("samples", &SimulateSummary::samples)
      .result("without_target", &SimulateSummary::without_target)
      .result("corners", &SimulateSummary::corners)
      .result("pictures", &SimulateSummary::pictures)
      .result("boards", &SimulateSummary::boards)
      .result("truth", &SimulateSummary::truth);
  module.def(
      "drawSamples", [](const Scene& scene, const SimulateOptions& how) { return drawSamples(scene, stoppable(how)); }, py::arg("scene"),
      py::arg_v("options", SimulateOptions(), "SimulateOptions()"), Unlocked(),
      "Joint readings of a scene [rad] or [m]: from its file, or drawn within the limits with the target in view.");
  module.def("trueCorners", trueCorners, py::arg("scene"), py::arg("samples"), Unlocked(),
             "Exact corners at each sample [px], with the scene's effects.");
  module.def(
      "simulate",
      [](const Scene& scene, const std::filesystem::path& capture, const SimulateOptions& how) {
        return simulate(scene, capture, stoppable(how));
      },
      py::arg("scene"), py::arg("capture"), py::arg_v("options", SimulateOptions(), "SimulateOptions()"), Unlocked(),
      "Writes the capture folder, and its truth beside it in the folder CAPTURE-truth.");
  module.def("renderTarget", renderedTarget, py::arg("camera"), py::arg("target"), py::arg("T_camera_target"),
             py::arg_v("options", ImageOptions(), "ImageOptions()"), py::arg("seed") = 1, py::arg("stream") = 0,
             "A grey picture of the target, height x width of 0..255; seed and stream are of its background and noise.");
}

}  // namespace poecal::python
