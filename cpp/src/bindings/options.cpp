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

template <class Choice>
struct Named {
  std::string_view name;
  Choice choice;
};

constexpr std::array samplings{Named<Sampling>{"uniform", Sampling::uniform},
                               Named<Sampling>{"low_discrepancy", Sampling::low_discrepancy}};
constexpr std::array second_stages{Named<SecondStage>{"auto", SecondStage::automatic},
                                   Named<SecondStage>{"joint", SecondStage::joint},
                                   Named<SecondStage>{"projected", SecondStage::projected}};

/// Throws Error for a name that is none of them.
template <class Table>
auto choose(const std::string& option, const Table& table, const std::string& name) {
  std::string known;
  for (const auto& entry : table) {
    if (entry.name == name) return entry.choice;
    known += (known.empty() ? "'" : ", '") + std::string(entry.name) + "'";
  }
  throw Error(option + " '" + name + "' is unknown; known: " + known);
}

/// {name: (lower, upper)}; None: open on that side.
using Bounds = std::map<std::string, std::pair<std::optional<double>, std::optional<double>>>;

void set_bounds(Options& options, const Bounds& bounds) {
  options.fit.bounds.clear();
  for (const auto& [name, ends] : bounds) {
    options.fit.bounds[name] = {ends.first.value_or(-infinity), ends.second.value_or(infinity)};
  }
}

/// {name: (mean, standard deviation)}.
void set_priors(Options& options, const std::map<std::string, std::pair<double, double>>& priors) {
  options.fit.priors.clear();
  for (const auto& [name, normal] : priors) {
    options.fit.priors[name] = {normal.first, normal.second};
  }
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

}  // namespace

void define_options(py::module_& module) {
  py::class_<Options> options(module, "Options");
  options.def(py::init<>());
  options.def_property("effects", nullptr, &set_effects);
  options.def_property("bounds", nullptr, &set_bounds);
  options.def_property("priors", nullptr, &set_priors);
  options.def_property("sampling", nullptr, [](Options& self, const std::string& name) {
    self.fit.sampling = choose("sampling", samplings, name);
  });
  options.def_property("second_stage", nullptr, [](Options& self, const std::string& name) {
    self.fit.second_stage = choose("second_stage", second_stages, name);
  });
  define_choice<&FitOptions::fixed>(options, "fixed");
  define_choice<&FitOptions::noise>(options, "noise");
  define_choice<&FitOptions::stage_one_segments>(options, "stage_one");
  define_choice<&FitOptions::stage_two_segments>(options, "stage_two");
  define_choice<&FitOptions::samples>(options, "samples");
  define_choice<&FitOptions::seed>(options, "seed");
  define_choice<&FitOptions::descents>(options, "descents");
  define_choice<&FitOptions::noise_tolerance>(options, "noise_tolerance");
  define_choice<&FitOptions::noise_iterations>(options, "noise_iterations");
  define_choice<&FitOptions::iterations>(options, "iterations");
  define_choice<&FitOptions::coloured_errors>(options, "coloured_errors");
  define_choice<&FitOptions::threads>(options, "threads");
  options.def_readwrite("free", &Options::free);
  options.def_readwrite("drop_invalid", &Options::drop_invalid);
}

}  // namespace sepcal::bindings
