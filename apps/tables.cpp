// SPDX-License-Identifier: BSD-3-Clause
#include "tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sepcal/flight/effect_catalogue.hpp"

namespace sepcal::app {
namespace {

using Json = nlohmann::ordered_json;

std::string status_line(FitStatus status, const std::string& message) {
  return fmt::format("status: {}{}{}\n", to_string(status), message.empty() ? "" : ": ", message);
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

std::string defined(double value, const char* format) {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

std::string stage_line(const Fit& fit, int samples) {
  const StageOne& one = fit.stage_one;
  std::string text = fmt::format("stage one: {} samples, {} local minim{}", samples,
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
  text += status_line(fit.status, fit.message);
  text += fmt::format("\n{:<14} {:>13} {:>12}  {:<5} {}\n", "parameter", "value", "std. error",
                      "unit", "bounds");
  for (const Parameter& parameter : fit.parameters) {
    const std::string row =
        fmt::format("{:<14} {:>13.6g} {:>12}  {:<5} {}", parameter.name, parameter.value,
                    defined(parameter.standard_error, "{:.2g}"), parameter.unit, limits(parameter));
    text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  }
  text += fmt::format("\n{:<14} {:>13} {:>12}\n", "output", "rmse", "noise");
  for (std::size_t j = 0; j < fit.rmse.size(); ++j) {
    text += fmt::format("{:<14} {:>13.4g} {:>12.4g}\n", fit.rmse[j].name, fit.rmse[j].value,
                        fit.noise[j].value);
  }
  return text + "\n" + stage_line(fit, calibration.options.fit.samples);
}

std::string comparison_table(const Comparison& comparison) {
  std::string text =
      fmt::format("{}: {} of {} rows of {}\n", comparison.model, comparison.flight.rows_used,
                  comparison.flight.rows, comparison.flight.file);
  text += status_line(comparison.status, comparison.message);
  std::size_t width = 8;
  for (const Misfit& misfit : comparison.where) width = std::max(width, misfit.segment.size());
  text += fmt::format("\n{:<{}}  {:<8} {:>8} {:>12} {:>12} {:>8}\n", "segment", width, "output",
                      "rows", "rmse", "mean", "lag one");
  const auto row = [&](const std::string& name, const Misfit& misfit) {
    text +=
        fmt::format("{:<{}}  {:<8} {:>8} {:>12.4g} {:>12.4g} {:>8}\n", name, width, misfit.output,
                    misfit.rows, misfit.rmse, misfit.mean, defined(misfit.lag_one, "{:.3f}"));
  };
  for (const Misfit& misfit : comparison.where) row(misfit.segment, misfit);
  for (const Misfit& misfit : comparison.overall) row("all", misfit);
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
  return text + "\n" + status_line(calibration.fit.status, calibration.fit.message);
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
  std::string text = fmt::format(
      "{}: what its model may lack (this version lists effects; it can't fit "
      "them yet)\n\n{:<26} {:<34} {:<20} {}\n",
      model, "effect", "the model with it", "driver", "unit");
  for (const CataloguedEffect& effect : effect_catalogue(model)) {
    text += fmt::format("{:<26} {:<34} {:<20} {}\n", effect.name, effect.equation, effect.drivers,
                        effect.unit);
  }
  return text;
}

std::string effects_json(const std::string& model) {
  Json effects = Json::array();
  for (const CataloguedEffect& effect : effect_catalogue(model)) {
    effects.push_back({{"name", effect.name},
                       {"equation", effect.equation},
                       {"drivers", effect.drivers},
                       {"unit", effect.unit}});
  }
  const Json root{{"schema_version", schema_version}, {"model", model}, {"effects", effects}};
  return root.dump(2) + "\n";
}

}  // namespace sepcal::app
