// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/units.hpp"

#include <algorithm>
#include <array>
#include <numbers>

namespace sepcal::files {
namespace {

using enum UnitKind;
using std::numbers::pi;

// Kinds stand together, the unit used inside first.
constexpr std::array units{
    Unit{"s", time},
    Unit{"ms", time, 1, 1000},
    Unit{"us", time, 1, 1'000'000},
    Unit{"ns", time, 1, 1'000'000'000},
    Unit{"min", time, 60, 1},
    Unit{"h", time, 3600, 1},
    Unit{"rad", angle},
    Unit{"deg", angle, pi, 180},
    Unit{"radps", rate},
    Unit{"degps", rate, pi, 180},
    Unit{"radps2", angular_acceleration},
    Unit{"degps2", angular_acceleration, pi, 180},
    Unit{"m", length},
    Unit{"ft", length, 0.3048, 1},
    Unit{"km", length, 1000, 1},
    Unit{"mps", speed},
    Unit{"kt", speed, 1852, 3600},  // the international nautical mile an hour
    Unit{"kmh", speed, 1000, 3600},
    Unit{"ftps", speed, 0.3048, 1},
    Unit{"fpm", speed, 0.3048, 60},
    Unit{"cmps", speed, 1, 100},
    Unit{"mph", speed, 1609.344, 3600},  // the international mile an hour
    Unit{"mps2", acceleration},
    Unit{"g", acceleration, 9.80665, 1},
    Unit{"ftps2", acceleration, 0.3048, 1},
    Unit{"kg", mass},
    Unit{"lb", mass, 0.45359237, 1},
    Unit{"slug", mass, 4.4482216152605, 0.3048},  // lbf s^2/ft
    Unit{"n", force},
    Unit{"lbf", force, 4.4482216152605, 1},
    Unit{"pa", pressure},
    Unit{"hpa", pressure, 100, 1},
    Unit{"kpa", pressure, 1000, 1},
    Unit{"psi", pressure, 4.4482216152605, 0.0254 * 0.0254},  // lbf/in^2
    Unit{"psf", pressure, 4.4482216152605, 0.3048 * 0.3048},  // lbf/ft^2
    Unit{"torr", pressure, 101325, 760},
    Unit{"bar", pressure, 100'000, 1},
    Unit{"mmhg", pressure, 133.322387415, 1},         // the conventional millimetre of mercury
    Unit{"inhg", pressure, 133.322387415 * 25.4, 1},  // and 25.4 of them
    Unit{"mmh2o", pressure, 9.80665, 1},              // the conventional millimetre of water
    Unit{"inh2o", pressure, 9.80665 * 25.4, 1},
    Unit{"ut", field},
    Unit{"nt", field, 1, 1000},
    Unit{"t", field, 1'000'000, 1},
    Unit{"mt", field, 1000, 1},
    Unit{"gauss", field, 100, 1},
    Unit{"mgauss", field, 1, 10},
    Unit{"k", temperature},
    Unit{"degc", temperature, 1, 1, 273.15},
    Unit{"degf", temperature, 5, 9, 459.67 * 5 / 9},
    Unit{"degr", temperature, 5, 9},  // Rankine
    Unit{"kgpm3", density},
    Unit{"slugpft3", density, 4.4482216152605, 0.3048 * 0.3048 * 0.3048 * 0.3048},  // lbf s^2/ft^4
    Unit{"1", share},
    Unit{"pct", share, 1, 100},
};

}  // namespace

std::span<const Unit> known_units(UnitKind kind) {
  const auto found = std::ranges::equal_range(units, kind, {}, &Unit::kind);
  return {found.begin(), found.end()};
}

const Unit* find_unit(UnitKind kind, std::string_view suffix) {
  for (const Unit& unit : known_units(kind)) {
    if (unit.suffix == suffix) return &unit;
  }
  return nullptr;
}

}  // namespace sepcal::files
