// The library's exceptions, under their names. Those that Python has a word for are that too.
#include "binding.hpp"
#include "poecal/core/error.hpp"
#include "poecal/registration/implausible.hpp"

namespace poecal::python {
namespace {

/// Types of the exceptions; the module lives as long as the interpreter.
struct ErrorTypes {
  py::object error, invalid_argument, file_error, implausible_input, implausible_capture, out_of_memory, insufficient_data;
};
ErrorTypes* types = nullptr;

py::object makeType(const py::module_& module, const char* name, const py::object& bases, const char* doc) {
  const std::string full = "poecal." + std::string(name);
  auto type = py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr));
  if (!type) throw py::error_already_set();
  module.attr(name) = type;
  return type;
}

py::object made(const py::object& type, const Error& error) {
  py::object made = type(error.what());
  made.attr("_exit_status") = error.exitStatus();
  return made;
}

void raise(const py::object& error) { PyErr_SetObject(error.get_type().ptr(), error.ptr()); }

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const InvalidArgument& error) {
    raise(made(types->invalid_argument, error));
  } catch (const FileError& error) {
    raise(made(types->file_error, error));
  } catch (const ImplausibleCapture& error) {
    const py::object raised = made(types->implausible_capture, error);
    raised.attr("_part") = error.part();
    raised.attr("_sample") = error.sample();
    raise(raised);
  } catch (const ImplausibleInput& error) {
    raise(made(types->implausible_input, error));
  } catch (const OutOfMemory& error) {
    raise(made(types->out_of_memory, error));
  } catch (const InsufficientData& error) {
    raise(made(types->insufficient_data, error));
  } catch (const Error& error) {
    raise(made(types->error, error));
  }
}

/// A method without arguments that gives a member back.
void addGetter(const py::object& type, const char* name, const char* member) {
  type.attr(name) = py::cpp_function([member](const py::object& self) { return self.attr(member); }, py::name(name), py::is_method(type));
}

}  // namespace

void bindErrors(py::module_& module) {
  py::enum_<InputPart>(module, "InputPart", "The files of a capture.")
      .value("kSamples", InputPart::kSamples)
      .value("kRobot", InputPart::kRobot)
      .value("kTarget", InputPart::kTarget)
      .value("kCamera", InputPart::kCamera)
      .value("kManifest", InputPart::kManifest)
      .value("kDetections", InputPart::kDetections)
      .value("kRegistration", InputPart::kRegistration);
  const auto builtin = [](PyObject* type) { return py::reinterpret_borrow<py::object>(type); };
  types = new ErrorTypes;
  types->error = makeType(module, "Error", builtin(PyExc_RuntimeError), "Base of everything that poecal raises on purpose.");
  types->invalid_argument = makeType(module, "InvalidArgument", py::make_tuple(types->error, builtin(PyExc_ValueError)),
                                     "A caller's mistake: a value outside its domain.");
  types->file_error = makeType(module, "FileError", types->error, "Bad input: FILE:LINE: what is wrong, what was expected.");
  types->implausible_input =
      makeType(module, "ImplausibleInput", types->error, "Input that is well-formed but cannot be true; it names the suspected mistake.");
  types->implausible_capture =
      makeType(module, "ImplausibleCapture", types->implausible_input, "The same with the file that is suspected.");
  types->out_of_memory = makeType(module, "OutOfMemory", py::make_tuple(types->error, builtin(PyExc_MemoryError)),
                                  "The machine has too little memory for what was asked.");
  types->insufficient_data = makeType(module, "InsufficientData", types->error, "The data cannot support what was asked.");
  addGetter(types->error, "exitStatus", "_exit_status");
  addGetter(types->implausible_capture, "part", "_part");
  addGetter(types->implausible_capture, "sample", "_sample");
  py::register_exception_translator(translate);
}

}  // namespace poecal::python
