// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/cross_checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <optional>

#include "base/escaping.hpp"
#include "flight/checks/axes.hpp"
#include "flight/checks/excitation.hpp"
#include "flight/checks/flow_angles.hpp"
#include "flight/checks/suspect_rows.hpp"
#include "flight/probes/plausible_readings.hpp"

namespace sepcal::checks {
namespace {

using Eigen::Matrix3Xd;
using files::Unit;
using files::UnitKind;

/// What two measures of one quantity may differ by: a wind of a third of the airspeed, say.
constexpr double least_ratio = 0.6;
constexpr double largest_ratio = 1.6;

/// The unit in which the readings would be nearest to what they are held against, where one brings
/// them within a quarter; nothing else. `ratio`: theirs, in the unit of their header. A sensor that
/// is off by some per cent makes miles of knots and feet of kilometres: units of which logs are
/// seldom count for farther.
const Unit* guess_unit(const Unit& header, double ratio) {
  constexpr double seldom = 0.12;
  const Unit* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Unit& unit : files::known_units(header.kind)) {
    const double error = std::abs(std::log(ratio * unit.convert(1.0) / header.convert(1.0)));
    if (&unit == &header || error > std::log(1.25)) continue;
    const double cost = error + (unit.suffix == "mph" || unit.suffix == "ftps" ? seldom : 0.0);
    if (cost > least) continue;
    nearest = &unit;
    least = cost;
  }
  return nearest;
}

/// "--map vn_kt=vn_mps,ve_kt=ve_mps": the columns read in another unit.
std::string map_in_unit(std::initializer_list<const LoggedColumn*> columns, const Unit& unit) {
  std::vector<std::string> pairs;
  for (const LoggedColumn* column : columns) {
    if (column == nullptr) continue;
    pairs.push_back(fmt::format("{}_{}={}", column->name(), unit.suffix, column->log_header()));
  }
  return "--map " + base::in_shell(fmt::format("{}", fmt::join(pairs, ",")));
}

/// "--map vn_mps=ve_mps,ve_mps=-vn_mps" of axes "ve, -vn" in the place of these.
std::string map_axes(const Log& log, std::initializer_list<std::string_view> quantities,
                     std::string_view axes) {
  std::vector<std::string> pairs;
  for (const std::string_view quantity : quantities) {
    std::string_view axis = axes.substr(0, axes.find(", "));
    axes.remove_prefix(std::min(axes.size(), axis.size() + 2));
    const bool turned = axis.starts_with('-');
    if (turned) axis.remove_prefix(1);
    if (axis == quantity && !turned) continue;
    const LoggedColumn& from = *log.find(axis);
    pairs.push_back(fmt::format("{}_{}={}{}", quantity, from.logged.unit->suffix, turned ? "-" : "",
                                from.log_header()));
  }
  return "--map " + base::in_shell(fmt::format("{}", fmt::join(pairs, ",")));
}

/// The airspeed in units of the speed through the air that the tracks over the ground tell,
/// whatever the wind: |v - W|^2 = a z^2 + b is linear in W, a and b - |W|^2. NaN where they don't
/// turn about W.
double find_ratio_in_wind(const std::vector<double>& north, const std::vector<double>& east,
                          const std::vector<double>& airspeed) {
  Eigen::MatrixX4d columns(static_cast<Eigen::Index>(north.size()), 4);
  Eigen::VectorXd squares(columns.rows());
  Eigen::Index rows = 0;
  for (std::size_t i = 0; i < north.size(); ++i) {
    if (!std::isfinite(north[i] + east[i] + airspeed[i])) continue;
    columns.row(rows) << 2 * north[i], 2 * east[i], 1, airspeed[i] * airspeed[i];
    squares[rows++] = north[i] * north[i] + east[i] * east[i];
  }
  if (rows < 20) return not_a_number;
  const Eigen::VectorXd x =
      columns.topRows(rows).completeOrthogonalDecomposition().solve(squares.head(rows));
  const double square =
      (columns.topRows(rows).rightCols<2>() * x.tail<2>()).mean() + x.head<2>().squaredNorm();
  std::vector<double> headings;
  for (Eigen::Index i = 0; i < rows; ++i) {
    headings.push_back(std::atan2(columns(i, 1) / 2 - x[1], columns(i, 0) / 2 - x[0]));
  }
  constexpr double enough = 200 * std::numbers::pi / 180;
  if (!(square > 0) || covered_arc(std::move(headings)) < enough) return not_a_number;
  return std::sqrt(columns.topRows(rows).col(3).mean() / square);
}

/// The column of speeds over the ground that the velocity is made of, where it is made of one.
std::optional<files::LoggedQuantity> find_speed_column(const Log& log,
                                                       const std::vector<double>& ground) {
  constexpr double rounding = 1e-9;
  auto speed = files::find_quantity(log.flight(), "gs", UnitKind::speed);
  if (!speed) return std::nullopt;
  for (std::size_t row = 0; row < ground.size(); ++row) {
    const double apart = std::abs(ground[row] - std::abs(speed->at(row)));
    if (apart > rounding * ground[row]) return std::nullopt;
  }
  return speed;
}

bool is_likely(double ratio) { return ratio >= least_ratio && ratio <= largest_ratio; }

void note_speeds(const Log& log, std::vector<LogNote>& notes) {
  const std::vector<double> ground = find_ground_speed(log);
  const auto airspeed = find_airspeed(log);
  if (ground.empty() || !airspeed) return;
  std::vector<double> ratios;
  for (const std::size_t row : find_moving_rows(ground, 0.3)) {
    const double ratio = airspeed->values[row] / ground[row];
    if (std::isfinite(ratio)) ratios.push_back(ratio);
  }
  const double ratio = median(std::move(ratios));
  if (std::isnan(ratio) || is_likely(ratio) || is_constant(airspeed->values)) return;
  const double in_wind =
      find_ratio_in_wind(log.find("vn")->values, log.find("ve")->values, airspeed->values);
  if (is_likely(in_wind)) return;
  const LoggedColumn* read = log.find("airspeed");
  const LoggedColumn* north = log.find("vn");
  const double held = std::isnan(in_wind) ? ratio : in_wind;
  const Unit* reads = read == nullptr ? nullptr : guess_unit(*read->logged.unit, held);
  const auto speed = find_speed_column(log, ground);
  const Unit* moves = guess_unit(speed ? *speed->unit : *north->logged.unit, 1 / held);
  std::vector<std::string> columns = airspeed->headers;
  columns.push_back(north->header());
  columns.push_back(log.find("ve")->header());
  LogNote note = note_on(log, "units", Concern::wrong, std::move(columns));
  note.found =
      fmt::format("{} is usually {:.3g} times the speed over the ground",
                  read != nullptr ? read->header() : "the airspeed of the pressures", ratio);
  note.effect = fmt::format("the scale of the airspeed comes out {:.2g} times what it is", ratio);
  note.predicts = Predicted::scale;
  std::vector<std::string> renamings;
  std::vector<std::string> slips;
  const auto offer = [&](const Unit& unit, const std::string& header, const std::string& mapping) {
    slips.push_back(fmt::format("{} under the header {}", unit.suffix, header));
    renamings.push_back(fmt::format("{} reads it so", mapping));
  };
  if (reads != nullptr) offer(*reads, read->header(), map_in_unit({read}, *reads));
  if (moves != nullptr && speed) {
    const std::string& logged = speed->column->logged_header();
    offer(*moves, speed->column->header,
          "--map " + files::map_pair(fmt::format("gs_{}", moves->suffix), logged));
  } else if (moves != nullptr) {
    offer(*moves, north->header(), map_in_unit({north, log.find("ve"), log.find("vd")}, *moves));
  }
  if (slips.empty()) {
    note.advice = "check the units of both; a wind alone would have to be strong";
  } else {
    note.found += fmt::format(": as {} would be", fmt::join(slips, ", or "));
    note.advice = fmt::format("if so, {}", fmt::join(renamings, ", or "));
  }
  notes.push_back(std::move(note));
}

/// The readings' strength in units of the true field's, by measures of which none needs what
/// another does: as it stands (hard iron adds to it), by their ellipsoid (which takes readings all
/// round), by how they follow the true field (which takes an attitude).
std::vector<double> find_strength_ratios(const FieldRows& field) {
  const Eigen::VectorXd strengths = field.read.colwise().norm();
  std::vector<double> ratios{median({strengths.begin(), strengths.end()}) / field.strength};
  const Eigen::MatrixX3d columns = field.read.transpose();
  const probes::Points points = points_of(columns);
  if (const auto ellipsoid = probes::fit_ellipsoid(points)) {
    const probes::Coverage coverage = probes::judge_coverage(points, *ellipsoid);
    if (coverage.one_sided < 0.5 && coverage.thinnest > 0.05) {
      ratios.push_back(ellipsoid->radius() / field.strength);
    }
  }
  if (field.truth.cols() > 0) {
    const Matrix3Xd m = field.read.colwise() - field.read.rowwise().mean();
    const Matrix3Xd h = field.truth.colwise() - field.truth.rowwise().mean();
    const double slope = m.norm() / h.norm();  // whichever way the axes point
    if (std::isfinite(slope)) ratios.push_back(slope);
  }
  return ratios;
}

/// A unit that is wrong is so by every measure.
void note_strength(const Log& log, const FieldRows& field, std::vector<LogNote>& notes) {
  constexpr double largest = 200.0;  // uT; of a true field beyond it that is said
  if (field.read.cols() == 0 || !(field.strength > 0) || field.strength > largest) return;
  const std::vector<double> ratios = find_strength_ratios(field);
  const double ratio =
      *std::ranges::min_element(ratios, {}, [](double r) { return std::abs(std::log(r)); });
  if (!(ratio < least_ratio || ratio > largest_ratio)) return;
  const Unit* unit = guess_unit(*field.unit, ratio);
  LogNote note = note_on(log, "units", Concern::wrong, field.headers);
  note.found = fmt::format(
      "the readings of {} are {:.3g} uT strong, {:.3g} times the true field's "
      "{:.3g} uT",
      list_headers(field.headers), ratio * field.strength, ratio, field.strength);
  if (unit != nullptr) {
    note.found +=
        fmt::format(": as {} under the header {} would be", unit->suffix, field.headers.front());
  }
  note.effect = fmt::format("scale errors come out near {:.2g}, or at their bounds", ratio - 1);
  note.predicts = Predicted::scale;
  note.advice =
      unit != nullptr
          ? fmt::format("if so, {} reads them so",
                        map_in_unit({log.find("mx"), log.find("my"), log.find("mz")}, *unit))
          : "check the unit of the readings; the true field is to be given "
            "in uT, not in nT or gauss";
  notes.push_back(std::move(note));
}

void note_field_axes(const Log& log, const FieldRows& field, std::vector<LogNote>& notes) {
  const auto better = find_field_axes(field.read, field.truth);
  if (!better) return;
  LogNote note = note_on(log, "axes", Concern::wrong, field.headers);
  note.found = fmt::format(
      "{} follow the true field as ({}): correlation {:.2f} against {:.2f} as they stand",
      list_headers(field.headers), better->axes, better->agreement, better->agreement_as_logged);
  note.effect = "no misalignment turns axes that far: they end at their bounds";
  note.predicts = Predicted::bound;
  note.advice = fmt::format(
      "{} reads them so; or give how the sensor is mounted, or check the attitude's signs",
      map_axes(log, {"mx", "my", "mz"}, better->axes));
  notes.push_back(std::move(note));
}

void note_track_axes(const Log& log, std::vector<LogNote>& notes) {
  const auto velocity = log.find_all({"vn", "ve"});
  const auto* yaw = log.find("yaw");
  if (velocity.empty() || yaw == nullptr) return;
  std::vector<std::array<double, 3>> moving;  // north, east, yaw
  for (const std::size_t row : find_moving_rows(find_ground_speed(log), 0.3)) {
    const std::array at{velocity[0]->values[row], velocity[1]->values[row], yaw->values[row]};
    if (std::isfinite(at[2])) moving.push_back(at);
  }
  const auto better = find_track_axes(moving);
  if (!better) return;
  LogNote note = note_on(log, "axes", Concern::wrong,
                         {velocity[0]->header(), velocity[1]->header(), yaw->header()});
  note.found = fmt::format("the motion does not go where {} points (agreement {:.2f} of 1)",
                           yaw->header(), better->agreement_as_logged);
  note.effect = "the wind and the angles come out wrong";
  if (better->axes.empty()) {
    note.advice = fmt::format("check the unit and the sense of {}, and the frame of the velocity",
                              yaw->header());
  } else {
    note.found += fmt::format("; with {} in the place of vn, ve it would ({:.2f})", better->axes,
                              better->agreement);
    note.advice = fmt::format("{} reads them so; or check the sense of the yaw",
                              map_axes(log, {"vn", "ve"}, better->axes));
  }
  notes.push_back(std::move(note));
}

/// A heading in degrees that turns over at 2 pi is in radians.
void note_heading_unit(const Log& log, std::vector<LogNote>& notes) {
  const LoggedColumn* yaw = log.find("yaw");
  if (yaw == nullptr || yaw->logged.unit->is_inside()) return;
  if (!files::turns_over_in_radians(yaw->logged.column->values)) return;
  LogNote note = note_on(log, "units", Concern::wrong, {yaw->header()});
  note.found =
      fmt::format("{} stays within a turn of 6.28, as an angle in radians does", yaw->header());
  note.effect = "the attitude hardly turns";
  note.advice = fmt::format("if so, {} reads it so",
                            map_in_unit({yaw}, *files::find_unit(UnitKind::angle, "rad")));
  notes.push_back(std::move(note));
}

/// Readings that no flight has, but for columns of which a note says more already.
void note_implausible(const Log& log, const Settings& settings, std::vector<LogNote>& notes) {
  const auto find = [&](std::string_view quantity) -> std::optional<probes::Reading> {
    const LoggedColumn* column = log.find(quantity);
    if (column == nullptr) return std::nullopt;
    probes::Reading reading{column->header(), std::nullopt, {}};
    if (column->logged.unit->is_inside()) reading.relabel = column->kind();
    reading.values = column->logged.values();
    reading.logged = column->logged.column->logged;
    const auto bad = [](double value) { return !std::isfinite(value); };
    if (std::ranges::any_of(reading.values, bad)) return std::nullopt;
    return reading;
  };
  const auto set = settings.find("field_strength");
  const bool is_given = set != settings.end() && !set->second.empty();  // else to be found
  const auto strength = is_given ? std::optional(set->second.front()) : std::nullopt;
  for (const probes::Implausible& found : probes::find_implausible(find, strength)) {
    const bool said = std::ranges::any_of(notes, [&](const LogNote& note) {
      return note.kind == "units" && std::ranges::any_of(found.headers, [&](const auto& header) {
               return std::ranges::find(note.columns, header) != note.columns.end();
             });
    });
    if (said) continue;
    LogNote note = note_on(log, "implausible", Concern::wrong, found.headers);
    const std::size_t way_out = found.sentence.find("; ");
    note.found = found.sentence.substr(0, way_out);
    note.effect = "a fit takes the readings as they stand, in the header's unit";
    note.advice = found.sentence.substr(way_out + 2);
    notes.push_back(std::move(note));
  }
}

}  // namespace

void check_across(const Log& log, const Settings& settings, std::vector<LogNote>& notes) {
  note_speeds(log, notes);
  note_track_axes(log, notes);
  note_heading_unit(log, notes);
  check_flow_angles(log, settings, notes);
  if (const auto field = find_field(log, settings)) {
    note_strength(log, *field, notes);
    note_field_axes(log, *field, notes);
  }
  note_implausible(log, settings, notes);
}

}  // namespace sepcal::checks
