// The next poses worth taking, from results in files or in memory.
#include "poecal/planning/plan.hpp"

#include "binding.hpp"
#include "poecal/planning/plan_files.hpp"

namespace poecal::python {
namespace {

void bindPlanningCell(py::module_& module) {
  Struct<PlanNoise>(module, "PlanNoise",
                    "Noise of the pictures to come, 1 sigma: of a corner and of a whole tag [px], of each joint's repeats [rad].")
      .made()
      .member("corner", &PlanNoise::corner)
      .member("tag", &PlanNoise::tag)
      .member("repeatability", &PlanNoise::repeatability);
  Struct<Rival>(module, "Rival", "An explanation that a diagnosis left open.")
      .made()
      .member("effect", &Rival::effect)
      .member("location", &Rival::location)
      .member("driver", &Rival::driver)
      .member("probability", &Rival::probability);
  Struct<Rivals>(module, "Rivals", "Explanations of one finding of which one is right; the finding itself is the first.")
      .made()
      .member("explanations", &Rivals::explanations)
      .member("separate_with", &Rivals::separate_with);
  Struct<PlanningCell>(
      module, "PlanningCell",
      "A cell and all that is known of it before the poses that are planned; positions in [m], rotations in [rad], 1 sigma.")
      .made()
      .member("nominal", &PlanningCell::nominal)
      .member("model", &PlanningCell::model)
      .member("target", &PlanningCell::target)
      .member("taken", &PlanningCell::taken)
      .member("robot_file", &PlanningCell::robot_file)
      .member("noise", &PlanningCell::noise)
      .member("tolerance_position", &PlanningCell::tolerance_position)
      .member("tolerance_rotation", &PlanningCell::tolerance_rotation)
      .member("arm_beyond_tolerance", &PlanningCell::arm_beyond_tolerance)
      .member("rough_position", &PlanningCell::rough_position)
      .member("rough_rotation", &PlanningCell::rough_rotation)
      .member("open", &PlanningCell::open);
}

void bindSources(py::module_& module) {
  Struct<PlanSource>(module, "PlanSource", "A capture, and the model.yaml that was found from it.")
      .made()
      .member("capture", &PlanSource::capture)
      .member("model", &PlanSource::model);
  Struct<FirstCapture>(module, "FirstCapture",
                       "Before the first picture: files, and where camera and target roughly are [m], [rad]: in base and in flange; eye "
                       "in hand: in flange and in base.")
      .made()
      .member("robot", &FirstCapture::robot)
      .member("camera", &FirstCapture::camera)
      .member("target", &FirstCapture::target)
      .member("base_link", &FirstCapture::base_link)
      .member("tip_link", &FirstCapture::tip_link)
      .member("setup", &FirstCapture::setup)
      .member("registration", &FirstCapture::registration)
      .member("camera_at", &FirstCapture::camera_at)
      .member("look_at", &FirstCapture::look_at)
      .member("target_at", &FirstCapture::target_at)
      .member("target_faces", &FirstCapture::target_faces)
      .member("rough_position", &FirstCapture::rough_position)
      .member("corner_sigma", &FirstCapture::corner_sigma)
      .member("rough_rotation", &FirstCapture::rough_rotation);
  module.def("readPlanningCell", readPlanningCell, py::arg("source"), Unlocked(),
             "What a plan starts from, of a capture with its results.");
  module.def("firstCapture", firstCapture, py::arg("first"), Unlocked(), "What a plan of a whole first capture starts from.");
}

void bindOptions(py::module_& module) {
  py::enum_<PlanAim>(module, "PlanAim", "What the poses are for.")
      .value("kTool", PlanAim::kTool)
      .value("kSeparate", PlanAim::kSeparate)
      .value("kDetect", PlanAim::kDetect);
  py::enum_<PlanCriterion>(module, "PlanCriterion", "A: mean variance of the tool's position. D: volume of the confidence region.")
      .value("kA", PlanCriterion::kA)
      .value("kD", PlanCriterion::kD);
  Struct<PlanOptions>(module, "PlanOptions",
                      "Options of a plan; radii and the floor's height in [m]. The result does not depend on `jobs`.")
      .made()
      .member("aim", &PlanOptions::aim)
      .member("criterion", &PlanOptions::criterion)
      .member("count", &PlanOptions::count)
      .member("candidates", &PlanOptions::candidates)
      .member("seed", &PlanOptions::seed)
      .member("link_radius", &PlanOptions::link_radius)
      .member("camera_radius", &PlanOptions::camera_radius)
      .member("floor", &PlanOptions::floor)
      .member("detect", &PlanOptions::detect)
      .member("detect_size", &PlanOptions::detect_size)
      .member("odds", &PlanOptions::odds)
      .member("jobs", &PlanOptions::jobs)
      .member("progress", &PlanOptions::progress);
}

void bindPlan(py::module_& module) {
  Struct<ToolUncertainty>(module, "ToolUncertainty", "Error of the tool before the camera, 1 sigma, mean over the workspace [m], [rad].")
      .result("position", &ToolUncertainty::position)
      .result("rotation", &ToolUncertainty::rotation);
  Struct<PlannedPose>(module, "PlannedPose", "Joint readings [rad] or [m], and the side from which each joint is to come: -1, 0, 1.")
      .result("q", &PlannedPose::q)
      .result("dir", &PlannedPose::dir);
  Struct<RivalOdds>(module, "RivalOdds", "Odds of the better of two rivals, where the first is right.")
      .result("right", &RivalOdds::right)
      .result("wrong", &RivalOdds::wrong)
      .result("before", &RivalOdds::before)
      .result("expected", &RivalOdds::expected);
  Struct<Detection>(module, "Detection", "How well an effect of the size asked for would show.")
      .result("chi_square", &Detection::chi_square)
      .result("probability", &Detection::probability);
  Struct<Plan>(module, "Plan", "Poses in an order that makes a short path, and what they bring.")
      .result("poses", &Plan::poses)
      .result("before", &Plan::before)
      .result("after", &Plan::after)
      .result("random_poses", &Plan::random_poses)
      .result("random_tried", &Plan::random_tried)
      .result("odds", &Plan::odds)
      .result("not_told", &Plan::not_told)
      .result("detection_before", &Plan::detection_before)
      .result("detection_after", &Plan::detection_after)
      .result("sides_matter", &Plan::sides_matter)
      .result("link_radius", &Plan::link_radius)
      .result("visible", &Plan::visible)
      .result("drawn", &Plan::drawn);
}

}  // namespace

void bindPlanning(py::module_& module) {
  bindPlanningCell(module);
  bindSources(module);
  bindOptions(module);
  bindPlan(module);
  module.def(
      "planPoses", [](const PlanningCell& cell, const PlanOptions& options) { return planPoses(cell, stoppable(options)); },
      py::arg("cell"), py::arg_v("options", PlanOptions(), "PlanOptions()"), Unlocked(),
      "Chooses poses within the limits that show the target and touch nothing obvious.");
  module.def("toolUncertainty", toolUncertainty, py::arg("cell"), py::arg("more"), Unlocked(),
             "The uncertainty of the tool once corners are seen at these samples as well.");
  module.def("planCsv", planCsv, py::arg("plan"), py::arg("taken") = 0, "Text of next.csv; pictures are numbered on from `taken`.");
}

}  // namespace poecal::python
