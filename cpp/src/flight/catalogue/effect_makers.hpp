// SPDX-License-Identifier: BSD-3-Clause
// Makers that effects with a physics of their own share. The effect, and its parameters before the
// dot, are called as the setting that it is made for.
#pragma once

#include <string>
#include <vector>

#include "sepcal/detail/named_effects.hpp"

namespace sepcal::catalogue {

inline constexpr double longest_offset = 0.5;      // [s] of a sensor's clock
inline constexpr double longest_sensor_lag = 0.2;  // [s]
inline constexpr double largest_scale = 0.5;       // of what is scaled

/// An effect that is another one under its own name: `means` is "bias[step(time)]", `port` bias.
EffectKit::Maker renamed(const std::string& means, const Port& port);

/// A constant on a port, of which the model may have one.
EffectKit::Maker constant_on(const Port& port);

/// A constant on a port where the model has none. It has no driver whose mean could be taken away:
/// all of it is the effect.
EffectKit::Maker lacking_constant_on(const Port& port);

/// An effect in time with the one parameter tau, within +-bound [s].
EffectKit::Maker in_time(Delay::Kind kind, double bound,
                         const std::vector<std::string>& inputs = {});

/// A clock that drifts: the same from none at the record's first time steadily to tau at its last.
EffectKit::Maker drifting_clock(Delay::Kind kind, double bound,
                                const std::vector<std::string>& inputs = {});

/// The error of an angle among the model's inputs.
EffectKit::Maker attitude_error(const std::string& input);

/// A port's `causes` where what happens there is the air's: time, place and labels.
std::vector<std::string> time_and_place();

/// How far an attitude's filter lets roll and pitch wander, and the heading: a third of a degree, a
/// degree. A table's `attitude_errors` has the three in this order.
ErrorBound tilt_bound();
ErrorBound heading_bound();

}  // namespace sepcal::catalogue
