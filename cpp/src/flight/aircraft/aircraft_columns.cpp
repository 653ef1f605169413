// SPDX-License-Identifier: BSD-3-Clause
#include "flight/aircraft/aircraft_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/columns.hpp"
#include "base/gaps.hpp"
#include "base/name_list.hpp"
#include "flight/aircraft/believed_rows.hpp"
#include "flight/files/headers.hpp"
#include "flight/logs/velocity_columns.hpp"
#include "flight/probes/air_columns.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "numerics/interpolated_column.hpp"
#include "sepcal/error.hpp"

namespace sepcal::aircraft_log {
namespace {

using probes::RecordBuilder;

/// A load factor has the other sign and is asked for by name, as it is what logs have.
void refuse_load_factor(const RecordBuilder& builder, const Flight& flight) {
  if (builder.has({"az"})) return;
  for (const char* header : {"an_g", "nz_g", "an_mps2", "an_ftps2"}) {
    if (flight.find(header) == nullptr) continue;
    throw Error(fmt::format(
        "{}: column '{}' is a load factor, positive up; az is the specific force downwards: log "
        "az_g = -{} (level flight reads az = -9.81 m/s^2)",
        flight.name(), header, header));
  }
}

void need_air(RecordBuilder& builder, const Flight& flight) {
  builder.need({"airspeed", "alpha", "beta"});
  if (builder.has({"qbar"})) {
    builder.need({"qbar"});
  } else {
    probes::need_density(builder, flight, "rho_kgpm3, or temp_k and ps_pa, or qbar_pa");
  }
}

/// A flight in the plane of symmetry: of what lies across it, zeros where a log has nothing.
Flight within_symmetry(const Flight& flight, std::vector<std::string>& notes) {
  const RecordBuilder logged(flight, quantities_of(AircraftModel::longitudinal).list, {});
  Flight whole = flight;
  std::vector<std::string> added;
  const auto add = [&](const char* name, const char* header) {
    if (logged.has({name})) return;
    whole.add(header, std::vector<double>(flight.rows(), 0.0));
    added.emplace_back(name);
  };
  add("ay", "ay_mps2");
  add("p", "p_radps");
  add("r", "r_radps");
  add("beta", "beta_rad");
  add("roll", "roll_rad");
  if (added.empty()) return flight;
  if (logged.has({"qdot"})) {
    add("pdot", "pdot_radps2");
    add("rdot", "rdot_radps2");
  }
  notes.push_back(
      fmt::format("{}: no column for {}, taken as zero, as in flight in the plane of symmetry",
                  flight.name(), base::list_names(added)));
  return whole;
}

/// Rows of the flight in which an output has no reading.
struct EmptyCells {
  std::string name;
  std::vector<bool> is_empty;
};

/// Of outputs that a filter follows, those with empty cells, which then have straight lines there:
/// states that are read, and where a fit starts, take these. A yaw that is logged within a turn has
/// none.
std::vector<EmptyCells> bridge_outputs(Flight& flight, bool is_path,
                                       std::vector<std::string>& notes) {
  constexpr std::size_t fewest = 10;
  static constexpr std::array outputs{"airspeed", "alpha", "beta",  "roll", "pitch", "vn",
                                      "ve",       "vd",    "north", "east", "down",  "ax",
                                      "ay",       "az",    "p",     "q",    "r"};
  constexpr std::size_t inertial = 6;  // which a path is integrated from
  std::vector<EmptyCells> bridged;
  std::vector<std::string> told;
  for (const char* name : std::span(outputs).first(outputs.size() - (is_path ? inertial : 0))) {
    const auto quantity = std::ranges::find(quantities_of(AircraftModel::path).list,
                                            std::string_view(name), &probes::ProbeQuantity::name);
    const auto logged = files::find_quantity(flight, name, quantity->kind);
    if (!logged) continue;
    const std::span<const double> read = logged->column->values;
    EmptyCells cells{name, std::vector<bool>(read.size())};
    std::size_t there = 0;
    for (std::size_t row = 0; row < read.size(); ++row) {
      cells.is_empty[row] = std::isnan(read[row]);
      if (!cells.is_empty[row]) ++there;
    }
    const auto& text = logged->column->first_text;
    if (there == read.size() || there < fewest || (text && !text->text.empty())) continue;
    std::vector<double> values(read.begin(), read.end());
    base::bridge_gaps(values);
    told.push_back(fmt::format("{} in {}", name, there));
    flight.replace(logged->column->header, std::move(values));
    bridged.push_back(std::move(cells));
  }
  if (!told.empty()) {
    notes.push_back(
        fmt::format("{}: of {} rows there are readings of {}; the likelihood takes "
                    "those",
                    flight.name(), flight.rows(), base::list_names(told)));
  }
  return bridged;
}

/// The record with roll and yaw going on where they are logged within a turn: a state that is
/// integrated doesn't jump.
Record without_jumps(const Record& record) {
  base::Columns columns(record);
  for (const char* name : {"roll", "yaw"}) {
    if (!record.has(name)) continue;
    const std::span<const double> logged = record.column(name);
    std::vector<double> angles(logged.begin(), logged.end());
    for (const Segment& segment : record.segments()) {
      numerics::unwrap(std::span(angles).subspan(segment.first, segment.rows()));
    }
    columns.set(name, std::move(angles));
  }
  return columns.record();
}

}  // namespace

probes::ModelQuantities quantities_of(AircraftModel model) {
  using files::UnitKind;
  static constexpr std::array quantities{
      probes::ProbeQuantity{"time", UnitKind::time},
      probes::ProbeQuantity{"ax", UnitKind::acceleration},
      probes::ProbeQuantity{"ay", UnitKind::acceleration},
      probes::ProbeQuantity{"az", UnitKind::acceleration},
      probes::ProbeQuantity{"p", UnitKind::rate},
      probes::ProbeQuantity{"q", UnitKind::rate},
      probes::ProbeQuantity{"r", UnitKind::rate},
      probes::ProbeQuantity{"airspeed", UnitKind::speed},
      probes::ProbeQuantity{"alpha", UnitKind::angle},
      probes::ProbeQuantity{"beta", UnitKind::angle},
      probes::ProbeQuantity{
          .name = "roll", .kind = UnitKind::angle, .taken = probes::Taken::as_known},
      probes::ProbeQuantity{
          .name = "pitch", .kind = UnitKind::angle, .taken = probes::Taken::as_known},
      probes::ProbeQuantity{
          .name = "yaw", .kind = UnitKind::angle, .taken = probes::Taken::as_known},
      probes::ProbeQuantity{
          .name = "vn", .kind = UnitKind::speed, .taken = probes::Taken::as_known},
      probes::ProbeQuantity{
          .name = "ve", .kind = UnitKind::speed, .taken = probes::Taken::as_known},
      probes::ProbeQuantity{
          .name = "vd", .kind = UnitKind::speed, .taken = probes::Taken::as_known},
      probes::ProbeQuantity{
          .name = "north", .kind = UnitKind::length, .taken = probes::Taken::as_known},
      probes::ProbeQuantity{
          .name = "east", .kind = UnitKind::length, .taken = probes::Taken::as_known},
      probes::ProbeQuantity{
          .name = "down", .kind = UnitKind::length, .taken = probes::Taken::as_known},
      probes::ProbeQuantity{"elevator", UnitKind::angle},
      probes::ProbeQuantity{"aileron", UnitKind::angle},
      probes::ProbeQuantity{"rudder", UnitKind::angle},
      probes::ProbeQuantity{"throttle", UnitKind::share},
      probes::ProbeQuantity{"thrust", UnitKind::force},
      probes::ProbeQuantity{"mass", UnitKind::mass},
      probes::ProbeQuantity{.name = "rho", .kind = UnitKind::density, .unless = {"qbar"}},
      probes::ProbeQuantity{"qbar", UnitKind::pressure},
      probes::ProbeQuantity{.name = "ps", .kind = UnitKind::pressure, .unless = {"qbar", "rho"}},
      probes::ProbeQuantity{.name = "temp",
                            .kind = UnitKind::temperature,
                            .is_driver = true,
                            .unless = {"qbar", "rho"}},
      probes::ProbeQuantity{"pdot", UnitKind::angular_acceleration},
      probes::ProbeQuantity{"qdot", UnitKind::angular_acceleration},
      probes::ProbeQuantity{"rdot", UnitKind::angular_acceleration},
  };
  const bool by_row = model == AircraftModel::aero;
  return {quantities, by_row ? probes::LooksAt::coefficients : probes::LooksAt::trajectory};
}

bool has_gaps(const Flight& logged, const AskedColumns& asked, const LogChoice& log) {
  if (log.drop_invalid) return false;
  Flight flight = probes::read_for(quantities_of(asked.model), logged, log).flight;
  std::vector<std::string> notes;
  if (asked.position) logs::derive_position(flight, notes);
  return !bridge_outputs(flight, asked.model == AircraftModel::path, notes).empty();
}

bool is_symmetric(AircraftModel model, const std::vector<AeroEquation>& equations) {
  if (model != AircraftModel::aero) return model == AircraftModel::longitudinal;
  return !equations.empty() && std::ranges::all_of(equations, [](const AeroEquation& equation) {
    return equation.coefficient == "CX" || equation.coefficient == "CZ" ||
           equation.coefficient == "Cm";
  });
}

AskedColumns two_step_columns(const AircraftOptions& path) {
  return {.model = AircraftModel::six_dof, .position = path.position};
}

ProbeRecord prepare(const Flight& logged, const AskedColumns& asked, const LogChoice& log,
                    std::vector<GappedOutput>* gaps) {
  const AircraftModel model = asked.model;
  ReadFlight read = probes::read_for(quantities_of(model), logged, log);
  if (asked.position) logs::derive_position(read.flight, read.notes);
  const BelievedFlight believed = believe(read.flight, model, log);
  std::vector<std::string> notes;
  Flight flight = asked.symmetric ? within_symmetry(believed.flight, notes) : believed.flight;
  const std::vector<EmptyCells> bridged =
      gaps == nullptr || log.drop_invalid
          ? std::vector<EmptyCells>()
          : bridge_outputs(flight, model == AircraftModel::path, notes);
  RecordBuilder builder(flight, quantities_of(model).list, log);
  refuse_load_factor(builder, flight);
  builder.keep([&](std::size_t row) { return !std::ranges::binary_search(believed.left_out, row); },
               "a code stands there in a reading's place");
  builder.need({"time", "ax", "ay", "az", "p", "q", "r"});
  const bool flies_by_air = model != AircraftModel::path;
  if (flies_by_air) need_air(builder, flight);
  builder.keep_valid();
  if (flies_by_air && !builder.has({"qbar"})) probes::keep_positive_density(builder);
  builder.check_time();
  if (!flies_by_air) {
    for (const auto name : {"airspeed", "alpha", "beta"}) builder.offer({name});
    if (!builder.offer({"qbar"})) probes::offer_density(builder);
  }
  for (const auto name : {"roll", "pitch", "yaw", "elevator", "aileron", "rudder", "throttle",
                          "thrust", "mass", "ps"}) {
    builder.offer({name});
  }
  if (asked.position && !builder.offer({"north", "east", "down"})) {
    throw Error(fmt::format(
        "{}: a path with its position needs north_m, east_m and down_m, or lat_deg, lon_deg and "
        "altitude_m, in every row; log them, or leave the position out",
        flight.name()));
  }
  if (!asked.position || !read.velocity_is_of_positions) builder.offer({"vn", "ve", "vd"});
  builder.offer({"pdot", "qdot", "rdot"});
  probes::offer_temperature(builder);
  ProbeRecord prepared = builder.finish();
  prepared.record = without_jumps(prepared.record);
  for (const EmptyCells& one : bridged) {
    const auto column = prepared.record.column(one.name);
    GappedOutput output{one.name, {column.begin(), column.end()}};
    for (std::size_t row = 0; row < output.values.size(); ++row) {
      if (one.is_empty[prepared.flight_rows[row]]) output.values[row] = not_a_number;
    }
    gaps->push_back(std::move(output));
  }
  for (const std::vector<std::string>* told :
       {&std::as_const(notes), &believed.notes, &std::as_const(read.notes)}) {
    prepared.notes.insert(prepared.notes.begin(), told->begin(), told->end());
  }
  return prepared;
}

}  // namespace sepcal::aircraft_log
