// SPDX-License-Identifier: BSD-3-Clause
// A fit of an aircraft put to use: what was flown, row by row, beside the log.
#include <algorithm>
#include <cmath>

#include "base/thread_pool.hpp"
#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/files/headers.hpp"
#include "flight/verbs/added_columns.hpp"
#include "flight/verbs/residual_comparison.hpp"
#include "sepcal/detail/aircraft/coefficients.hpp"
#include "sepcal/flight/aircraft.hpp"
#include "sepcal/states/reconstruct.hpp"

namespace sepcal {

using namespace aircraft_log;  // this room's own

namespace {

using Columns = std::vector<CorrectedColumn>;

/// Values of the record's rows at the rows of the flight.
std::vector<double> spread(std::span<const double> values, const LaidAircraft& laid,
                           std::size_t flight_rows) {
  std::vector<double> spread(flight_rows, not_a_number);
  for (std::size_t row = 0; row < values.size(); ++row) spread[laid.flight_rows[row]] = values[row];
  return spread;
}

/// The outputs at the fit, in the segments' rows.
void add_modelled(const Fit& fit, const LaidAircraft& laid, const Flight& flight,
                  Columns& columns) {
  const auto& outputs = laid.model->tables().outputs;
  base::ThreadPool pool(1);
  const Eigen::MatrixXd residuals = verbs::residuals_of(*laid.model, laid.record, fit, pool);
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    std::vector<double> modelled(laid.record.length(), not_a_number);
    Eigen::Index k = 0;
    for (const Segment& segment : laid.record.segments()) {
      for (std::size_t row = segment.first; row < segment.last; ++row, ++k) {
        modelled[row] =
            laid.record.column(outputs[j].name)[row] - residuals(k, static_cast<Eigen::Index>(j));
      }
    }
    columns.push_back({files::header_of(outputs[j].name + "_model", outputs[j].unit),
                       spread(modelled, laid, flight.rows())});
  }
}

void add_path(const AircraftFit& fitted, const Fit& fit, const LaidAircraft& laid,
              const Flight& flight, Columns& columns) {
  const Record flown = reconstruct(*laid.path, fit.by_name(), seen_by_model(laid, fit));
  const auto add = [&](const Record& record, const std::string& name, const std::string& header) {
    columns.push_back({header, spread(record.column(name), laid, flight.rows())});
  };
  const auto add_table = [&](const auto& table, std::size_t count, const std::string& middle) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::string name(table[i].name);
      add(flown, name, files::header_of(name + middle, std::string(table[i].unit)));
    }
  };
  add_table(FlightPath::inputs, FlightPath::readings, "_cal");
  add_table(FlightPath::outputs, 6, "_cal");
  add_table(FlightPath::states, 3, "");
  if (fitted.options.position) {
    for (const char* name : {"x", "y", "z"}) add(flown, name, files::header_of(name, "m"));
  }
  if (!fitted.options.geometry) return;
  const AeroCoefficients found =
      aero_coefficients(flown, *fitted.options.geometry, {.window = fitted.options.window});
  for (const std::string& name : found.names) add(found.record, name, name);
}

std::vector<double> column_of(const Eigen::MatrixXd& matrix, Eigen::Index j) {
  const Eigen::VectorXd column = matrix.col(j);
  return {column.begin(), column.end()};
}

/// Square roots of an element of the diagonal, row by row.
std::vector<double> deviations_of(const std::vector<Eigen::MatrixXd>& covariances, Eigen::Index i) {
  std::vector<double> deviations;
  for (const Eigen::MatrixXd& P : covariances) deviations.push_back(std::sqrt(P(i, i)));
  return deviations;
}

/// States, the noises that were given, and the innovations.
void add_smoothed(const SmoothedRecord& smoothed, const ProcessNoise& given,
                  const StateTables& tables, const LaidAircraft& laid, const Flight& flight,
                  Columns& columns) {
  const auto add = [&](const std::string& name, const std::string& unit,
                       const std::vector<double>& values) {
    columns.push_back({files::header_of(name, unit), spread(values, laid, flight.rows())});
  };
  const auto unit_of = [](const std::vector<Variable>& table, const std::string& name) {
    return std::ranges::find(table, name, &Variable::name)->unit;
  };
  for (std::size_t i = 0; i < smoothed.states.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const std::string& name = smoothed.states[i];
    const std::string unit = unit_of(tables.states, name);
    add(name + "_smooth", unit, column_of(smoothed.x, at));
    add(name + "_sd", unit, deviations_of(smoothed.P, at));
  }
  for (std::size_t i = 0; i < smoothed.noises.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const std::string& name = smoothed.noises[i];
    if (!given.contains(name)) continue;
    std::string unit = unit_of(tables.noise, name);
    unit.resize(unit.rfind("/sqrt"));  // of w itself
    add("w_" + name, unit, column_of(smoothed.w, at));
    add("w_" + name + "_sd", unit, deviations_of(smoothed.Q, at));
  }
  for (std::size_t j = 0; j < smoothed.outputs.size(); ++j) {
    const std::string& name = smoothed.outputs[j];
    add(name + "_innovation", unit_of(tables.outputs, name),
        column_of(smoothed.innovations, static_cast<Eigen::Index>(j)));
  }
}

/// But for the initial states, which are another flight's, and the smoother's own.
ParameterErrors errors_without_starts(const AircraftFit& fitted) {
  const ParameterErrors all = errors_of(fitted.fit);
  std::vector<Eigen::Index> kept;
  ParameterErrors errors;
  for (std::size_t i = 0; i < all.names.size(); ++i) {
    if (std::ranges::find(fitted.initial_states, all.names[i]) != fitted.initial_states.end()) {
      continue;
    }
    kept.push_back(static_cast<Eigen::Index>(i));
    errors.names.push_back(all.names[i]);
  }
  errors.covariance = all.covariance(kept, kept);
  return errors;
}

}  // namespace

SmoothedRecord aircraft_log::smooth_laid(const AircraftFit& fitted, const Fit& fit,
                                         const LaidAircraft& laid,
                                         const ProcessNoise& process_noise) {
  SmoothingNoise noise{.process = process_noise};
  for (const OutputValue& output : fitted.fit.noise) noise.outputs[output.name] = output.value;
  return smooth(state_model_of(laid, fitted), readings_of(laid), fit.by_name(), noise,
                errors_without_starts(fitted));
}

SmoothedRecord smooth_aircraft(const AircraftFit& fitted, const Flight& flight,
                               const ProcessNoise& given) {
  const ProcessNoise process_noise = given.empty() ? fitted.fit.process_noise() : given;
  LaidAircraft laid = lay(flight, options_on(fitted, flight));
  const Fit fit = fit_on(flight, fitted, laid);
  const SmoothedRecord on_record =
      within(flight, [&] { return smooth_laid(fitted, fit, laid, process_noise); });
  SmoothedRecord smoothed = on_record;
  const auto rows = static_cast<Eigen::Index>(flight.rows());
  for (auto* matrix : {&smoothed.x, &smoothed.w, &smoothed.innovations, &smoothed.innovation_sd}) {
    matrix->setConstant(rows, matrix->cols(), not_a_number);
  }
  const auto nothing = [](const std::vector<Eigen::MatrixXd>& matrices) {
    return Eigen::MatrixXd::Constant(matrices.front().rows(), matrices.front().cols(),
                                     not_a_number);
  };
  smoothed.P.assign(flight.rows(), nothing(on_record.P));
  smoothed.Q.assign(flight.rows(), nothing(on_record.Q));
  for (std::size_t row = 0; row < laid.flight_rows.size(); ++row) {
    const auto from = static_cast<Eigen::Index>(row);
    const auto to = static_cast<Eigen::Index>(laid.flight_rows[row]);
    smoothed.x.row(to) = on_record.x.row(from);
    smoothed.w.row(to) = on_record.w.row(from);
    smoothed.innovations.row(to) = on_record.innovations.row(from);
    smoothed.innovation_sd.row(to) = on_record.innovation_sd.row(from);
    smoothed.P[laid.flight_rows[row]] = on_record.P[row];
    smoothed.Q[laid.flight_rows[row]] = on_record.Q[row];
  }
  return smoothed;
}

std::vector<CorrectedColumn> apply_aircraft(const AircraftFit& fitted, const Flight& flight,
                                            const ProcessNoise& given,
                                            std::vector<std::string>& notes) {
  const ProcessNoise process_noise = given.empty() ? fitted.fit.process_noise() : given;
  LaidAircraft laid = lay(flight, options_on(fitted, flight));
  const Fit fit = fit_on(flight, fitted, laid);
  Columns columns;
  add_modelled(fit, laid, flight, columns);
  if (laid.path) add_path(fitted, fit, laid, flight, columns);
  if (!process_noise.empty()) {
    const StateTables& tables = state_model_of(laid, fitted).plan().model();
    const SmoothedRecord smoothed =
        within(flight, [&] { return smooth_laid(fitted, fit, laid, process_noise); });
    add_smoothed(smoothed, process_noise, tables, laid, flight, columns);
    if (!fitted.warning.empty())
      notes.push_back(fitted.warning);  // the bands have the fit's errors
  }
  notes.insert(notes.end(), laid.notes.begin(), laid.notes.end());
  return columns;
}

Applied apply_aircraft_to_file(const AircraftFit& fitted, const std::string& file,
                               const std::string& output, const ProcessNoise& process_noise,
                               const Progress& progress) {
  check_not_input(output, file);
  OutputFile target(output);
  const Flight flight = read_csv(file, progress, 0, fitted.options.calibration.log.form());
  Applied applied{.output = output, .rows = flight.rows(), .headers = {}, .notes = {}};
  const Columns columns = apply_aircraft(fitted, flight, process_noise, applied.notes);
  verbs::write_with_columns(flight, columns, target);
  target.commit();
  for (const CorrectedColumn& column : columns) applied.headers.push_back(column.header);
  const auto& modelled = columns.front().values;
  applied.rows_left_empty = static_cast<std::size_t>(
      std::ranges::count_if(modelled, [](double value) { return std::isnan(value); }));
  return applied;
}

}  // namespace sepcal
