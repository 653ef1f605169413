// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/track_velocity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>

#include "flight/files/headers.hpp"
#include "flight/files/known_names.hpp"
#include "flight/logs/velocity_columns.hpp"

namespace sepcal::logs {
namespace {

using files::LoggedQuantity;
using files::UnitKind;

std::optional<LoggedQuantity> find_angle(const Flight& flight, const char* name) {
  return files::find_quantity(flight, name, UnitKind::angle);
}

bool has_speed(const Flight& flight, const char* name) {
  return files::find_quantity(flight, name, UnitKind::speed).has_value();
}

void add_with_holes(Flight& flight, const char* header, std::vector<double> values,
                    const char* why) {
  const auto owned = std::make_shared<const std::vector<double>>(std::move(values));
  std::optional<Flight::Cell> first;
  const auto bad = std::ranges::find_if_not(*owned, [](double v) { return std::isfinite(v); });
  if (bad != owned->end()) {
    first = Flight::Cell{static_cast<std::size_t>(bad - owned->begin()), why};
  }
  flight.view(header, *owned, owned, std::move(first));
}

/// How the track agrees with where the positions go, 1 where it does, as it stands and turned by
/// magvar; nothing where they don't move.
struct Agreement {
  double as_logged = 0.0;
  double turned = 0.0;
};

std::optional<Agreement> compare_with_positions(const Flight& flight,
                                                const std::vector<double>& track,
                                                const std::vector<double>& variation) {
  const std::vector<double> latitude = files::read_quantity(flight, "lat", UnitKind::angle);
  const std::vector<double> longitude = files::read_quantity(flight, "lon", UnitKind::angle);
  if (latitude.empty() || longitude.empty()) return std::nullopt;
  constexpr double shortest = 10.0 / 6.4e6;  // rad, some 10 m
  constexpr double longest = 500.0 / 6.4e6;
  constexpr std::size_t enough = 20;
  Agreement sum;
  std::size_t count = 0;
  std::size_t last = 0;
  for (std::size_t row = 1; row < track.size(); ++row) {
    const double north = latitude[row] - latitude[last];
    const double east = (longitude[row] - longitude[last]) * std::cos(latitude[row]);
    const double distance = std::hypot(north, east);
    if (distance < shortest) continue;
    const double middle = track[(last + row) / 2];
    const double turn = variation[(last + row) / 2];
    last = row;
    if (!(distance < longest) || !std::isfinite(middle + turn)) continue;
    const double course = std::atan2(east, north);
    sum.as_logged += std::cos(course - middle);
    sum.turned += std::cos(course - middle - turn);
    ++count;
  }
  if (count < enough) return std::nullopt;
  return Agreement{sum.as_logged / static_cast<double>(count),
                   sum.turned / static_cast<double>(count)};
}

/// A track that goes beyond a turn of its unit, or turns over within it as radians do.
void note_unit(const Flight& flight, const LoggedQuantity& track, std::vector<std::string>& notes) {
  const std::span<const double> values = track.column->values;
  const std::string& header = track.column->logged_header();
  const std::string name = track.column->header.substr(0, track.column->header.rfind('_'));
  if (!track.unit->is_inside()) {
    if (!files::turns_over_in_radians(values)) return;
    notes.push_back(fmt::format(
        "{}: {} turns over at 6.28, as an angle in radians does: if so, --map {} reads it so",
        flight.name(), header, files::map_pair(name + "_rad", header)));
    return;
  }
  constexpr double turn = 6.3;
  const auto largest = std::ranges::max_element(
      values, {}, [](double value) { return std::isfinite(value) ? std::abs(value) : 0.0; });
  if (largest == values.end() || !(std::abs(*largest) > 2.0 * turn)) return;
  notes.push_back(fmt::format(
      "{}: {} goes to {:.4g}, beyond a turn, as an angle in degrees does: if so, --map {} reads it "
      "so",
      flight.name(), header, *largest, files::map_pair(name + "_deg", header)));
}

/// Whether a track that does not say so is magnetic: where the positions go tells, or else a maker
/// whose track is.
bool is_magnetic(const Flight& flight, const LoggedQuantity& track,
                 const std::optional<LoggedQuantity>& magvar) {
  if (!magvar) return false;
  const auto agreement = compare_with_positions(flight, track.values(), magvar->values());
  constexpr double told = 1e-4;  // as 0.8 deg
  if (agreement && std::abs(agreement->turned - agreement->as_logged) > told) {
    return agreement->turned > agreement->as_logged;
  }
  const auto words = files::split_words(track.column->logged_header());
  return std::ranges::find(words, "trk") != words.end();  // Garmin's
}

}  // namespace

void turn_heading(Flight& flight, std::vector<std::string>& notes) {
  const auto heading = find_angle(flight, "mag_heading");
  const auto magvar = find_angle(flight, "magvar");
  if (flight.is_mapped() || !heading || !magvar || find_angle(flight, "yaw")) return;
  std::vector<double> yaw = heading->values();
  for (std::size_t row = 0; row < yaw.size(); ++row) yaw[row] += magvar->at(row);
  notes.push_back(fmt::format("{}: yaw is {} turned to true north by {}", flight.name(),
                              heading->column->logged_header(), magvar->column->logged_header()));
  add_with_holes(flight, "yaw_rad", std::move(yaw), "no heading");
}

void derive_from_track(Flight& flight, std::vector<std::string>& notes) {
  const auto speed = files::find_quantity(flight, "gs", UnitKind::speed);
  if (flight.is_mapped() || !speed || has_speed(flight, "vn") || has_speed(flight, "ve")) return;
  const auto magvar = find_angle(flight, "magvar");
  auto track = find_angle(flight, "track");
  bool magnetic = track && is_magnetic(flight, *track, magvar);
  if (!track) {
    track = find_angle(flight, "mag_track");
    magnetic = true;
  }
  if (!track) return;
  if (magnetic && !magvar) {
    notes.push_back(
        fmt::format("{}: no velocity is made of {}, a magnetic track: log the variation as "
                    "magvar_deg, positive to the east",
                    flight.name(), track->column->logged_header()));
    return;
  }
  note_unit(flight, *track, notes);
  constexpr double standstill = 1.0;  // m/s
  std::vector<double> north;
  std::vector<double> east;
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    const double moves = speed->at(row);
    double angle = track->at(row) + (magnetic ? magvar->at(row) : 0.0);
    if (moves < standstill && !std::isfinite(angle)) angle = 0.0;
    north.push_back(moves * std::cos(angle));
    east.push_back(moves * std::sin(angle));
  }
  notes.push_back(fmt::format(
      "{}: vn and ve are from {} and {}{}", flight.name(), speed->column->logged_header(),
      track->column->logged_header(),
      magnetic ? fmt::format(", turned to true north by {}", magvar->column->logged_header())
               : ", taken from true north"));
  add_with_holes(flight, "vn_mps", std::move(north), "no speed or track");
  add_with_holes(flight, "ve_mps", std::move(east), "no speed or track");
}

void derive_climb(Flight& flight, std::vector<std::string>& notes) {
  if (flight.is_mapped() || has_speed(flight, "vd")) return;
  if (!has_speed(flight, "vn") || !has_speed(flight, "ve")) return;
  if (smooth_climb(flight, notes)) return;
  const bool of_track =
      has_speed(flight, "gs") && (find_angle(flight, "track") || find_angle(flight, "mag_track"));
  if (!of_track) return;
  notes.push_back(
      fmt::format("{}: neither a vertical speed nor an altitude is logged: flight is taken for "
                  "level, vd for zero",
                  flight.name()));
  flight.add("vd_mps", std::vector<double>(flight.rows(), 0.0));
}

}  // namespace sepcal::logs
