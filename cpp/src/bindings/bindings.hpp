// SPDX-License-Identifier: BSD-3-Clause
// The parts of sepcal._core, a file each, and the types that they share. Results cross over as
// plain dictionaries and arrays, which python/sepcal/ turns into its documented classes.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <vector>

#include "sepcal/block_model.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/probe.hpp"
#include "sepcal/named_effects.hpp"

namespace sepcal::bindings {

namespace py = pybind11;

/// A model, and the probe that brings flights to it where there is one.
struct Model {
  explicit Model(std::shared_ptr<const BlockModel> model) : block(std::move(model)) {}
  explicit Model(const std::shared_ptr<const Probe>& given)
      : block(given, &given->model()), probe(given) {}

  std::shared_ptr<const BlockModel> block;
  std::shared_ptr<const Probe> probe;  // may be empty
};

/// Keys as the fields of sepcal.Fit; its parts are dictionaries in turn.
py::dict describe(const Fit& fit, const CalibrationOptions& options);
py::list describe(const std::vector<Parameter>& parameters);
py::list describe(const std::vector<Combination>& combinations);
py::dict describe(const std::vector<OutputValue>& values);

/// A page as print() takes it: print() ends the last line itself.
inline std::string without_last_end(std::string page) {
  page.pop_back();
  return page;
}

/// Adds what the apps print of a result: `text`, and `explained`, as with --explain.
template <class... Result>
void add_pages(py::dict& described, const Result&... result) {
  described["text"] = without_last_end(to_text(result..., Detail::brief));
  described["explained"] = without_last_end(to_text(result..., Detail::explained));
}

/// Intervals by both kinds and predictions: for fits on columns, functions of the module; for
/// calibrations, what their class has as methods.
void define_intervals(py::module_& module);
py::dict find_intervals(const Calibration& calibration, const Flight& flight, double level,
                        const std::vector<std::string>& names);
py::dict predict(const Calibration& calibration, const Flight& flight, double level);

void define_options(py::module_& module);
void define_effects(py::module_& module);
void define_engine(py::module_& module);
void define_figures(py::module_& module);
void define_flight(py::module_& module);
void define_many(py::module_& module);
void define_simulation(py::module_& module);

}  // namespace sepcal::bindings
