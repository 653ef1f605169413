// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "base/page.hpp"
#include "flight/text/failure_tables.hpp"
#include "flight/text/number_text.hpp"
#include "flight/text/status_text.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal {

using base::Page;
using base::page;
using namespace text;  // this room's own

namespace {

/// A mean that is rounding beside the residuals themselves is written as zero.
double shown_mean(const Misfit& misfit) {
  constexpr double rounding = 1e-9;
  return std::abs(misfit.mean) < rounding * misfit.rmse ? 0.0 : misfit.mean;
}

double white_limit(const Misfit& misfit) {
  return 3.0 / std::sqrt(static_cast<double>(misfit.rows));
}

}  // namespace

bool is_white(const Misfit& misfit) { return std::abs(misfit.lag_one) <= white_limit(misfit); }

std::string verdict_on_noise(const Misfit& misfit) {
  if (std::isnan(misfit.lag_one)) return "too few rows to tell";
  if (is_white(misfit)) return "white, as noise alone would be";
  return page("not white: neighbouring residuals {} ({:.3f}, noise alone within {:.2g})",
              misfit.lag_one > 0 ? "correlate" : "alternate", misfit.lag_one, white_limit(misfit))
      .text();
}

namespace {

/// Innovations over their own standard deviations, and when a noise was more than noise.
Page filter_lines(const Comparison& comparison) {
  if (comparison.method != FitMethod::filter_error) return "";
  Page text = "\nrms of innovations over the filter's own standard deviation, 1 where it is right:";
  for (const OutputValue& sigma : comparison.sigma) {
    text += page(" {} {:.3f}", sigma.name, sigma.value);
  }
  text += page("\n\n{:<14} {:>12}  {:<16} {:>9}  {}\n", "process noise", "size", "unit", "beyond 3",
               "longest beyond 3 standard deviations");
  for (const Disturbance& one : comparison.disturbances) {
    const Page share =
        std::isnan(one.share_beyond) ? Page("-") : page("{:.2f} %", 100.0 * one.share_beyond);
    text += page("{:<14} {:>12.4g}  {:<16} {:>9}  {}\n", one.noise.name, one.noise.value,
                 one.noise.unit, share,
                 one.rows == 0 ? page("{}", one.noise.at_floor ? "at its floor" : "none")
                               : page("{:.2f} to {:.2f} s, {} row{}, {:+.1f}", one.first_s,
                                      one.last_s, one.rows, one.rows == 1 ? "" : "s", one.peak));
  }
  return text + "noise alone is beyond 3 in 0.27 % of the rows\n";
}

}  // namespace

std::string to_text(const Comparison& comparison, Detail detail) {
  Page text = page("{}: {} of {} rows of {}\n", comparison.model, comparison.flight.rows_used,
                   comparison.flight.rows, comparison.flight.file);
  text += status_lines(comparison.status, comparison.at_bound, comparison.message, detail);
  std::size_t width = 8;
  for (const Misfit& misfit : comparison.where) width = std::max(width, misfit.segment.size());
  text += page("\n{:<{}}  {:<8} {:>8} {:>12} {:>12} {:>8}\n", "segment", width, "output", "rows",
               "rmse", "mean", "lag one");
  const auto row = [&](const std::string& name, const Misfit& misfit) {
    text += page("{:<{}}  {:<8} {:>8} {:>12.4g} {:>12.4g} {:>8}\n", name, width, misfit.output,
                 misfit.rows, misfit.rmse, shown_mean(misfit), defined(misfit.lag_one, "{:.3f}"));
  };
  for (const Misfit& misfit : comparison.where) row(misfit.segment, misfit);
  for (const Misfit& misfit : comparison.overall) row("all", misfit);
  text += "\n";
  for (const Misfit& misfit : comparison.overall) {
    text += page("{}: {}\n", misfit.output, verdict_on_noise(misfit));
  }
  text += validation_table(comparison);
  text += filter_lines(comparison);
  text += reference_table(comparison);
  text += page("\n{}\n{}", channel_table(comparison), window_table(comparison));
  text += comparison.method == FitMethod::filter_error
              ? Page("\nrmse and mean of innovations (readings minus their predictions), in")
              : "\nrmse and mean of measured - modelled, in";
  for (const Misfit& misfit : comparison.overall) {
    text += page(" {} [{}]", misfit.output, misfit.unit);
  }
  text +=
      "; lag one: correlation of neighbouring residuals,\nnear 0 for noise alone, near 1 where "
      "something slow is missing from the model\n";
  return text.text();
}

}  // namespace sepcal
