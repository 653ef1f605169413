// SPDX-License-Identifier: BSD-3-Clause
// sepcal._core: the engine and its flights for the Python front, which documents it.
#include "base/escaping.hpp"
#include "bindings.hpp"
#include "sepcal/detail/solver_log.hpp"
#include "sepcal/diagnosis.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"

namespace sepcal::bindings {
namespace {

/// As UTF-8. Bytes of a file's name that are none stay as they are, and halves of pairs become
/// such.
std::string bytes_of(const py::str& text) {
  for (const char* const errors : {"surrogateescape", "surrogatepass"}) {
    PyObject* const encoded = PyUnicode_AsEncodedString(text.ptr(), "utf-8", errors);
    if (encoded != nullptr) return py::reinterpret_steal<py::bytes>(encoded);
    PyErr_Clear();
  }
  return {};
}

/// sepcal.Error, with the text of the C++ one; that of one which Python raised is a line too. One
/// with options in it has `as_typed`, which names them as a command line does.
void define_error(py::module_& module) {
  const auto& error = py::register_exception<sepcal::Error>(module, "Error", PyExc_ValueError);
  error.attr("__module__") = "sepcal";
  error.attr("__doc__") =
      "Bad input or misuse: one line that names the culprit and the way out.\n\n"
      "Non-convergence is no error: it is the `status` of a fit.";
  const auto text_of = [](const py::object& self) {
    const py::object said = py::handle(PyExc_ValueError).attr("__str__")(self);
    return base::in_line(bytes_of(py::str(said)));
  };
  // As pybind11 calls it. NOLINTNEXTLINE(performance-unnecessary-value-param)
  py::register_exception_translator([](const std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const OptionError& refused) {
      py::object made = py::module_::import("sepcal._core").attr("Error")(refused.what());
      made.attr("as_typed") = refused.spelled(base::as_typed);
      PyErr_SetObject(py::type::handle_of(made).ptr(), made.ptr());
    }
  });
  error.attr("__str__") = py::cpp_function(text_of, py::name("__str__"), py::is_method(error));
}

void define_escaping(py::module_& module) {
  module.def("in_line", [](const py::str& text) { return base::in_line(bytes_of(text)); });
  module.def("in_shell", [](const py::str& text) { return base::in_shell(bytes_of(text)); });
}

}  // namespace
}  // namespace sepcal::bindings

PYBIND11_MODULE(_core, module) {
  using namespace sepcal::bindings;
  sepcal::silence_solver_log();
  module.attr("__version__") = SEPCAL_VERSION;
  module.attr("SIGNIFICANT_BELOW") = sepcal::significant_below;
  module.attr("LEAST_GAIN") = sepcal::least_gain;
  module.attr("VISIBLE_FROM") = sepcal::visible_from;
  define_error(module);
  define_escaping(module);
  define_options(module);
  define_results(module);
  define_effects(module);
  define_engine(module);
  define_noise(module);
  define_intervals(module);
  define_certificate(module);
  define_rivals(module);
  define_comparison(module);
  define_diagnosis(module);
  define_state_results(module);
  define_flight(module);
  define_foreign_files(module);
  define_check(module);
  define_export(module);
  define_figures(module);
  define_many(module);
  define_fleet(module);
  define_trials(module);
  define_simulation(module);
  define_programs(module);
}
