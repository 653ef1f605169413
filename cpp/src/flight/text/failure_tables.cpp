// SPDX-License-Identifier: BSD-3-Clause
#include "flight/text/failure_tables.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/page.hpp"
#include "base/short_number.hpp"
#include "flight/text/number_text.hpp"

namespace sepcal::text {

using base::Page;
using base::page;

namespace {

/// At most three an output, those that explain a hundredth or more.
std::vector<ChannelMisfit> telling_channels(const Comparison& comparison) {
  constexpr double worth_a_line = 0.01;
  constexpr int most = 3;
  std::map<std::string, int> shown;  // by output
  std::vector<ChannelMisfit> telling;
  for (const ChannelMisfit& channel : comparison.channels) {
    if (channel.share_smooth < worth_a_line) break;
    if (shown[channel.output]++ < most) telling.push_back(channel);
  }
  return telling;
}

}  // namespace

Page channel_table(const Comparison& comparison) {
  const std::vector<ChannelMisfit> telling = telling_channels(comparison);
  if (telling.empty()) return "no channel explains a hundredth of an output's residual\n";
  std::size_t width = 8;
  for (const ChannelMisfit& channel : telling) width = std::max(width, channel.driver.size());
  Page text = page("{:<{}}  {:<8} {:>8} {:>8} {:>12} {:>10}  {}\n", "channel", width, "output",
                   "line", "smooth", "slope", "+-", "unit");
  for (const ChannelMisfit& channel : telling) {
    text += page("{:<{}}  {:<8} {:>6.1f} % {:>6.1f} % {:>12.4g} {:>10.2g}  {}\n", channel.driver,
                 width, channel.output, 100.0 * channel.share_line, 100.0 * channel.share_smooth,
                 channel.slope, channel.slope_error, channel.unit);
  }
  return text +
         "line, smooth: what a straight line, a spline of the channel explains of the residual's "
         "variance\n";
}

Page window_table(const Comparison& comparison) {
  if (comparison.windows.empty()) return "";
  Page text = page("{:<24} {:>8}", "worst windows [s]", "rows");
  for (const Misfit& misfit : comparison.overall) text += page(" {:>11}", misfit.output);
  for (const Misfit& misfit : comparison.overall) {
    text += page(" {:>11}", page("mean {}", misfit.output));
  }
  text += "\n";
  for (const Window& window : comparison.windows) {
    text += page("{:<24} {:>8}", base::stamp(window.first_s) + ":" + base::stamp(window.last_s),
                 window.rows);
    for (const OutputValue& rmse : window.rmse) text += page(" {:>11.4g}", rmse.value);
    for (const OutputValue& mean : window.mean) text += page(" {:>11.4g}", mean.value);
    text += "\n";
  }
  return text;
}

Page validation_table(const Comparison& comparison) {
  Page text = page("\n{:<8} {:>9} {:>9}  {:>8} {:>8} {:>10}\n", "output", "R^2", "Theil U", "bias",
                   "variance", "covariance");
  const auto percent = [](double share) { return defined(100.0 * share, "{:.1f} %"); };
  for (const OutputValidation& one : comparison.validation) {
    text +=
        page("{:<8} {:>9} {:>9}  {:>8} {:>8} {:>10}\n", one.output,
             defined(one.r_squared, "{:.4f}"), defined(one.theil, "{:.4f}"),
             percent(one.theil_bias), percent(one.theil_variance), percent(one.theil_covariance));
  }
  return text +
         "Theil U: 0 exact, 1 the worst; by the means' difference, by that of the standard "
         "deviations, by the rest\n";
}

Page reference_table(const Comparison& comparison) {
  Page text;
  for (const ReferenceMisfit& one : comparison.references) {
    text += page("\n{} against {}: {} rows\n", one.calibrated, one.reference, one.rows);
    text +=
        page("  difference  bias {:.4g} +- {:.2g}, rms {:.4g}, sd {:.4g} {}, lag one {}\n",
             one.bias, one.bias_error, one.rms, one.sd, one.unit, defined(one.lag_one, "{:.3f}"));
    if (std::isnan(one.scale)) {
      text += "  the reference doesn't move: no scale\n";
      continue;
    }
    text += page(
        "  calibrated = offset + scale * reference:  scale {:.5f} +- {:.2g}, offset {:.4g} +- "
        "{:.2g} {}; the other way round scale {}\n",
        one.scale, one.scale_error, one.offset, one.offset_error, one.unit,
        defined(one.scale_reversed, "{:.5f}"));
  }
  if (!text.empty()) text += "+- allows for a coloured difference\n";
  return text;
}

}  // namespace sepcal::text
