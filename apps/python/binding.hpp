// How the library's structs become classes of the module.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pybind11/stl/filesystem.h>

#include "arrays.hpp"
#include "progress.hpp"

namespace poecal::python {

/// One line: the type, and its members that are not empty.
std::string describe(const py::object& object);

/// Sets members by their names. @throws TypeError for a name that the type does not have.
void setMembers(const py::object& object, const py::kwargs& members);

/// What Python holds by itself: a reference to what is inside could outlive it.
template <typename Member>
struct IsHeld : std::disjunction<std::is_arithmetic<Member>, std::is_enum<Member>> {};
template <typename Member>
struct IsHeld<std::optional<Member>> : std::true_type {};
template <typename Member>
struct IsHeld<std::vector<Member>> : std::true_type {};
template <typename Signature>
struct IsHeld<std::function<Signature>> : std::true_type {};
template <typename Key, typename Member>
struct IsHeld<std::map<Key, Member>> : std::true_type {};

/// Lists as tuples and maps as read-only ones, so that nobody adds to a copy.
template <typename Member>
py::object frozen(const Member& member, py::return_value_policy policy, py::handle parent) {
  py::object made = py::cast(member, policy, parent);
  if (py::isinstance<py::list>(made)) return py::tuple(made);
  if (py::isinstance<py::dict>(made)) return py::module_::import("types").attr("MappingProxyType")(made);
  if (py::isinstance<py::array>(made)) made.attr("setflags")(py::arg("write") = false);
  return made;
}

/// A struct of the library. Members have the names of C++.
template <typename T>
class Struct : public py::class_<T> {
 public:
  Struct(py::module_& module, const char* name, const char* doc) : py::class_<T>(module, name, doc) {
    this->def("__repr__", [](const py::object& self) { return describe(self); });
  }

  /// It may be made by hand, with the members as keywords, and copied.
  Struct& made() {
    this->def(py::init([](const py::kwargs& members) {
      auto made = std::make_unique<T>();
      setMembers(py::cast(made.get(), py::return_value_policy::reference), members);
      return made;
    }));
    this->def("__copy__", [](const T& self) { return T(self); });
    this->def(
        "__deepcopy__", [](const T& self, const py::dict&) { return T(self); }, py::arg("memo"));
    return *this;
  }

  /// A member that may be set. Lists, maps, arrays and optional members are read as copies: change one and set it again.
  template <typename Member>
  Struct& member(const char* name, Member T::*at) {
    if constexpr (IsHeld<Member>::value) {
      const auto get = [at](const T& self) { return frozen(self.*at, py::return_value_policy::copy, {}); };
      this->def_property(name, get, [at](T& self, const Member& value) { self.*at = value; });
    } else {
      this->def_readwrite(name, at);
    }
    return *this;
  }

  /// A member that may not be set, of something that is a member itself and may be set as a whole: a copy.
  template <typename Member>
  Struct& copied(const char* name, Member T::*at) {
    this->def_property_readonly(name, [at](const T& self) { return frozen(self.*at, py::return_value_policy::copy, {}); });
    return *this;
  }

  /// A member of a result, which lives as long as anybody holds a part of it.
  template <typename Member>
  Struct& result(const char* name, Member T::*at) {
    this->def_property_readonly(name, [at](const py::object& self) {
      return frozen(self.cast<const T&>().*at, py::return_value_policy::reference_internal, self);
    });
    return *this;
  }
};

// One room of the module each. Types come before the functions that take them.
void bindErrors(py::module_& module);
void bindProgress(py::module_& module);
void bindArm(py::module_& module);
void bindMeasurements(py::module_& module);
void bindEffects(py::module_& module);
void bindResults(py::module_& module);
void bindCalibration(py::module_& module);
void bindDetection(py::module_& module);
void bindSimulation(py::module_& module);
void bindPlanning(py::module_& module);
void bindExporting(py::module_& module);
void bindPrinting(py::module_& module);
void bindPaper(py::module_& module);

}  // namespace poecal::python
