// SPDX-License-Identifier: BSD-3-Clause
// Model + effects at run time: how tables join, what is added, what is refused.
#include "sepcal/composition.hpp"

#include <doctest/doctest.h>

#include <numeric>

#include "block_inputs.hpp"
#include "composed_checks.hpp"
#include "dense_reference.hpp"
#include "sepcal/detail/effects/air_data.hpp"
#include "sepcal/detail/run_time_effect.hpp"
#include "sepcal/error.hpp"
#include "small_models.hpp"

namespace composition_test {

using doctest::Contains;
using sepcal::block_model;
using sepcal::compose;
using sepcal::Delay;
using sepcal::Effect;
using sepcal::Error;
using sepcal::Record;
using sepcal::Varying;
using namespace sepcal::test;

namespace {

const Record record = five_hole_record();

Effect follows(const std::string& name, const sepcal::DriverPointer& driver,
               std::vector<Varying::Component> components) {
  Effect effect{.name = name};
  effect.varying.push_back({driver, std::move(components), "1"});
  return effect;
}

Effect in_time(const std::string& name, Delay::Kind kind, double longest,
               std::vector<std::string> inputs = {}) {
  Effect effect{.name = name};
  effect.delays.push_back({kind, {name + ".tau", "s", -longest, longest}, std::move(inputs)});
  return effect;
}

std::shared_ptr<const sepcal::BlockModel> compose_probe(const std::vector<Effect>& effects) {
  return compose(block_model(five_holes), effects, record);
}

void check_refused(const std::vector<Effect>& effects, const char* words) {
  CHECK_THROWS_WITH_AS(compose_probe(effects), Contains(words), Error);
}

const auto altitude = [] { return sepcal::power_driver({"altitude_m", "m"}, 300, 1); };

/// A term with two outputs.
struct Flat {
  static constexpr std::array inputs{sepcal::Quantity{"u", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"flat.s", "1"}};
  static constexpr std::array<sepcal::Quantity, 0> nonlinear{};
  template <class U, class X>
  sepcal::Vec<U, 2> columns(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 0>&) const {
    return {u[0], u[0]};
  }
};

/// z = gain u, counting samples: a model, or a term, that carries a state.
class Counting final : public sepcal::BlockModel {
 public:
  Counting() : BlockModel({{{"u", "1"}}, {{"z", "1"}}, {{"gain", "1"}}, {}}) {}

  struct Count final : sepcal::Carry {
    double samples = 0.0;
  };
  std::unique_ptr<sepcal::Carry> new_carry() const override { return std::make_unique<Count>(); }

  void evaluate(const sepcal::Block& block, const double* /*xi2*/, const double* /*xi1*/,
                sepcal::Carry* carry, Eigen::Ref<Eigen::MatrixXd> rows) const override {
    auto& count = dynamic_cast<Count&>(*carry);
    for (std::size_t k = 0; k < block.rows; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      rows(row, 0) = block.inputs[0][k];
      rows(row, rows.cols() - 1) = count.samples++;
    }
  }
};

}  // namespace

TEST_CASE("without effects the model is the model itself") {
  const auto model = block_model(five_holes);
  CHECK(compose(model, {}, record) == model);
}

TEST_CASE("the order of effects is the order of their parameters") {
  const Effect wind = follows("wind[altitude_m]", altitude(), {{"n", "w_n"}, {"e", "w_e"}});
  const Effect bend = follows("wind[throttle^x]", sepcal::exponent_driver({"throttle", ""}),
                              {{"n", "w_n"}, {"e", "w_e"}});
  const Effect arm = sepcal::effect("lever_arm", sepcal::effects::LeverArm{});
  const Effect heading = sepcal::effect("heading_bias", sepcal::effects::HeadingBias{});
  const auto added = [](const std::vector<sepcal::Variable>& table) {
    const auto names = names_of(table);
    return std::vector<std::string>(names.begin() + 5, names.end());
  };
  const auto one = compose_probe({wind, heading, bend, arm});
  CHECK(added(one->tables().linear) ==
        std::vector<std::string>{"wind[altitude_m].n", "wind[altitude_m].e", "wind[throttle^x].n",
                                 "wind[throttle^x].e", "lever_arm.x", "lever_arm.y",
                                 "lever_arm.z"});
  CHECK(added(one->tables().nonlinear) ==
        std::vector<std::string>{"heading_bias.delta", "wind[throttle^x].exponent"});
  CHECK(one->tables().nonlinear[5].lower == -0.35);
  CHECK(one->tables().nonlinear[6].upper == 2.0);
  CHECK(names_of(one->tables().outputs) == std::vector<std::string>{"vn", "ve", "vd"});

  const auto other = compose_probe({arm, bend, heading, wind});
  CHECK(added(other->tables().linear).front() == "lever_arm.x");
  CHECK(added(other->tables().nonlinear).front() == "wind[throttle^x].exponent");
  Draws draws(441);
  const NamedValues values = draw_values(one->tables(), draws);
  CHECK(largest_difference(*one, *other, record, values) < 1e-13);
  check_tangent(*one, record, values);
}

TEST_CASE("an effect in parts counts its parameters as the tables do") {
  // A term, a correction and a varying parameter under one name, twice each, interleaved.
  Effect both = follows("a", altitude(), {{"n", "w_n"}});
  both.terms = sepcal::effect("lever_arm", sepcal::effects::LeverArm{}).terms;
  both.corrections = sepcal::effect("m", sepcal::effects::MountingError{}).corrections;
  both.varying.push_back({sepcal::exponent_driver({"throttle", ""}), {{"s", "lambda_va"}}, "1"});
  Effect more = follows("b", sepcal::exponent_driver({"flap", ""}), {{"s", "b_va"}});
  more.corrections = sepcal::effect("h", sepcal::effects::HeadingBias{}).corrections;
  const auto model = compose_probe({both, more});
  Draws draws(442);
  check_tangent(*model, record, draw_values(model->tables(), draws));
}

TEST_CASE("any model of as many outputs is a term: what it predicts is added, b and all") {
  Record wave;
  Draws draws(445);
  wave.add("u", draws.uniform_column(40, 0, 3e5)).add("eta", draws.uniform_column(40, -3, 3));
  const auto own = block_model(SmallParameter{});
  const auto extra = block_model(sepcal::ScalarExample1{});
  Effect ripple{.name = "ripple"};
  ripple.terms.push_back(extra);
  const auto model = compose(own, {ripple}, wave);
  const NamedValues values{{"s", 1.5}, {"k", 6e-6}, {"a", 0.3}, {"c", -0.2}, {"b", 0.1}};
  const Eigen::VectorXd sum = predict(*own, wave, values) + predict(*extra, wave, values);
  CHECK((predict(*model, wave, values) - sum).norm() < 1e-13);
}

TEST_CASE("inputs merge by name, and keep the model's unit and absent value") {
  const sepcal::Variable bare("pressure_offset", "Pa");
  Effect wash{.name = "wash"};
  wash.corrections.push_back(sepcal::driven_inputs("wash", altitude(), {{"s", bare}}, "Pa", 10.0));
  const auto model =
      compose_probe({wash, follows("wind", altitude(), {{"n", "w_n"}}),
                     follows("p", sepcal::power_driver({"p", ""}, 0, 1), {{"n", "w_e"}})});
  const auto& inputs = model->tables().inputs;
  REQUIRE(inputs.size() == 15);
  CHECK(inputs[11].absent == 0.0);
  CHECK(inputs[14].name == "altitude_m");
  CHECK(inputs[3].unit == "rad/s");
}

TEST_CASE("a parameter's name used twice is an error that names both owners") {
  const Effect wind = follows("wind", altitude(), {{"n", "w_n"}});
  check_refused({wind, wind}, "parameter 'wind.n' belongs to effect wind and to effect wind alike");
  const Effect arm = sepcal::effect("one", sepcal::effects::LeverArm{});
  check_refused({arm, sepcal::effect("two", sepcal::effects::LeverArm{})},
                "parameter 'lever_arm.x' belongs to effect one and to effect two alike; leave one "
                "out or rename one");
  Effect shadow{.name = "shadow"};
  shadow.corrections.push_back(
      sepcal::driven_inputs("x", sepcal::constant_driver(), {{"s", {"dpa", "Pa"}}}, "Pa", 1));
  shadow.delays.push_back({Delay::Kind::outputs_late, {"eps_phi", "s", -1, 1}, {}});
  check_refused({shadow}, "parameter 'eps_phi' belongs to the model and to effect shadow alike");
}

TEST_CASE("one input in two units is an error that names both owners") {
  Effect wash{.name = "wash"};
  wash.corrections.push_back(
      sepcal::driven_inputs("wash", altitude(), {{"s", {"pressure_offset", "hPa"}}}, "hPa", 1));
  check_refused({wash},
                "input 'pressure_offset' is in Pa for the model and in hPa for effect wash");
  const Effect in_feet =
      follows("b", sepcal::power_driver({"altitude_m", "ft"}, 0, 1), {{"n", "w_n"}});
  check_refused({follows("a", altitude(), {{"n", "w_n"}}), in_feet},
                "input 'altitude_m' is in m for effect a and in ft for effect b");
}

TEST_CASE("a target, an output or an input that isn't there is an error that names the effect") {
  check_refused({follows("bias[current_a]", altitude(), {{"x", "n_x"}})},
                "effect bias[current_a] varies 'n_x', which is no linear parameter of the model");
  check_refused({follows("wind", altitude(), {{"n", "eps_phi"}})}, "varies 'eps_phi'");
  check_refused({sepcal::effect("flat", Flat{})},
                "effect flat has columns for 2 outputs, and the model has 3");
  for (const int output : {-1, 3}) {
    check_refused({follows("share", altitude(), {{"s", "", {{output, {"p", "rad/s"}}}}})},
                  "effect share has a share in output");
  }
  check_refused({in_time("late", Delay::Kind::inputs_late, 0.5, {"pt", "hx"})},
                "effect late acts on the input 'hx', which neither the model nor an effect has");
}

TEST_CASE("an input, or the outputs, can't lag twice") {
  const auto lags = [](const char* name, std::vector<std::string> inputs) {
    return in_time(name, Delay::Kind::inputs_lagging, 0.5, std::move(inputs));
  };
  check_refused({lags("a", {"pt", "ps"}), lags("b", {"dpa", "ps"})},
                "input 'ps' lags in two effects");
  CHECK_NOTHROW(compose_probe({lags("a", {"pt", "ps"}), lags("b", {"dpa"})}));
  check_refused({in_time("a", Delay::Kind::outputs_lagging, 0.1),
                 in_time("b", Delay::Kind::outputs_lagging, 0.1)},
                "the outputs lag in two effects");
}

TEST_CASE("a model that carries a state goes through with it, and takes no varying parameters") {
  Record counted;
  counted.add("u", {1, 2, 3, 4}).add("time", {0, 1, 2, 3});
  const auto counting = std::make_shared<const Counting>();
  Effect plus{.name = "plus"};
  plus.corrections.push_back(
      sepcal::driven_inputs("plus", sepcal::constant_driver(), {{"s", {"u", "1"}}}, "1", 5.0));
  const auto model = compose(counting, {plus}, counted);
  const auto carry = model->new_carry();
  REQUIRE(carry != nullptr);
  Eigen::MatrixXd rows(2, 2);
  const double s = 10.0;
  const auto inputs = block_inputs(*model, counted);
  model->evaluate({inputs.pointers, 2, 0, true}, &s, nullptr, carry.get(), rows);
  model->evaluate({inputs.pointers, 2, 0, false}, &s, nullptr, carry.get(), rows);
  CHECK(rows == (Eigen::MatrixXd(2, 2) << 11, 2, 12, 3).finished());

  const Effect follow = follows("f", sepcal::power_driver({"time", "s"}, 0, 1), {{"s", "gain"}});
  const char* const words = "a model that carries a state takes terms and corrections only";
  CHECK_THROWS_WITH_AS(compose(counting, {follow}, counted), Contains(words), Error);
  CHECK_THROWS_WITH_AS(compose(counting, {in_time("late", Delay::Kind::outputs_late, 1)}, counted),
                       Contains(words), Error);
  Effect term{.name = "counts"};
  term.terms.push_back(counting);
  CHECK_THROWS_WITH_AS(compose(block_model(Line{}), {term}, counted),
                       Contains("effect counts has a term that carries a state"), Error);
}

TEST_CASE("a composed model is differentiated by its inputs, but not by what drives an effect") {
  const Effect scale = follows("airspeed_scale[flap]", sepcal::power_driver({"flap", ""}, 0, 1),
                               {{"s", "lambda_va"}});
  const Effect arm = sepcal::effect("lever_arm", sepcal::effects::LeverArm{});
  const Effect mount = sepcal::effect("mounting_error", sepcal::effects::MountingError{});
  const Effect share =
      follows("share", sepcal::power_driver({"throttle", ""}, 0, 1), {{"s", "", {{1, {"q", ""}}}}});
  Effect wash{.name = "wash"};
  wash.corrections.push_back(
      sepcal::driven_inputs("wash", altitude(), {{"s", {"pressure_offset", "Pa"}}}, "Pa", 10.0));
  const auto model = compose_probe({scale, arm, mount, share, wash});
  Draws draws(443);
  const NamedValues values = draw_values(model->tables(), draws);
  const auto tangents = [&](const std::vector<int>& inputs) {
    return input_tangents(*model, record, in_order(model->tables().linear, values),
                          in_order(model->tables().nonlinear, values), inputs);
  };
  std::vector<int> own(14);
  std::iota(own.begin(), own.end(), 0);
  for (const int input : own) {
    CAPTURE(input);
    const InputTangents both = tangents({input});
    CHECK((both.given - both.numeric).cwiseAbs().maxCoeff() <
          1e-8 * (1.0 + both.numeric.cwiseAbs().maxCoeff()));
  }
  CHECK(tangents({5, 2, 5}).given == tangents(own).given(Eigen::all, {5, 2, 5}));
  CHECK(tangents({}).given.cols() == 0);
  const auto& names = names_of(model->tables().inputs);
  REQUIRE(names.size() == 17);
  CHECK_THROWS_WITH_AS(tangents({14}), Contains("'flap', which drives effect airspeed_scale[flap]"),
                       Error);
  CHECK_THROWS_WITH_AS(tangents({16}), Contains("'altitude_m', which drives effect wash"), Error);
  CHECK_THROWS_WITH_AS(
      input_tangents(*compose_probe({in_time("late", Delay::Kind::outputs_late, 1)}), record,
                     Eigen::VectorXd::Zero(5), Eigen::VectorXd::Zero(6), {0}),
      Contains("effect in time can't be differentiated by its inputs"), Error);
}

TEST_CASE("a composed model composes again") {
  const Effect wind = follows("wind", altitude(), {{"n", "w_n"}, {"e", "w_e"}});
  const Effect scale =
      follows("scale", sepcal::power_driver({"flap", ""}, 0, 1), {{"s", "lambda_va"}});
  const Effect heading = sepcal::effect("heading_bias", sepcal::effects::HeadingBias{});
  const auto once = compose_probe({wind, scale, heading});
  const auto twice = compose(compose_probe({wind, scale}), {heading}, record);
  Draws draws(444);
  const NamedValues values = draw_values(once->tables(), draws);
  CHECK(largest_difference(*once, *twice, record, values) < 1e-13);
}

}  // namespace composition_test
