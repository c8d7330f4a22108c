// Models with effects: what they are, their files, and where the arm really goes.
#include "binding.hpp"
#include "poecal/compensation/compensate.hpp"
#include "poecal/effects/catalogue.hpp"
#include "poecal/identification/model.hpp"

namespace poecal::python {
namespace {

void bindEffectTypes(py::module_& module) {
  Struct<EffectSpec>(module, "EffectSpec", "An effect as a file says it: what, where, how large, what drives it.")
      .made()
      .member("effect", &EffectSpec::effect)
      .member("location", &EffectSpec::location)
      .member("parameters", &EffectSpec::parameters)
      .member("driver", &EffectSpec::driver);
  Struct<EffectParameter>(module, "EffectParameter", "A parameter of an effect: `typical` is 1 sigma of its size on real cells.")
      .result("name", &EffectParameter::name)
      .result("unit", &EffectParameter::unit)
      .result("typical", &EffectParameter::typical);
  Struct<EffectKind>(module, "EffectKind", "A kind of effect.")
      .result("name", &EffectKind::name)
      .result("drivers", &EffectKind::drivers)
      .result("parameters", &EffectKind::parameters)
      .result("meaning", &EffectKind::meaning)
      .result("formula", &EffectKind::formula)
      .result("confused_with", &EffectKind::confused_with)
      .result("separate", &EffectKind::separate)
      .result("remedy", &EffectKind::remedy)
      .def("placePattern", &EffectKind::placePattern);
  Struct<Effect>(module, "Effect", "One effect at one place.")
      .def("name", &Effect::name)
      .def("location", &Effect::location)
      .def("kind", &Effect::kind, py::return_value_policy::reference)
      .def("parameters", &Effect::parameters, py::return_value_policy::copy)
      .def("spec", &Effect::spec, py::arg("parameters"));
  Struct<AppliedEffect>(module, "AppliedEffect", "An effect with values.")
      .result("effect", &AppliedEffect::effect)
      .member("parameters", &AppliedEffect::parameters)
      .member("standard_deviation", &AppliedEffect::standard_deviation);
  module.def("effectKinds", effectKinds, py::return_value_policy::reference, "All kinds of effects.");
  module.def("effectKind", effectKind, py::arg("name"), py::return_value_policy::reference);
  module.def("makeEffect", makeEffect, py::arg("spec"), py::arg("cell"), "The instance that a spec names; parameters left out are 0.");
}

void bindModel(py::module_& module) {
  Struct<Model>(module, "Model", "The calibrated cell, with the effects that a diagnosis found.")
      .made()
      .member("cell", &Model::cell)
      .member("target", &Model::target)
      .member("gravity", &Model::gravity)
      .member("effects", &Model::effects)
      .member("driver_ranges", &Model::driver_ranges)
      .member("method", &Model::method)
      .member("urdf", &Model::urdf)
      .member("base_link", &Model::base_link)
      .member("tip_link", &Model::tip_link);
  module.def("readModel", readModel, py::arg("file"), "Reads model.yaml.");
  module.def("modelYaml", modelYaml, py::arg("model"), "Text of model.yaml.");
}

}  // namespace

void bindEffects(py::module_& module) {
  bindEffectTypes(module);
  bindModel(module);
  Struct<RealArm>(module, "RealArm", "The arm as it really moves: calibrated axes, and effects.")
      .made()
      .member("arm", &RealArm::arm)
      .member("effects", &RealArm::effects)
      .member("gravity", &RealArm::gravity);
  Struct<JointCommand>(module, "JointCommand", "What to command for one wanted pose; `why_not` is empty where it is reached.")
      .result("start", &JointCommand::start)
      .result("q", &JointCommand::q)
      .result("T_base_flange", &JointCommand::T_base_flange)
      .result("position_error", &JointCommand::position_error)
      .result("rotation_error", &JointCommand::rotation_error)
      .result("why_not", &JointCommand::why_not);
  module.def("realArm", realArm, py::arg("model"), "The arm of a model as it really moves.");
  module.def("reachedPoses", reachedPoses, py::arg("arm"), py::arg("commands"), Unlocked(),
             "T_base_flange that each command really reaches, effects included: N x 4 x 4.");
  module.def(
      "compensate",
      [](const RealArm& arm, const SampleTable& wanted, const Arm* start_arm, Listener* listener) {
        return compensate(arm, wanted, start_arm, GivenListener(listener)->progressFunction());
      },
      py::arg("arm"), py::arg("wanted"), py::arg("start_arm") = py::none(), py::arg("listener") = py::none(), Unlocked(),
      "The joints to command so that the arm reaches T_base_flange of each row.");
  module.def("commandsCsv", commandsCsv, py::arg("wanted"), py::arg("commands"), "Text of the table of commands.");
}

}  // namespace poecal::python
