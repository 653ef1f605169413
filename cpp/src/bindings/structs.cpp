// SPDX-License-Identifier: BSD-3-Clause
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

py::tuple values_of(const py::object& self) {
  const py::tuple names = self.attr("_fields");
  py::tuple values(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) values[i] = self.attr(names[i]);
  return values;
}

bool equal(const py::object& self, const py::object& other) {
  return py::isinstance(other, py::type::of(self)) && values_of(self).equal(values_of(other));
}

py::typing::Dict<py::str, py::object> as_dict(const py::object& self) {
  py::typing::Dict<py::str, py::object> fields;
  for (const py::handle name : py::tuple(self.attr("_fields"))) {
    fields[name] = self.attr(py::reinterpret_borrow<py::str>(name));
  }
  return fields;
}

std::string repr(const py::object& self) {
  std::string text;
  for (const auto& [name, value] : as_dict(self)) {
    text += (text.empty() ? "" : ", ") + py::cast<std::string>(name) + "=" +
            py::cast<std::string>(py::repr(value));
  }
  return py::cast<std::string>(py::type::of(self).attr("__name__")) + "(" + text + ")";
}

/// A method of a class that no template knows.
template <class Function>
void add_method(py::object& type, const char* name, Function function, const char* doc = "") {
  type.attr(name) = py::cpp_function(function, py::name(name), py::is_method(type), doc);
}

}  // namespace

void add_record_methods(py::object& type, const std::vector<std::string>& names) {
  type.attr("_fields") = py::tuple(py::cast(names));
  add_method(type, "_asdict", &as_dict, "{field: value}, as of a named tuple.");
  add_method(type, "__repr__", &repr);
}

void add_equality(py::object& type) {
  add_method(type, "__eq__", &equal);
  add_method(type, "__hash__", [](const py::object& self) { return py::hash(values_of(self)); });
}

}  // namespace sepcal::bindings
