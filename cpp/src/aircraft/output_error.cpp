// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/aircraft/output_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "aircraft/held.hpp"
#include "base/columns.hpp"
#include "base/name_list.hpp"
#include "sepcal/aircraft/rigid_aircraft.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Names = std::vector<std::string>;

struct Axes {
  std::string_view name;
  Names coefficients;
  Names measured;
  Names outputs;
};

const Axes& axes_of(AircraftAxes axes) {
  static const std::array<Axes, 3> all{
      Axes{"longitudinal",
           {"CX", "CZ", "Cm"},
           {"v", "p", "r", "phi", "psi"},
           {"airspeed", "alpha", "pitch", "ax", "az", "q"}},
      Axes{"lateral",
           {"CY", "Cl", "Cn"},
           {"u", "w", "q", "theta", "psi"},
           {"beta", "roll", "ay", "p", "r"}},
      Axes{"six-dof",
           {"CX", "CY", "CZ", "Cl", "Cm", "Cn"},
           {"psi"},
           {"airspeed", "beta", "alpha", "roll", "pitch", "ax", "ay", "az", "p", "q", "r"}}};
  return all[static_cast<std::size_t>(axes)];
}

TrajectoryOptions along(const Record& record, const OutputErrorOptions& options) {
  const Axes& axes = axes_of(options.axes);
  TrajectoryOptions along = options.trajectory;
  if (along.outputs.empty()) {
    for (const std::string& output : axes.outputs) {
      if (record.has(output)) along.outputs.push_back(output);
    }
  }
  if (along.outputs.empty()) {
    throw Error("the record has none of the outputs " + std::string(axes.name) +
                " needs, as alpha or p; add one");
  }
  if (along.measured.empty()) {
    along.measured = axes.measured;
    if (base::is_among(along.outputs, "yaw")) std::erase(along.measured, "psi");
  }
  return along;
}

template <int Capacity>
void lay(const RigidAircraft<Capacity>& aircraft, const TrajectoryOptions& along,
         AircraftTrajectory& laid) {
  auto model =
      std::make_shared<TrajectoryModel<RigidAircraft<Capacity>>>(aircraft, laid.record, along);
  for (const auto& [name, value] : model->initial_states(laid.record)) {
    laid.fit.start.emplace(name, value);
    laid.initial_states.push_back(name);
  }
  laid.model = std::move(model);
}

/// The model with the shortest dual numbers that have room.
void lay_smallest(const AircraftGeometry& geometry, double gravity, const TrajectoryOptions& along,
                  AircraftTrajectory& laid) {
  AeroTerms aero = compile_equations(laid.equations);
  check_room(aero);
  if (aero.terms.size() <= 16) {
    lay(RigidAircraft<16>{geometry, std::move(aero), gravity}, along, laid);
  } else if (aero.terms.size() <= 24) {
    lay(RigidAircraft<24>{geometry, std::move(aero), gravity}, along, laid);
  } else {
    lay(RigidAircraft<40>{geometry, std::move(aero), gravity}, along, laid);
  }
}

/// Scales and biases of what is measured beside the inertial unit.
Names held_of_aircraft(const std::vector<Variable>& linear) {
  Names held;
  const Names biases{"b_v", "b_beta", "b_alpha", "b_phi", "b_theta", "b_psi"};
  for (const Variable& parameter : linear) {
    const std::string& name = parameter.name;
    if (name.starts_with("lambda_") || base::is_among(biases, name)) held.push_back(name);
  }
  return held;
}

}  // namespace

std::string_view to_string(AircraftAxes axes) { return axes_of(axes).name; }

AircraftAxes find_aircraft_axes(std::string_view name) {
  for (const auto axes :
       {AircraftAxes::longitudinal, AircraftAxes::lateral, AircraftAxes::six_dof}) {
    if (name == to_string(axes)) return axes;
  }
  throw Error("there are no axes '" + std::string(name) +
              "'; choose longitudinal, lateral or six-dof");
}

Record with_states(const Record& record) {
  base::Columns columns(record);
  const std::size_t rows = record.length();
  const bool flow = record.has("airspeed") && record.has("alpha") && record.has("beta");
  std::array<std::vector<double>, 3> air;
  for (std::size_t row = 0; flow && row < rows; ++row) {
    const double V = record.column("airspeed")[row];
    const double alpha = record.column("alpha")[row];
    const double beta = record.column("beta")[row];
    air[0].push_back(V * std::cos(alpha) * std::cos(beta));
    air[1].push_back(V * std::sin(beta));
    air[2].push_back(V * std::sin(alpha) * std::cos(beta));
  }
  const auto add = [&](const std::string& name, std::vector<double> values) {
    if (!record.has(name)) columns.set(name, std::move(values));
  };
  if (flow) {
    add("u", air[0]);
    add("v", air[1]);
    add("w", air[2]);
  }
  for (const auto& [state, angle] :
       {std::pair{"phi", "roll"}, std::pair{"theta", "pitch"}, std::pair{"psi", "yaw"}}) {
    if (!record.has(angle)) continue;
    const auto values = record.column(angle);
    add(state, {values.begin(), values.end()});
  }
  if (!record.has("yaw")) add("psi", std::vector<double>(rows, 0.0));
  return columns.record();
}

namespace {

/// Throws Error for a state that is read and isn't logged, by the name that logs have for it.
void check_measured(const Record& record, const Names& measured) {
  const std::map<std::string_view, std::string> logged{
      {"phi", "roll"}, {"theta", "pitch"}, {"psi", "yaw"}};
  for (const std::string& state : measured) {
    const auto at = logged.find(state);
    if (at == logged.end() || record.has(state)) continue;
    throw Error("column '" + at->second + "' is missing, as the state " + state +
                " is read and not integrated; add it, or integrate " + state +
                " too (six degrees of freedom, or other measured states)");
  }
}

}  // namespace

AircraftTrajectory lay_aircraft(const Record& record, const AircraftGeometry& geometry,
                                const OutputErrorOptions& options) {
  if (!geometry.has_inertia()) {
    throw Error("output error needs the aircraft's inertia; give Ix, Iy, Iz and Ixz");
  }
  AircraftTrajectory laid;
  laid.fit = options.fit;
  laid.equations = complete_equations(options.equations, axes_of(options.axes).coefficients);
  Names coefficients;
  for (const AeroEquation& equation : laid.equations) coefficients.push_back(equation.coefficient);
  const AeroCoefficients found =
      aero_coefficients(record, geometry, {.coefficients = coefficients, .window = options.window});
  const AeroFit start =
      fit_equation_error(found, laid.equations, {.coloured_errors = false, .threads = 1});
  for (const Parameter& parameter : start.fit.parameters) {
    if (std::isfinite(parameter.value)) laid.fit.start.emplace(parameter.name, parameter.value);
  }
  base::Columns columns(with_states(record));
  if (!record.has("rho")) {
    std::vector<double> rho;
    for (std::size_t row = 0; row < record.length(); ++row) {
      const double V = record.column("airspeed")[row];
      rho.push_back(2.0 * record.column("qbar")[row] / (V * V));
    }
    columns.set("rho", std::move(rho));
  }
  laid.record = columns.record();
  const TrajectoryOptions chosen = along(record, options);
  check_measured(laid.record, chosen.measured);
  const bool reads =
      std::ranges::any_of(chosen.measured, [](const std::string& state) { return state != "psi"; });
  if (reads) laid.warning = measured_warning;
  lay_smallest(geometry, options.gravity, chosen, laid);
  aircraft::hold_at_zero(held_of_aircraft(laid.model->tables().linear), options.free, laid.fit);
  laid.notes = coefficient_notes(record, geometry, coefficients);
  return laid;
}

AeroFit fit_output_error(const Record& record, const AircraftGeometry& geometry,
                         const OutputErrorOptions& options) {
  AircraftTrajectory laid = lay_aircraft(record, geometry, options);
  return {fit(*laid.model, laid.record, laid.fit), std::move(laid.equations), std::move(laid.notes),
          std::move(laid.warning)};
}

}  // namespace sepcal
