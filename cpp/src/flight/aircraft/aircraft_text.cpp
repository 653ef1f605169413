// SPDX-License-Identifier: BSD-3-Clause
// Fits of an aircraft as pages for people.
#include <algorithm>
#include <cmath>

#include "base/page.hpp"
#include "flight/aircraft/aircraft_effects.hpp"
#include "flight/text/fit_text.hpp"
#include "flight/text/pages.hpp"
#include "sepcal/detail/flight/effect_catalogue.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal {

using base::joined;
using base::Page;
using base::page;

namespace {

Page heading(const AircraftFit& fitted) {
  Page text = page("{} by {}", to_string(fitted.options.model), method_of(fitted));
  if (fitted.options.model != AircraftModel::aero) {
    text += page(", inputs {} between rows", to_string(fitted.options.trajectory.inputs));
  }
  if (const auto& band = fitted.options.band) {
    text += page(", {:.4g} to {:.4g} Hz", band->low, band->high);
  }
  if (fitted.options.geometry && fitted.options.model != AircraftModel::path) {
    text += page(", pitch rate q {}", to_string(fitted.options.geometry->rate_reference));
  }
  return text + page(": {} of {} rows of {}\n", fitted.flight.rows_used, fitted.flight.rows,
                     fitted.flight.file);
}

/// The chain of added effects, each with the errors before and after.
Page history_table(const AircraftFit& fitted) {
  Page text = fitted.history.empty() ? Page() : Page("\nRMSE before and after\n");
  for (const AddedRegressor& added : fitted.history) {
    text += page("  + {}\n", added.effect);
    for (std::size_t j = 0; j < added.rmse_after.size(); ++j) {
      const double before = added.rmse_before[j].value;
      const double after = added.rmse_after[j].value;
      text += page("      {:<9} {:.4g} -> {:.4g}  ({:+.1f} %)\n", added.rmse_after[j].name, before,
                   after, 100.0 * (after / before - 1.0));
    }
    if (std::isnan(added.predicted_drop)) continue;
    text += page("      all, each in units of its own: {:+.1f} %, promised {:+.1f} %\n",
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
  std::vector<Eigen::Index> kept;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    const bool hidden = std::ranges::find(initial, fit.parameters[k].name) != initial.end();
    if (!hidden) kept.push_back(static_cast<Eigen::Index>(k));
  }
  if (fit.correlation.rows() == static_cast<Eigen::Index>(fit.parameters.size())) {
    fit.correlation = fitted.fit.correlation(kept, kept);
  }
  std::erase_if(fit.parameters, [&](const Parameter& parameter) {
    return std::ranges::find(initial, parameter.name) != initial.end();
  });
  return fit;
}

Page fit_page(const AircraftFit& fitted, Detail detail) {
  const Fit fit = shown(fitted, detail);
  Page text = heading(fitted) + text::fit_table(fit, fitted.options.calibration, {}, detail);
  if (const auto hidden = fitted.fit.parameters.size() - fit.parameters.size(); hidden > 0) {
    text += page("{} initial states of the segments: all of them with --explain\n", hidden);
  }
  text += history_table(fitted);
  if (!fitted.warning.empty()) text += page("\nwarning: {}\n", fitted.warning);
  return text;
}

}  // namespace

std::string to_text(const AircraftFit& fitted, Detail detail) {
  return fit_page(fitted, detail).text();
}

std::string to_text(const StepwiseAircraft& result, Detail detail) {
  return (text::course_page(result.course) + "\n" + fit_page(result.fitted, detail)).text();
}

std::string to_text(const TwoStepFit& fitted, Detail detail) {
  const Page text = "step one, the flight path\n" + fit_page(fitted.path, detail) +
                    "\nstep two, the aerodynamics of what was flown\n" +
                    fit_page(fitted.aero, detail);
  return text.text();
}

std::string to_text(const Applied& applied, const AircraftFit& fitted) {
  constexpr std::size_t many = 24;
  const auto& headers = applied.headers;
  Page text = page("wrote {}: {} rows with {} more\n", applied.output, applied.rows,
                   headers.size() > many ? page("{} columns, {} ... {}", headers.size(),
                                                headers.front(), headers.back())
                                         : joined(headers, ", "));
  if (applied.rows_left_empty > 0) {
    text += page("{} rows were left empty: they are in no segment\n", applied.rows_left_empty);
  }
  text += page("status of the fit: {}\n", to_string(fitted.fit.status));
  return text.text();
}

std::string aircraft_effects_text() {
  Page text = text::catalogue_page("path") + text::catalogue_page("aircraft") +
              "the regressors of each coefficient\n";
  for (const AeroEquation& equation : standard_equations()) {
    text += page("  {}  {}\n", equation.coefficient, joined(equation.regressors, ", "));
  }
  text += "\nwhat diagnose tries beside these and every other channel of the log\n";
  for (const char* const like : {"Cm", "Cn"}) {
    text += page("  {}  {}\n", like == std::string_view("Cm") ? "CX CZ Cm" : "CY Cl Cn",
                 joined(aircraft_log::usual_regressors(like), ", "));
  }
  text +=
      "\n--effect adds a regressor: a product of powers of alpha, beta, p_hat, q_hat, r_hat,\n"
      "elevator, aileron, rudder, throttle and any other column of the log by its header, as\n"
      "  --effect 'Cm[alpha^2]'  --effect 'Cl[alpha*p_hat]'  --effect 'CY[beta*abs(beta)]'\n"
      "--equation 'Cm=1,alpha,q_hat,elevator' takes the place of a coefficient's own\n";
  return text.text();
}

}  // namespace sepcal
