// What a long job tells Python: a callable in its options, or a listener whose functions Python may override.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

#include "poecal/core/progress.hpp"

namespace poecal::python {

namespace py = pybind11;

/// Other threads of Python run while the library works.
using Unlocked = py::call_guard<py::gil_scoped_release>;

/// Takes Python's lock and tells how far a job is. Between two pieces of work it sees Ctrl-C.
/// @param name  of who is told, for messages.
template <typename Tell>
void tellProgress(const char* name, std::size_t total, const Tell& tell) {
  const py::gil_scoped_acquire lock;
  if (total > 0) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    tell();
    return;
  }
  // The job has failed, for a reason that must not be lost to another one.
  const py::error_scope reason;
  try {
    tell();
  } catch (py::error_already_set& error) {
    error.discard_as_unraisable(name);
  }
}

/// A callable of Python as a ProgressFunction, which the library may copy, call and drop without Python's lock.
class PythonProgress {
 public:
  explicit PythonProgress(py::object callable)
      : callable_(new py::object(std::move(callable)), [](const py::object* held) {
          const py::gil_scoped_acquire lock;
          delete held;
        }) {}
  void operator()(const std::string& label, std::size_t done, std::size_t total) const {
    tellProgress("poecal progress", total, [&] { (*callable_)(label, done, total); });
  }
  py::object callable() const { return *callable_; }

 private:
  std::shared_ptr<const py::object> callable_;
};

/// Options of a long call, which Ctrl-C stops also where nobody is told of its progress.
template <typename Options>
Options stoppable(Options options) {
  if (!options.progress) {
    options.progress = [](const std::string&, std::size_t, std::size_t total) { tellProgress("", total, [] {}); };
  }
  return options;
}

/// A listener whose functions Python may override.
class PythonListener : public Listener {
 public:
  void warning(const std::string& message) override;
  void warnings(const std::vector<std::string>& messages) override;
  void progress(const std::string& label, std::size_t done, std::size_t total) override;
};

/// Where nobody listens, warnings are Python's.
class PlainListener : public PythonListener {
 public:
  void warning(const std::string& message) override;
  void warnings(const std::vector<std::string>& messages) override;
};

/// The listener that a caller gave, or a PlainListener where none was; it must outlive the call that it is handed to.
class GivenListener {
 public:
  explicit GivenListener(Listener* given) : given_(given) {}
  Listener& operator*() { return given_ != nullptr ? *given_ : plain_; }
  Listener* operator->() { return &**this; }

 private:
  Listener* given_;
  PlainListener plain_;
};

}  // namespace poecal::python

namespace pybind11::detail {

/// A callable, or None for nobody. What was set is what is read.
template <>
struct type_caster<poecal::ProgressFunction> {
  PYBIND11_TYPE_CASTER(poecal::ProgressFunction, const_name("Callable[[str, int, int], object] | None"));

  bool load(handle source, bool) {
    if (source.is_none()) return true;
    if (PyCallable_Check(source.ptr()) == 0) return false;
    value = poecal::python::PythonProgress(reinterpret_borrow<object>(source));
    return true;
  }

  static handle cast(const poecal::ProgressFunction& function, return_value_policy, handle) {
    if (!function) return none().release();
    if (const auto* told = function.target<poecal::python::PythonProgress>()) return told->callable().release();
    return cpp_function(function).release();
  }
};

}  // namespace pybind11::detail
