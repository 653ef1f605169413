// SPDX-License-Identifier: BSD-3-Clause
// A probe that ships: its names, and how it is made. Each stands beside its probe.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/flight/probe.hpp"

namespace sepcal::probes {

using Settings = std::map<std::string, std::vector<double>>;

/// A probe by its name in a calibration's file, which is made of settings as it gives them.
struct Shipped {
  std::string_view name;
  std::string_view words;  // what people call it: "five-hole probe"
  std::unique_ptr<const Probe> (*make)(const Settings& settings);
};

extern const Shipped shipped_five_hole;
extern const Shipped shipped_vane_boom;
extern const Shipped shipped_pitot_static;
extern const Shipped shipped_magnetometer;
extern const Shipped shipped_attitude_independent;

/// All of them. Defined in registry/.
std::span<const Shipped* const> shipped();

/// A setting of one number or three. Throws Error where it is missing or of another length.
double one_number(const Settings& settings, const std::string& name);
std::array<double, 3> three_numbers(const Settings& settings, const std::string& name);

}  // namespace sepcal::probes
