// SPDX-License-Identifier: BSD-3-Clause
// Effects put together at run time: inputs that follow a driver, columns that vary with one.
#include "sepcal/detail/effect.hpp"

#include <doctest/doctest.h>

#include "composed_checks.hpp"
#include "sepcal/composition.hpp"

namespace effect_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using sepcal::Correction;
using sepcal::driven_inputs;
using sepcal::Effect;
using sepcal::Record;
using sepcal::Variable;
using sepcal::Varying;
using namespace sepcal::test;

namespace {

const Variable offset(sepcal::port("pressure_offset", "Pa"));
const Variable north("vn", "m/s");
const Variable east("ve", "m/s");

/// u'_c and its slopes at `xi2` for two rows of each input.
struct Evaluated {
  MatrixXd values;
  MatrixXd slopes;
};
Evaluated evaluate(const Correction& correction, const std::vector<std::vector<double>>& u,
                   const std::vector<double>& xi2) {
  std::vector<const double*> inputs;
  for (const auto& column : u) inputs.push_back(column.data());
  const auto width = static_cast<Index>(correction.inputs().size() + correction.nonlinear().size());
  Evaluated result{MatrixXd(2, correction.corrected()),
                   MatrixXd::Constant(2, correction.corrected() * width, sepcal::not_a_number)};
  const sepcal::Block block{inputs, 2, 0, true};
  correction.evaluate(block, xi2.data(), result.values, &result.slopes);
  MatrixXd alone(2, correction.corrected());
  correction.evaluate(block, xi2.data(), alone, nullptr);
  CHECK(alone == result.values);
  return result;
}

}  // namespace

TEST_CASE("a driven input's tables: targets, then the driver; coefficients, then the shape") {
  const auto correction = driven_inputs("wind[d^x]", sepcal::exponent_driver({"d", "A"}),
                                        {{"n", north, -1.0}, {"e", east, -1.0}}, "m/s per A", 7.0);
  CHECK(names_of(correction->inputs()) == std::vector<std::string>{"vn", "ve", "d"});
  CHECK(names_of(correction->nonlinear()) ==
        std::vector<std::string>{"wind[d^x].n", "wind[d^x].e", "wind[d^x].exponent"});
  CHECK(correction->corrected() == 2);
  CHECK(correction->nonlinear()[0].unit == "m/s per A");
  CHECK(correction->nonlinear()[1].lower == -7.0);
  CHECK(correction->nonlinear()[1].upper == 7.0);
  CHECK(correction->nonlinear()[2].upper == 2.0);
  CHECK_FALSE(correction->is_driver(1));
  CHECK(correction->is_driver(2));
  CHECK(correction->reach() == 0.0);
}

TEST_CASE("u' = u + sign s phi(d) and all its derivatives") {
  const auto correction = driven_inputs("wind[d]", sepcal::exponent_driver({"d", ""}),
                                        {{"n", north, -1.0}, {"e", east, 1.0}}, "m/s", 7.0);
  // phi = d^0.5 = 2 and 3, d phi / d exponent = phi log d
  const Evaluated at = evaluate(*correction, {{10, 20}, {30, 40}, {4, 9}}, {5, 0.25, 0.5});
  MatrixXd values(2, 2);
  values << 10 - 5 * 2, 30 + 0.25 * 2, 20 - 5 * 3, 40 + 0.25 * 3;
  CHECK((at.values - values).norm() < 1e-13);
  // columns: vn, ve, d, n, e, exponent, of each of the two; d is read as it was logged
  const double a = 2 * std::log(4);
  const double b = 3 * std::log(9);
  MatrixXd slopes(2, 12);
  slopes << 1, 0, 0, -2, 0, -5 * a, 0, 1, 0, 0, 2, 0.25 * a,  //
      1, 0, 0, -3, 0, -5 * b, 0, 1, 0, 0, 3, 0.25 * b;
  CHECK((at.slopes - slopes).norm() < 1e-13);
}

TEST_CASE("several functions have a coefficient each, a constant needs no column") {
  const auto bent = driven_inputs("p[spline(d,3)]", sepcal::spline_driver({"d", ""}, {0, 1, 2}),
                                  {{"s", offset}}, "Pa", 50.0);
  CHECK(names_of(bent->nonlinear()) ==
        std::vector<std::string>{"p[spline(d,3)].s_2", "p[spline(d,3)].s_3"});
  const Evaluated at = evaluate(*bent, {{100, 200}, {1, 2}}, {5, -7});
  CHECK((at.values - Eigen::Vector2d(105, 193)).norm() < 1e-12);
  MatrixXd slopes(2, 4);  // pressure_offset, d, s_2, s_3
  slopes << 1, 0, 1, 0, 1, 0, 0, 1;
  CHECK((at.slopes - slopes).norm() < 1e-14);

  const auto plain = driven_inputs("p", sepcal::constant_driver(), {{"s", offset}}, "Pa", 50.0);
  CHECK(names_of(plain->inputs()) == std::vector<std::string>{"pressure_offset"});
  CHECK(evaluate(*plain, {{1, 2}}, {10}).values == MatrixXd(Eigen::Vector2d(11, 12)));
}

TEST_CASE("a delayed driver reaches as far as its delay") {
  const Record record = five_hole_record();
  const auto correction =
      driven_inputs("p[delay(throttle)]", sepcal::delay_driver({"throttle", ""}, record, 0.2),
                    {{"s", offset}}, "Pa", 50.0);
  CHECK(correction->reach() == 0.2);
}

TEST_CASE("parameters that vary with a shaped driver, an input's share and a spline: D is right") {
  const Record record = five_hole_record();
  const sepcal::DriverPointer curve = sepcal::exponent_driver({"throttle", ""});
  Effect wind{.name = "wind[throttle^n]"};
  wind.varying.push_back({curve, {{"n", "w_n"}, {"e", "w_e"}}, "m/s"});
  Effect scale{.name = "airspeed_scale[flap]"};
  scale.varying.push_back({sepcal::power_driver({"flap", ""}, 0.2, 1), {{"s", "lambda_va"}}, "1"});
  Effect bend{.name = "airspeed_scale[spline(altitude_m,4)]"};
  bend.varying.push_back({sepcal::spline_driver({"altitude_m", "m"}, {260, 280, 300, 340}),
                          {{"s", "lambda_va"}},
                          "1"});
  Effect share{.name = "share"};
  share.varying.push_back({curve, {{"s", "", {{0, {"p", "rad/s"}}, {2, {"q", "rad/s"}}}}}, "m"});
  Effect wash{.name = "pressure_offset[decay(time)]"};
  wash.corrections.push_back(driven_inputs("pressure_offset[decay(time)]",
                                           sepcal::decay_driver({"time", "s"}, 0, 12),
                                           {{"s", offset}}, "Pa", 30.0));
  const auto model =
      sepcal::compose(sepcal::block_model(five_holes), {wind, scale, bend, share, wash}, record);
  Draws draws(421);
  const NamedValues values = draw_values(model->tables(), draws);
  check_tangent(*model, record, values);

  // A share, written out: + s phi p north, + s phi q down.
  NamedValues none = values;
  none.at("share.s") = 0.0;
  const Eigen::VectorXd added = predict(*model, record, values) - predict(*model, record, none);
  const double exponent = values.at("share.exponent");
  for (Index k = 0; k < 60; ++k) {
    const auto row = static_cast<std::size_t>(k);
    const double phi = std::pow(record.column("throttle")[row], exponent);
    const double s = values.at("share.s");
    CHECK(std::abs(added[k] - s * phi * record.column("p")[row]) < 1e-12);
    CHECK(added[60 + k] == 0.0);
    CHECK(std::abs(added[120 + k] - s * phi * record.column("q")[row]) < 1e-12);
  }
}

TEST_CASE("two shares of one input's driver in one output add up") {
  const Record record = five_hole_record();
  Effect share{.name = "share"};
  share.varying.push_back(
      {sepcal::constant_driver(), {{"s", "", {{1, {"p", "rad/s"}}, {1, {"q", "rad/s"}}}}}, "m"});
  const auto model = sepcal::compose(sepcal::block_model(five_holes), {share}, record);
  Draws draws(422);
  const auto columns = named_columns(*model, record, draw_values(model->tables(), draws));
  for (Index k = 0; k < 60; ++k) {
    const auto row = static_cast<std::size_t>(k);
    const double sum = record.column("p")[row] + record.column("q")[row];
    CHECK(columns.at("share.s")[60 + k] == Approx(sum));
  }
}

TEST_CASE("a driver is read as it was logged, whatever shifts or corrects its channel") {
  const Record record = five_hole_record();
  // q is physical, and drives; q_logged is the same channel, and drives only.
  const auto q = record.column("q");
  Record copied = with_column(record, "q_logged", {q.begin(), q.end()});
  const auto effects_of = [&](const std::string& channel) {
    const auto driver = sepcal::power_driver({channel, "rad/s"}, 0.1, 1);
    Effect scale{.name = "scale"};
    scale.varying.push_back({driver, {{"s", "lambda_va"}}, "1"});
    Effect turn{.name = "turn"};
    turn.corrections.push_back(
        driven_inputs("turn", sepcal::constant_driver(), {{"s", {"q", "rad/s"}}}, "rad/s", 0.5));
    Effect tilt{.name = "tilt"};
    tilt.corrections.push_back(driven_inputs(
        "tilt", driver, {{"s", Variable(sepcal::port("alpha_offset", "rad"))}}, "1", 0.5));
    Effect late{.name = "late"};
    late.delays.push_back({sepcal::Delay::Kind::outputs_late, {"late.tau", "s", -0.5, 0.5}, {}});
    return std::vector<Effect>{turn, scale, tilt, late};
  };
  const auto shared = sepcal::compose(sepcal::block_model(five_holes), effects_of("q"), copied);
  const auto separate =
      sepcal::compose(sepcal::block_model(five_holes), effects_of("q_logged"), copied);
  Draws draws(446);
  NamedValues values = draw_values(shared->tables(), draws);
  values["turn.s"] = 0.2;
  values["late.tau"] = 0.15;
  CHECK(largest_difference(*shared, *separate, copied, values) < 1e-14);
  check_tangent(*shared, copied, values, 1e-5);
}

}  // namespace effect_test
