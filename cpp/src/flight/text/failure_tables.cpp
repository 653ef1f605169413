// SPDX-License-Identifier: BSD-3-Clause
#include "flight/text/failure_tables.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "base/page.hpp"
#include "base/short_number.hpp"

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

}  // namespace sepcal::text
