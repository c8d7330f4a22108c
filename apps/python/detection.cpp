// Corners from pictures: of a capture, of any pictures, and of a board that a lens is found from.
#include "poecal/detection/detect_capture.hpp"

#include "binding.hpp"
#include "poecal/camera/intrinsics.hpp"
#include "poecal/cell/measurements.hpp"
#include "poecal/detection/board_pictures.hpp"
#include "poecal/detection/detector.hpp"
#include "poecal/detection/known_corners.hpp"

namespace poecal::python {
namespace {

void bindCorners(py::module_& module) {
  Struct<PictureLook>(module, "PictureLook",
                      "What a picture looks like: blur [px] and noise [grey levels of 255], 1 sigma; growth of dark into light [px].")
      .made()
      .member("blur", &PictureLook::blur)
      .member("noise", &PictureLook::noise)
      .member("growth", &PictureLook::growth);
  Struct<ImageCorners>(module, "ImageCorners", "The corners of one picture, sorted by id.")
      .made()
      .member("image", &ImageCorners::image)
      .member("corners", &ImageCorners::corners)
      .member("look", &ImageCorners::look);
  Struct<Detections>(module, "Detections", "Pictures in the order of the capture, with their corners.")
      .made()
      .member("images", &Detections::images)
      .def("find", &Detections::find, py::arg("image"), py::return_value_policy::copy, "A picture's corners; None where it is not there.");
  module.def(
      "readDetections", [](const std::filesystem::path& file, const Target& target) { return readDetections(file, target); },
      py::arg("file"), py::arg("target"), "Reads detections.csv.");
  module.def("detectionsCsv", detectionsCsv, py::arg("detections"), "Text of detections.csv.");
  module.def("picturesCsv", picturesCsv, py::arg("detections"), "Text of detections-pictures.csv: a row for each picture that has a look.");
  module.def("readPictureLooks", readPictureLooks, py::arg("file"), "Reads a table of looks, as picturesCsv() writes it.");
  module.def("medianLook", medianLook, py::arg("looks"), "The median of each figure by itself; None where there are no looks.");
  module.def("measurementsOf", py::overload_cast<const Capture&, const Detections&>(measurementsOf), py::arg("capture"),
             py::arg("detections"), "The corners of a capture, for calibrate().");
}

void bindDetector(py::module_& module) {
  Struct<DetectOptions>(module, "DetectOptions", "Options of a detection; the result does not depend on `jobs`.")
      .made()
      .member("jobs", &DetectOptions::jobs)
      .member("quad_decimate", &DetectOptions::quad_decimate)
      .member("refine", &DetectOptions::refine)
      .member("camera", &DetectOptions::camera)
      .member("expected_width", &DetectOptions::expected_width)
      .member("expected_height", &DetectOptions::expected_height)
      .member("other_tags", &DetectOptions::other_tags)
      .member("progress", &DetectOptions::progress);
  Struct<PictureNote>(module, "PictureNote", "A remark about one picture; `failed`: no corners came from it.")
      .result("image", &PictureNote::image)
      .result("message", &PictureNote::message)
      .result("failed", &PictureNote::failed)
      .def("text", &PictureNote::text, "\"image: message\".");
  Struct<DetectResult>(module, "DetectResult", "Corners of each picture in the order given, remarks, and the pictures' size [px].")
      .result("detections", &DetectResult::detections)
      .result("notes", &DetectResult::notes)
      .result("width", &DetectResult::width)
      .result("height", &DetectResult::height);
  py::class_<KnownCorners>(module, "KnownCorners", "Corners found before, kept in a file: no picture is searched twice.")
      .def(py::init<const std::filesystem::path&>(), py::arg("file"))
      .def("read", &KnownCorners::read, py::arg("file"), "Takes in what another such file knows.")
      .def("finish", &KnownCorners::finish, "Rewrites the file with what was asked for or added alone, sorted.")
      .def("reused", &KnownCorners::reused, "How many pictures were not searched again.");
}

void bindBoards(py::module_& module) {
  Struct<BoardView>(module, "BoardView", "A board's points in one picture: 3 x N p_target [m], 2 x N pixels [px], N sigmas [px] or none.")
      .made()
      .member("image", &BoardView::image)
      .member("points", &BoardView::points)
      .member("pixels", &BoardView::pixels)
      .member("sigmas", &BoardView::sigmas);
  Struct<BoardPictures>(module, "BoardPictures", "A folder of pictures of a board: a view each, remarks, and the pictures' size [px].")
      .result("target", &BoardPictures::target)
      .result("views", &BoardPictures::views)
      .result("notes", &BoardPictures::notes)
      .result("width", &BoardPictures::width)
      .result("height", &BoardPictures::height);
  module.def(
      "calibrateIntrinsics",
      [](const std::vector<BoardView>& views, int width, int height, const IntrinsicsOptions& options) {
        return calibrateIntrinsics(views, width, height, stoppable(options));
      },
      py::arg("views"), py::arg("width"), py::arg("height"), py::arg_v("options", IntrinsicsOptions(), "IntrinsicsOptions()"), Unlocked(),
      "Fits a camera and one board pose per picture.");
}

}  // namespace

void bindDetection(py::module_& module) {
  bindCorners(module);
  bindDetector(module);
  bindBoards(module);
  using Path = std::filesystem::path;
  const auto options = [] { return py::arg_v("options", DetectOptions(), "DetectOptions()"); };
  module.def(
      "detect",
      [](const Path& folder, const std::vector<std::string>& images, const Target& target, const DetectOptions& how, KnownCorners* known) {
        return detect(folder, images, target, stoppable(how), known);
      },
      py::arg("folder"), py::arg("images"), py::arg("target"), options(), py::arg("known") = py::none(), Unlocked(),
      "Corners of the target in each of the pictures, which are named from the folder.");
  module.def(
      "detectCapture",
      [](const Capture& capture, const DetectOptions& how, KnownCorners* known) { return detectCapture(capture, stoppable(how), known); },
      py::arg("capture"), options(), py::arg("known") = py::none(), Unlocked(),
      "Corners of the target in the picture of every sample, and of the reference where there is one.");
  module.def("takeSizeFromPictures", takeSizeFromPictures, py::arg("capture"), Unlocked(),
             "Gives the camera of a file without a size that of the capture's first picture.");
  module.def(
      "readBoardPictures",
      [](const Path& folder, const DetectOptions& how, KnownCorners* known) { return readBoardPictures(folder, stoppable(how), known); },
      py::arg("folder"), options(), py::arg("known") = py::none(), Unlocked(),
      "Finds the target of folder/target.yaml in every picture of the folder.");
  module.def("texts", texts, py::arg("notes"), "\"image: message\" of each remark.");
  module.def("listPictures", listPictures, py::arg("folder"), "Names of a folder's pictures, sorted.");
  module.def("knownFamilies", knownFamilies, "Families of tags that can be detected.");
}

}  // namespace poecal::python
