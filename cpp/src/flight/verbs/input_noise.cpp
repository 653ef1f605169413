// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/input_noise.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "model/smooth_inputs.hpp"
#include "sepcal/error.hpp"

namespace sepcal::verbs {
namespace {

/// White noise of an input.
struct InputNoise {
  std::string name;
  std::string unit;
  double rms = 0.0;
};

double rms_between(std::span<const double> one, std::span<const double> other) {
  double squares = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) squares += (one[i] - other[i]) * (one[i] - other[i]);
  return std::sqrt(squares / static_cast<double>(one.size()));
}

double spread_of(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  const std::vector<double> means(values.size(), sum / static_cast<double>(values.size()));
  return rms_between(values, means);
}

/// The inputs that differ by more than what smoothing does to motion without noise.
std::vector<InputNoise> find_noise(const Tables& tables, const Record& logged,
                                   const Record& smooth) {
  constexpr double little = 1e-4;  // of the spread
  std::vector<InputNoise> found;
  for (const Variable& input : tables.inputs) {
    if (!logged.has(input.name)) continue;
    const double rms = rms_between(logged.column(input.name), smooth.column(input.name));
    if (!(rms > little * spread_of(logged.column(input.name)))) continue;
    found.push_back({input.name, input.unit, rms});
  }
  return found;
}

std::string describe(const InputNoise& noise) {
  const bool is_angle = noise.unit.starts_with("rad");
  const double shown = is_angle ? noise.rms * 180.0 / std::numbers::pi : noise.rms;
  const std::string unit = is_angle ? "deg" + noise.unit.substr(3) : noise.unit;
  return fmt::format("{} {:.2g}{}{}", noise.name, shown, unit.empty() || unit == "1" ? "" : " ",
                     unit == "1" ? "" : unit);
}

std::string describe(const std::vector<InputNoise>& noises) {
  std::vector<std::string> each;
  for (const InputNoise& noise : noises) each.push_back(describe(noise));
  return fmt::format("{}", fmt::join(each, ", "));
}

/// The estimates from these inputs, beginning at the calibration's; nothing where there is no fit.
std::optional<Fit> refit(const Calibration& calibration, PreparedFlight prepared, Record inputs) {
  CalibrationOptions options = options_from(calibration, {}, {});
  options.fit.coloured_errors = false;                              // nobody reads them
  options.fit.stage_one_segments = options.fit.stage_two_segments;  // nothing is sampled
  prepared.readings.record = std::move(inputs);
  try {
    Fit fit = calibrate(calibration.probe, prepared, options).fit;
    if (fit.status == FitStatus::converged) return fit;
    return std::nullopt;
  } catch (const Error&) {  // as where smooth readings leave the model's domain
    return std::nullopt;
  }
}

/// Sum of the logarithms of the outputs' errors.
double size_of_residuals(const Fit& fit) {
  double sum = 0.0;
  for (const OutputValue& output : fit.rmse) sum += std::log(output.value);
  return sum;
}

/// In standard errors of the fit; 0 of what has none.
double shift(const Parameter& from, const Fit& to) {
  const double errors = (to[from.name].value - from.value) / from.standard_error;
  return std::isfinite(errors) ? errors : 0.0;
}

/// Those whose noise alone does a good part of the shift.
std::vector<InputNoise> find_movers(const Calibration& calibration, const PreparedFlight& prepared,
                                    const std::vector<InputNoise>& noises, const Record& smooth,
                                    const Parameter& moved, double whole) {
  constexpr double good_part = 0.2;
  std::vector<InputNoise> movers;
  for (const InputNoise& noise : noises) {
    Record one = prepared.readings.record;
    const auto values = smooth.column(noise.name);
    one.replace(noise.name, {values.begin(), values.end()});
    const std::optional<Fit> fit = refit(calibration, prepared, std::move(one));
    if (fit && shift(moved, *fit) / whole > good_part) movers.push_back(noise);
  }
  return movers.empty() ? noises : movers;
}

/// Of a probe whose inputs are the readings that it calibrates.
bool allows_for_noise(const Probe& probe) { return probe.with_noise(1.0) != nullptr; }

}  // namespace

void take_out_input_noise(const Tables& tables, const std::string& flight, Record& record,
                          std::vector<std::string>& notes) {
  if (record.is_mapped()) {
    throw OptionError({flight + ": ", Option{"smooth_inputs"},
                       " looks at whole columns, which a streamed log never has in memory; leave "
                       "it out or fit without ",
                       Option{"stream"}});
  }
  Record smooth = model::smooth_inputs(record, tables);
  const std::vector<InputNoise> noises = find_noise(tables, record, smooth);
  record = std::move(smooth);
  notes.push_back(noises.empty()
                      ? fmt::format("{}: the inputs have no white noise to take out", flight)
                      : fmt::format("{}: white noise (rms) is taken out of the inputs: {}", flight,
                                    describe(noises)));
}

void take_out_input_noise(const Probe& probe, const std::string& flight, ProbeRecord& readings) {
  if (allows_for_noise(probe)) {
    throw OptionError({flight + ": ", Option{"smooth_inputs"},
                       fmt::format(" has no part here: {} reads what it calibrates, and allows for "
                                   "its noise; leave it out",
                                   probe.name())});
  }
  take_out_input_noise(probe.model().tables(), flight, readings.record, readings.notes);
}

void note_input_noise(Calibration& calibration, const PreparedFlight& prepared) {
  constexpr std::size_t most_rows = 20000;
  constexpr double much = 3.0;  // standard errors
  const Record& logged = prepared.readings.record;
  const Fit& fit = calibration.fit;
  if (calibration.options.log.smooth_inputs || calibration.probe->app() == own_app ||
      allows_for_noise(*calibration.probe) || logged.is_mapped() || logged.rows() > most_rows ||
      fit.status != FitStatus::converged) {
    return;
  }
  const Tables tables = calibration.probe->model().tables();
  const Record smooth = model::smooth_inputs(logged, tables);
  const std::vector<InputNoise> noises = find_noise(tables, logged, smooth);
  if (noises.empty()) return;
  const std::optional<Fit> without = refit(calibration, prepared, smooth);
  if (!without || !(size_of_residuals(*without) < size_of_residuals(fit))) return;
  const Parameter* farthest = nullptr;
  double most = 0.0;
  for (const Parameter& parameter : fit.parameters) {
    const double moved = shift(parameter, *without);
    if (!(std::abs(moved) > std::abs(most))) continue;
    farthest = &parameter;
    most = moved;
  }
  if (!(std::abs(most) > much)) return;
  calibration.notes.push_back(fmt::format(
      "{}: white noise of what the model reads ({} rms) moves {} from {:.4g} to {:.4g}, by {:.2g} "
      "of its standard errors; --smooth-inputs fits without that noise",
      prepared.logged.name(),
      describe(find_movers(calibration, prepared, noises, smooth, *farthest, most)), farthest->name,
      (*without)[farthest->name].value, farthest->value, std::abs(most)));
}

}  // namespace sepcal::verbs
