// SPDX-License-Identifier: BSD-3-Clause
// Effects on trajectories: the model with an effect against the same flight integrated with the
// inputs changed by hand, its derivatives against differences of whole trajectories, the path
// tangent against both, and a filter's steps against differences of steps.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "dense_reference.hpp"
#include "flight_paths.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/detail/path_model.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/models/short_period.hpp"
#include "short_periods.hpp"
#include "trajectories.hpp"

namespace path_tangent_test {

namespace {

using doctest::Approx;
using doctest::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::BlockModel;
using sepcal::compose;
using sepcal::Delay;
using sepcal::DriverPointer;
using sepcal::Effect;
using sepcal::Error;
using sepcal::FlightPath;
using sepcal::Record;
using sepcal::ShortPeriod;
using sepcal::StateBlockModel;
using sepcal::TrajectoryModel;
using sepcal::Variable;

constexpr std::size_t rows = 160;
constexpr double interval = 0.05;  // s

/// Two segments, a temperature that rises and swings.
Record flown() {
  Record record = sepcal::test::write_flight({}, rows, interval, {{"b_q", 0.002}}, 1.0);
  std::vector<double> temperature(rows);
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = interval * static_cast<double>(k);
    temperature[k] = 20.0 + 1.5 * t + 2.0 * std::sin(0.9 * t);
  }
  record.add("temp", std::move(temperature));
  return record.cut({{"one", 0, 90}, {"two", 90, rows}});
}

Variable temperature() { return {"temp", "degC"}; }

Effect on_inputs(const std::string& name, const DriverPointer& driver,
                 const std::vector<sepcal::DrivenInput>& components) {
  Effect effect{.name = name, .driver = driver};
  effect.corrections.push_back(sepcal::driven_inputs(name, driver, components, "1", 5.0));
  return effect;
}

Effect on_parameter(const std::string& name, const DriverPointer& driver,
                    const std::string& target) {
  Effect effect{.name = name, .driver = driver};
  effect.varying.push_back({driver, {{"s", target}}, "1"});
  return effect;
}

Effect late(const std::vector<std::string>& inputs) {
  Effect effect{.name = "imu_late"};
  effect.delays.push_back({Delay::Kind::inputs_late, {"imu_late.tau", "s", -0.5, 0.5}, inputs});
  return effect;
}

const std::vector<std::string> imu{"ax", "ay", "az", "p", "q", "r"};

std::vector<Effect> effects() {
  const DriverPointer by_temperature = sepcal::power_driver(temperature(), 25.0, 1);
  return {on_inputs("gyro_bias", by_temperature, {{"q", {"q", "rad/s"}}, {"r", {"r", "rad/s"}}}),
          on_inputs("accel_scale", sepcal::constant_driver(),
                    {{"x", {"ax", "m/s^2"}, 1.0, Variable("ax", "m/s^2")},
                     {"xz", {"ax", "m/s^2"}, 1.0, Variable("az", "m/s^2")}}),
          on_inputs("wind", sepcal::power_driver({"time", "s"}, 3.0, 2),
                    {{"n", {"wind_change_n", "m/s"}}, {"d", {"wind_change_d", "m/s"}}}),
          on_inputs("delays", sepcal::constant_driver(),
                    {{"air", {"airdata_delay", "s"}},
                     {"alpha", {"alpha_delay", "s"}},
                     {"attitude", {"attitude_delay", "s"}},
                     {"velocity", {"velocity_delay", "s"}}}),
          on_parameter("airspeed_scale", by_temperature, "lambda_v"),
          late(imu)};
}

/// xi of a model by name, the effects' as given, the path's near the truth.
struct Point {
  VectorXd xi1;
  VectorXd xi2;
  VectorXd all() const {
    VectorXd xi(xi1.size() + xi2.size());
    xi << xi1, xi2;
    return xi;
  }
};

Point point_of(const BlockModel& model, const Record& record,
               const std::map<std::string, double>& given) {
  std::map<std::string, double> values = model.starting_values(record);
  values.insert({"lambda_alpha", 0.03});
  values.insert({"w_n", 2.0});
  values.insert({"b_ax", 0.02});
  for (const auto& [name, value] : given) values[name] = value;
  const auto in_order = [&](const std::vector<Variable>& table) {
    VectorXd ordered = VectorXd::Zero(static_cast<Index>(table.size()));
    for (std::size_t i = 0; i < table.size(); ++i) {
      const auto at = values.find(table[i].name);
      if (at != values.end()) ordered[static_cast<Index>(i)] = at->second;
    }
    return ordered;
  };
  return {in_order(model.tables().linear), in_order(model.tables().nonlinear)};
}

const std::map<std::string, double> sizes{
    {"gyro_bias.q", 3e-4},       {"gyro_bias.r", -2e-4},    {"accel_scale.x", 0.02},
    {"accel_scale.xz", -0.01},   {"wind.n", 0.05},          {"wind.d", -0.02},
    {"airspeed_scale.s", 0.004}, {"imu_late.tau", 0.03},    {"delays.air", 0.02},
    {"delays.alpha", -0.01},     {"delays.attitude", 0.03}, {"delays.velocity", 0.015}};

std::shared_ptr<const StateBlockModel> path_of(const Record& record) {
  return std::make_shared<const TrajectoryModel<FlightPath>>(FlightPath{}, record);
}

double relative(const MatrixXd& a, const MatrixXd& b) {
  double worst = 0.0;
  for (Index k = 0; k < a.cols(); ++k) {
    const double scale = std::max(b.col(k).cwiseAbs().maxCoeff(), 1e-12);
    worst = std::max(worst, (a.col(k) - b.col(k)).cwiseAbs().maxCoeff() / scale);
  }
  return worst;
}

}  // namespace

TEST_CASE("a path with effects is the path of inputs that were changed by hand") {
  const Record record = flown();
  const auto path = path_of(record);
  const auto with = compose(path, {effects()[0], effects()[1], effects()[4]}, record);
  const Point point = point_of(*with, record, sizes);
  Record changed;
  for (const std::string& name : record.names()) {
    std::vector<double> values(record.column(name).begin(), record.column(name).end());
    for (std::size_t k = 0; k < rows; ++k) {
      const double warmer = record.column("temp")[k] - 25.0;
      if (name == "q") values[k] += 3e-4 * warmer;
      if (name == "r") values[k] -= 2e-4 * warmer;
      if (name == "ax") values[k] += 0.02 * record.column("ax")[k] - 0.01 * record.column("az")[k];
    }
    changed.add(name, std::move(values));
  }
  changed.cut(record.segments());
  const Point plain = point_of(*path, record, {});
  const VectorXd expected = sepcal::test::dense_prediction(*path, changed, plain.xi1, plain.xi2);
  VectorXd found = sepcal::test::dense_prediction(*with, record, point.xi1, point.xi2);
  // airspeed, the first output, by the share of its own
  for (std::size_t k = 0; k < rows; ++k) {
    const double scale = 1.0 + 0.004 * (record.column("temp")[k] - 25.0);
    CHECK(found[static_cast<Index>(k)] ==
          Approx(scale * expected[static_cast<Index>(k)]).epsilon(1e-12));
  }
  const Index others = found.size() - static_cast<Index>(rows);
  CHECK((found.tail(others) - expected.tail(others)).cwiseAbs().maxCoeff() < 1e-11);
}

TEST_CASE("its tangent is that of whole trajectories") {
  const Record record = flown();
  const auto with = compose(path_of(record), effects(), record);
  const Point point = point_of(*with, record, sizes);
  const Index parameters = point.xi1.size() + point.xi2.size();
  const MatrixXd numeric = sepcal::test::dense_rows(*with, record, point.xi1, point.xi2);
  const MatrixXd given = sepcal::test::rows_of(*with, record, point.xi2, &point.xi1);
  CHECK(relative(given.leftCols(parameters), numeric.leftCols(parameters)) < 1e-6);
}

TEST_CASE("the path tangent is what a small effect of any kind does") {
  const Record record = flown();
  const auto path = path_of(record);
  for (const std::vector<Effect>& own :
       {std::vector<Effect>{}, std::vector<Effect>{effects()[0], effects()[4]}}) {
    const auto fitted = compose(path, own, record);
    const auto* along = dynamic_cast<const sepcal::PathModel*>(fitted.get());
    REQUIRE(along != nullptr);
    const Point at = point_of(*fitted, record, sizes);
    const auto tangent = along->path_tangent(record, at.all(), {});
    for (const Effect& effect : effects()) {
      if (effect.corrections.empty() && effect.delays.empty()) continue;
      bool has = false;
      for (const Effect& one : own) has = has || one.name == effect.name;
      if (has) continue;
      CAPTURE(effect.name);
      std::vector<Effect> all = own;
      all.push_back(effect);
      const auto with = compose(path, all, record);
      std::map<std::string, double> without = sizes;
      for (auto& [name, size] : without) {
        if (name.starts_with(effect.name)) size = 0.0;
      }
      const Point point = point_of(*with, record, without);
      const Index own_2 = fitted->tables().n_2();
      const Index more = with->tables().n_2() - own_2;
      auto inputs = dynamic_cast<const sepcal::PathModel&>(*with).input_slopes(record, point.xi2);
      for (auto& moved : inputs) moved.slopes = moved.slopes.rightCols(more).eval();
      const MatrixXd columns = tangent->columns({.inputs = inputs});
      std::vector<Index> places;
      for (Index k = 0; k < more; ++k) places.push_back(with->tables().n_1() + own_2 + k);
      const MatrixXd by_steps =
          tangent->columns(tangent->change(*with, record, point.all(), places));
      CHECK(relative(by_steps, columns) < 1e-8);
      const MatrixXd numeric = sepcal::test::dense_rows(*with, record, point.xi1, point.xi2)
                                   .middleCols(with->tables().n_1() + own_2, more);
      CHECK(relative(columns, numeric) < 1e-6);
    }
  }
}

TEST_CASE("the likelihood's score knows effects") {
  const Record record = flown();
  const auto with = compose(path_of(record), effects(), record);
  const Point point = point_of(*with, record, sizes);
  const auto likelihood = with->innovations(record);
  VectorXd theta(likelihood->size());
  theta << point.all(), VectorXd::Constant(3, std::log(0.02)),
      VectorXd::Constant(3, std::log(0.001)), VectorXd::Constant(9, std::log(0.1));
  VectorXd gradient = VectorXd::Zero(theta.size());
  likelihood->scores(theta, [&](std::size_t, MatrixXd& scores) {
    gradient -= scores.leftCols(theta.size()).transpose() * scores.rightCols<1>();
  });
  const auto& tables = with->tables();
  std::vector<std::string> names;
  for (const Variable& parameter : tables.parameters()) names.push_back(parameter.name);
  for (const auto& [name, size] : sizes) {
    CAPTURE(name);
    const Index k = std::ranges::find(names, name) - names.begin();
    const double h = 1e-3 * std::abs(size);
    const auto cost = [&](double by) {
      VectorXd there = theta;
      there[k] += by;
      return likelihood->value(there).cost;
    };
    const double numeric =
        (8.0 * (cost(h) - cost(-h)) - (cost(2.0 * h) - cost(-2.0 * h))) / (12.0 * h);
    CHECK(gradient[k] == Approx(numeric).epsilon(1e-5));
  }
}

TEST_CASE("a filter's path tangent is what its score has, where gains know nothing of the effect") {
  const Record record = sepcal::test::fly_short_period({.rows = 300});
  const auto model = std::make_shared<const TrajectoryModel<ShortPeriod>>(ShortPeriod{}, record);
  const DriverPointer by_time = sepcal::power_driver({"time", "s"}, 3.0, 1);
  const auto with = compose(model,
                            {on_inputs("trim", by_time, {{"s", {"elevator", "rad"}}}),
                             on_parameter("bias", by_time, "b_az")},
                            record);
  const std::map<std::string, double> values{{"Za", -4},     {"Zd", -0.35}, {"Ma", -40},
                                             {"Mq", -5},     {"Md", -45},   {"b_alpha", 0.02},
                                             {"b_q", -0.01}, {"b_az", 0.5}};
  const Point point = point_of(*with, record, values);
  const Point own = point_of(*model, record, values);
  const sepcal::PathNoise noise{VectorXd{{0.003, 0.09}}, VectorXd{{0.005, 0.01, 0.15}}};
  const auto tangent = model->path_tangent(record, own.all(), noise);
  const auto& names = with->tables().parameters();
  const auto place = [&](const char* name) {
    return std::ranges::find(names, name, &Variable::name) - names.begin();
  };
  const std::vector<Index> places{place("bias.s"), place("trim.s")};
  const MatrixXd columns = tangent->columns(tangent->change(*with, record, point.all(), places));
  VectorXd theta(point.all().size() + 5);
  theta << point.all(), noise.process.array().log().matrix(), noise.outputs.array().log().matrix();
  const auto likelihood = with->innovations(record);
  const auto N = static_cast<Index>(record.rows());
  MatrixXd expected(3 * N, 2);
  Index at = 0;
  likelihood->scores(theta, [&](std::size_t, MatrixXd& scores) {
    for (Index first = 0; first < scores.rows(); first += likelihood->rows_a_sample(), ++at) {
      expected(Eigen::seqN(at, 3, N), Eigen::all) = scores.middleRows(first, 3)(Eigen::all, places);
    }
  });
  REQUIRE(at == N);
  CHECK(relative(columns, expected) < 1e-8);
}

TEST_CASE("what can't act along a trajectory is refused") {
  const Record record = flown();
  const auto path = path_of(record);
  Effect lag{.name = "lag"};
  lag.delays.push_back({Delay::Kind::outputs_lagging, {"lag.tau", "s", 0, 0.5}, {}});
  CHECK_THROWS_WITH_AS(compose(path, {lag}, record), Contains("can't lag"), Error);
  CHECK_THROWS_WITH_AS(
      compose(path, {on_parameter("x", sepcal::constant_driver(), "b_ax")}, record),
      Contains("no linear parameter"), Error);
}

}  // namespace path_tangent_test
