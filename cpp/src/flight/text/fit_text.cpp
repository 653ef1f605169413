// SPDX-License-Identifier: BSD-3-Clause
#include "flight/text/fit_text.hpp"

#include <algorithm>
#include <cmath>

#include "base/page.hpp"
#include "estimation/collinear_directions.hpp"
#include "flight/text/number_text.hpp"
#include "flight/text/status_text.hpp"
#include "sepcal/collinearity.hpp"

namespace sepcal {

using base::Page;
using base::page;
using namespace text;  // this room's own

namespace {

Page bound(double value) { return page("{:.4g}", value); }

Page limits(const Parameter& parameter) {
  if (parameter.fixed) return "fixed";
  if (!std::isfinite(parameter.lower) && !std::isfinite(parameter.upper)) return "";
  return page("[{}, {}]{}", bound(parameter.lower), bound(parameter.upper),
              parameter.at_bound ? "  AT ITS BOUND" : "");
}

/// A step's time, which no derivative finds.
bool is_scanned(const CalibrationOptions& options, const Parameter& parameter) {
  return std::ranges::any_of(options.effects, [&](const EffectSetting& setting) {
    return setting.t0 && parameter.name == setting.name + ".t0" &&
           !options.fit.fix.contains(parameter.name);
  });
}

/// Bounds, and the prior.
Page remark(const CalibrationOptions& options, const Parameter& parameter) {
  if (is_scanned(options, parameter)) return "by a scan";
  Page text = limits(parameter);
  const auto& priors = options.fit.prior;
  const auto prior = priors.find(parameter.name);
  if (prior == priors.end()) return text;
  if (!text.empty()) text += "  ";
  return text +
         page("prior {:.6g} +- {:.2g}", prior->second.mean, prior->second.standard_deviation);
}

Page stage_line(const Fit& fit, const CalibrationOptions& options) {
  const StageOne& one = fit.stage_one;
  const std::string_view points =
      options.fit.search == Search::global ? "points of a global search" : "samples";
  Page text = options.fit.samples == 0 || !options.fit.start.empty()
                  ? Page("stage one: nothing sampled")
                  : page("stage one: {} {}, {} local minim{}", options.fit.samples, points,
                         one.minima.size(), one.minima.size() == 1 ? "um" : "a");
  for (const std::string& flat : one.flat_directions) text += page(", flat along {}", flat);
  return text + page("; stage two: {}, {} iteration{}, noise covariance converged in {}\n",
                     to_string(fit.second_stage), fit.iterations, fit.iterations == 1 ? "" : "s",
                     fit.noise_iterations);
}

/// Of a parameter or a derived quantity: the error to believe, the white one and, explained, those
/// by the other ways.
template <class Estimate>
Page error_columns(const Estimate& estimate, Detail detail) {
  Page text = page("{:>12} {:>9}", defined(estimate.standard_error, "{:.2g}"),
                   defined(estimate.standard_error_white, "{:.2g}"));
  if (detail == Detail::brief) return text;
  return text + page(" {:>11} {:>9}", defined(estimate.standard_error_noise_model, "{:.2g}"),
                     defined(estimate.standard_error_blocks, "{:.2g}"));
}

/// The RMSE of each output, and the noise that it was weighed by where that is another: the RMSE
/// says nothing of the sensor's noise, and would if it stood there twice.
Page output_table(const Fit& fit) {
  const auto is_same = [](const OutputValue& rmse, const OutputValue& noise) {
    return std::abs(noise.value - rmse.value) <= 1e-3 * rmse.value;
  };
  const bool same = std::ranges::equal(fit.rmse, fit.noise, is_same);
  Page text = page("\n{:<14} {:>13}{}\n", "output", "rmse", same ? "" : "   weighed by");
  for (std::size_t j = 0; j < fit.rmse.size(); ++j) {
    text += page("{:<14} {:>13.4g}", fit.rmse[j].name, fit.rmse[j].value);
    if (!same) text += page(" {:>12.4g}", fit.noise[j].value);
    text += "\n";
  }
  return text;
}

/// Sizes of the noises that filter error estimated, and whether the record asks for process noise:
/// twice the rise of ln L beside output error, on as many degrees of freedom as there are, halved
/// as none may be negative.
Page noise_table(const Fit& fit, const FitOptions& options) {
  const auto is_given = [&](const std::string& name) {  // "q_alpha", "r_alpha_m"
    return (name.starts_with("q_") ? options.process_noise : options.noise)
        .contains(name.substr(2));
  };
  Page text = page("\n{:<14} {:>13} {:>12}  {}\n", "noise", "size", "std. error", "unit");
  for (const NoiseSize& size : fit.noise_sizes) {
    text += page("{:<14} {:>13.4g} {:>12}  {}{}\n", size.name, size.value,
                 defined(size.standard_error, "{:.2g}"), size.unit,
                 size.at_floor         ? "  AT ITS FLOOR"
                 : is_given(size.name) ? "  held"
                 : size.value == 0.0   ? "  shown by no output"
                                       : "");
  }
  const double rise = 2.0 * (fit.log_likelihood - fit.log_likelihood_without);
  if (!std::isfinite(rise)) return text;
  text += page("ln L {:.6g}; process noise ", fit.log_likelihood);
  // At its floors it is all but none, and may cost a little.
  if (rise <= 0.0) return text + "doesn't raise it\n";
  return text + page("raises 2 ln L by {:.3g}\n", rise);
}

}  // namespace

Page text::collinearity_lines(const Fit& fit, Detail detail) {
  const Collinearity found = find_collinearity(fit);
  constexpr std::size_t most = 5;
  const std::size_t shown =
      detail == Detail::brief ? std::min(most, found.pairs.size()) : found.pairs.size();
  Page text;
  for (std::size_t i = 0; i < shown; ++i) {
    text += i == 0 ? Page("\ncorrelation above 0.9: ") : Page(", ");
    text += page("{} and {} {:.3f}", found.pairs[i].first, found.pairs[i].second,
                 found.pairs[i].correlation);
  }
  if (shown < found.pairs.size()) text += page(" and {} more", found.pairs.size() - shown);
  if (!text.empty()) text += "\n";
  if (detail == Detail::brief) return text;
  for (const estimation::CollinearDirection& one : estimation::collinear_directions(found)) {
    text += page("condition index {:.0f}, share of each variance:", one.condition_index);
    for (const OutputValue& share : one.proportions) {
      constexpr double worth_a_word = 0.1;
      if (share.value >= worth_a_word) text += page(" {} {:.2f}", share.name, share.value);
    }
    text += "\n";
  }
  return text;
}

Page text::fit_table(const Fit& fit, const CalibrationOptions& options,
                     const std::vector<Derived>& derived, Detail detail) {
  Page text = status_lines(fit, detail);
  std::size_t name = 14;
  std::size_t unit = 5;
  for (const Parameter& parameter : fit.parameters) {
    name = std::max(name, parameter.name.size());
    unit = std::max(unit, parameter.unit.size());
  }
  const auto add_row = [&](std::string_view what, const Page& value, const Page& errors,
                           std::string_view of, const Page& remark) {
    const Page row =
        page("{:<{}} {:>13} {}  {:<{}} {}", what, name, value, errors, of, unit, remark);
    text += row.trimmed() + "\n";
  };
  text += "\n";
  add_row("parameter", "value",
          detail == Detail::brief ? Page("  std. error     white")
                                  : "  std. error     white noise model    blocks",
          "unit", "bounds");
  for (const Parameter& parameter : fit.parameters) {
    add_row(parameter.name, page("{:.6g}", parameter.value), error_columns(parameter, detail),
            parameter.unit, remark(options, parameter));
  }
  for (const Derived& quantity : derived) {
    add_row(quantity.name, page("{:.6g}", quantity.value), error_columns(quantity, detail),
            quantity.unit, "derived");
  }
  text += collinearity_lines(fit, detail);
  text += output_table(fit);
  if (fit.method == FitMethod::filter_error) {
    return text + noise_table(fit, options.fit) +
           page("\nfilter error: {} step{} of scoring\n", fit.iterations,
                fit.iterations == 1 ? "" : "s");
  }
  return text + "\n" + stage_line(fit, options);
}

std::string to_text(const Fit& fit, const CalibrationOptions& options, Detail detail) {
  return (page("{} rows\n", fit.rows) + fit_table(fit, options, {}, detail)).text();
}

}  // namespace sepcal
