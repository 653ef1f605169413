// SPDX-License-Identifier: BSD-3-Clause
// sepcal._states: models with a state, filters and the aircraft for the Python front, which
// documents them. A module of its own, because it is long to compile and who calibrates a sensor
// needs none of it; its functions take and give the classes of sepcal._core.
#include "bindings.hpp"
#include "sepcal/detail/solver_log.hpp"

PYBIND11_MODULE(_states, module) {
  using namespace sepcal::bindings;
  const auto core = pybind11::module_::import("sepcal._core");
  define_foreign_files(module);
  module.attr("read_foreign_files")(core.attr("foreign_reader")());
  sepcal::silence_solver_log();
  define_states(module);
  define_filters(module);
  define_damped_sinusoids(module);
  define_aircraft(module);
  define_frequency(module);
  define_aircraft_program(module);
}
