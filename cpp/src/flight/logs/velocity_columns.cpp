// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/velocity_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "base/gaps.hpp"
#include "flight/files/headers.hpp"
#include "flight/logs/smoothed_track.hpp"
#include "numerics/interpolated_column.hpp"
#include "sepcal/error.hpp"

namespace sepcal::logs {
namespace {

using files::UnitKind;

constexpr double not_there = std::numeric_limits<double>::quiet_NaN();

/// WGS 84: metres a radian of latitude and of longitude.
struct Radii {
  double north;
  double east;
};

Radii radii_at(double latitude, double altitude) {
  constexpr double equator = 6'378'137.0;
  constexpr double e2 = 6.69437999014e-3;
  const double s = std::sin(latitude);
  const double w = 1.0 - e2 * s * s;
  return {equator * (1.0 - e2) / (w * std::sqrt(w)) + altitude,
          (equator / std::sqrt(w) + altitude) * std::cos(latitude)};
}

/// A value a row, in rad, m and s.
struct Positions {
  std::vector<double> time;
  std::vector<double> latitude;
  std::vector<double> longitude;
  std::vector<double> altitude;

  bool all_there(std::size_t row) const {
    return std::isfinite(time[row]) && std::isfinite(latitude[row]) &&
           std::isfinite(longitude[row]) && std::isfinite(altitude[row]);
  }
};

/// Rows of new fixes; a stamp that does not rise is none.
std::vector<std::size_t> find_fixes(const Positions& at) {
  std::vector<std::size_t> fixes;
  for (std::size_t row = 0; row < at.time.size(); ++row) {
    if (!at.all_there(row)) continue;
    if (at.latitude[row] == 0.0 && at.longitude[row] == 0.0) continue;  // no fix yet
    if (!fixes.empty()) {
      const std::size_t last = fixes.back();
      if (!(at.time[row] > at.time[last])) continue;
      if (at.latitude[row] == at.latitude[last] && at.longitude[row] == at.longitude[last])
        continue;
    }
    fixes.push_back(row);
  }
  return fixes;
}

/// From one fix to the next.
std::vector<double> intervals_of(const std::vector<double>& time) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < time.size(); ++i) intervals.push_back(time[i] - time[i - 1]);
  return intervals;
}

/// The first fix of each part between gaps, and behind them their count.
std::vector<std::size_t> find_parts(const std::vector<double>& intervals) {
  const double gap = base::find_gap(intervals);
  std::vector<std::size_t> parts{0};
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    if (intervals[i] > gap) parts.push_back(i + 1);
  }
  parts.push_back(intervals.size() + 1);
  return parts;
}

/// The slope at `t` of the cubic with these ends and slopes there.
double slope_between(double t, double t0, double t1, double p0, double p1, double v0, double v1) {
  const double dt = t1 - t0;
  const double s = (t - t0) / dt;
  return 6.0 * s * (1.0 - s) * (p1 - p0) / dt + (1.0 - s) * (1.0 - 3.0 * s) * v0 +
         s * (3.0 * s - 2.0) * v1;
}

/// At every row of `time`, from the fixes within the same part, and from the nearest one where that
/// is not farther than `reach` [s]; NaN elsewhere.
std::vector<double> velocity_at(const std::vector<double>& time, const std::vector<double>& fixed,
                                const std::vector<std::size_t>& parts, const SmoothedTrack& track,
                                double reach) {
  std::vector<double> velocity(time.size(), not_there);
  for (std::size_t row = 0; row < time.size(); ++row) {
    if (!std::isfinite(time[row])) continue;
    const auto after = std::ranges::upper_bound(fixed, time[row]);
    if (after == fixed.begin()) {
      if (fixed.front() - time[row] <= reach) velocity[row] = track.velocity.front();
      continue;
    }
    const auto i = static_cast<std::size_t>(after - fixed.begin()) - 1;
    const bool is_last = i + 1 == fixed.size() || std::ranges::binary_search(parts, i + 1);
    if (time[row] == fixed[i] || (is_last && time[row] - fixed[i] <= reach)) {
      velocity[row] = track.velocity[i];
    } else if (!is_last) {
      velocity[row] =
          slope_between(time[row], fixed[i], fixed[i + 1], track.position[i], track.position[i + 1],
                        track.velocity[i], track.velocity[i + 1]);
    }
  }
  return velocity;
}

std::vector<double> at_fixes(const std::vector<double>& values,
                             const std::vector<std::size_t>& fixes) {
  std::vector<double> chosen;
  for (const std::size_t row : fixes) chosen.push_back(values[row]);
  return chosen;
}

/// From the first one on, in other units.
std::vector<double> offsets(std::vector<double> values, double scale) {
  const double first = values.front();
  for (double& value : values) value = scale * (value - first);
  return values;
}

/// Throws Error for a latitude beyond the poles: another unit.
void check_latitude(const Flight& flight, const Positions& at) {
  constexpr double pole = std::numbers::pi / 2.0;
  const auto beyond = std::ranges::find_if(
      at.latitude, [](double latitude) { return std::abs(latitude) > 1.001 * pole; });
  const auto logged = files::find_quantity(flight, "lat", UnitKind::angle);
  if (beyond == at.latitude.end() || !logged) return;
  const auto row = static_cast<std::size_t>(beyond - at.latitude.begin());
  throw Error(fmt::format("{}: {} is {}, beyond 90 degrees: convert it, or ignore the column",
                          flight.locate(row), logged->column->header, logged->column->values[row]));
}

/// Empty where a column isn't there. Throws Error as check_latitude().
Positions read_positions(const Flight& flight) {
  Positions at{files::read_quantity(flight, "time", UnitKind::time),
               files::read_quantity(flight, "lat", UnitKind::angle),
               files::read_quantity(flight, "lon", UnitKind::angle),
               files::read_quantity(flight, "altitude", UnitKind::length)};
  if (at.time.empty() || at.latitude.empty() || at.longitude.empty() || at.altitude.empty()) {
    return {};
  }
  check_latitude(flight, at);
  return at;
}

/// Says in the column of what rows lack why they lack it.
void add_with_reason(Flight& flight, const char* header, std::vector<double> values,
                     const char* reason) {
  const auto owned = std::make_shared<const std::vector<double>>(std::move(values));
  std::optional<Flight::Cell> first;
  const auto bad = std::ranges::find_if_not(*owned, [](double v) { return std::isfinite(v); });
  if (bad != owned->end()) {
    first = Flight::Cell{static_cast<std::size_t>(bad - owned->begin()), reason};
  }
  flight.view(header, *owned, owned, std::move(first));
}

void add_velocity(Flight& flight, const char* header, std::vector<double> values) {
  add_with_reason(flight, header, std::move(values), "no velocity: no fix is near");
}

}  // namespace

bool derive_velocity(Flight& flight, std::vector<std::string>& notes) {
  const auto is_logged = [&](const char* name) {
    return files::find_quantity(flight, name, UnitKind::speed).has_value();
  };
  if (flight.is_mapped() || is_logged("vn") || is_logged("ve")) return false;
  const Positions at = read_positions(flight);
  if (at.time.empty()) return false;
  const std::vector<std::size_t> fixes = find_fixes(at);
  constexpr std::size_t fewest_fixes = 10;
  if (fixes.size() < fewest_fixes) return false;
  const std::vector<double> time = offsets(at_fixes(at.time, fixes), 1.0);
  std::vector<double> longitude = at_fixes(at.longitude, fixes);
  numerics::unwrap(longitude);
  const std::vector<double> intervals = intervals_of(time);
  const std::vector<std::size_t> parts = find_parts(intervals);
  const Radii first = radii_at(at.latitude[fixes[0]], at.altitude[fixes[0]]);
  const SmoothedTrack north =
      smooth_track(time, offsets(at_fixes(at.latitude, fixes), first.north), parts);
  const SmoothedTrack east = smooth_track(time, offsets(std::move(longitude), first.east), parts);
  const SmoothedTrack down = smooth_track(time, offsets(at_fixes(at.altitude, fixes), -1.0), parts);
  std::vector<double> rows = at.time;
  for (double& t : rows) t -= at.time[fixes[0]];
  const double reach = 1.5 * base::usual_interval(intervals);
  std::vector<double> vn = velocity_at(rows, time, parts, north, reach);
  std::vector<double> ve = velocity_at(rows, time, parts, east, reach);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (!at.all_there(row)) continue;
    const Radii here = radii_at(at.latitude[row], at.altitude[row]);
    vn[row] *= here.north / first.north;
    ve[row] *= here.east / first.east;
  }
  add_velocity(flight, "vn_mps", std::move(vn));
  add_velocity(flight, "ve_mps", std::move(ve));
  if (!is_logged("vd")) {
    add_velocity(flight, "vd_mps", velocity_at(rows, time, parts, down, reach));
  }
  notes.push_back(fmt::format(
      "{}: velocity is from {} fixes of lat, lon and altitude, which are off by {:.2g} m (north), "
      "{:.2g} m (east) and {:.2g} m (down) from a smooth track; its errors there are about {:.2g}, "
      "{:.2g} and {:.2g} m/s",
      flight.name(), fixes.size(), north.position_error, east.position_error, down.position_error,
      north.velocity_error, east.velocity_error, down.velocity_error));
  return true;
}

void derive_position(Flight& flight, std::vector<std::string>& notes) {
  const auto is_logged = [&](const char* name) {
    return files::find_quantity(flight, name, UnitKind::length).has_value();
  };
  if (flight.is_mapped() || is_logged("north") || is_logged("east")) return;
  const Positions at = read_positions(flight);
  if (at.time.empty()) return;
  const std::vector<std::size_t> fixes = find_fixes(at);
  if (fixes.empty()) return;
  std::vector<double> longitude = at_fixes(at.longitude, fixes);
  numerics::unwrap(longitude);
  const std::size_t first = fixes.front();
  std::vector<double> north(at.time.size(), not_there);
  std::vector<double> east = north;
  std::vector<double> down = north;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const std::size_t row = fixes[i];
    // Between both: of second order in the distance.
    const double height = 0.5 * (at.altitude[row] + at.altitude[first]);
    const Radii radii = radii_at(0.5 * (at.latitude[row] + at.latitude[first]), height);
    north[row] = radii.north * (at.latitude[row] - at.latitude[first]);
    east[row] = radii.east * (longitude[i] - longitude.front());
    down[row] = at.altitude[first] - at.altitude[row];
  }
  add_with_reason(flight, "north_m", std::move(north), "");
  add_with_reason(flight, "east_m", std::move(east), "");
  add_with_reason(flight, "down_m", std::move(down), "");
  notes.push_back(fmt::format(
      "{}: north, east and down are metres from the first fix ({:.6f}, {:.6f} deg), of {} fixes",
      flight.name(), at.latitude[first] * 180.0 / std::numbers::pi,
      at.longitude[first] * 180.0 / std::numbers::pi, fixes.size()));
}

bool smooth_climb(Flight& flight, std::vector<std::string>& notes) {
  const std::vector<double> time = files::read_quantity(flight, "time", UnitKind::time);
  const auto logged = files::find_quantity(flight, "altitude", UnitKind::length);
  constexpr std::size_t fewest_changes = 10;
  if (flight.is_mapped() || time.empty() || !logged) return false;
  const std::vector<double> altitude = logged->values();
  std::vector<std::size_t> all;
  std::vector<std::size_t> changes;  // a value that is held is no new one
  for (std::size_t row = 0; row < time.size(); ++row) {
    if (!std::isfinite(time[row]) || !std::isfinite(altitude[row])) continue;
    if (!all.empty() && !(time[row] > time[all.back()])) continue;
    all.push_back(row);
    if (changes.empty() || altitude[row] != altitude[changes.back()]) changes.push_back(row);
  }
  if (all.size() < fewest_changes) return false;
  const auto parts_of = [&](const std::vector<std::size_t>& rows) {
    return find_parts(intervals_of(at_fixes(time, rows)));
  };
  const bool is_held =
      changes.size() >= fewest_changes && parts_of(changes).size() <= parts_of(all).size();
  const std::vector<std::size_t>& fixes = is_held ? changes : all;
  const std::vector<double> fixed = offsets(at_fixes(time, fixes), 1.0);
  const std::vector<double> intervals = intervals_of(fixed);
  const std::vector<std::size_t> parts = find_parts(intervals);
  const SmoothedTrack down = smooth_track(fixed, offsets(at_fixes(altitude, fixes), -1.0), parts);
  std::vector<double> rows = time;
  for (double& t : rows) t -= time[fixes[0]];
  notes.push_back(fmt::format("{}: vd is from {}, smoothed; its error is about {:.2g} m/s",
                              flight.name(), logged->column->logged_header(), down.velocity_error));
  add_velocity(flight, "vd_mps",
               velocity_at(rows, fixed, parts, down, 1.5 * base::usual_interval(intervals)));
  return true;
}

void turn_climb(Flight& flight, std::vector<std::string>& notes) {
  const auto climb = files::find_quantity(flight, "vu", UnitKind::speed);
  if (!climb || flight.is_mapped()) return;
  if (files::find_quantity(flight, "vd", UnitKind::speed)) return;
  std::vector<double> down = climb->values();
  for (double& value : down) value = -value;
  notes.push_back(
      fmt::format("{}: vd is {} turned downwards", flight.name(), climb->column->logged_header()));
  flight.add("vd_mps", std::move(down));
}

}  // namespace sepcal::logs
