// SPDX-License-Identifier: BSD-3-Clause
// Units: factors from their definitions, and values in the inside unit bit for bit.
#include "flight/files/units.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

namespace units_test {

using doctest::Approx;
using sepcal::files::find_unit;
using sepcal::files::UnitKind;

namespace {

double convert(UnitKind kind, const char* suffix, double value) {
  const auto* unit = find_unit(kind, suffix);
  REQUIRE(unit != nullptr);
  return unit->convert(value);
}

const std::vector<UnitKind> kinds{UnitKind::time,        UnitKind::angle,    UnitKind::rate,
                                  UnitKind::speed,       UnitKind::pressure, UnitKind::field,
                                  UnitKind::temperature, UnitKind::density};

std::string list_suffixes(UnitKind kind) {
  std::string list;
  for (const auto& unit : sepcal::files::known_units(kind)) list += std::string(unit.suffix) + " ";
  return list;
}

}  // namespace

TEST_CASE("each kind has its units, the inside one first") {
  CHECK(list_suffixes(UnitKind::time) == "s ms us ns min h ");
  CHECK(list_suffixes(UnitKind::angle) == "rad deg ");
  CHECK(list_suffixes(UnitKind::rate) == "radps degps ");
  CHECK(list_suffixes(UnitKind::speed) == "mps kt kmh ftps fpm cmps mph ");
  CHECK(list_suffixes(UnitKind::pressure) == "pa hpa kpa psi psf torr bar mmhg inhg mmh2o inh2o ");
  CHECK(list_suffixes(UnitKind::field) == "ut nt t mt gauss mgauss ");
  CHECK(list_suffixes(UnitKind::temperature) == "k degc degf degr ");
  CHECK(list_suffixes(UnitKind::density) == "kgpm3 slugpft3 ");
  CHECK(list_suffixes(UnitKind::angular_acceleration) == "radps2 degps2 ");
  CHECK(list_suffixes(UnitKind::length) == "m ft km ");
  CHECK(list_suffixes(UnitKind::acceleration) == "mps2 g ftps2 ");
  CHECK(list_suffixes(UnitKind::mass) == "kg lb slug ");
  CHECK(list_suffixes(UnitKind::force) == "n lbf ");
  CHECK(list_suffixes(UnitKind::share) == "1 pct ");
  for (const UnitKind kind : kinds) CHECK(sepcal::files::known_units(kind).front().is_inside());
}

TEST_CASE("conversions") {
  const auto exactly = [](double value) { return Approx(value).epsilon(1e-15); };
  CHECK(convert(UnitKind::time, "ms", 1500) == 1.5);
  CHECK(convert(UnitKind::time, "us", 1'500'000) == 1.5);
  CHECK(convert(UnitKind::angle, "deg", 180) == 3.141592653589793);
  CHECK(convert(UnitKind::rate, "degps", -90) == exactly(-1.5707963267948966));
  CHECK(convert(UnitKind::speed, "kt", 3600) == 1852);
  CHECK(convert(UnitKind::speed, "kmh", 36) == 10);
  CHECK(convert(UnitKind::pressure, "hpa", 1013.25) == 101325);
  CHECK(convert(UnitKind::pressure, "kpa", 101.325) == exactly(101325));
  // NIST SP 811, B.8: 1 psi = 6.894 757 293 168 36 E+03 Pa; 1 torr = 101325/760 Pa.
  CHECK(convert(UnitKind::pressure, "psi", 1) == exactly(6894.75729316836));
  CHECK(convert(UnitKind::pressure, "torr", 760) == 101325);
  // The same table, to the digits that it has: the slug, lbf/ft^2 and the slug per cubic foot.
  const auto nearly = [](double value) { return Approx(value).epsilon(5e-7); };
  CHECK(convert(UnitKind::mass, "slug", 1) == nearly(14.59390));
  CHECK(convert(UnitKind::pressure, "psf", 1) == nearly(47.88026));
  CHECK(convert(UnitKind::density, "slugpft3", 1) == nearly(515.3788));
  CHECK(convert(UnitKind::mass, "lb", 1) == exactly(0.45359237));
  CHECK(convert(UnitKind::force, "lbf", 1) == exactly(4.4482216152605));
  CHECK(convert(UnitKind::speed, "ftps", 10) == exactly(3.048));
  CHECK(convert(UnitKind::speed, "fpm", 1000) == exactly(5.08));
  CHECK(convert(UnitKind::acceleration, "g", 1) == exactly(9.80665));
  CHECK(convert(UnitKind::acceleration, "ftps2", 100) == exactly(30.48));
  CHECK(convert(UnitKind::length, "ft", 1000) == exactly(304.8));
  CHECK(convert(UnitKind::angular_acceleration, "degps2", 180) == exactly(3.141592653589793));
  CHECK(convert(UnitKind::share, "pct", 50) == 0.5);
  CHECK(convert(UnitKind::field, "nt", 50'000) == 50);
  CHECK(convert(UnitKind::field, "gauss", 0.5) == 50);
  CHECK(convert(UnitKind::field, "mgauss", 500) == 50);
  CHECK(convert(UnitKind::temperature, "degc", 15) == 288.15);
  CHECK(convert(UnitKind::temperature, "degc", -273.15) == 0);
}

TEST_CASE("a value in the inside unit passes bit for bit") {
  for (const UnitKind kind : kinds) {
    for (const double value : {-0.0, 0.1, 1.7e308, 5e-324}) {
      const double converted = sepcal::files::known_units(kind).front().convert(value);
      CHECK(std::bit_cast<std::uint64_t>(converted) == std::bit_cast<std::uint64_t>(value));
    }
  }
}

TEST_CASE("unknown units are not found") {
  CHECK(find_unit(UnitKind::angle, "grad") == nullptr);
  CHECK(find_unit(UnitKind::angle, "") == nullptr);
  CHECK(find_unit(UnitKind::angle, "RAD") == nullptr);
  CHECK(find_unit(UnitKind::speed, "rad") == nullptr);
}

}  // namespace units_test
