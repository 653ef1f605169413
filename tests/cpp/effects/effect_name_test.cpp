// SPDX-License-Identifier: BSD-3-Clause
// The grammar of effects' names: every form, and what is said of a text that is none.
#include "sepcal/effect_name.hpp"

#include <doctest/doctest.h>

#include <initializer_list>
#include <string>

#include "sepcal/error.hpp"

namespace effect_name_test {

using sepcal::EffectName;
using sepcal::parse_effect_name;
using sepcal::split_effects;
using Names = std::vector<std::string>;
using Shape = sepcal::EffectName::Shape;

namespace {

void check_name(std::string_view text, const EffectName& expected) {
  CAPTURE(text);
  const EffectName name = parse_effect_name(text);
  CHECK(name.text == expected.text);
  CHECK(name.port == expected.port);
  CHECK(name.base == expected.base);
  CHECK(name.shape == expected.shape);
  CHECK(name.number == expected.number);
}

template <class Act>
void check_refusal(const Act& act, std::initializer_list<std::string_view> words) {
  try {
    act();
    FAIL_CHECK("nothing was thrown");
  } catch (const sepcal::Error& error) {
    const std::string what = error.what();
    CAPTURE(what);
    CHECK(what.find('\n') == std::string::npos);
    for (const std::string_view word : words) {
      CAPTURE(word);
      CHECK(what.find(word) != std::string::npos);
    }
  }
}

/// The refusal names the text and has all `words`.
void check_no_name(std::string_view text, std::initializer_list<std::string_view> words) {
  CAPTURE(text);
  check_refusal([&] { parse_effect_name(text); }, words);
  check_refusal([&] { parse_effect_name(text); }, {"effect '", text});
}

}  // namespace

TEST_CASE("an effect without a driver is a name alone") {
  check_name("heading_bias", {"heading_bias", "heading_bias", "", Shape::none, 1});
}

TEST_CASE("a port and a channel, to a power from 1 to 9 or to a fitted one") {
  check_name("wind[altitude_m]", {"wind[altitude_m]", "wind", "altitude_m", Shape::power, 1});
  check_name("wind[time]", {"wind[time]", "wind", "time", Shape::power, 1});
  check_name("wind[time^1]", {"wind[time^1]", "wind", "time", Shape::power, 1});
  check_name("airspeed_scale[alpha^2]",
             {"airspeed_scale[alpha^2]", "airspeed_scale", "alpha", Shape::power, 2});
  check_name("bias[i^9]", {"bias[i^9]", "bias", "i", Shape::power, 9});
  check_name("bias[throttle^n]", {"bias[throttle^n]", "bias", "throttle", Shape::exponent, 1});
  check_name("wind[maneuver]", {"wind[maneuver]", "wind", "maneuver", Shape::power, 1});
}

TEST_CASE("functions of a channel, and of time alone") {
  check_name("wind[spline(altitude_m,12)]",
             {"wind[spline(altitude_m,12)]", "wind", "altitude_m", Shape::spline, 12});
  check_name("bias[spline(time,3)]", {"bias[spline(time,3)]", "bias", "time", Shape::spline, 3});
  check_name("bias[spline(time,1000)]",
             {"bias[spline(time,1000)]", "bias", "time", Shape::spline, 1000});
  check_name("bias[step(time)]", {"bias[step(time)]", "bias", "time", Shape::step, 1});
  check_name("scale[ramp(time)]", {"scale[ramp(time)]", "scale", "time", Shape::ramp, 1});
  check_name("bias[decay(time)]", {"bias[decay(time)]", "bias", "time", Shape::decay, 1});
  check_name("bias[delay(current_a)]",
             {"bias[delay(current_a)]", "bias", "current_a", Shape::delay, 1});
}

TEST_CASE("spaces and tabs don't matter, capitals and signs in a header stay") {
  check_name(" wind [ spline( altitude_m ,\t6 ) ] ",
             {"wind[spline(altitude_m,6)]", "wind", "altitude_m", Shape::spline, 6});
  check_name("bias[Bus-1.V]", {"bias[Bus-1.V]", "bias", "Bus-1.V", Shape::power, 1});
  check_name("bias[a^b^2]", {"bias[a^b^2]", "bias", "a^b", Shape::power, 2});
}

TEST_CASE("a header with brackets of its own is a channel like any other") {
  check_name("bias[flow (l/s)_x]", {"bias[flow(l/s)_x]", "bias", "flow(l/s)_x", Shape::power, 1});
  check_name("bias[(a)]", {"bias[(a)]", "bias", "(a)", Shape::power, 1});
}

TEST_CASE("a text without a name or with loose brackets is refused with the form") {
  check_no_name("", {"a name is missing", "write port[driver], e.g. wind[time]"});
  check_no_name("[time]", {"a name is missing", "write port[driver]"});
  for (const char* text : {"wind[", "wind[]", "wind[time", "wind[time]x", "wind[time]]]x"}) {
    check_no_name(text, {"write port[driver], e.g. wind[altitude_m]"});
  }
  for (const char* text : {"wind]", "wind(time)", "spline)"}) {
    check_no_name(text, {"write port[driver], e.g. wind[spline(time,6)]"});
  }
}

TEST_CASE("a power that is none is refused with its limits") {
  for (const char* power : {"0", "10", "-1", "1.5", "", "m", "99999999999"}) {
    check_no_name(std::string("wind[time^") + power + "]",
                  {std::string("the power '") + power + "'", "whole number from 1 to 9",
                   "n for a fitted exponent"});
  }
}

TEST_CASE("a function that is none is refused with those that there are") {
  for (const char* driver : {"sin(time)", "Spline(time,6)", "spline2(time,6)"}) {
    check_no_name(
        std::string("wind[") + driver + "]",
        {driver,
         "is no driver; known: x, x^2, x^n, x*y, abs(x), spline(x,k), levels(x,a,b), step(time), "
         "ramp(time), decay(time), delay(x)"});
  }
}

TEST_CASE("a spline needs a number of knots from 3 to 1000") {
  for (const char* driver : {"spline(time)", "spline(time,)", "spline(time,2)", "spline(time,1001)",
                             "spline(time,6.0)", "spline(time,-6)", "spline(time,six)"}) {
    check_no_name(std::string("wind[") + driver + "]",
                  {"write a spline as spline(x,k) with k knots, 3 to 1000"});
  }
}

TEST_CASE("levels are told by thresholds that rise") {
  const EffectName one = parse_effect_name("wind[levels(altitude_m, 1300)]");
  CHECK(one.text == "wind[levels(altitude_m,1300)]");
  CHECK(one.base == "altitude_m");
  CHECK(one.shape == Shape::levels);
  CHECK(one.thresholds == std::vector<double>{1300.0});
  const EffectName two = parse_effect_name("pressure_offset[levels(temp_degc,-2.5,3e1)]");
  CHECK(two.thresholds == std::vector<double>{-2.5, 30.0});
  CHECK(driver_channels(two) == std::vector<std::string>{"temp_degc"});
  for (const char* driver :
       {"levels(time)", "levels(time,)", "levels(time,2,1)", "levels(time,1,1)", "levels(time,one)",
        "levels(time,1,)", "levels(time,nan)", "levels(time,inf)"}) {
    check_no_name(std::string("wind[") + driver + "]",
                  {"write levels as levels(x,a,b) with thresholds that rise"});
  }
}

TEST_CASE("steps, ramps and decays take time, and the refusal says how to write them") {
  check_no_name("bias[step(altitude_m)]", {"step takes time: write step(time)"});
  check_no_name("bias[ramp()]", {"ramp takes time: write ramp(time)"});
  check_no_name("bias[decay(t)]", {"decay takes time: write decay(time)"});
}

TEST_CASE("a driver without a channel is refused, and so is arithmetic on a label") {
  for (const char* text : {"wind[^2]", "wind[delay()]", "wind[spline(,6)]", "wind[levels(,6)]"}) {
    check_no_name(text, {"the driver names no channel"});
  }
  for (const char* text : {"wind[maneuver^2]", "wind[maneuver^n]", "wind[spline(maneuver,6)]",
                           "wind[levels(maneuver,1)]", "wind[delay(maneuver)]"}) {
    check_no_name(text, {"maneuver is a label, not a number; write port[maneuver]"});
  }
}

TEST_CASE("a list is joined by '+'; one within brackets belongs to a name") {
  CHECK(split_effects("wind[time]") == Names{"wind[time]"});
  CHECK(split_effects(" wind[time] + heading_bias+lever_arm ") ==
        Names{"wind[time]", "heading_bias", "lever_arm"});
  CHECK(split_effects("bias[a+b]+bias[spline(c+d,4)]") ==
        Names{"bias[a+b]", "bias[spline(c+d,4)]"});
  for (const char* text : {"", " ", "+", "wind[time]+", "+wind[time]", "a++b"}) {
    CAPTURE(text);
    check_refusal([&] { split_effects(text); },
                  {"effect '" + std::string(text) + "'", "a name is missing beside '+'"});
  }
}

TEST_CASE("a channel that port[channel] names, and those that it doesn't") {
  for (const char* channel : {"throttle", "thr%", "thr-1", "a+b", "Battery_I"}) {
    CHECK(sepcal::can_name(channel));
    CHECK(parse_effect_name("wind[" + std::string(channel) + "]").base == channel);
  }
  for (const char* channel : {"", "Throttle [%]", "thr pct", "temp^2", "thr(A)", "a]b"}) {
    CHECK_FALSE(sepcal::can_name(channel));
  }
}

}  // namespace effect_name_test
