// SPDX-License-Identifier: BSD-3-Clause
// Fits of an aircraft as pages for people.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "flight/aircraft/aircraft_effects.hpp"
#include "flight/text/fit_text.hpp"
#include "sepcal/flight/aircraft.hpp"
#include "sepcal/flight/effect_catalogue.hpp"

namespace sepcal {
namespace {

std::string heading(const AircraftFit& fitted) {
  std::string text = fmt::format("{} by {}", to_string(fitted.options.model), method_of(fitted));
  if (fitted.options.model != AircraftModel::aero) {
    text += fmt::format(", inputs {} between rows", to_string(fitted.options.trajectory.inputs));
  }
  if (fitted.options.geometry && fitted.options.model != AircraftModel::path) {
    text += fmt::format(", pitch rate q {}", to_string(fitted.options.geometry->rate_reference));
  }
  return text + fmt::format(": {} of {} rows of {}\n", fitted.flight.rows_used, fitted.flight.rows,
                            fitted.flight.file);
}

/// The chain of added effects, each with the errors before and after.
std::string history_table(const AircraftFit& fitted) {
  std::string text = fitted.history.empty() ? "" : "\nRMSE before and after\n";
  for (const AddedRegressor& added : fitted.history) {
    text += fmt::format("  + {}\n", added.effect);
    for (std::size_t j = 0; j < added.rmse_after.size(); ++j) {
      const double before = added.rmse_before[j].value;
      const double after = added.rmse_after[j].value;
      text += fmt::format("      {:<9} {:.4g} -> {:.4g}  ({:+.1f} %)\n", added.rmse_after[j].name,
                          before, after, 100.0 * (after / before - 1.0));
    }
    if (std::isnan(added.predicted_drop)) continue;
    text += fmt::format("      all, each in units of its own: {:+.1f} %, promised {:+.1f} %\n",
                        -100.0 * added.drop(), -100.0 * added.predicted_drop);
  }
  return text;
}

/// The fit without its initial states, where these are so many that they would hide the rest.
Fit shown(const AircraftFit& fitted, Detail detail) {
  constexpr std::size_t many = 12;
  Fit fit = fitted.fit;
  const std::vector<std::string>& initial = fitted.initial_states;
  if (detail == Detail::explained || initial.size() <= many) return fit;
  std::erase_if(fit.parameters, [&](const Parameter& parameter) {
    return std::ranges::find(initial, parameter.name) != initial.end();
  });
  return fit;
}

}  // namespace

std::string to_text(const AircraftFit& fitted, Detail detail) {
  const Fit fit = shown(fitted, detail);
  std::string text = heading(fitted) + text::fit_table(fit, fitted.options.calibration, {}, detail);
  if (const auto hidden = fitted.fit.parameters.size() - fit.parameters.size(); hidden > 0) {
    text += fmt::format("{} initial states of the segments: all of them with --explain\n", hidden);
  }
  text += history_table(fitted);
  if (!fitted.warning.empty()) text += fmt::format("\nwarning: {}\n", fitted.warning);
  return text;
}

std::string to_text(const StepwiseAircraft& result, Detail detail) {
  return to_text(result.course) + "\n" + to_text(result.fitted, detail);
}

std::string to_text(const TwoStepFit& fitted, Detail detail) {
  return "step one, the flight path\n" + to_text(fitted.path, detail) +
         "\nstep two, the aerodynamics of what was flown\n" + to_text(fitted.aero, detail);
}

std::string to_text(const Applied& applied, const AircraftFit& fitted) {
  constexpr std::size_t many = 24;
  const auto& headers = applied.headers;
  std::string text = fmt::format(
      "wrote {}: {} rows with {} more\n", applied.output, applied.rows,
      headers.size() > many
          ? fmt::format("{} columns, {} ... {}", headers.size(), headers.front(), headers.back())
          : fmt::format("{}", fmt::join(headers, ", ")));
  if (applied.rows_left_empty > 0) {
    text +=
        fmt::format("{} rows were left empty: they are in no segment\n", applied.rows_left_empty);
  }
  return text + fmt::format("status of the fit: {}\n", to_string(fitted.fit.status));
}

std::string aircraft_effects_text() {
  std::string text =
      catalogue_text("path") + catalogue_text("aircraft") + "what each coefficient is a sum of\n";
  for (const AeroEquation& equation : standard_equations()) {
    text += fmt::format("  {}  {}\n", equation.coefficient, fmt::join(equation.regressors, ", "));
  }
  text += "\nwhat diagnose tries beside these and every other channel of the log\n";
  for (const char* const like : {"Cm", "Cn"}) {
    text += fmt::format("  {}  {}\n", like == std::string_view("Cm") ? "CX CZ Cm" : "CY Cl Cn",
                        fmt::join(aircraft_log::usual_regressors(like), ", "));
  }
  return text +
         "\n--effect adds a regressor: a product of powers of alpha, beta, p_hat, q_hat, r_hat,\n"
         "elevator, aileron, rudder, throttle and any other column of the log by its header, as\n"
         "  --effect 'Cm[alpha^2]'  --effect 'Cl[alpha*p_hat]'  --effect 'CY[beta*abs(beta)]'\n"
         "--equation 'Cm=1,alpha,q_hat,elevator' takes the place of a coefficient's own\n";
}

}  // namespace sepcal
