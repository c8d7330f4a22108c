// Listeners of Python.
#include "progress.hpp"

#include "binding.hpp"

namespace poecal::python {

void PythonListener::warning(const std::string& message) { PYBIND11_OVERRIDE(void, Listener, warning, message); }

void PythonListener::warnings(const std::vector<std::string>& messages) { PYBIND11_OVERRIDE(void, Listener, warnings, messages); }

void PythonListener::progress(const std::string& label, std::size_t done, std::size_t total) {
  const auto tell = [&] { PYBIND11_OVERRIDE(void, Listener, progress, label, done, total); };
  tellProgress("poecal.Listener.progress", total, tell);
}

void PlainListener::warning(const std::string& message) {
  const py::gil_scoped_acquire lock;
  if (PyErr_WarnEx(PyExc_UserWarning, message.c_str(), 1) != 0) throw py::error_already_set();
}

void PlainListener::warnings(const std::vector<std::string>& messages) { Listener::warnings(messages); }

void bindProgress(py::module_& module) {
  py::class_<Listener, PythonListener>(module, "Listener", "Hears what a long job has to say; override what is of interest.")
      .def(py::init<>())
      .def("warning", &Listener::warning, py::arg("message"))
      .def("warnings", &Listener::warnings, py::arg("messages"))
      .def("progress", &Listener::progress, py::arg("label"), py::arg("done"), py::arg("total"));
}

}  // namespace poecal::python
