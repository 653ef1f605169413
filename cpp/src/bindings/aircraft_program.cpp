// SPDX-License-Identifier: BSD-3-Clause
// `sepcal aircraft`, as programs.cpp has the others.
#include <pybind11/stl.h>

#include "programs.hpp"
#include "typed_words.hpp"

namespace sepcal::bindings {
namespace {

int run_aircraft(const std::string& called, std::vector<std::string> arguments) {
  return run_with(called, std::move(arguments),
                  [&](int argc, char** argv) { return app::run_aircraft(called, argc, argv); });
}

}  // namespace

void define_aircraft_program(py::module_& module) { module.def("run_aircraft", &run_aircraft); }

}  // namespace sepcal::bindings
