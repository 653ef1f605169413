// SPDX-License-Identifier: BSD-3-Clause
// What a probe's effects can be made of, and a flight brought to the model that they make.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sepcal/detail/named_effects.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal {

/// Ports, effects with a physics of their own and aliases of a probe: the catalogue that
/// effect_catalogue.hpp describes; with `own`, which go before those. The probe must outlive it.
EffectKit effect_kit(const Probe& probe, const OwnEffects& own = {});

/// The same of a probe that ships, by its Probe::name().
EffectKit effect_kit(std::string_view probe);

/// A flight as the model with its effects takes it.
struct EffectiveFlight {
  ProbeRecord prepared;         // rows that the effects in time can't use are left out
  std::vector<Effect> effects;  // in the order of the settings
  std::shared_ptr<const BlockModel> model;
};

/// What Probe::prepare() gave for `flight`, with effects; what `settings` lack is taken from it.
/// `own`: effects that the caller made. `bounds` replace those of the effects' parameters. Throws
/// Error, opened by the flight's name, as make_effects(), compose() and without_edges() do.
EffectiveFlight with_effects(const Probe& probe, const Flight& flight, const ProbeRecord& prepared,
                             std::vector<EffectSetting>& settings, const OwnEffects& own,
                             const std::map<std::string, Interval>& bounds = {});

/// The same of a record alone, whose errors name no flight.
EffectiveFlight with_effects(const Probe& probe, const Record& record,
                             std::vector<EffectSetting>& settings, const OwnEffects& own,
                             const std::map<std::string, Interval>& bounds = {});

/// The probe's model where an owner is asked for; the probe must outlive it.
std::shared_ptr<const BlockModel> model_of(const Probe& probe);

}  // namespace sepcal
