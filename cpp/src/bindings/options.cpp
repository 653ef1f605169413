// SPDX-License-Identifier: BSD-3-Clause
// The choices of a fit, under the names of fit()'s keyword arguments: rows of option_fields.hpp.
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <optional>

#include "bindings.hpp"
#include "flight/schema/option_fields.hpp"
#include "flight/schema/typed_options.hpp"
#include "sepcal/error.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

using Options = CalibrationOptions;

/// What Python has in a value's place, and how a type checker calls it.
template <class Value>
struct InPython {
  using Type = Value;
  static Value to(const Value& value) { return value; }
  static Value from(const std::string& /*name*/, Value value) { return value; }
};

template <NamedChoice Choice>
struct InPython<Choice> {
  using Type = std::string;
  static std::string to(Choice value) { return std::string(to_string(value)); }
  static Choice from(const std::string& name, const std::string& value) {
    return choice_of<Choice>(name, value);
  }
};

/// {name: (lower, upper)}; None: open on that side.
template <>
struct InPython<std::map<std::string, Interval>> {
  using End = std::optional<double>;
  using Type = std::map<std::string, std::pair<End, End>>;
  static Type to(const std::map<std::string, Interval>& intervals) {
    const auto end = [](double at) { return std::isfinite(at) ? End(at) : End(); };
    Type ends;
    for (const auto& [name, of] : intervals) ends[name] = {end(of.lower), end(of.upper)};
    return ends;
  }
  static std::map<std::string, Interval> from(const std::string& /*name*/, const Type& intervals) {
    std::map<std::string, Interval> bounds;
    for (const auto& [name, ends] : intervals) {
      bounds[name] = {ends.first.value_or(-infinity), ends.second.value_or(infinity)};
    }
    return bounds;
  }
};

/// {name: (mean, standard deviation)}.
template <>
struct InPython<std::map<std::string, Normal>> {
  using Type = std::map<std::string, std::pair<double, double>>;
  static Type to(const std::map<std::string, Normal>& normals) {
    Type pairs;
    for (const auto& [name, of] : normals) pairs[name] = {of.mean, of.standard_deviation};
    return pairs;
  }
  static std::map<std::string, Normal> from(const std::string& /*name*/, const Type& pairs) {
    std::map<std::string, Normal> normals;
    for (const auto& [name, pair] : pairs) normals[name] = {pair.first, pair.second};
    return normals;
  }
};

/// {t_1, t_2, l_2, convex}, any of them.
template <>
struct InPython<std::optional<Screens>> {
  using Type = std::optional<std::map<std::string, double>>;
  static Type to(const std::optional<Screens>& screens) {
    if (!screens) return std::nullopt;
    return {{{"t_1", screens->t_1},
             {"t_2", screens->t_2},
             {"l_2", screens->l_2},
             {"convex", screens->convex ? 1.0 : 0.0}}};
  }
  static std::optional<Screens> from(const std::string& /*name*/, const Type& values) {
    if (!values) return std::nullopt;
    Screens screens;
    for (const auto& [name, value] : *values) {
      if (name == "t_1") {
        screens.t_1 = value;
      } else if (name == "t_2") {
        screens.t_2 = value;
      } else if (name == "l_2") {
        screens.l_2 = value;
      } else if (name == "convex") {
        screens.convex = value != 0.0;
      } else {
        throw Error("screens have no '" + name + "'; they have: t_1, t_2, l_2, convex");
      }
    }
    return screens;
  }
};

/// Names, aliases, and several joined by '+'.
template <>
struct InPython<std::vector<EffectSetting>> {
  using Type = std::vector<std::string>;
  static Type to(const std::vector<EffectSetting>& settings) {
    Type names;
    for (const EffectSetting& setting : settings) names.push_back(setting.name);
    return names;
  }
  static std::vector<EffectSetting> from(const std::string& /*name*/, const Type& texts) {
    std::vector<EffectSetting> settings;
    for (const std::string& text : texts) {
      for (const std::string& name : split_effects(text)) settings.push_back({.name = name});
    }
    return settings;
  }
};

/// An option for whoever writes help, types or a command line of it.
struct OptionRow {
  std::string name;
  std::string sentence;
  std::string unset;
  std::string type;  // "Mapping[str, float]"
  std::vector<std::string> choices;
  std::vector<std::string> flags;
  std::string form;
  bool is_of_log = false;
};

template <class Value>
std::string type_of() {
  if constexpr (NamedChoice<Value>) {
    std::string names;
    for (const std::string_view name : ChoiceNames<Value>::names) {
      names += (names.empty() ? "\"" : ", \"") + std::string(name) + "\"";
    }
    return "Literal[" + names + "] | str";
  }
  if constexpr (std::same_as<Value, bool>) return "bool";
  if constexpr (std::integral<Value>) return "int";
  if constexpr (std::floating_point<Value>) return "float";
  if constexpr (std::same_as<Value, std::optional<double>>) return "float";
  if constexpr (std::same_as<Value, std::string>) return "str";
  if constexpr (std::same_as<Value, std::vector<std::string>>) return "Sequence[str]";
  if constexpr (std::same_as<Value, std::vector<EffectSetting>>) return "Sequence[str | Effect]";
  if constexpr (std::same_as<Value, std::optional<Screens>>) return "Mapping[str, float | bool]";
  if constexpr (std::same_as<Value, std::map<std::string, double>>) return "Mapping[str, float]";
  if constexpr (std::same_as<Value, std::map<std::string, std::string>>) return "Mapping[str, str]";
  if constexpr (std::same_as<Value, std::map<std::string, Normal>>) {
    return "Mapping[str, tuple[float, float]]";
  }
  if constexpr (std::same_as<Value, std::map<std::string, Interval>>) {
    return "Mapping[str, tuple[float | None, float | None]]";
  }
}

template <class Field>
OptionRow row_of(const Field& field) {
  using Value = std::remove_cvref_t<decltype(field.in(std::declval<Options&>()))>;
  OptionRow row{.name = std::string(field.name),
                .sentence = std::string(field.about.sentence),
                .unset = std::string(field.about.unset),
                .type = type_of<Value>(),
                .choices = {},
                .flags = {},
                .form = std::string(field.about.form),
                .is_of_log = field.is_of_log};
  if (!field.about.flags.empty()) row.flags = schema::split(field.about.flags, ',');
  if constexpr (NamedChoice<Value>) {
    row.choices.assign(ChoiceNames<Value>::names.begin(), ChoiceNames<Value>::names.end());
  }
  return row;
}

void define_rows(py::module_& module) {
  BoundStruct<OptionRow>(module, "OptionRow", "An option of fit().")
      .field("name", &OptionRow::name, "")
      .field("sentence", &OptionRow::sentence, "")
      .field("unset", &OptionRow::unset,
             "The words for an option that is not given; empty: its default.")
      .field("type", &OptionRow::type, "As type checkers call it.")
      .field("choices", &OptionRow::choices, "Choices of an option that is chosen by name.")
      .field("flags", &OptionRow::flags, "The programs' flags; empty: code alone has it.")
      .field("form", &OptionRow::form, "The form of the flag's value.")
      .field("is_of_log", &OptionRow::is_of_log, "Chooses of a flight's columns and rows.")
      .finish();
  module.def("option_rows", [] {
    std::vector<OptionRow> rows;
    schema::each_option([&](const auto& field) { rows.push_back(row_of(field)); });
    return rows;
  });
}

/// Sets an option from what is typed for it, a text for each time.
void read_typed(Options& options, const std::string& name, const std::vector<std::string>& texts) {
  schema::each_option([&](const auto& field) {
    if (field.name != name) return;
    const schema::About& about = field.about;
    const schema::Typed typed{schema::split(about.flags, ',').front(), std::string(about.form),
                              texts};
    if constexpr (requires { schema::read_typed(typed, field.in(options)); }) {
      schema::read_typed(typed, field.in(options));
    }
  });
}

}  // namespace

void define_options(py::module_& module) {
  define_rows(module);
  py::class_<Options> bound(module, "Options");
  bound.def(py::init<>());
  schema::each_option([&](const auto& field) {
    using Value = std::remove_cvref_t<decltype(field.in(std::declval<Options&>()))>;
    using Python = InPython<Value>;
    const std::string name(field.name);
    bound.def_property(
        name.c_str(),
        [field](const Options& self) ->
        typename Python::Type { return Python::to(field.in(self)); },
        [field, name](Options& self, const Python::Type& value) {
          field.in(self) = Python::from(name, value);
        });
  });
  bound.def("read_typed", &read_typed, py::arg("name"), py::arg("texts"));
}

}  // namespace sepcal::bindings
