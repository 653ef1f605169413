// SPDX-License-Identifier: BSD-3-Clause
#include "tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "failure_tables.hpp"
#include "sepcal/flight/effect_catalogue.hpp"

namespace sepcal::app {
namespace {

using Json = nlohmann::ordered_json;

/// "status: converged, 2 parameters at their bounds: alpha_xz, eta_y", then the message.
std::string status_line(const Fit& fit) {
  std::vector<std::string> at_bound;
  for (const Parameter& parameter : fit.parameters) {
    if (parameter.at_bound) at_bound.push_back(parameter.name);
  }
  std::string text = fmt::format("status: {}", to_string(fit.status));
  if (!at_bound.empty()) {
    text += fmt::format(
        ", {} at {}: {}",
        at_bound.size() == 1 ? "1 parameter" : fmt::format("{} parameters", at_bound.size()),
        at_bound.size() == 1 ? "its bound" : "their bounds", fmt::join(at_bound, ", "));
  }
  if (!fit.message.empty()) text += (at_bound.empty() ? ": " : "; ") + fit.message;
  return text + "\n";
}

std::string bound(double value, const char* none) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : none;
}

std::string limits(const Parameter& parameter) {
  if (parameter.fixed) return "fixed";
  if (!std::isfinite(parameter.lower) && !std::isfinite(parameter.upper)) return "";
  return fmt::format("[{}, {}]{}", bound(parameter.lower, "-inf"), bound(parameter.upper, "inf"),
                     parameter.at_bound ? "  AT ITS BOUND" : "");
}

/// A step's time, which no derivative finds.
bool is_scanned(const Calibration& calibration, const Parameter& parameter) {
  return std::ranges::any_of(calibration.options.effects, [&](const EffectSetting& setting) {
    return setting.t0 && parameter.name == setting.name + ".t0" &&
           !calibration.options.fit.fixed.contains(parameter.name);
  });
}

std::string defined(double value, const char* format) {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

/// A mean that is rounding beside the residuals themselves is written as zero.
double shown_mean(const Misfit& misfit) {
  constexpr double rounding = 1e-9;
  return std::abs(misfit.mean) < rounding * misfit.rmse ? 0.0 : misfit.mean;
}

/// Two standard errors of white noise's lag-one correlation about zero: one verdict in twenty on
/// noise alone is wrong.
std::string verdict_on_noise(const Misfit& misfit) {
  if (std::isnan(misfit.lag_one)) return "too few rows to tell";
  const double limit = 2.0 / std::sqrt(static_cast<double>(misfit.rows));
  if (std::abs(misfit.lag_one) <= limit) return "white, as noise alone would be";
  return fmt::format("not white: neighbouring residuals {} ({:.3f}, noise alone within {:.2g})",
                     misfit.lag_one > 0 ? "correlate" : "alternate", misfit.lag_one, limit);
}

/// Bounds, and the prior.
std::string remark(const Calibration& calibration, const Parameter& parameter) {
  if (is_scanned(calibration, parameter)) return "by a scan";
  std::string text = limits(parameter);
  const auto& priors = calibration.options.fit.prior;
  const auto prior = priors.find(parameter.name);
  if (prior == priors.end()) return text;
  if (!text.empty()) text += "  ";
  return text + fmt::format("prior {:.6g} +- {:.2g}", prior->second.mean,
                            prior->second.standard_deviation);
}

std::string stage_line(const Fit& fit, const CalibrationOptions& options) {
  const StageOne& one = fit.stage_one;
  const std::string_view points =
      options.fit.search == Search::global ? "points of a global search" : "samples";
  std::string text =
      options.fit.samples == 0 || !options.fit.start.empty()
          ? "stage one: nothing sampled"
          : fmt::format("stage one: {} {}, {} local minim{}", options.fit.samples, points,
                        one.minima.size(), one.minima.size() == 1 ? "um" : "a");
  for (const std::string& flat : one.flat_directions) text += ", flat along " + flat;
  return text + fmt::format("; stage two: {}, {} iteration{}, R settled in {}\n",
                            to_string(fit.method), fit.iterations, fit.iterations == 1 ? "" : "s",
                            fit.noise_iterations);
}

}  // namespace

std::string calibration_table(const Calibration& calibration) {
  const Fit& fit = calibration.fit;
  std::string text =
      fmt::format("{}: {} of {} rows of {}\n", calibration.probe->name(),
                  calibration.flight.rows_used, calibration.flight.rows, calibration.flight.file);
  text += status_line(fit);
  std::size_t name = 14;
  std::size_t unit = 5;
  for (const Parameter& parameter : fit.parameters) {
    name = std::max(name, parameter.name.size());
    unit = std::max(unit, parameter.unit.size());
  }
  const auto add_row = [&](std::string_view what, const std::string& value, std::string_view error,
                           std::string_view white, std::string_view of, std::string_view remark) {
    const std::string row = fmt::format("{:<{}} {:>13} {:>12} {:>9}  {:<{}} {}", what, name, value,
                                        error, white, of, unit, remark);
    text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  };
  text += '\n';
  add_row("parameter", "value", "std. error", "white", "unit", "bounds");
  for (const Parameter& parameter : fit.parameters) {
    add_row(parameter.name, fmt::format("{:.6g}", parameter.value),
            defined(parameter.standard_error, "{:.2g}"),
            defined(parameter.standard_error_white, "{:.2g}"), parameter.unit,
            remark(calibration, parameter));
  }
  for (const Derived& derived : calibration.derived) {
    add_row(derived.name, fmt::format("{:.6g}", derived.value),
            defined(derived.standard_error, "{:.2g}"),
            defined(derived.standard_error_white, "{:.2g}"), derived.unit, "derived");
  }
  text += fmt::format("\n{:<14} {:>13} {:>12}\n", "output", "rmse", "noise");
  for (std::size_t j = 0; j < fit.rmse.size(); ++j) {
    text += fmt::format("{:<14} {:>13.4g} {:>12.4g}\n", fit.rmse[j].name, fit.rmse[j].value,
                        fit.noise[j].value);
  }
  return text + "\n" + stage_line(fit, calibration.options);
}

std::string history_table(const Calibration& calibration) {
  const std::vector<HistoryEntry>& history = calibration.history;
  if (history.empty()) return "";
  const auto& outputs = calibration.probe->model().tables().outputs;
  std::string text = fmt::format("\nRMSE over all outputs [{}]\n", outputs.front().unit);
  std::size_t width = 0;
  for (const HistoryEntry& entry : history) width = std::max(width, entry.effect.size());
  for (const HistoryEntry& entry : history) {
    text += fmt::format("  + {:<{}}  {:.4g} -> {:.4g}  ({:+.1f} %", entry.effect, width,
                        entry.rmse_before, entry.rmse_after,
                        100.0 * (entry.rmse_after / entry.rmse_before - 1.0));
    if (std::isfinite(entry.predicted_drop)) {
      text += fmt::format(", promised {:+.1f} %", -100.0 * entry.predicted_drop);
    }
    if (std::isfinite(entry.held_out_before)) {
      text += fmt::format("; on rows held out {:.4g} -> {:.4g}", entry.held_out_before,
                          entry.held_out_after);
    }
    text += ")\n";
  }
  return text;
}

std::string comparison_table(const Comparison& comparison, const Calibration& calibration) {
  std::string text =
      fmt::format("{}: {} of {} rows of {}\n", comparison.model, comparison.flight.rows_used,
                  comparison.flight.rows, comparison.flight.file);
  text += status_line(calibration.fit);
  std::size_t width = 8;
  for (const Misfit& misfit : comparison.where) width = std::max(width, misfit.segment.size());
  text += fmt::format("\n{:<{}}  {:<8} {:>8} {:>12} {:>12} {:>8}\n", "segment", width, "output",
                      "rows", "rmse", "mean", "lag one");
  const auto row = [&](const std::string& name, const Misfit& misfit) {
    text += fmt::format("{:<{}}  {:<8} {:>8} {:>12.4g} {:>12.4g} {:>8}\n", name, width,
                        misfit.output, misfit.rows, misfit.rmse, shown_mean(misfit),
                        defined(misfit.lag_one, "{:.3f}"));
  };
  for (const Misfit& misfit : comparison.where) row(misfit.segment, misfit);
  for (const Misfit& misfit : comparison.overall) row("all", misfit);
  text += '\n';
  for (const Misfit& misfit : comparison.overall) {
    text += fmt::format("{}: {}\n", misfit.output, verdict_on_noise(misfit));
  }
  text += fmt::format("\n{}\n{}", channel_table(comparison), window_table(comparison));
  text += "\nrmse and mean of measured - modelled, in";
  for (const Misfit& misfit : comparison.overall) {
    text += fmt::format(" {} [{}]", misfit.output, misfit.unit);
  }
  return text +
         "; lag one: correlation of neighbouring residuals,\nnear 0 for noise alone, near 1 where "
         "something slow is missing from the model\n";
}

std::string applied_text(const Applied& applied, const Calibration& calibration,
                         const std::string& output) {
  std::string text = fmt::format("wrote {}: {} rows, with {} added", output, applied.rows,
                                 fmt::join(applied.headers, ", "));
  if (applied.rows_left_empty > 0) {
    text += fmt::format("; {} rows have no reading to calibrate and stay empty",
                        applied.rows_left_empty);
  }
  return text + "\n" + status_line(calibration.fit);
}

std::string applied_json(const Applied& applied, const Calibration& calibration,
                         const std::string& output) {
  const Json root{{"schema_version", schema_version},
                  {"model", calibration.probe->name()},
                  {"output", output},
                  {"rows", applied.rows},
                  {"rows_left_empty", applied.rows_left_empty},
                  {"columns", applied.headers},
                  {"status", to_string(calibration.fit.status)},
                  {"message", calibration.fit.message}};
  return root.dump(2) + "\n";
}

std::string effects_table(const std::string& model) {
  std::size_t name = 0;
  std::size_t equation = 0;
  std::size_t driver = 0;
  for (const CataloguedEffect& effect : effect_catalogue(model)) {
    name = std::max(name, effect.name.size());
    equation = std::max(equation, effect.equation.size());
    driver = std::max(driver, effect.drivers.size());
  }
  const auto row = [&](std::string_view a, std::string_view b, std::string_view c,
                       std::string_view d) {
    return fmt::format("{:<{}}  {:<{}}  {:<{}}  {}\n", a, name, b, equation, c, driver, d);
  };
  std::string text = fmt::format("{}: what its model may lack; fit --effect E, or add ... E\n\n{}",
                                 model, row("effect", "the model with it", "driver", "unit"));
  for (const CataloguedEffect& effect : effect_catalogue(model)) {
    text += row(effect.name, effect.equation, effect.drivers, effect.unit);
  }
  return text +
         "\nDRIVER: a numeric column by its header, or time, alpha, beta, q, r where there; x "
         "alone or "
         "x^2 to x^9,\nx^n (n fitted), spline(x,k), step(time), ramp(time), decay(time), delay(x), "
         "maneuver.\n\n";
}

std::string effects_json(const std::vector<std::string>& models) {
  Json effects = Json::array();
  for (const std::string& model : models) {
    for (const CataloguedEffect& effect : effect_catalogue(model)) {
      effects.push_back({{"model", model},
                         {"name", effect.name},
                         {"equation", effect.equation},
                         {"drivers", effect.drivers},
                         {"unit", effect.unit}});
    }
  }
  const Json root{{"schema_version", schema_version}, {"effects", effects}};
  return root.dump(2) + "\n";
}

}  // namespace sepcal::app
