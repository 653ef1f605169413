// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/expected_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/name_list.hpp"
#include "base/page.hpp"
#include "base/thread_pool.hpp"
#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/files/headers.hpp"
#include "flight/json/output_values.hpp"
#include "flight/text/fit_text.hpp"
#include "flight/text/number_text.hpp"
#include "flight/text/status_text.hpp"
#include "flight/verbs/residual_comparison.hpp"
#include "sepcal/collinearity.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace aircraft_log;  // this room's own
using base::Page;
using base::page;
using text::defined;

namespace {

using Values = std::map<std::string, double>;

/// The fit's values, with the initial state of the first trajectory as the only one's.
Values values_at_start(const Fit& at, const std::vector<std::string>& initial_states) {
  Values values;
  for (const Parameter& parameter : at.parameters) {  // the first trajectory comes first
    const bool begins = base::is_among(initial_states, parameter.name);
    const std::size_t end = begins ? parameter.name.find('[') : std::string::npos;
    values.emplace(parameter.name.substr(0, end), parameter.value);
  }
  return values;
}

/// In the unit used inside; nothing where the model reads no such column.
std::optional<std::pair<std::string, std::vector<double>>> read_input(const Flight& inputs,
                                                                      const Flight::Column& column,
                                                                      const LaidAircraft& base,
                                                                      AircraftModel model) {
  std::string name = column.header;
  std::vector<double> values(column.values.begin(), column.values.end());
  for (const probes::ProbeQuantity& quantity : quantities_of(model).list) {
    const auto logged = files::find_quantity(inputs, quantity.name, quantity.kind);
    if (!logged || logged->column != &column) continue;
    name = quantity.name;
    values = logged->values();
  }
  const std::vector<Variable>& outputs = base.model->tables().outputs;
  const bool is_output = std::ranges::find(outputs, name, &Variable::name) != outputs.end();
  if (name == "time" || is_output || !base.record.has(name)) return std::nullopt;
  return std::pair{std::move(name), std::move(values)};
}

void check_finite(const Flight& inputs, const Flight::Column& column) {
  const auto bad = std::ranges::find_if(column.values, [](double v) { return !std::isfinite(v); });
  if (bad == column.values.end()) return;
  throw Error(fmt::format("{}: column '{}' is no number; inputs are flown in every row",
                          inputs.locate(static_cast<std::size_t>(bad - column.values.begin())),
                          column.header));
}

/// Every column as in the row where the flight begins, and the inputs on top of it.
Record fly_inputs(const Flight& inputs, const LaidAircraft& base, const Flight& flight,
                  AircraftModel model) {
  const auto time = files::find_quantity(inputs, "time", files::UnitKind::time);
  if (!time) {
    throw Error(
        fmt::format("{}: column 'time_s' is missing; {}", inputs.name(), inputs.list_columns()));
  }
  const std::size_t start = base.record.segments().front().first;
  Record flown;
  for (const std::string& name : base.record.names()) {
    flown.add(name, std::vector<double>(inputs.rows(), base.record.column(name)[start]));
  }
  for (const Flight::Column& column : inputs.columns()) {
    check_finite(inputs, column);
    if (&column == time->column) continue;
    auto read = read_input(inputs, column, base, model);
    if (!read) {
      throw Error(
          fmt::format("{}: '{}' is no input that the model reads of {}; leave it out, or "
                      "log it",
                      inputs.name(), column.header, flight.name()));
    }
    auto& [name, values] = *read;
    for (double& value : values) value += base.record.column(name)[start];
    flown.replace(name, std::move(values));
  }
  flown.replace("time", time->values());
  flown.cut(find_segments(flown.column("time"), {}));
  if (flown.segments().size() > 1) {
    throw Error(fmt::format("{}: time has a gap; inputs are flown at one go", inputs.name()));
  }
  return flown;
}

/// Puts what the model gives in the place of the outputs (rows in one segment).
std::vector<OutputRange> put_modelled(const Values& values, LaidAircraft& laid) {
  const Tables& tables = laid.model->tables();
  Fit at;
  for (const Variable& parameter : tables.parameters()) {
    const auto known = values.find(parameter.name);
    at.parameters.push_back({.name = parameter.name, .unit = parameter.unit});
    at.parameters.back().value = known == values.end() ? 0.0 : known->second;
  }
  at.n_1 = tables.n_1();
  base::ThreadPool pool(1);
  const Eigen::MatrixXd residuals = verbs::residuals_of(*laid.model, laid.record, at, pool);
  std::vector<OutputRange> ranges;
  for (Eigen::Index j = 0; j < residuals.cols(); ++j) {
    const Variable& output = tables.outputs[static_cast<std::size_t>(j)];
    const auto read = laid.record.column(output.name);
    std::vector<double> modelled(read.begin(), read.end());
    for (std::size_t row = 0; row < modelled.size(); ++row) {
      modelled[row] -= residuals(static_cast<Eigen::Index>(row), j);
    }
    const auto [low, high] = std::ranges::minmax_element(modelled);
    if (!std::isfinite(*low) || !std::isfinite(*high)) {
      throw Error(
          fmt::format("{} runs away while the model flies the inputs; make them smaller or "
                      "shorter",
                      output.name));
    }
    ranges.push_back({output.name, output.unit, *low, *high});
    laid.record.replace(output.name, std::move(modelled));
  }
  return ranges;
}

/// From the values on, weighed by the noise that the fit found.
FitOptions options_at(const Values& values, const AircraftFit& fitted, const LaidAircraft& laid) {
  FitOptions options = laid.fit;
  options.start.clear();
  for (const Variable& parameter : laid.model->tables().nonlinear) {
    const auto known = values.find(parameter.name);
    if (known == values.end() || options.fix.contains(parameter.name)) continue;
    options.start.emplace(parameter.name, known->second);
  }
  for (auto& [name, prior] : options.prior) {  // what it is worth, and no pull
    const auto known = values.find(name);
    if (known != values.end()) prior.mean = known->second;
  }
  for (const OutputValue& noise : fitted.fit.noise) options.noise[noise.name] = noise.value;
  if (fitted.fit.method == FitMethod::filter_error) {
    options.process_noise = fitted.fit.process_noise();
  }
  options.coloured_errors = false;
  return options;
}

/// By how much errors that allow for colour were larger than white ones, in the middle.
double colour_of(const Fit& fit) {
  std::vector<double> ratios;
  for (const Parameter& parameter : fit.parameters) {
    const double ratio = parameter.standard_error / parameter.standard_error_white;
    if (std::isfinite(ratio)) ratios.push_back(ratio);
  }
  if (ratios.empty()) return 1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::ranges::nth_element(ratios, middle);
  return *middle;
}

std::vector<std::string> notes_of(const AircraftFit& fitted, const LaidAircraft& base,
                                  const LaidAircraft& laid) {
  std::vector<std::string> notes;
  constexpr double worth_a_word = 1.2;
  if (const double colour = colour_of(fitted.fit); colour > worth_a_word) {
    notes.push_back(
        fmt::format("the fit's residuals are no white noise: its errors are {:.2g} times as large "
                    "as white ones, and so may these come to be",
                    colour));
  }
  if (fitted.options.band) notes.emplace_back("these are errors of a fit in time");
  if (!base.gaps.empty()) notes.emplace_back("every output is taken to be read in every row");
  if (!laid.warning.empty()) notes.push_back(laid.warning);
  return notes;
}

}  // namespace

ExpectedFit expect_aircraft(const AircraftFit& fitted, const Flight& flight, const Flight& inputs) {
  const AircraftModel model = fitted.options.model;
  if (model == AircraftModel::path || model == AircraftModel::aero) {
    throw Error(fmt::format("the model '{}' flies no inputs; fit longitudinal, lateral or six-dof",
                            to_string(model)));
  }
  LaidAircraft base = lay(flight, options_on(fitted, flight));
  const Fit at = fit_on(flight, fitted, base);
  const Values values = values_at_start(at, base.initial_states);
  AircraftOptions options = options_on(fitted, inputs);
  options.band.reset();
  options.trajectory.shoot = infinity;
  options.calibration.log.smooth_inputs = false;
  ExpectedFit expected;
  within(inputs, [&] {
    LaidAircraft laid = lay_record(fly_inputs(inputs, base, flight, model), options);
    expected.ranges = put_modelled(values, laid);
    expected.fit = fit_laid(laid, options_at(values, fitted, laid));
    expected.notes = notes_of(fitted, base, laid);
  });
  for (const Parameter& parameter : expected.fit.parameters) {
    const auto same = std::ranges::find(fitted.fit.parameters, parameter.name, &Parameter::name);
    if (same == fitted.fit.parameters.end()) continue;
    expected.had.push_back({parameter.name, same->standard_error});
  }
  return expected;
}

ExpectedFit expect_aircraft(const AircraftFit& fitted, const Flight& flight,
                            const InputDesign& inputs) {
  Flight table("the inputs");
  table.add("time_s", inputs.time);
  for (std::size_t i = 0; i < inputs.inputs.size(); ++i) {
    const auto signal = inputs.signals.col(static_cast<Eigen::Index>(i));
    table.add(inputs.inputs[i], {signal.begin(), signal.end()});
  }
  return expect_aircraft(fitted, flight, table);
}

std::string to_text(const ExpectedFit& expected, Detail detail) {
  const Fit& fit = expected.fit;
  Page text = page("\nto be expected of {} rows\n", fit.rows);
  text += text::status_lines(fit, detail);
  text += page("\n{:<14} {:>13} {:>12} {:>12}  {}\n", "parameter", "value", "std. error",
               "of the fit", "unit");
  for (const Parameter& parameter : fit.parameters) {
    if (parameter.fixed) continue;
    const auto had = std::ranges::find(expected.had, parameter.name, &OutputValue::name);
    const double before = had == expected.had.end() ? not_a_number : had->value;
    text +=
        page("{:<14} {:>13.6g} {:>12} {:>12}  {}", parameter.name, parameter.value,
             defined(parameter.standard_error, "{:.2g}"), defined(before, "{:.2g}"), parameter.unit)
            .trimmed() +
        "\n";
  }
  text += text::collinearity_lines(fit, detail);
  text += page("\n{:<14} {:>13} {:>12} {:>12}  {}\n", "output", "from", "to", "noise", "unit");
  for (std::size_t j = 0; j < expected.ranges.size(); ++j) {
    const OutputRange& range = expected.ranges[j];
    text += page("{:<14} {:>13.4g} {:>12.4g} {:>12.2g}  {}", range.name, range.low, range.high,
                 fit.noise[j].value, range.unit)
                .trimmed() +
            "\n";
  }
  for (const std::string& note : expected.notes) text += page("note: {}\n", note);
  return text.text();
}

std::string to_json(const ExpectedFit& expected) {
  using json::Json;
  Json root = {{"schema_version", schema_version},
               {"status", to_string(expected.fit.status)},
               {"message", expected.fit.message},
               {"rows", expected.fit.rows}};
  Json& parameters = root["parameters"] = Json::object();
  for (const Parameter& parameter : expected.fit.parameters) {
    if (parameter.fixed) continue;
    const auto had = std::ranges::find(expected.had, parameter.name, &OutputValue::name);
    parameters[parameter.name] = {
        {"value", parameter.value},
        {"unit", parameter.unit},
        {"standard_error", json::number(parameter.standard_error)},
        {"standard_error_of_fit",
         json::number(had == expected.had.end() ? not_a_number : had->value)}};
  }
  root["correlated"] = Json::array();
  for (const CorrelatedPair& pair : find_collinearity(expected.fit).pairs) {
    root["correlated"].push_back(
        {{"first", pair.first}, {"second", pair.second}, {"correlation", pair.correlation}});
  }
  root["outputs"] = Json::object();
  for (const OutputRange& range : expected.ranges) {
    root["outputs"][range.name] = {{"from", range.low}, {"to", range.high}, {"unit", range.unit}};
  }
  root["notes"] = expected.notes;
  return json::text_of(root);
}

std::string to_json(const InputDesign& design, const ExpectedFit& expected) {
  json::Json root = json::Json::parse(to_json(design));
  root["expected"] = json::Json::parse(to_json(expected));
  root["expected"].erase("schema_version");
  return json::text_of(root);
}

}  // namespace sepcal
