// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/effect_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "flight/files/headers.hpp"
#include "flight/probes/air_columns.hpp"
#include "sepcal/error.hpp"

namespace sepcal::catalogue {
namespace {

using files::UnitKind;

/// Quantities that effects read, under the names that a record gives them.
struct State {
  std::string_view name;    // in the record
  std::string_view header;  // its column's base name
  UnitKind kind;
};
constexpr std::array states{
    State{"time", "time", UnitKind::time},  State{"p", "p", UnitKind::rate},
    State{"q", "q", UnitKind::rate},        State{"r", "r", UnitKind::rate},
    State{"ps", "ps", UnitKind::pressure},  State{"dp", "dp", UnitKind::pressure},
    State{"rho", "rho", UnitKind::density}, State{"temperature", "temp", UnitKind::temperature}};

const State& find_state(std::string_view name) {
  return *std::ranges::find(states, name, &State::name);
}

/// The column of a state quantity in the unit used inside; empty where it isn't logged.
std::vector<double> state_column(const Flight& flight, const State& state) {
  return files::read_quantity(flight, state.header, state.kind);
}

/// A flow angle as read [rad]; empty where the probe has none.
std::vector<double> flow_angle(const Record& record, const Probe& probe, bool alpha) {
  const auto settings = probe.settings();
  const auto k = settings.find(alpha ? "k_alpha" : "k_beta");
  if (k == settings.end()) return {};
  const auto dp = record.column(alpha ? "dpa" : "dpb");
  const auto pt = record.column("pt");
  const auto ps = record.column("ps");
  std::vector<double> angle(dp.size());
  for (std::size_t row = 0; row < angle.size(); ++row) {
    angle[row] = dp[row] / (k->second.front() * (pt[row] - ps[row]));
  }
  return angle;
}

/// Density from static pressure and temperature; empty where one of them isn't logged.
std::vector<double> computed_density(const Flight& flight) {
  std::vector<double> rho = state_column(flight, find_state("ps"));
  const std::vector<double> temperature = state_column(flight, find_state("temperature"));
  if (temperature.empty()) return {};
  for (std::size_t row = 0; row < rho.size(); ++row) {
    rho[row] = probes::density_of_air(rho[row], temperature[row]);
  }
  return rho;
}

/// The channel's values; empty where there is no way to them.
std::vector<double> find_values(const Record& record, const Flight& flight, const Probe& probe,
                                const std::string& channel) {
  if (channel == "alpha" || channel == "beta") {
    return flow_angle(record, probe, channel == "alpha");
  }
  if (std::ranges::find(states, channel, &State::name) == states.end()) return {};
  std::vector<double> values = state_column(flight, find_state(channel));
  return values.empty() && channel == "rho" ? computed_density(flight) : values;
}

bool add_channel(Record& record, const Flight& flight, const Probe& probe,
                 const std::string& channel) {
  if (record.has(channel)) return true;
  std::vector<double> values = find_values(record, flight, probe, channel);
  if (!values.empty()) {
    record.add(channel, std::move(values));
    return true;
  }
  const Flight::Column* column = flight.find(channel);
  if (column == nullptr) return false;
  record.view(channel, column->values, column->owner);
  return true;
}

/// What an effect reads beside the readings themselves.
std::vector<std::string> channels_of(const EffectTable& table, const EffectName& name) {
  if (const EffectRow* own = table.find_effect(name.text)) return own->channels;
  std::vector<std::string> channels = driver_channels(name);
  if (name.base == "maneuver") channels = {"time"};
  if (name.shape == EffectName::Shape::delay) channels.emplace_back("time");
  if (const PortRow* row = table.find_port(name.port)) {
    channels.insert(channels.end(), row->channels.begin(), row->channels.end());
  }
  return channels;
}

/// Adds what makes the effect better known, where all of it is logged, and its names to `channels`.
void add_better(Record& record, const Flight& flight, const Probe& probe, const EffectRow& effect,
                std::vector<std::string>& channels) {
  Record better;
  for (const std::string& channel : effect.better_with) {
    if (!add_channel(better, flight, probe, channel)) return;
  }
  const auto logged = [&](const std::string& channel) { return is_logged(better, channel); };
  if (std::ranges::none_of(effect.better_with, logged)) return;
  for (const std::string& channel : effect.better_with) {
    add_channel(record, flight, probe, channel);
    channels.push_back(channel);
  }
}

}  // namespace

bool is_logged(const Record& record, const std::string& name) {
  if (!record.has(name)) return false;
  if (name != "p" && name != "q" && name != "r") return true;
  return std::ranges::any_of(record.column(name), [](double rate) { return rate != 0.0; });
}

bool acts_on_the_world(const EffectTable& table, const EffectName& name) {
  if (const EffectRow* own = table.find_effect(name.text)) return own->acts_on == ActsOn::world;
  const PortRow* row = table.find_port(name.port);
  return row != nullptr && row->acts_on == ActsOn::world;
}

std::vector<std::string> add_channels(Record& record, const Flight& flight, const Probe& probe,
                                      const EffectName& effect) {
  const EffectTable& table = probe.effects();
  std::vector<std::string> channels = channels_of(table, effect);
  for (const std::string& channel : channels) {
    if (add_channel(record, flight, probe, channel)) continue;
    throw Error(fmt::format("{}: the calibration's effect {} needs {}, which is not logged; {}",
                            flight.name(), effect.text, channel, flight.list_columns()));
  }
  if (const EffectRow* own = table.find_effect(effect.text)) {
    add_better(record, flight, probe, *own, channels);
  }
  return channels;
}

void add_all_channels(Record& record, const Flight& flight) {
  for (const State& state : states) {
    if (record.has(state.name)) continue;
    std::vector<double> values = state_column(flight, state);
    if (!values.empty()) record.add(std::string(state.name), std::move(values));
  }
  for (const Flight::Column& column : flight.columns()) {
    if (!record.has(column.header)) record.view(column.header, column.values, column.owner);
  }
}

}  // namespace sepcal::catalogue
