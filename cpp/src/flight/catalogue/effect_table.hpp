// SPDX-License-Identifier: BSD-3-Clause
// All that is known of a probe's effects, a row an effect: what people read of it, what it reads of
// a flight, and who makes it. Kits, the printed catalogue, the candidates of a diagnosis and the
// channels of a correction are derived from these tables.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/flight/effect_catalogue.hpp"
#include "sepcal/detail/named_effects.hpp"

namespace sepcal::catalogue {

/// What an effect changes: the reading, which a correction undoes, or the world around the probe,
/// which it leaves as it is.
enum class ActsOn { reading, world };

/// `port[driver]` as the catalogue shows it.
struct Form {
  std::string driver;  // "alpha^2"; `any_driver` where it is open
  std::string equation;
  std::string drivers = "any DRIVER";
};
inline constexpr const char* any_driver = "DRIVER";

/// A driver that is curved or smooth where physics is seldom straight.
struct Curve {
  std::string channel;  // how its name begins: "temp"
  std::string driver;   // "{}^2", with the channel's name for {}
};

struct PortRow {
  Port port;
  std::string sentence;  // "the wind changes", before what it changes with
  ActsOn acts_on = ActsOn::reading;
  std::vector<Form> forms;
  std::vector<Curve> curves = {};
  std::vector<std::string> channels = {};  // that it reads beside its driver
  std::string by_maneuver = {};            // the sentence where a maneuver may drive it
};

/// An effect with a physics of its own.
struct EffectRow {
  CataloguedEffect entry;
  std::string sentence;
  std::vector<std::string> channels = {};  // that it reads, by their names in a record
  ActsOn acts_on = ActsOn::reading;
  EffectKit::Maker maker;
  std::vector<std::string> better_with = {};       // channels that it reads where all are logged
  std::map<std::string, Interval> plausible = {};  // of coefficients, by component

  const std::string& name() const { return entry.name; }
};

/// Another name of `port[driver]`; in `port[altitude_*]` the one column that begins so.
struct AliasRow {
  std::string name;
  std::string means;
  std::string drivers;
  std::string unit;
};

/// A channel that effects follow where it is logged.
struct Channel {
  std::string beginning;  // of the header
  std::string name;       // that a log would give it
};

struct EffectTable {
  std::vector<PortRow> ports;
  std::vector<EffectRow> effects;
  std::vector<AliasRow> aliases;
  std::vector<Channel> channels;
  std::vector<EffectKit::Maker> attitude_errors = {};  // errors of the attitude: roll, pitch, yaw
  std::vector<ErrorBound> error_budget = {};           // as sensors of the kind let them
  std::vector<std::string> disturbed = {};             // readings that meet gusts
  /// What drives effects under the name that a record gives it, where it is there.
  std::vector<std::string> state_drivers = {"alpha", "beta", "q", "r"};
  /// Outputs that a log may have under the name that a record gives them: no effect follows them.
  std::vector<std::string> measured = {};

  /// nullptr where there is none of that name.
  const PortRow* find_port(const std::string& name) const;
  const EffectRow* find_effect(const std::string& name) const;
};

EffectTable five_hole_effects();
EffectTable vane_boom_effects();
EffectTable pitot_static_effects();
EffectTable magnetometer_effects();
EffectTable attitude_independent_effects();

/// Of all probes that ship, by Probe::name(). Defined in registry/, which knows them.
const std::map<std::string, EffectTable, std::less<>>& effect_tables();

/// Those along a trajectory: of "path", and of "aircraft", one that is integrated.
const std::map<std::string, EffectTable, std::less<>>& trajectory_tables();

/// One of these two.
const EffectTable& trajectory_table(std::string_view model);

/// What its effects are made with; the table must outlive it.
EffectKit kit_of(const EffectTable& table);

/// Throws Error for a name of no probe.
const EffectTable& effect_table(std::string_view probe);

}  // namespace sepcal::catalogue
