// SPDX-License-Identifier: BSD-3-Clause
// `sepcal` within Python's process, for the command of that name alone: what it prints and its exit
// codes are those of the native program.
#include "programs.hpp"

#include <pybind11/stl.h>

#include "sepcal.hpp"
#include "typed_words.hpp"

namespace sepcal::bindings {

using namespace py::literals;

namespace {

/// The aircraft's code is in a module that is loaded where it is asked for.
int run_aircraft_of_states(const std::string& called, int argc, char** argv) {
  const py::gil_scoped_acquire gil;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const py::object states = py::module_::import("sepcal.states_module").attr("states_module")();
  return states.attr("run_aircraft")(called, arguments).cast<int>();
}

std::string table_of_aircraft() {
  const py::gil_scoped_acquire gil;
  const py::object states = py::module_::import("sepcal.states_module").attr("states_module")();
  return states.attr("aircraft_table")().cast<std::string>();
}

/// The words as the shell gave them: a file's name need not be UTF-8. `tables` are of the commands
/// that are Python's, as apps/tables.hpp has them.
int run_sepcal(const std::vector<py::bytes>& words, const std::vector<std::string>& tables) {
  std::vector<std::string> arguments(words.begin(), words.end());
  const std::vector<app::NamedProgram> programs{
      {"mag", app::run_mag, app::mag_table},
      {"pitot", app::run_pitot, app::pitot_table},
      {"aircraft", run_aircraft_of_states, table_of_aircraft}};
  return run_with("sepcal", std::move(arguments), [&](int argc, char** argv) {
    return app::run_sepcal(programs, tables, argc, argv);
  });
}

}  // namespace

void define_programs(py::module_& module) {
  module.def("run_sepcal", &run_sepcal, "words"_a, "tables"_a = std::vector<std::string>());
}

}  // namespace sepcal::bindings
