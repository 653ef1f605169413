// SPDX-License-Identifier: BSD-3-Clause
// Aerodynamic parameters of one flight, three ways: equation error, two steps, output error.
#include <cstdio>
#include <sepcal/aircraft/output_error.hpp>
#include <sepcal/aircraft/two_step.hpp>
#include <sepcal/simulation/aircraft.hpp>
using namespace sepcal;

int main() {
  AircraftTruth truth;                      // a Cessna-like aircraft, in light turbulence, with
  truth.parameters["b_az"] = 0.2;           // an accelerometer's bias, m/s^2,
  truth.parameters["lambda_alpha"] = 0.05;  // and a vane that reads 5 % too much
  truth.turbulence = 0.1;                   // m/s
  Record record;
  for (const SimulatedColumn& column : simulate_aircraft(truth, {.seed = 1}).columns)
    record.add(column.name.substr(0, column.name.rfind('_')), column.values);  // "az" of "az_mps2"

  const AircraftGeometry& geometry = truth.geometry;  // or read_aircraft("AIRCRAFT.json")
  const AeroFit one = fit_equation_error(aero_coefficients(record, geometry));
  const TwoStep two = two_step(record, geometry, {.path_fit = {.fix = {{"lambda_v", 0.0}}}});
  const AeroFit output = fit_output_error(
      record, geometry, {.axes = AircraftAxes::longitudinal, .free = {"lambda_alpha"}});
  std::printf("%s\n", output.notes.front().c_str());
  std::printf("lambda_alpha %.3f of 0.05\n", two.path["lambda_alpha"].value);
  std::printf("%-12s %7s %15s %9s %15s\n", "", "truth", "equation error", "two steps",
              "output error");
  for (const char* name : {"CZ_alpha", "Cm_alpha", "Cm_q", "Cm_elevator"}) {
    const Parameter& p = output.fit[name];
    std::printf("%-12s %7.2f %15.3f %9.3f %8.3f +- %.3f\n", name, truth.parameters.at(name),
                one.fit[name].value, two.aero.fit[name].value, p.value, p.standard_error);
  }
  std::printf("%s\n", one.warning.c_str());
}
