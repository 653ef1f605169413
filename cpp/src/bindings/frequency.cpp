// SPDX-License-Identifier: BSD-3-Clause
// Frequency responses and inputs to be flown, for sepcal._states.
#include "sepcal/flight/frequency.hpp"

#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <array>

#include "bindings.hpp"
#include "released.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;
using Triple = std::array<double, 3>;  // low, high, spacing [Hz]

FlightResponse respond(const Flight& flight, const std::vector<std::string>& inputs,
                       const std::string& output, const Triple& band, double window, double level) {
  const Released released;
  return find_response(flight, inputs, output,
                       {.band = {band[0], band[1], band[2]}, .window = window, .level = level});
}

InputDesign make_multisines(const Amplitudes& amplitudes, const Triple& band, double duration,
                            double rate, bool optimised) {
  const Released released;
  return design_multisines(amplitudes, {.band = {band[0], band[1], band[2]},
                                        .duration = duration,
                                        .rate = rate,
                                        .optimised = optimised});
}

InputDesign make_steps(const Amplitudes& amplitudes, const Triple& band, double rate, double before,
                       double after) {
  const Released released;
  return design_steps(
      amplitudes,
      {.band = {band[0], band[1], band[2]}, .rate = rate, .before = before, .after = after});
}

template <class Result>
void save_table(const Result& result, const std::string& file) {
  OutputFile output(file);
  write_csv(result, output);
  output.commit();
}

}  // namespace

void define_frequency(py::module_& module) {
  py::class_<FlightResponse>(module, "Response")
      .def_property_readonly("inputs", [](const FlightResponse& self) { return self.found.inputs; })
      .def_property_readonly("output", [](const FlightResponse& self) { return self.found.output; })
      .def_property_readonly("frequencies",
                             [](const FlightResponse& self) { return self.found.frequencies; })
      .def_property_readonly("response",
                             [](const FlightResponse& self) { return self.found.response; })
      .def_property_readonly("coherence",
                             [](const FlightResponse& self) { return self.found.coherence; })
      .def_property_readonly("coherence_all",
                             [](const FlightResponse& self) { return self.found.coherence_all; })
      .def_property_readonly("standard_error",
                             [](const FlightResponse& self) { return self.found.standard_error; })
      .def_property_readonly("radius", [](const FlightResponse& self) { return self.found.radius; })
      .def_property_readonly("window", [](const FlightResponse& self) { return self.found.window; })
      .def_property_readonly("windows",
                             [](const FlightResponse& self) { return self.found.windows; })
      .def_property_readonly("averages",
                             [](const FlightResponse& self) { return self.found.averages; })
      .def_readonly("notes", &FlightResponse::notes)
      .def("polar",
           [](const FlightResponse& self) {
             MagnitudeAndPhase polar = magnitude_and_phase(self.found);
             return std::vector<Eigen::MatrixXd>{polar.magnitude,      polar.magnitude_low,
                                                 polar.magnitude_high, polar.phase,
                                                 polar.phase_low,      polar.phase_high};
           })
      .def("to_text", [](const FlightResponse& self) { return to_text(self); })
      .def("save", &save_table<FlightResponse>, WithoutGil());
  py::class_<InputDesign>(module, "Design")
      .def_readonly("kind", &InputDesign::kind)
      .def_readonly("inputs", &InputDesign::inputs)
      .def_readonly("time", &InputDesign::time)
      .def_readonly("signals", &InputDesign::signals)
      .def_readonly("frequencies", &InputDesign::frequencies)
      .def_readonly("peak_factors", &InputDesign::peak_factors)
      .def_readonly("step", &InputDesign::step)
      .def_readonly("share", &InputDesign::share)
      .def("to_text", [](const InputDesign& self) { return to_text(self); })
      .def("save", &save_table<InputDesign>, WithoutGil());
  module.def("frequency_response", &respond);
  module.def("multisines", &make_multisines);
  module.def("three_two_one_one", &make_steps);
}

}  // namespace sepcal::bindings
