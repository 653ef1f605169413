// SPDX-License-Identifier: BSD-3-Clause
// Effects by name on a model of one line: what a driver takes from the record that it first meets,
// what it keeps for the next one, and what is said of names and channels that don't do.
#include "sepcal/detail/named_effects.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "calibrated_flights.hpp"
#include "dense_reference.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/run_time_effect.hpp"
#include "small_models.hpp"

namespace named_effects_test {

using namespace sepcal;
using namespace sepcal::test;
using doctest::Approx;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Texts = std::vector<std::string>;
using Values = std::vector<double>;

namespace {

const auto line = block_model(Line{});  // z = s u + c

/// Six rows in the segments "calm" and "loop"; the first and the last are in neither.
Record make_record() {
  Record record;
  record.add("time", {0, 1, 2, 3, 5, 9});
  record.add("u", {1, 2, 3, 4, 5, 6});
  record.add("z", {0, 0, 0, 0, 0, 0});
  record.add("altitude_m", {1000, 300, 310, 320, 350, 1000});
  record.add("temp_degc", {50, 20, 21, 22, 25, 50});
  record.add("current_a", {9, 1, 2, 3, 6, 9});
  record.add("throttle", {0.5, 0.5, 0.5, 0.5, 0.5, 0.6});
  record.add("gusts_mps", {1, 2, not_a_number, 4, 5, 6});
  return record.cut({{"calm", 1, 3}, {"loop", 3, 5}});
}

struct Made {
  Effect effect;
  EffectSetting setting;
};

Made make(const EffectSetting& asked, Record record = make_record()) {
  std::vector<EffectSetting> settings{asked};
  auto effects = make_effects(plain_kit(line->tables()), *line, settings, record);
  return {effects.front(), settings.front()};
}

/// [A | b] of the line with an effect, at the nonlinear values (in the model's order).
MatrixXd rows_with(const std::string& name, const VectorXd& xi2 = {}) {
  Record record = make_record();
  std::vector<EffectSetting> settings{{.name = name}};
  const auto effects = make_effects(plain_kit(line->tables()), *line, settings, record);
  return dense_values(*compose(line, effects, record), record, xi2);
}

template <class Column>
void check_column(const Column& column, const Values& expected) {
  REQUIRE(column.size() == static_cast<Eigen::Index>(expected.size()));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(std::abs(column[static_cast<Eigen::Index>(i)] - expected[i]) < 1e-12);
  }
}

std::string unit_of(const std::string& name) {
  const Effect effect = make({.name = name}).effect;
  if (!effect.varying.empty()) return effect.varying.front().unit;
  return effect.corrections.front()->nonlinear().front().unit;
}

}  // namespace

TEST_CASE("every linear parameter and every input of a model is a port with the component s") {
  const EffectKit kit = plain_kit(line->tables());
  Texts ports;
  for (const Port& port : kit.ports) ports.push_back(port.name);
  CHECK(ports == Texts{"s", "c", "u"});
  // s + k I: its column is I u; u + k I: the model at another input.
  check_column(rows_with("s[current_a]").col(2), {1 * 2, 2 * 3, 3 * 4, 6 * 5});
  check_column(rows_with("u[current_a]", VectorXd::Constant(1, 0.5)).col(0),
               {2 + 0.5, 3 + 1.0, 4 + 1.5, 5 + 3.0});
}

TEST_CASE("altitude, time and temperature are taken about their mean over the segments") {
  for (const auto& [name, centre] : {std::pair{"c[altitude_m]", 320.0},
                                     {"c[time]", 2.75},
                                     {"c[temp_degc^2]", 22.0},
                                     {"c[current_a]", 0.0}}) {
    CAPTURE(std::string(name));
    const Made made = make({.name = name});
    CHECK(made.setting.centre.value() == Approx(centre).epsilon(1e-14));
    CHECK(made.setting.known);
  }
  check_column(rows_with("c[altitude_m]").col(2), {-20, -10, 0, 30});
  check_column(rows_with("c[temp_degc^2]").col(2), {4, 1, 0, 9});
  check_column(rows_with("c[current_a^3]").col(2), {1, 8, 27, 216});
}

TEST_CASE(
    "a channel that keeps away from zero goes about its mean where the model has a constant") {
  const auto with_voltage = [](EffectSetting setting) {
    Record record = make_record();
    record.add("voltage_v", {0, 14, 15, 15.5, 15.5, 0});
    return make(std::move(setting), record);
  };
  CHECK(with_voltage({.name = "c[voltage_v]"}).setting.centre == 0.0);
  CHECK(with_voltage({.name = "c[voltage_v]"}).setting.mean.value() == Approx(15).epsilon(1e-14));
  const double squares = (14.0 * 14 + 15 * 15 + 2 * 15.5 * 15.5) / 4;
  CHECK(with_voltage({.name = "c[voltage_v^2]"}).setting.mean.value() ==
        Approx(squares).epsilon(1e-14));
  CHECK(!make({.name = "c[current_a]"}).setting.mean);          // 1 to 6 A: no current is near
  CHECK(!with_voltage({.name = "u[voltage_v]"}).setting.mean);  // u has no constant of its own
  // A calibration of before has a centre and no mean: it keeps what it meant.
  const EffectSetting before{.name = "c[voltage_v]", .centre = 0.0, .known = true};
  CHECK(!with_voltage(before).setting.mean);
}

TEST_CASE("a spline of a channel that is far from zero is zero in the mean") {
  for (const char* name : {"c[spline(time,3)]", "c[spline(altitude_m,3)]"}) {
    CAPTURE(name);
    CHECK(make({.name = name}).setting.means.size() == 2);
    CHECK(rows_with(name).rightCols(2).colwise().mean().cwiseAbs().maxCoeff() < 1e-12);
  }
  CHECK(make({.name = "c[spline(current_a,3)]"}).setting.means.empty());
  // A calibration of before has knots and no means: it keeps what it meant.
  const Made before = make({.name = "c[spline(time,3)]", .knots = {1, 3, 5}, .known = true});
  CHECK(before.setting.means.empty());
}

TEST_CASE("a centre, knots, labels, a span and a time that are known are kept") {
  const Made power = make({.name = "c[altitude_m]", .centre = 100.0, .known = true});
  CHECK(power.setting.centre == 100.0);
  const Values knots{0, 1, 50};
  const Made spline = make({.name = "c[spline(time,3)]", .knots = knots, .known = true});
  CHECK(spline.setting.knots == knots);
  const Made labels =
      make({.name = "c[maneuver]", .labels = {"climb", "loop", "calm"}, .known = true});
  CHECK(labels.setting.labels == Texts{"climb", "loop", "calm"});
  CHECK(labels.effect.driver->suffixes() == Texts{"_loop", "_calm"});
  const Made step =
      make({.name = "c[step(time)]", .span = std::pair{-1.0, 7.0}, .t0 = 2.5, .known = true});
  CHECK(step.setting.span == std::pair{-1.0, 7.0});
  CHECK(step.setting.t0 == 2.5);
  CHECK(step.effect.driver->shape()->upper == 7.0);
}

TEST_CASE("what is not known is taken from the record's segments") {
  const Made spline = make({.name = "c[spline(altitude_m,6)]"});
  CHECK(spline.setting.knots == Values{300, 310, 320, 330, 340, 350});
  const Made labels = make({.name = "c[maneuver]"});
  CHECK(labels.setting.labels == Texts{"calm", "loop"});
  check_column(rows_with("c[maneuver]").col(2), {0, 0, 1, 1});
  const Made decay = make({.name = "c[decay(time)]"});
  CHECK(decay.setting.span == std::pair{1.0, 5.0});
}

TEST_CASE("a maneuver that the first record didn't have is taken for its first label") {
  Record record = make_record();
  record.cut({{"calm", 1, 2}, {"spin", 2, 4}, {"loop", 4, 5}});
  std::vector<EffectSetting> settings{
      {.name = "c[maneuver]", .labels = {"calm", "loop"}, .known = true}};
  const auto effects = make_effects(plain_kit(line->tables()), *line, settings, record);
  check_column(dense_values(*compose(line, effects, record), record, {}).col(2), {0, 0, 0, 1});
}

TEST_CASE("units are the port's per the channel's, as far as its header says one") {
  const auto kit_of = [](const char* unit) {
    EffectKit kit;
    kit.ports.push_back({"c", unit, {{.name = "s", .linear = "c"}}});
    return kit;
  };
  const auto unit_on = [&](const char* port_unit, const std::string& name) {
    Record record = make_record();
    std::vector<EffectSetting> settings{{.name = name}};
    return make_effects(kit_of(port_unit), *line, settings, record).front().varying.front().unit;
  };
  CHECK(unit_on("m/s", "c[altitude_m]") == "m/s per m");
  CHECK(unit_on("m/s", "c[time]") == "m/s per s");
  CHECK(unit_on("uT", "c[current_a]") == "uT per A");
  CHECK(unit_on("uT", "c[temp_degc^2]") == "uT per degC^2");
  CHECK(unit_on("uT", "c[delay(current_a)]") == "uT per A");
  CHECK(unit_on("1", "c[ramp(time)]") == "1 per s");
  CHECK(unit_on("uT", "c[current_a^n]") == "uT");
  CHECK(unit_on("uT", "c[spline(time,4)]") == "uT");
  CHECK(unit_on("uT", "c[step(time)]") == "uT");
  CHECK(unit_on("m/s", "c[maneuver]") == "m/s");
  CHECK(unit_of("u[current_a]") == "1 per A");
}

TEST_CASE("an effect on an input may amount to what its port says and no more") {
  EffectKit kit;
  kit.ports.push_back({"u", "1", {{.name = "s", .input = "u", .sign = -1.0}}, 12.0});
  Record record = make_record();
  std::vector<EffectSetting> settings{{.name = "u[current_a]"}};
  const auto effects = make_effects(kit, *line, settings, record);
  const Variable& s = effects.front().corrections.front()->nonlinear().front();
  CHECK(s.name == "u[current_a].s");
  CHECK(s.upper == Approx(12.0 / 6.0));
  CHECK(s.lower == -s.upper);
  const auto composed = compose(line, effects, record);
  check_column(dense_values(*composed, record, VectorXd::Constant(1, 0.5)).col(0),
               {2 - 0.5, 3 - 1.0, 4 - 1.5, 5 - 3.0});
}

TEST_CASE("a name or a channel that doesn't do is refused, and the way out is said") {
  const auto refused = [](const char* name, std::initializer_list<std::string_view> words) {
    CAPTURE(name);
    check_refused([&] { make({.name = name}); }, words);
  };
  refused("d[time]", {"there is no effect 'd[time]'; known: s[driver], c[driver], u[driver]"});
  refused("c", {"effect 'c' needs a driver: write c[time]"});
  refused("c[flap]", {"effect c[flap]: there is no channel 'flap'", "the record has: time, u"});
  refused("c[throttle]", {"effect c[throttle]: channel 'throttle' is constant (0.5"});
  refused("c[gusts_mps]", {"effect c[gusts_mps]: channel 'gusts_mps' holds something else"});
  refused("c[sin(time)]", {"effect 'c[sin(time)]'", "is no driver"});
  Record single = make_record();
  single.cut({{"calm", 1, 5}});
  check_refused([&] { make({.name = "c[maneuver]"}, single); }, {"fewer than two labels"});
  CHECK_NOTHROW(make({.name = "c[throttle]", .centre = 0.0, .known = true}));
}

TEST_CASE("aliases are resolved, spaces and all") {
  EffectKit kit = plain_kit(line->tables());
  kit.aliases["drift"] = [](const Record&) { return "c[time]"; };
  Record record = make_record();
  std::vector<EffectSetting> settings{{.name = " drift "}};
  const auto effects = make_effects(kit, *line, settings, record);
  CHECK(settings.front().name == "c[time]");
  CHECK(effects.front().name == "c[time]");
  settings = {{.name = "brift"}};
  check_refused([&] { make_effects(kit, *line, settings, record); }, {"'brift'", "drift"});
}

TEST_CASE("a port's total is the sum of the effects there, NaN outside the segments") {
  Record record = make_record();
  std::vector<EffectSetting> settings{
      {.name = "c[current_a]"}, {.name = "s[current_a]"}, {.name = "c[throttle^n]", .known = true}};
  const auto effects = make_effects(plain_kit(line->tables()), *line, settings, record);
  const std::map<std::string, double> values{{"c[current_a].s", 2.0},
                                             {"s[current_a].s", 100.0},
                                             {"c[throttle^n].s", 3.0},
                                             {"c[throttle^n].exponent", 2.0}};
  const VectorXd total = port_total(effects, "c", "s", values, record);
  REQUIRE(total.size() == 6);
  CHECK(std::isnan(total[0]));
  CHECK(std::isnan(total[5]));
  check_column(total.segment(1, 4), {2 + 0.75, 4 + 0.75, 6 + 0.75, 12 + 0.75});
  CHECK(port_total(effects, "u", "s", values, record).size() == 0);
  CHECK(port_total(effects, "c", "n", values, record).size() == 0);
}

TEST_CASE("a delayed driver's total is unknown where the delay reaches beyond a segment") {
  Record record = make_record();
  record.cut({{"all", 0, 6}});
  std::vector<EffectSetting> settings{{.name = "c[delay(u)]"}};
  const auto effects = make_effects(plain_kit(line->tables()), *line, settings, record);
  const auto total_at = [&](double tau) {
    return port_total(effects, "c", "s", {{"c[delay(u)].s", 1.0}, {"c[delay(u)].tau", tau}},
                      record);
  };
  CHECK(std::isnan(total_at(0.1)[0]));
  CHECK(total_at(0.1).tail(5).allFinite());
  CHECK(std::isnan(total_at(-0.1)[5]));
  CHECK(total_at(-0.1).head(5).allFinite());
  check_column(total_at(0.0), {1, 2, 3, 4, 5, 6});
}

TEST_CASE("an effect of known columns joins A, row by row of the record") {
  const Record record = make_record();
  MatrixXd column(6, 1);
  column << not_a_number, 1, -2, 3, 4, not_a_number;
  const Effect effect = column_effect("gusts", "m/s", {{"up", column}}, *line, record);
  const auto composed = compose(line, {effect}, record);
  CHECK(composed->tables().linear.back().name == "gusts.up");
  CHECK(composed->tables().linear.back().unit == "m/s");
  check_column(dense_values(*composed, record, {}).col(2), {1, -2, 3, 4});
  const auto refused = [&](const MatrixXd& wrong, std::initializer_list<std::string_view> words) {
    check_refused([&] { column_effect("gusts", "m/s", {{"up", wrong}}, *line, record); }, words);
  };
  refused(MatrixXd::Zero(5, 1), {"effect gusts, component 'up' has the shape (5, 1)", "(6, 1)"});
  refused(MatrixXd::Zero(6, 3), {"has the shape (6, 3)"});
  column(3, 0) = not_a_number;
  refused(column, {"effect gusts, component 'up' holds something else than finite numbers"});
}

}  // namespace named_effects_test
