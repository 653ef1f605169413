// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/effect_readings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "base/parameter_values.hpp"
#include "base/thread_pool.hpp"
#include "flight/catalogue/effect_channels.hpp"
#include "flight/probes/corrected_columns.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "flight/verbs/residual_comparison.hpp"
#include "numerics/interpolated_column.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/error.hpp"

namespace sepcal::verbs {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The rows in which every channel is a number, cut at gaps and changes of maneuver.
struct Compact {
  Record record;
  std::vector<std::size_t> flight_rows;
};

Compact keep_rows(const ProbeReadings& readings, const Flight& flight,
                  const std::set<std::string>& needed) {
  Compact kept;
  std::vector<std::span<const double>> channels;
  for (const std::string& name : needed) channels.push_back(readings.record.column(name));
  for (std::size_t row = 0; row < readings.valid.size(); ++row) {
    const auto is_number = [row](const auto& column) { return std::isfinite(column[row]); };
    if (!readings.valid[row] || !std::ranges::all_of(channels, is_number)) continue;
    kept.flight_rows.push_back(row);
  }
  for (const std::string& name : readings.record.names()) {
    const auto column = readings.record.column(name);
    std::vector<double> values;
    values.reserve(kept.flight_rows.size());
    for (const std::size_t row : kept.flight_rows) values.push_back(column[row]);
    kept.record.add(name, std::move(values));
  }
  if (!kept.record.has("time") || kept.flight_rows.empty()) return kept;
  std::vector<std::string> labels;
  if (!flight.maneuvers().empty()) {
    for (const std::size_t row : kept.flight_rows) labels.push_back(flight.maneuvers()[row]);
  }
  kept.record.cut(find_segments(kept.record.column("time"), labels));
  return kept;
}

/// How far readings are shifted to undo delays: r'(t) = r(t + late) + lag dr/dt(t + late).
class TimeShift {
 public:
  void add(const Delay& delay, double tau) {
    if (delay.kind == Delay::Kind::inputs_lagging || delay.kind == Delay::Kind::outputs_lagging) {
      lag_ += tau;
      return;
    }
    late_.emplace_back(delay, tau);
  }

  bool none() const { return lag_ == 0.0 && late_.empty(); }
  double lag() const { return lag_; }  // [s]

  /// [s]; an output that was logged at t belongs to t - late(t), an input to where it is read.
  double late(double t) const {
    double seconds = 0.0;
    for (const auto& [delay, tau] : late_) {
      double own = 0.0;
      const int rounds = delay.kind == Delay::Kind::outputs_late && delay.grows ? 4 : 1;
      for (int round = 0; round < rounds; ++round) own = tau * delay.share_at(t + own);
      seconds += own;
    }
    return seconds;
  }

 private:
  std::vector<std::pair<Delay, double>> late_;
  double lag_ = 0.0;
};

/// The slope about `at` of the straight line through the rows within half a width of it, by least
/// squares: tau times the slope from one row to the next would multiply noise by tau over the
/// interval. `fallback` where fewer than three rows are so near.
double slope_about(std::span<const double> time, std::span<const double> values, double at,
                   double half_width, double fallback) {
  const auto first = std::ranges::lower_bound(time, at - half_width) - time.begin();
  const auto last = std::ranges::upper_bound(time, at + half_width) - time.begin();
  const auto rows = last - first;
  if (rows < 3) return fallback;
  const Eigen::Map<const Eigen::ArrayXd> t(time.data() + first, rows);
  const Eigen::Map<const Eigen::ArrayXd> x(values.data() + first, rows);
  const Eigen::ArrayXd centred = t - t.mean();
  return (centred * x).sum() / centred.square().sum();
}

/// NaN where the shift reaches beyond a segment's ends.
std::vector<double> put_in_time(const Record& record, const std::string& name,
                                const TimeShift& shift) {
  const numerics::InterpolatedColumn column(record, name);
  const auto time = record.column("time");
  const auto logged = record.column(name);
  std::vector<double> corrected(record.length(), not_a_number);
  for (const Segment& segment : record.segments()) {
    std::vector<NaturalSpline::Value> values(segment.rows());
    std::vector<double> late(segment.rows());
    for (std::size_t i = 0; i < late.size(); ++i) late[i] = shift.late(time[segment.first + i]);
    column.fill(segment.first, late, values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double at = time[segment.first + i] + late[i];
      if (at < time[segment.first] || at > time[segment.last - 1]) continue;
      const double slope = shift.lag() == 0.0
                               ? 0.0
                               : slope_about(time.subspan(segment.first, segment.rows()),
                                             logged.subspan(segment.first, segment.rows()), at,
                                             std::abs(shift.lag()), values[i].slope);
      corrected[segment.first + i] = values[i].value + shift.lag() * slope;
    }
  }
  return corrected;
}

/// The record with the columns that `shift_of` names shifted.
Record undo_delays(const Record& record, const std::map<std::string, TimeShift>& shift_of) {
  if (shift_of.empty()) return record;
  Record result;
  for (const std::string& name : record.names()) {
    const auto column = record.column(name);
    const auto shift = shift_of.find(name);
    result.add(name, shift == shift_of.end() ? std::vector(column.begin(), column.end())
                                             : put_in_time(record, name, shift->second));
  }
  result.cut(record.segments());
  return result;
}

/// The readings without their delays; a row of which one is lost, or what effects do there is not
/// known, is not valid.
ProbeReadings put_right(const Record& record, const std::map<std::string, TimeShift>& shifts,
                        const ReadingEffects& totals) {
  ProbeReadings kept{undo_delays(record, shifts), std::vector<bool>(record.length(), true), {}, {}};
  const auto check = [&kept](const auto& values) {
    for (std::size_t row = 0; row < kept.valid.size(); ++row) {
      if (!std::isfinite(values[row])) kept.valid[row] = false;
    }
  };
  for (const auto& [name, shift] : shifts) check(kept.record.column(name));
  for (const auto& [name, total] : totals.totals) {
    check(std::span(total.data(), static_cast<std::size_t>(total.size())));
  }
  return kept;
}

/// What delays of a probe's inputs do to its readings, by reading.
std::map<std::string, TimeShift> shifts_of_readings(const std::vector<Effect>& effects,
                                                    const base::ParameterValues& values) {
  std::map<std::string, TimeShift> shifts;
  for (const Effect& effect : effects) {
    for (const Delay& delay : effect.delays) {
      const double tau = base::value_of(values, delay.parameter.name);
      const bool of_inputs =
          delay.kind == Delay::Kind::inputs_late || delay.kind == Delay::Kind::inputs_lagging;
      if (!of_inputs) continue;
      for (const std::string& input : delay.inputs) shifts[input].add(delay, tau);
    }
  }
  return shifts;
}

/// What delays of all that a sensor measures do to it.
TimeShift shift_of_outputs(const std::vector<Effect>& effects,
                           const base::ParameterValues& values) {
  TimeShift shift;
  for (const Effect& effect : effects) {
    for (const Delay& delay : effect.delays) {
      const bool of_outputs =
          delay.kind == Delay::Kind::outputs_late || delay.kind == Delay::Kind::outputs_lagging;
      if (of_outputs) shift.add(delay, base::value_of(values, delay.parameter.name));
    }
  }
  return shift;
}

/// Corrected columns, one value a row of `record`, shifted: drivers acted when they were logged.
void undo_delays(std::vector<CorrectedColumn>& columns, const Record& record,
                 const TimeShift& shift) {
  if (shift.none()) return;
  const auto time = record.column("time");
  for (CorrectedColumn& column : columns) {
    Record alone;
    alone.add("time", {time.begin(), time.end()}).add(column.header, std::move(column.values));
    alone.cut(record.segments());
    column.values = put_in_time(alone, column.header, shift);
  }
}

ReadingEffects totals_of(const std::vector<Effect>& effects, const base::ParameterValues& values,
                         const Record& record) {
  ReadingEffects result;
  for (const Effect& effect : effects) {
    for (const std::string& component : effect.components) {
      const std::string name = effect.port + "." + component;
      if (result.totals.contains(name)) continue;
      result.totals[name] = port_total(effects, effect.port, component, values, record);
    }
    for (const auto& term : effect.terms) {
      const auto& tables = term->tables();
      result.terms.push_back(
          {term, base::in_order(tables.linear, values), base::in_order(tables.nonlinear, values)});
    }
  }
  return result;
}

/// Adds what these effects read to the readings; returns the channels that a row needs for them.
std::set<std::string> add_what_drives(const Calibration& calibration,
                                      const std::vector<EffectSetting>& settings,
                                      const Flight& flight, ProbeReadings& readings) {
  std::set<std::string> needed;
  for (const EffectSetting& setting : settings) {
    if (calibration.options.own_effects.contains(setting.name)) {
      catalogue::add_all_channels(readings.record, flight);
      continue;
    }
    for (std::string& channel : catalogue::add_channels(readings.record, flight, *calibration.probe,
                                                        parse_effect_name(setting.name))) {
      needed.insert(std::move(channel));
    }
  }
  return needed;
}

/// What the model with its effects makes of the inputs, in the rows that have all that it takes.
std::vector<CorrectedColumn> predict_outputs(const Calibration& calibration, const Flight& flight,
                                             ProbeReadings& readings) {
  const Probe& probe = *calibration.probe;
  std::vector<EffectSetting> settings = calibration.options.effects;
  const std::set<std::string> needed = add_what_drives(calibration, settings, flight, readings);
  std::vector<CorrectedColumn> columns = probe.correct(readings, own_values(calibration), {});
  Compact compact = keep_rows(readings, flight, needed);
  readings.valid.assign(readings.valid.size(), false);
  if (compact.flight_rows.empty()) return columns;
  Record& record = compact.record;
  for (const Variable& output : probe.model().tables().outputs) {  // nobody asks what was measured
    std::vector<double> zeros(record.length(), 0.0);
    if (record.has(output.name)) {
      record.replace(output.name, std::move(zeros));
    } else {
      record.add(output.name, std::move(zeros));
    }
  }
  const CalibrationOptions& options = calibration.options;
  const std::vector<Effect> effects =
      make_effects(effect_kit(probe, options.own_effects), probe.model(), settings, record);
  const auto model = compose(model_of(probe), effects, record);
  const Record inside = without_edges(record, reach(effects, options.fit.bounds));
  base::ThreadPool pool(options.fit.threads);
  const Eigen::MatrixXd modelled = -residuals_of(*model, inside, calibration.fit, pool);
  Index row = 0;
  for (const Segment& segment : inside.segments()) {
    for (std::size_t at = segment.first; at < segment.last; ++at, ++row) {
      const std::size_t flight_row = compact.flight_rows[at];
      readings.valid[flight_row] = true;
      for (Index j = 0; j < modelled.cols(); ++j) {
        columns[static_cast<std::size_t>(j)].values[flight_row] = modelled(row, j);
      }
    }
  }
  return columns;
}

}  // namespace

std::vector<CorrectedColumn> predict_along(const Calibration& given, const Flight& flight,
                                           ProbeReadings& readings) {
  PreparedFlight prepared = prepare(given, flight);
  const Calibration calibration = along(given, prepared);
  const EffectiveFlight effective = with_effects_of(calibration, prepared);
  const Record& record = effective.prepared.record;
  base::ThreadPool pool(calibration.options.fit.threads);
  const Eigen::MatrixXd residuals = residuals_of(calibration, effective, pool);
  const std::vector<Variable>& outputs = calibration.probe->model().tables().outputs;
  std::vector<CorrectedColumn> columns =
      probes::empty_columns(calibration.probe->corrected_headers(), flight.rows());
  readings.valid.assign(flight.rows(), false);
  Index row = 0;
  for (const Segment& segment : record.segments()) {
    for (std::size_t at = segment.first; at < segment.last; ++at, ++row) {
      const std::size_t flight_row = prepared.readings.flight_rows[at];
      readings.valid[flight_row] = true;
      for (std::size_t j = 0; j < outputs.size(); ++j) {
        columns[j].values[flight_row] =
            record.column(outputs[j].name)[at] - residuals(row, static_cast<Index>(j));
      }
    }
  }
  readings.notes = std::move(prepared.readings.notes);
  return columns;
}

std::vector<CorrectedColumn> correct_with_effects(const Calibration& calibration,
                                                  const Flight& flight, ProbeReadings& readings) {
  const Probe& probe = *calibration.probe;
  if (probe.predicts()) return predict_outputs(calibration, flight, readings);
  if (calibration.options.effects.empty()) {
    return probe.correct(readings, own_values(calibration), {});
  }
  const catalogue::EffectTable& table = probe.effects();
  std::vector<EffectSetting> settings;
  std::ranges::copy_if(
      calibration.options.effects, std::back_inserter(settings), [&](const EffectSetting& setting) {
        return !catalogue::acts_on_the_world(table, parse_effect_name(setting.name));
      });
  const std::set<std::string> needed = add_what_drives(calibration, settings, flight, readings);
  Compact compact = keep_rows(readings, flight, needed);
  const std::vector<Effect> effects = make_effects(
      effect_kit(probe, calibration.options.own_effects), probe.model(), settings, compact.record);
  const auto values = calibration.fit.by_name();
  const ReadingEffects totals = totals_of(effects, values, compact.record);
  const ProbeReadings kept = put_right(compact.record, shifts_of_readings(effects, values), totals);
  auto columns = probe.correct(kept, own_values(calibration), totals);
  undo_delays(columns, kept.record, shift_of_outputs(effects, values));

  readings.valid.assign(readings.valid.size(), false);
  std::vector<CorrectedColumn> result;
  for (const CorrectedColumn& column : columns) {
    result.push_back({column.header, std::vector(readings.valid.size(), not_a_number)});
    for (std::size_t i = 0; i < column.values.size(); ++i) {
      result.back().values[compact.flight_rows[i]] = column.values[i];
    }
  }
  for (const std::size_t row : compact.flight_rows) {
    readings.valid[row] = std::isfinite(result.front().values[row]);
  }
  return result;
}

}  // namespace sepcal::verbs
