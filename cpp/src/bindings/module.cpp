// SPDX-License-Identifier: BSD-3-Clause
// sepcal._core: the engine and its flights for the Python front, which documents it.
#include "base/escaping.hpp"
#include "bindings.hpp"
#include "sepcal/diagnosis.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/solver_log.hpp"

namespace sepcal::bindings {
namespace {

/// sepcal.Error, with the text of the C++ one.
void define_error(py::module_& module) {
  const auto& error = py::register_exception<sepcal::Error>(module, "Error", PyExc_ValueError);
  error.attr("__module__") = "sepcal";
  error.attr("__doc__") =
      "Bad input or misuse: one line that names the culprit and the way out.\n\n"
      "Non-convergence is no error: it is the `status` of a fit.";
}

/// Of bytes, as a file's name in Python may hold what is no UTF-8.
void define_escaping(py::module_& module) {
  module.def("in_line", [](const py::bytes& text) { return base::in_line(std::string(text)); });
  module.def("in_shell", [](const py::bytes& text) { return base::in_shell(std::string(text)); });
}

}  // namespace
}  // namespace sepcal::bindings

PYBIND11_MODULE(_core, module) {
  using namespace sepcal::bindings;
  sepcal::silence_solver_log();
  module.attr("__version__") = SEPCAL_VERSION;
  module.attr("SIGNIFICANT_BELOW") = sepcal::significant_below;
  module.attr("VISIBLE_FROM") = sepcal::visible_from;
  define_error(module);
  define_escaping(module);
  define_options(module);
  define_results(module);
  define_effects(module);
  define_engine(module);
  define_intervals(module);
  define_certificate(module);
  define_rivals(module);
  define_flight(module);
  define_check(module);
  define_export(module);
  define_figures(module);
  define_many(module);
  define_trials(module);
  define_simulation(module);
  define_state_results(module);
}
