// SPDX-License-Identifier: BSD-3-Clause
// The parts of sepcal._core and sepcal._states, a file each, and the types that they share. Results
// cross over as immutable classes, whose fields and documents stand where they are bound.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "named_casters.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/detail/named_effects.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/own_model.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal::bindings {

namespace py = pybind11;

/// Lays a model with a state along a record, whose segments' initial states join its tables; or,
/// without one, along any record, each of whose segments begins at one initial state.
using Along = std::function<std::shared_ptr<const BlockModel>(const Record*)>;

/// A model, and the probe that brings flights to it where there is one.
struct Model {
  explicit Model(std::shared_ptr<const BlockModel> model) : block(std::move(model)) {}
  explicit Model(Along lay) : block(lay(nullptr)), along(std::move(lay)) {}
  explicit Model(const std::shared_ptr<const Probe>& given)
      : block(given, &given->model()), probe(given) {}

  EffectKit kit() const { return probe ? effect_kit(*probe) : plain_kit(block->tables()); }

  std::shared_ptr<const BlockModel> block;
  std::shared_ptr<const Probe> probe;  // may be empty
  std::shared_ptr<const Probe> own;    // of a model of the caller's own: what takes flights
  Along along;                         // the same
  std::map<std::string, double> held;  // unless freed, of a model without a probe
};

/// Where a model is written, and the file's SHA-256; both empty: unknown.
using Source = std::pair<std::string, std::string>;

/// A model of the caller's own as a probe; nullptr where it is called as one that ships: its
/// columns can be fitted all the same.
template <class Given>
std::shared_ptr<const Probe> own_if_free(const std::string& name, const Given& model,
                                         const ModelSource& source = {}) {
  try {
    return own_model(name, model, source);
  } catch (const Error&) {
    return nullptr;
  }
}

/// One without a probe that ships: its tables say what it takes of a flight.
inline Model plain_model(const std::string& name, std::shared_ptr<const BlockModel> block,
                         const ModelSource& source = {}) {
  Model model(std::move(block));
  model.own = own_if_free(name, model.block, source);
  return model;
}

/// What takes the model's flights; may be empty.
const std::shared_ptr<const Probe>& subject_of(const Model& model);

/// Throws Error where the model takes none.
const Probe& probe_of(const Model& model);

// Of both modules.
void define_foreign_files(py::module_& module);

// Of sepcal._core.
void define_comparison(py::module_& module);
void define_diagnosis(py::module_& module);
void define_certificate(py::module_& module);
void define_check(py::module_& module);
void define_options(py::module_& module);
void define_results(py::module_& module);
void define_rivals(py::module_& module);
void define_effects(py::module_& module);
void define_engine(py::module_& module);
void define_export(py::module_& module);
void define_figures(py::module_& module);
void define_flight(py::module_& module);
void define_intervals(py::module_& module);
void define_many(py::module_& module);
void define_fleet(py::module_& module);
void define_noise(py::module_& module);
void define_programs(py::module_& module);
void define_simulation(py::module_& module);
void define_state_results(py::module_& module);
void define_trials(py::module_& module);

// Of sepcal._states.
void define_aircraft(py::module_& module);
void define_frequency(py::module_& module);
void define_aircraft_program(py::module_& module);
void define_damped_sinusoids(py::module_& module);
void define_filters(py::module_& module);
void define_states(py::module_& module);

}  // namespace sepcal::bindings
