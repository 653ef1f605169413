// SPDX-License-Identifier: BSD-3-Clause
// model + effects at compile time: the joined tables, and the same rows as at run time, each effect
// alone and several together in both orders.
#include "sepcal/static_composition.hpp"

#include "sepcal/detail/run_time_effect.hpp"

#include <doctest/doctest.h>

#include "composed_checks.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/effects/air_data.hpp"
#include "sepcal/detail/effects/magnetic.hpp"

namespace static_composition_test {

using sepcal::block_model;
using sepcal::Effect;
using sepcal::FiveHoleProbe;
using sepcal::Magnetometer;
using sepcal::Record;
using sepcal::Variable;
using namespace sepcal::effects;
using namespace sepcal::test;

namespace {

/// + s h exp(-k |h|^2 / F^2), F = 50 uT: a term with a nonlinear parameter.
struct Fading {
  static constexpr std::array inputs = true_field;
  static constexpr std::array linear{sepcal::Quantity{"fading.s", "1"}};
  static constexpr std::array nonlinear{sepcal::Quantity{"fading.k", "1", 0, 2}};

  template <class U, class X>
  sepcal::Vec<X, 3> columns(const sepcal::Vec<U, 3>& h, const sepcal::Vec<X, 1>& xi2) const {
    using std::exp;
    const X share = exp(-xi2[0] * ((h[0] * h[0] + 2.0 * h[1] * h[1] + h[2] * h[2]) / 2500.0));
    return h.template cast<X>() * share;
  }
};

/// One effect, both ways.
template <class Static>
struct Twin {
  Static at_compile_time;
  Effect at_run_time;
};
template <class Static>
Twin(Static, Effect) -> Twin<Static>;

Effect varying(const std::string& name, const Variable& driver, double centre, int power,
               std::vector<sepcal::Varying::Component> components, const std::string& unit) {
  Effect effect{.name = name};
  effect.varying.push_back(
      {sepcal::power_driver(driver, centre, power), std::move(components), unit});
  return effect;
}

Effect driven(const std::string& name, const Variable& driver, double centre, int power,
              const std::string& port, const std::string& unit) {
  Effect effect{.name = name};
  effect.corrections.push_back(
      sepcal::driven_inputs(name, sepcal::power_driver(driver, centre, power),
                            {{"s", Variable(sepcal::port(port, unit))}}, unit, 30.0));
  return effect;
}

// Five-hole.
const Twin wind{Wind<"altitude_m">{300}, varying("wind[altitude_m]", {"altitude_m", ""}, 300, 1,
                                                 {{"n", "w_n"}, {"e", "w_e"}}, "m/s")};
const Twin airspeed_scale{
    AirspeedScale<"flap", 2>{0.1},
    varying("airspeed_scale[flap^2]", {"flap", ""}, 0.1, 2, {{"s", "lambda_va"}}, "1")};
const Twin airspeed_bias{
    AirspeedBias<"throttle">{},
    varying("airspeed_bias[throttle]", {"throttle", ""}, 0, 1, {{"s", "b_va"}}, "m/s")};
const Twin pressure_offset{
    PressureOffset<"throttle", 3>{0.2},
    driven("pressure_offset[throttle^3]", {"throttle", ""}, 0.2, 3, "pressure_offset", "Pa")};
const Twin pressure_zero{
    PressureZero{}, [] {
      Effect effect{.name = "pressure_offset"};
      effect.corrections.push_back(sepcal::driven_inputs(
          "pressure_offset", sepcal::constant_driver(),
          {{"s", Variable(sepcal::port("pressure_offset", "Pa"))}}, "Pa", 30.0));
      return effect;
    }()};
const Twin alpha_offset{AlphaOffset<"flap">{},
                        driven("alpha_offset[flap]", {"flap", ""}, 0, 1, "alpha_offset", "rad")};
const Twin beta_offset{BetaOffset<"q">{},
                       driven("beta_offset[q]", {"q", ""}, 0, 1, "beta_offset", "rad")};
const Twin heading_bias{HeadingBias{}, sepcal::effect("heading_bias", HeadingBias{})};
const Twin lever_arm{LeverArm{}, sepcal::effect("lever_arm", LeverArm{})};
const Twin mounting_error{MountingError{}, sepcal::effect("mounting_error", MountingError{})};

// Magnetometer.
const Twin bias{Bias<"current_a">{5}, varying("bias[current_a]", {"current_a", ""}, 5, 1,
                                              {{"x", "n_x"}, {"y", "n_y"}, {"z", "n_z"}}, "uT")};
const Twin scale{
    Scale<"temp_degc", 2>{20},
    varying("scale[temp_degc^2]", {"temp_degc", ""}, 20, 2,
            {{"s", "", {{0, {"hx", "uT"}}, {1, {"hy", "uT"}}, {2, {"hz", "uT"}}}}}, "1")};
const Twin axis_scale{AxisScale<"temp_degc">{20},
                      varying("axis_scale[temp_degc]", {"temp_degc", ""}, 20, 1,
                              {{"x", "", {{0, {"hx", "uT"}}}},
                               {"y", "", {{1, {"hy", "uT"}}}},
                               {"z", "", {{2, {"hz", "uT"}}}}},
                              "1")};
const Twin cubic{CubicNonlinearity{}, sepcal::effect("cubic_nonlinearity", CubicNonlinearity{})};
const Twin eddy{EddyCurrents{}, sepcal::effect("eddy_currents", EddyCurrents{})};
const Twin declination{FieldDeclination{}, sepcal::effect("field_declination", FieldDeclination{})};
const Twin attitude_bias{AttitudeBias{}, sepcal::effect("attitude_bias", AttitudeBias{})};

const Twin fading{Fading{}, sepcal::effect("fading", Fading{})};

template <class Model, class... Effects>
void check_same(const Model& model, const Record& record, const Effects&... effects) {
  const auto at_compile_time = block_model((model + ... + effects.at_compile_time));
  const auto at_run_time = sepcal::compose(block_model(model), {effects.at_run_time...}, record);
  Draws draws(431);
  const NamedValues values = draw_values(at_run_time->tables(), draws);
  CHECK(largest_difference(*at_compile_time, *at_run_time, record, values) < 1e-13);
}

/// Both orders, both ways, and the orders against each other.
template <class Model, class A, class B>
void check_pair(const Model& model, const Record& record, const A& a, const B& b) {
  check_same(model, record, a, b);
  check_same(model, record, b, a);
  const auto one = block_model(model + a.at_compile_time + b.at_compile_time);
  const auto other = block_model(model + b.at_compile_time + a.at_compile_time);
  Draws draws(432);
  const NamedValues values = draw_values(one->tables(), draws);
  CHECK(largest_difference(*one, *other, record, values) < 1e-13);
  check_tangent(*one, record, values);
}

}  // namespace

TEST_CASE("the tables are joined: the model's first, inputs once each, corrections' outermost") {
  const auto tables =
      sepcal::tables_of<decltype(five_holes + PressureOffset<"throttle">{} + Wind<"altitude_m">{} +
                                 LeverArm{} + HeadingBias{})>();
  CHECK(tables.n_u() == 16);  // 14, altitude_m and throttle
  CHECK(tables.n_z() == 3);
  const auto linear = names_of(tables.linear);
  CHECK(std::vector<std::string>(linear.begin() + 5, linear.end()) ==
        std::vector<std::string>{"wind[altitude_m].n", "wind[altitude_m].e", "lever_arm.x",
                                 "lever_arm.y", "lever_arm.z"});
  const auto nonlinear = names_of(tables.nonlinear);
  CHECK(std::vector<std::string>(nonlinear.begin() + 5, nonlinear.end()) ==
        std::vector<std::string>{"heading_bias.delta", "pressure_offset[throttle].s"});
  CHECK(tables.nonlinear[5].upper == 0.35);
  CHECK(tables.inputs[11].absent == 0.0);
}

TEST_CASE("five-hole: pairs in both orders, of terms, of corrections and of one each") {
  const Record record = five_hole_record();
  check_pair(five_holes, record, wind, airspeed_scale);
  check_pair(five_holes, record, pressure_offset, heading_bias);
  check_pair(five_holes, record, pressure_zero, pressure_offset);
  check_pair(five_holes, record, lever_arm, heading_bias);  // the term sees the corrected yaw
}

TEST_CASE("magnetometer: pairs in both orders") {
  const Record record = magnetometer_record();
  const Magnetometer model;
  check_pair(model, record, scale, declination);   // the share follows the corrected field
  check_pair(model, record, fading, declination);  // a nonlinear parameter on either side
}

TEST_CASE("corrections of the same inputs act in the order in which they are named") {
  const Record record = magnetometer_record();
  const Magnetometer model;
  check_same(model, record, declination, attitude_bias);
  check_same(model, record, attitude_bias, declination);
  const auto one = block_model(model + FieldDeclination{} + AttitudeBias{});
  const auto other = block_model(model + AttitudeBias{} + FieldDeclination{});
  Draws draws(433);
  const NamedValues values = draw_values(one->tables(), draws);
  check_tangent(*one, record, values);
  const double apart = largest_difference(*one, *other, record, values);
  CHECK(apart > 1e-6);  // two turns about different axes
}

// Every effect of the catalogue that exists at compile time. Types this deep take a compiler long.
TEST_CASE("everything at once is the same at compile time and at run time") {
  const Record flight = five_hole_record();
  check_same(five_holes, flight, wind, airspeed_scale, pressure_offset, alpha_offset, heading_bias,
             lever_arm, mounting_error, airspeed_bias, beta_offset);
  const Record turns = magnetometer_record();
  check_same(Magnetometer{}, turns, bias, scale, declination, cubic, attitude_bias, eddy,
             axis_scale);
}

TEST_CASE("a composed model can be used in constant expressions' places: it owns no data") {
  constexpr auto model = Magnetometer{} + Bias<"current_a">{5.0} + AttitudeBias{};
  static_assert(sepcal::SeparableModel<decltype(model)>);
  static_assert(sepcal::Sizes<decltype(model)>::n_1 == 9);
  static_assert(sepcal::Sizes<decltype(model)>::n_2 == 8);
  CHECK(model.effect.nonlinear.size() == 2);
  CHECK(model.model.effect.centre == 5.0);
}

TEST_CASE("composed models are differentiated by their inputs too, drivers among them") {
  const Record record = five_hole_record();
  const auto model = block_model(five_holes + Wind<"altitude_m">{300} +
                                 PressureOffset<"throttle">{} + HeadingBias{} + LeverArm{});
  Draws draws(434);
  check_input_tangent(*model, record, draw_values(model->tables(), draws));
}

}  // namespace static_composition_test
