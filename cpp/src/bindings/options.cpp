// SPDX-License-Identifier: BSD-3-Clause
// The choices of a fit, under the names of fit()'s keyword arguments. Defaults stay where they are:
// in options.hpp.
#include <pybind11/stl.h>

#include <array>
#include <optional>

#include "bindings.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::bindings {
namespace {

using Options = CalibrationOptions;

/// {name: (lower, upper)}; None: open on that side.
using Bounds = std::map<std::string, std::pair<std::optional<double>, std::optional<double>>>;

void set_bounds(Options& options, const Bounds& bounds) {
  options.fit.bounds.clear();
  for (const auto& [name, ends] : bounds) {
    options.fit.bounds[name] = {ends.first.value_or(-infinity), ends.second.value_or(infinity)};
  }
}

/// {name: (mean, standard deviation)}.
template <auto Member, class Class>
void define_normals(Class& options, const char* name) {
  using Normals = std::map<std::string, std::pair<double, double>>;
  options.def_property(name, nullptr, [](Options& self, const Normals& normals) {
    (self.fit.*Member).clear();
    for (const auto& [parameter, normal] : normals) {
      (self.fit.*Member)[parameter] = {normal.first, normal.second};
    }
  });
}

/// One of a choice's names.
template <auto Member, class Class>
void define_named(Class& options, const std::string& name) {
  using Choice = std::remove_cvref_t<decltype(std::declval<FitOptions&>().*Member)>;
  options.def_property(
      name.c_str(), [](const Options& self) { return to_string(self.fit.*Member); },
      [name](Options& self, const std::string& choice) {
        self.fit.*Member = choice_of<Choice>(name, choice);
      });
}

/// {t_1, t_2, l_2, convex}, any of them. Throws Error for another name.
void set_screens(Options& options, const std::map<std::string, double>& values) {
  Screens screens;
  for (const auto& [name, value] : values) {
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
  options.fit.screens = screens;
}

/// Names, aliases, and several joined by '+'.
void set_effects(Options& options, const std::vector<std::string>& texts) {
  options.effects.clear();
  for (const std::string& text : texts) {
    for (const std::string& name : split_effects(text)) options.effects.push_back({.name = name});
  }
}

/// A keyword that is a member of FitOptions as it stands.
template <auto Member, class Class>
void define_choice(Class& options, const char* name) {
  using Value = std::remove_cvref_t<decltype(std::declval<FitOptions&>().*Member)>;
  options.def_property(
      name, [](const Options& self) { return self.fit.*Member; },
      [](Options& self, const Value& value) { self.fit.*Member = value; });
}

/// A keyword that is a member of LogChoice as it stands.
template <auto Member, class Class>
void define_of_log(Class& options, const char* name) {
  using Value = std::remove_cvref_t<decltype(std::declval<LogChoice&>().*Member)>;
  options.def_property(
      name, [](const Options& self) { return self.log.*Member; },
      [](Options& self, Value value) { self.log.*Member = std::move(value); });
}

}  // namespace

void define_options(py::module_& module) {
  py::class_<Options> options(module, "Options");
  options.def(py::init<>());
  options.def_property("effects", nullptr, &set_effects);
  options.def_property("bounds", nullptr, &set_bounds);
  options.def_property("screens", nullptr, &set_screens);
  define_normals<&FitOptions::sampling_distribution>(options, "sampling_distribution");
  define_normals<&FitOptions::prior>(options, "prior");
  define_named<&FitOptions::search>(options, "search");
  define_named<&FitOptions::sampling>(options, "sampling");
  define_named<&FitOptions::second_stage>(options, "second_stage");
  define_named<&FitOptions::jacobian>(options, "jacobian");
  define_named<&FitOptions::loss>(options, "loss");
  define_named<&FitOptions::method>(options, "method");
  define_named<&FitOptions::hessian>(options, "hessian");
  define_choice<&FitOptions::loss_width>(options, "loss_width");
  define_choice<&FitOptions::fix>(options, "fix");
  define_choice<&FitOptions::noise>(options, "noise");
  define_choice<&FitOptions::stage_one_segments>(options, "stage_one_segments");
  define_choice<&FitOptions::stage_two_segments>(options, "stage_two_segments");
  define_choice<&FitOptions::samples>(options, "samples");
  define_choice<&FitOptions::start>(options, "start");
  define_choice<&FitOptions::seed>(options, "seed");
  define_choice<&FitOptions::descents>(options, "descents");
  define_choice<&FitOptions::noise_tolerance>(options, "noise_tolerance");
  define_choice<&FitOptions::noise_iterations>(options, "noise_iterations");
  define_choice<&FitOptions::iterations>(options, "iterations");
  define_choice<&FitOptions::coloured_errors>(options, "coloured_errors");
  define_choice<&FitOptions::process_noise>(options, "process_noise");
  define_choice<&FitOptions::threads>(options, "threads");
  options.def_readwrite("free", &Options::free);
  define_of_log<&LogChoice::map>(options, "map");
  define_of_log<&LogChoice::ignore>(options, "ignore");
  define_of_log<&LogChoice::drop_invalid>(options, "drop_invalid");
  define_of_log<&LogChoice::drop_repeats>(options, "drop_repeats");
  define_of_log<&LogChoice::where>(options, "where");
  define_of_log<&LogChoice::from_time>(options, "from_time");
  define_of_log<&LogChoice::to_time>(options, "to_time");
}

}  // namespace sepcal::bindings
