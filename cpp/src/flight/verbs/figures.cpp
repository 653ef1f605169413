// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/parts_of_record.hpp"
#include "base/thread_pool.hpp"
#include "flight/files/headers.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "numerics/order_statistics.hpp"
#include "numerics/quantiles.hpp"
#include "numerics/residual_curves.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using files::UnitKind;

std::array<double, 3> spread_of_intervals(const std::vector<double>& time) {
  if (time.size() < 2) return {1, 1, 1};
  std::vector<double> intervals;
  for (std::size_t i = 1; i < time.size(); ++i) intervals.push_back(time[i] - time[i - 1]);
  std::ranges::sort(intervals);
  using numerics::quantile;
  return {quantile(intervals, 0.1), quantile(intervals, 0.5), quantile(intervals, 0.9)};
}

/// Measured, modelled and how much of the residual is within its noise, output by output.
void compare_outputs(const Calibration& calibration, const Eigen::MatrixXd& residuals,
                     FlightFigures& figures) {
  const double reach = numerics::normal_reach(0.95);
  const auto settings = calibration.probe->settings();
  const auto& outputs = calibration.probe->model().tables().outputs;
  figures.measured = figures.modelled = residuals;
  for (Index j = 0; j < residuals.cols(); ++j) {
    const std::string& name = outputs[static_cast<std::size_t>(j)].name;
    const auto r = residuals.col(j);
    const auto noise = std::ranges::find(calibration.fit.noise, name, &OutputValue::name);
    const double widest = noise == calibration.fit.noise.end() ? 0.0 : reach * noise->value;
    figures.within_95.push_back((r.array().abs() <= widest).cast<double>().mean());
    if (name == "field") {
      figures.modelled.col(j).setConstant(settings.at("field_strength").front());
      figures.measured.col(j) = figures.modelled.col(j) - r;
    } else {
      const Record& channels = figures.channels;
      figures.measured.col(j) = gather_rows(channels.column(name), channels.segments());
      figures.modelled.col(j) = figures.measured.col(j) - r;
    }
  }
}

/// Airspeed as the probe reads it, from the pressures where that is what it measures.
std::vector<double> read_airspeed(const Record& channels) {
  const auto gather = [&](const char* name) {
    return gather_rows(channels.column(name), channels.segments());
  };
  VectorXd speed;
  if (channels.has("airspeed")) {
    speed = gather("airspeed");
  } else if (channels.has("pt") && channels.has("ps") && channels.has("rho")) {
    speed = (2 * (gather("pt") - gather("ps")).cwiseQuotient(gather("rho"))).cwiseSqrt();
  }
  return {speed.begin(), speed.end()};
}

/// A logged angle, or that of two logged components, in the figures' rows.
void find_heading(const Flight& flight, FlightFigures& figures) {
  std::vector<double> angle = files::read_quantity(flight, "yaw", UnitKind::angle);
  if (angle.empty()) {
    const std::vector<double> north = files::read_quantity(flight, "vn", UnitKind::speed);
    angle = files::read_quantity(flight, "ve", UnitKind::speed);
    if (north.empty() || angle.empty()) return;
    std::ranges::transform(angle, north, angle.begin(),
                           [](double e, double n) { return std::atan2(e, n); });
    figures.heading_is_track = true;
  }
  for (const std::size_t row : figures.rows) {
    constexpr double turn = 2 * std::numbers::pi;
    figures.heading.push_back(angle[row] - turn * std::floor(angle[row] / turn));
  }
}

}  // namespace

FlightFigures gather_figures(const Calibration& given, const Flight& flight) {
  PreparedFlight prepared = prepare(given, flight);
  const Calibration calibration = along(given, prepared);
  const EffectiveFlight effective = with_effects_of(calibration, prepared);
  base::ThreadPool pool(calibration.options.fit.threads);
  FlightFigures figures;
  figures.channels = effective.prepared.record;
  const std::vector<Segment>& segments = figures.channels.segments();
  for (const Segment& segment : segments) {
    const auto from = prepared.readings.flight_rows.begin();
    figures.rows.insert(figures.rows.end(), from + static_cast<std::ptrdiff_t>(segment.first),
                        from + static_cast<std::ptrdiff_t>(segment.last));
  }
  figures.segments = base::join_segments(segments);
  figures.runs = find_runs(figures.channels);
  figures.interval = spread_of_intervals(base::gather_time(figures.channels));
  compare_outputs(calibration, residuals_of(calibration, effective, pool), figures);
  figures.airspeed = read_airspeed(figures.channels);
  find_heading(flight, figures);
  return figures;
}

}  // namespace sepcal
