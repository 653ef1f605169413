// SPDX-License-Identifier: BSD-3-Clause
// State models of an aircraft on a record, for other programs to compare with:
//   aircraft_record rates AIRCRAFT.json RECORD   (u v w p q r phi theta psi)' at every row, a line
//       each, where the record's CX ... Cn act; columns u v w p q r phi theta psi rho mass as well
//   aircraft_record path GRAVITY RECORD          flight path reconstruction, all parameters free
//       but b_phi b_theta b_psi and these scales: "name value standard_error", a line each
// RECORD: a header of names as sepcal has them, then numbers, separated by blanks.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "sepcal/aircraft/rigid_aircraft.hpp"
#include "sepcal/detail/flight/aircraft_file.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/models/flight_path.hpp"

namespace {

using sepcal::Record;

Record read_record(const std::string& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  std::istringstream header(line);
  std::vector<std::string> names;
  for (std::string name; header >> name;) names.push_back(name);
  std::vector<std::vector<double>> columns(names.size());
  for (double value = 0.0; stream >> value;) {
    columns[0].push_back(value);
    for (std::size_t i = 1; i < names.size() && stream >> value; ++i) columns[i].push_back(value);
  }
  Record record;
  for (std::size_t i = 0; i < names.size(); ++i) record.add(names[i], columns[i]);
  return record;
}

/// The coefficients are columns: each equation's one regressor, of which one is taken.
void print_rates(const std::string& aircraft, const Record& record) {
  using Model = sepcal::RigidAircraft<16>;
  std::vector<sepcal::AeroEquation> equations;
  for (const auto name : sepcal::coefficient_names) {
    equations.push_back({std::string(name), {std::string(name)}});
  }
  const Model model{sepcal::read_aircraft(aircraft), sepcal::compile_equations(equations), 9.80665};
  for (std::size_t k = 0; k < record.length(); ++k) {
    sepcal::Vec<double, 9> x;
    for (int i = 0; i < 9; ++i) {
      x[i] = record.column(Model::states[static_cast<std::size_t>(i)].name)[k];
    }
    sepcal::Vec<double, Model::n_u> u = sepcal::Vec<double, Model::n_u>::Zero();
    u[Model::rho] = record.column("rho")[k];
    u[Model::mass] = record.column("mass")[k];
    for (int i = 0; i < 6; ++i) {
      u[Model::first_column + i] =
          record.column(sepcal::coefficient_names[static_cast<std::size_t>(i)])[k];
    }
    const sepcal::Vec<double, 9> rate = model.rate(x, u, sepcal::Vec<double, 16>::Ones().eval());
    for (const double value : rate) std::printf("%.17g ", value);
    std::printf("\n");
  }
}

void print_path(double gravity, const Record& record) {
  using sepcal::FlightPath;
  const sepcal::TrajectoryModel<FlightPath> model(
      FlightPath{.gravity = gravity}, record,
      {.outputs = {"airspeed", "beta", "alpha", "roll", "pitch", "yaw"}});
  sepcal::FitOptions options;
  options.start = model.initial_states(record);
  for (const char* angle : {"phi", "theta", "psi"}) {
    options.fix["lambda_" + std::string(angle)] = 0.0;
    options.fix["b_" + std::string(angle)] = 0.0;
  }
  const sepcal::Fit fit = sepcal::fit(model, record, options);
  for (const sepcal::Parameter& p : fit.parameters) {
    if (!p.fixed) std::printf("%s %.17g %.17g\n", p.name.c_str(), p.value, p.standard_error);
  }
}

}  // namespace

int main(int count, char** words) try {
  if (count != 4) return 2;
  const std::string what = words[1];
  const Record record = read_record(words[3]);
  if (what == "rates") {
    print_rates(words[2], record);
  } else {
    print_path(std::stod(words[2]), record);
  }
  return 0;
} catch (const sepcal::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
