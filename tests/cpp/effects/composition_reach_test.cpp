// SPDX-License-Identifier: BSD-3-Clause
// Where a fit with effects begins, and how far effects reach along the time axis.
#include <doctest/doctest.h>

#include "composed_checks.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/effects/air_data.hpp"
#include "sepcal/detail/run_time_effect.hpp"
#include "sepcal/error.hpp"

namespace composition_reach_test {

using doctest::Approx;
using doctest::Contains;
using sepcal::Delay;
using sepcal::Effect;
using sepcal::Error;
using sepcal::Record;
using namespace sepcal::test;

namespace {

const Record record = five_hole_record();

Effect follows(const std::string& name, const sepcal::DriverPointer& driver) {
  Effect effect{.name = name};
  effect.varying.push_back({driver, {{"n", "w_n"}}, "m/s"});
  return effect;
}

Effect in_time(const std::string& name, Delay::Kind kind, double longest) {
  Effect effect{.name = name};
  effect.delays.push_back({kind, {name + ".tau", "s", -longest, longest}, {}});
  return effect;
}

}  // namespace

TEST_CASE("a fit with effects begins where they do nothing: coefficients at zero, not shapes") {
  const auto curve = sepcal::exponent_driver({"throttle", ""});
  Effect wash{.name = "wash", .driver = curve};
  wash.corrections.push_back(sepcal::driven_inputs("wash", curve, {{"s", {"dpa", "Pa"}}}, "Pa", 1));
  Effect wind = follows("wind", curve);
  wind.driver = curve;
  const auto zeros = sepcal::initial_corrections(
      {wash, wind, in_time("late", Delay::Kind::outputs_late, 1),
       sepcal::effect("mounting_error", sepcal::effects::MountingError{})});
  CHECK(zeros == std::map<std::string, double>{{"wash.s", 0},
                                               {"late.tau", 0},
                                               {"mounting_error.pitch", 0},
                                               {"mounting_error.yaw", 0}});
}

TEST_CASE("reach: delays add up, a lag of the inputs has none, a driver's stands for itself") {
  CHECK(sepcal::reach({}) == 0.0);
  CHECK(sepcal::reach({follows("wind", sepcal::power_driver({"altitude_m", "m"}, 300, 1))}) == 0.0);
  const Effect late = in_time("late", Delay::Kind::inputs_late, 0.5);
  const Effect late_outputs = in_time("offset", Delay::Kind::outputs_late, 0.25);
  const Effect lagging = in_time("lagging", Delay::Kind::inputs_lagging, 0.5);
  const Effect lag = in_time("lag", Delay::Kind::outputs_lagging, 0.2);
  CHECK(sepcal::reach({late}) == 0.5);
  CHECK(sepcal::reach({late, late_outputs}) == 0.75);
  CHECK(sepcal::reach({lagging}) == 0.0);
  CHECK(sepcal::reach({lag}) == Approx(0.2 * 7.0459054));  // the fifth root of L_8
  const auto delayed = sepcal::delay_driver({"throttle", ""}, record, 0.2);
  const Effect varying = follows("wind[delay(throttle)]", delayed);
  Effect driven{.name = "p"};
  driven.corrections.push_back(
      sepcal::driven_inputs("p", delayed, {{"s", {"dpa", "Pa"}}}, "Pa", 1.0));
  for (const Effect& effect : {varying, driven}) {
    CHECK(sepcal::reach({effect}) == 0.2);
    CHECK(sepcal::reach({effect, late_outputs}) == 0.25);
    CHECK(sepcal::reach({late_outputs, effect}) == 0.25);
    CHECK(sepcal::reach({effect, effect}) == 0.2);
  }
  // Bounds given instead of a parameter's own.
  CHECK(sepcal::reach({late, late_outputs}, {{"late.tau", {-0.1, 0.3}}}) == 0.55);
  CHECK(sepcal::reach({late}, {{"late.tau", {-0.9, 0.3}}}) == 0.9);
  CHECK(sepcal::reach({varying}, {{"wind[delay(throttle)].tau", {-1, 1.5}}}) == 1.5);
  CHECK(sepcal::reach({driven}, {{"p.tau", {-0.1, 0.1}}}) == 0.1);
  CHECK_THROWS_WITH_AS(sepcal::reach({late}, {{"late.tau", {0, sepcal::infinity}}}),
                       Contains("bounds of 'late.tau' must be finite"), Error);
}

TEST_CASE("without_edges drops the rows nearer than the margin to an edge of their segment") {
  Record ten;
  std::vector<double> time{0, 1, 2, 3, 4, 5, 5.5, 6, 7, 8, 100, 101};
  ten.add("time", time).cut({{"long", 0, 6}, {"short", 6, 9}, {"far", 9, 12}});
  const auto kept = [&](double margin) {
    std::vector<std::string> text;
    const Record inner = without_edges(ten, margin);
    for (const auto& segment : inner.segments()) {
      text.push_back(segment.label + " " + std::to_string(segment.first) + ":" +
                     std::to_string(segment.last));
    }
    return text;
  };
  CHECK(kept(0.0) == std::vector<std::string>{"long 0:6", "short 6:9", "far 9:12"});
  // A row just at the margin stays.
  CHECK(kept(0.5) == std::vector<std::string>{"long 1:5", "short 7:8", "far 10:11"});
  CHECK(kept(1.0) == std::vector<std::string>{"long 1:5", "far 10:11"});
  CHECK(kept(1.5) == std::vector<std::string>{"long 2:4"});
  CHECK_THROWS_WITH_AS(kept(50), Contains("no segment is longer than twice 50"), Error);
  CHECK(ten.rows() == 12);
}

}  // namespace composition_reach_test
