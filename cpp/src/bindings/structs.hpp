// SPDX-License-Identifier: BSD-3-Clause
// A C++ struct as an immutable class of Python: its fields with their documents, told once, give
// the properties, repr(), pickles and _asdict().
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "flight/schema/result_fields.hpp"

namespace sepcal::bindings {

namespace py = pybind11;

/// What does not depend on the struct: _fields, _asdict(), and repr() as of a dataclass.
void add_record_methods(py::object& type, const std::vector<std::string>& names);
/// == of all fields, and the hash that goes with it.
void add_equality(py::object& type);

/// Fields in the order of their declaration; finish() ends it.
template <class Struct>
class BoundStruct {
 public:
  BoundStruct(py::module_& module, const char* name, const char* doc)
      : class_(module, name, doc), fields_(std::make_shared<std::vector<Field>>()) {}

  /// `get` is what Python sees, which keeps the struct alive; `set` is for pickles alone.
  template <class Get, class Set>
  BoundStruct& field(const char* name, Get get, Set set, const char* doc) {
    using Value = std::decay_t<std::invoke_result_t<Get, const Struct&>>;
    class_.def_property_readonly(name, get, doc);
    fields_->push_back({name, [set](Struct& self, const py::handle& value) {
                          set(self, py::cast<Value>(value));
                        }});
    return *this;
  }

  template <class Value>
  BoundStruct& field(const char* name, Value Struct::* member, const char* doc) {
    return field(
        name, [member](const Struct& self) -> const Value& { return self.*member; },
        [member](Struct& self, Value value) { self.*member = std::move(value); }, doc);
  }

  /// A member of a member.
  template <class Part, class Value>
  BoundStruct& field(const char* name, Part Struct::* part, Value Part::* member, const char* doc) {
    return field(
        name, [=](const Struct& self) -> const Value& { return self.*part.*member; },
        [=](Struct& self, Value value) { self.*part.*member = std::move(value); }, doc);
  }

  /// A list as a tuple, which nobody can change.
  template <class Value>
  BoundStruct& tuple(const char* name, std::vector<Value> Struct::* member, const char* doc) {
    using Tuple = py::typing::Tuple<Value, py::ellipsis>;
    return field(
        name, [member](const Struct& self) -> Tuple { return py::tuple(py::cast(self.*member)); },
        [member](Struct& self, const Tuple& values) {
          self.*member = py::cast<std::vector<Value>>(values);
        },
        doc);
  }

  /// A column of numbers, a member of a member, as an array (N,) that is seen in place.
  template <class Part>
  BoundStruct& array(const char* name, Part Struct::* part, std::vector<double> Part::* member,
                     const char* doc) {
    class_.def_property_readonly(
        name,
        [=](const py::object& self) {
          return array_within(py::cast<const Struct&>(self).*part.*member, self);
        },
        doc);
    fields_->push_back({name, [=](Struct& self, const py::handle& values) {
                          self.*part.*member = py::cast<std::vector<double>>(values);
                        }});
    return *this;
  }

  /// The fields that its table tells, of the struct or of a part of it.
  BoundStruct& told() {
    return told([](auto& self) -> auto& { return self; }, static_cast<Struct*>(nullptr));
  }

  template <class Part>
  BoundStruct& told(Part Struct::* part) {
    return told([part](auto& self) -> auto& { return self.*part; }, static_cast<Part*>(nullptr));
  }

  /// For derived classes in Python: made from another.
  BoundStruct& copied() {
    class_.def(py::init<const Struct&>());
    return *this;
  }

  BoundStruct& comparable() {
    add_equality(class_);
    return *this;
  }

  py::class_<Struct>& finish() {
    std::vector<std::string> names;
    for (const Field& field : *fields_) names.emplace_back(field.name);
    add_record_methods(class_, names);
    class_.def(py::pickle(
        [fields = fields_](const py::object& self) {
          py::tuple state(fields->size());
          for (std::size_t i = 0; i < fields->size(); ++i) {
            state[i] = self.attr((*fields)[i].name);
          }
          return state;
        },
        [fields = fields_](const py::tuple& state) {
          Struct self;
          for (std::size_t i = 0; i < fields->size(); ++i) (*fields)[i].set(self, state[i]);
          return self;
        }));
    return class_;
  }

 private:
  template <class Of, class Part>
  BoundStruct& told(const Of& part_of, Part* /*of which type*/) {
    schema::ResultFields<Part>::each([&](const char* name, const auto& member, const char* sentence,
                                         schema::Told = schema::Told::everywhere,
                                         schema::Null = schema::Null::not_a_number) {
      using Given = std::invoke_result_t<decltype(member), Part&>;
      using Value = std::decay_t<Given>;
      field(
          name, [=](const Struct& self) -> Value { return std::invoke(member, part_of(self)); },
          [=](Struct& self, const Value& value) {
            if constexpr (std::is_lvalue_reference_v<Given>) {
              std::invoke(member, part_of(self)) = value;
            }
          },
          sentence);
    });
    return *this;
  }

  struct Field {
    const char* name;
    std::function<void(Struct&, const py::handle&)> set;
  };

  py::class_<Struct> class_;
  std::shared_ptr<std::vector<Field>> fields_;  // which the pickles keep
};

}  // namespace sepcal::bindings
