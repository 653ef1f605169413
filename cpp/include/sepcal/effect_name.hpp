// SPDX-License-Identifier: BSD-3-Clause
// The names of effects: `port[driver]`, or a name alone for an effect with a physics of its own.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/channel_product.hpp"

namespace sepcal {

struct EffectName {
  enum class Shape {
    none,      // no driver: "heading_bias"
    power,     // "x", "x^2"
    product,   // "x*y^2", "x*abs(x)"
    exponent,  // "x^n"
    spline,    // "spline(x,k)"
    levels,    // "levels(x,a,b)"
    step,      // "step(time)"
    ramp,      // "ramp(time)"
    decay,     // "decay(time)"
    delay      // "delay(x)"
  };

  std::string text;  // the whole name, without spaces
  std::string port;  // "wind", or the whole name where there is no driver
  std::string base;  // the channel: "altitude_m", "time"; the whole product; empty without a driver
  Shape shape = Shape::none;
  int number = 1;                           // the power, or how many knots
  std::vector<ChannelFactor> factors = {};  // of a product
  std::vector<double> thresholds = {};      // between levels, rising
};

/// Throws Error for a text that is no name, saying what the forms are.
EffectName parse_effect_name(std::string_view text);

/// What the driver reads, each once.
std::vector<std::string> driver_channels(const EffectName& name);

/// Whether port[channel] names the channel: "Throttle [%]" and "temp^2" don't name themselves.
bool can_name(std::string_view channel);

/// The names of a list joined by '+' ("E1+E2"); a '+' within brackets belongs to a name. Throws
/// Error for an empty one.
std::vector<std::string> split_effects(std::string_view text);

}  // namespace sepcal
