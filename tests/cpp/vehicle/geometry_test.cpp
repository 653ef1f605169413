// SPDX-License-Identifier: BSD-3-Clause
// An aircraft's geometry, and its file.
#include "sepcal/aircraft/geometry.hpp"

#include <doctest/doctest.h>

#include <string>

#include "sepcal/detail/flight/aircraft_file.hpp"
#include "sepcal/error.hpp"

namespace geometry_test {

using doctest::Contains;
using sepcal::AircraftGeometry;
using sepcal::Error;
using sepcal::parse_aircraft;
using sepcal::RateReference;

namespace {

const AircraftGeometry cessna{
    .area = 16.2, .chord = 1.49, .span = 10.9, .mass = 1000, .inertia = {1285, 1825, 2667, 0}};

void refuse(AircraftGeometry geometry, const char* message) {
  CHECK_THROWS_WITH_AS(sepcal::check_geometry(geometry), Contains(message), Error);
}

void refuse(const std::string& json, const char* message) {
  CHECK_THROWS_WITH_AS(parse_aircraft(json, "a.json"), Contains(message), Error);
}

}  // namespace

TEST_CASE("an aircraft that can't be is refused in one line that says what") {
  CHECK_NOTHROW(sepcal::check_geometry(cessna));
  AircraftGeometry one = cessna;
  one.area = -1;
  refuse(one, "the aircraft's area is -1 m^2; it must be above zero");
  one = cessna;
  one.mass = sepcal::not_a_number;
  refuse(one, "the aircraft's mass is nan kg");
  one = cessna;
  one.chord = 11;
  refuse(one, "chord, 11 m, is longer than its span, 10.9 m; they are probably exchanged");
  one = cessna;
  one.inertia.Ixz = 2000;
  refuse(one, "Ixz is 2e+03 kg m^2; of a body its square is below Ix Iz");
  one = cessna;
  one.inertia.Iz = 9000;
  refuse(one, "one is larger than the sum of the others");
  one = cessna;
  one.cg[1] = sepcal::infinity;
  refuse(one, "cg position is not three numbers");
  one = cessna;
  one.inertia = {};
  CHECK_NOTHROW(sepcal::check_geometry(one));
  CHECK(!one.has_inertia());
}

TEST_CASE("a file of it reads back as it was written") {
  AircraftGeometry there = cessna;
  there.inertia.Ixz = -35;
  there.imu = {0.1, 0, -0.2};
  there.rate_reference = RateReference::chord_per_speed;
  const AircraftGeometry back = parse_aircraft(sepcal::to_json(there), "a.json");
  CHECK(back.inertia.Ixz == -35);
  CHECK(back.imu == there.imu);
  CHECK(back.span == 10.9);
  CHECK(back.rate_reference == RateReference::chord_per_speed);
}

TEST_CASE("a file that is none is refused in one line") {
  const std::string head = R"({"area_m2": 16.2, "chord_m": 1.49, "span_m": 10.9, )";
  const std::string whole = head + R"("mass_kg": 1000, "rate_reference": "c/2V")";
  CHECK(!parse_aircraft(whole + "}", "a.json").has_inertia());
  refuse("[]", "a.json is not an aircraft file");
  refuse(head + R"("mass_kg": 1000})", "rate_reference is missing; say \"c/V\" or \"c/2V\"");
  refuse(head + R"("rate_reference": "c/V"})", "a.json: mass_kg is missing");
  refuse(whole + R"(, "wing": 3})", "'wing' is unknown; known: area_m2, cg_m");
  refuse(whole + R"(, "imu_m": [1, 2]})", "imu_m needs 3 numbers");
  refuse(whole + R"(, "inertia_kgm2": "big"})", "inertia_kgm2 is \"big\", which is not what");
  refuse(head + R"("mass_kg": 1000, "rate_reference": "b/V"})", "no rate reference 'b/V'");
  refuse(head + R"("mass_kg": -1000, "rate_reference": "c/V"})", "mass is -1e+03 kg");
  CHECK_THROWS_WITH_AS(sepcal::read_aircraft("nowhere.json"), Contains("nowhere.json"), Error);
}

}  // namespace geometry_test
