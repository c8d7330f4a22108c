// The experiment of Gao, Wang and Jiang (2013), section 4.
#include "binding.hpp"
#include "poecal/identification/paper_experiment.hpp"

namespace poecal::python {

void bindPaper(py::module_& module) {
  Struct<PaperOptions>(module, "PaperOptions",
                       "Options of the paper's experiment; the noise of measured poses is uniform: half widths in [m] and [rad].")
      .made()
      .member("seeds", &PaperOptions::seeds)
      .member("poses", &PaperOptions::poses)
      .member("test_poses", &PaperOptions::test_poses)
      .member("noise_position", &PaperOptions::noise_position)
      .member("noise_rotation", &PaperOptions::noise_rotation);
  Struct<PaperFit>(module, "PaperFit", "What one method made of one seed: the arm, and its errors at poses that it did not see.")
      .result("arm", &PaperFit::arm)
      .result("residuals", &PaperFit::residuals)
      .result("test_poses", &PaperFit::test_poses)
      .result("error", &PaperFit::error);
  Struct<PaperSeed>(module, "PaperSeed", "One seed of the experiment.")
      .result("nominal_test_poses", &PaperSeed::nominal_test_poses)
      .result("nominal", &PaperSeed::nominal)
      .result("gao", &PaperSeed::gao)
      .result("weighted", &PaperSeed::weighted);
  const auto options = [] { return py::arg_v("options", PaperOptions(), "PaperOptions()"); };
  module.def("paperPoses", paperPoses, py::arg("actual"), options(), py::arg("seed") = 1, "The measured poses of one seed.");
  module.def("paperExperiment", paperExperiment, py::arg("nominal"), py::arg("actual"), options(), Unlocked(),
             "The paper's methods `gao` and `weighted` side by side, for seeds 1 to options.seeds.");
}

}  // namespace poecal::python
