// The module `poecal`: the library's calls from Python, under the names that they have in C++.
#include <cctype>

#include "binding.hpp"

namespace poecal::python {
namespace {

/// forward_kinematics of forwardKinematics.
std::string pep8Name(const std::string& name) {
  std::string words;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isupper(letter) != 0) words += '_';
    words += static_cast<char>(std::tolower(letter));
  }
  return words;
}

/// Functions are also called by their PEP 8 names.
void addPep8Names(const py::object& scope) {
  for (const auto item : py::list(scope.attr("__dict__").attr("items")())) {
    const auto [key, value] = item.cast<std::pair<std::string, py::object>>();
    const std::string type = py::str(value.get_type().attr("__name__"));
    if (type == "type" || type == "pybind11_type") continue;
    const bool function = type.find("method") != std::string::npos || type.find("function") != std::string::npos;
    if (function && !key.starts_with("_") && pep8Name(key) != key) scope.attr(pep8Name(key).c_str()) = value;
  }
}

bool isOurs(const py::handle& type) { return std::string(py::str(type.attr("__module__"))) == "poecal"; }

std::string memberText(const py::handle& value);

std::string typeName(const py::handle& value) { return py::str(py::type::of(value).attr("__name__")); }

/// "<60 Sample>".
std::string countText(std::size_t count, const std::string& of) { return "<" + std::to_string(count) + " " + of + ">"; }

/// "(1, 2)"; the number of what is long or has members itself.
std::string listText(const py::sequence& list) {
  constexpr std::size_t kLong = 7;
  if (isOurs(py::type::of(list[0])) || list.size() >= kLong) return countText(list.size(), typeName(list[0]));
  std::string text;
  for (const auto& item : list) text += (text.empty() ? "" : ", ") + memberText(item);
  return "(" + text + ")";
}

std::string mapText(const py::dict& map) {
  std::string text;
  for (const auto& [key, value] : map) text += (text.empty() ? "" : ", ") + std::string(py::repr(key)) + ": " + memberText(value);
  return "{" + text + "}";
}

/// Whole files, such as a page to print.
bool isLongText(const py::handle& value) {
  constexpr std::size_t kLong = 500;
  return (py::isinstance<py::str>(value) || py::isinstance<py::bytes>(value)) && py::len(value) > kLong;
}

std::string memberText(const py::handle& value) {
  constexpr std::size_t kShort = 100;
  if (isLongText(value)) return countText(py::len(value), typeName(value));
  if (py::isinstance<py::float_>(value)) return py::str("{:.6g}").format(value.cast<double>() + 0.0);  // no -0
  if (py::isinstance<py::tuple>(value)) return listText(py::reinterpret_borrow<py::sequence>(value));
  if (py::isinstance(value, py::module_::import("types").attr("MappingProxyType")))
    return mapText(py::dict(py::reinterpret_borrow<py::object>(value)));
  if (py::isinstance<py::array>(value)) {
    const bool row = py::len(value.attr("shape")) == 1 && py::len(value) <= 6;
    return row ? listText(value.attr("tolist")()) : "<array " + std::string(py::str(value.attr("shape"))) + ">";
  }
  std::string text = py::repr(value);
  return isOurs(py::type::of(value)) && text.size() > kShort ? "<" + typeName(value) + ">" : text;
}

bool isEmpty(const py::object& value) { return value.is_none() || (py::hasattr(value, "__len__") && py::len(value) == 0); }

}  // namespace

std::string describe(const py::object& object) {
  const py::object property = py::module_::import("builtins").attr("property");
  std::string text;
  for (const auto item : py::dict(object.get_type().attr("__dict__"))) {
    if (!py::isinstance(item.second, property)) continue;
    const py::object value = object.attr(item.first);
    if (!isEmpty(value)) text += (text.empty() ? "" : ", ") + std::string(py::str(item.first)) + "=" + memberText(value);
  }
  return std::string(py::str(object.get_type().attr("__name__"))) + "(" + text + ")";
}

void setMembers(const py::object& object, const py::kwargs& members) {
  for (const auto& [name, value] : members) {
    if (!py::hasattr(object.get_type(), name)) {
      throw py::type_error(std::string(py::str(object.get_type().attr("__name__"))) + " has no member " + std::string(py::str(name)));
    }
    object.attr(name) = value;
  }
}

}  // namespace poecal::python

PYBIND11_MODULE(poecal, module) {
  using namespace poecal::python;
  module.doc() =
      "poecal calibrates a serial robot arm from pictures of a tag on its flange, and diagnoses the gap that is left. "
      "Long calls let other threads run: no object may change while one works on it.";
  module.attr("__version__") = POECAL_VERSION;
  bindErrors(module);
  bindProgress(module);
  bindArm(module);
  bindMeasurements(module);
  bindEffects(module);
  bindResults(module);
  bindCalibration(module);
  bindDetection(module);
  bindSimulation(module);
  bindPlanning(module);
  bindExporting(module);
  bindPrinting(module);
  bindPaper(module);
  for (const auto item : py::list(module.attr("__dict__").attr("values")())) {
    if (py::isinstance<py::type>(item)) addPep8Names(py::reinterpret_borrow<py::object>(item));
  }
  addPep8Names(module);
}
