// SPDX-License-Identifier: BSD-3-Clause
// A state model of a user's own, laid along records: against closed forms and differences.
#include "sepcal/states/trajectory_model.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "sepcal/check_model.hpp"
#include "sepcal/detail/stage_one.hpp"
#include "sepcal/error.hpp"
#include "simulated_records.hpp"
#include "trajectories.hpp"

namespace trajectory_model_test {

using doctest::Approx;
using doctest::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::check_model;
using sepcal::Error;
using sepcal::InputsBetweenRows;
using sepcal::Record;
using sepcal::TrajectoryModel;
using sepcal::TrajectoryOptions;
using sepcal::test::error_of_tangent;
using sepcal::test::LinearOscillator;
using sepcal::test::Oscillator;
using sepcal::test::outputs_of;
using sepcal::test::rows_of;

namespace {

constexpr double w = 3.0;    // rad/s
constexpr double d = 0.2;    // damping ratio
constexpr double g = 4.0;    // m/s^2
constexpr double x_0 = 0.7;  // m
constexpr double v_0 = -0.4;
constexpr double slope = 0.5;  // of the input, 1/s

/// x(t) driven by u = slope t: the particular solution is a line.
double driven(double t) {
  const double wd = w * std::sqrt(1.0 - d * d);
  const double rise = g * slope / (w * w);
  const double offset = -2.0 * d / w * rise;
  const double a = x_0 - offset;
  const double b = (v_0 - rise + d * w * a) / wd;
  return std::exp(-d * w * t) * (a * std::cos(wd * t) + b * std::sin(wd * t)) + offset + rise * t;
}

/// Rows at uneven times up to 4 s, u = slope t, and readings that check_model() asks for.
Record ramp(std::size_t rows) {
  std::vector<double> time(rows);
  for (std::size_t k = 0; k < rows; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(rows - 1);
    time[k] = 4.0 * (share + 0.1 * std::sin(2.0 * std::numbers::pi * share) / 2.0);
  }
  std::vector<double> u(rows);
  for (std::size_t k = 0; k < rows; ++k) u[k] = slope * time[k];
  Record record;
  record.add("time", time).add("u", u);
  record.add("x_m", std::vector<double>(rows, 0.6)).add("v_m", std::vector<double>(rows, -0.3));
  return record;
}

/// Three segments of an input that jumps about, the last one short.
Record three_segments() {
  sepcal::test::Draws draws(3);
  constexpr std::size_t rows = 120;
  std::vector<double> time(rows);
  for (std::size_t k = 0; k < rows; ++k) time[k] = 0.05 * static_cast<double>(k);
  Record record;
  record.add("time", time).add("u", draws.uniform_column(rows, -1, 1));
  record.add("x_m", draws.uniform_column(rows, -1, 1));
  record.add("v_m", draws.uniform_column(rows, -1, 1));
  return record.cut({{"one", 0, 50}, {"two", 50, 111}, {"three", 111, 120}});
}

double largest_error(std::size_t rows, int substeps) {
  const Record record = ramp(rows);
  const TrajectoryModel model(Oscillator{}, record, {.substeps = substeps});
  VectorXd xi2(5);
  xi2 << w, d, g, x_0, v_0;
  const VectorXd read = outputs_of(model, record, xi2, VectorXd::Zero(2));
  double worst = 0.0;
  for (std::size_t k = 0; k < rows; ++k) {
    worst =
        std::max(worst, std::abs(read[static_cast<Index>(k)] - driven(record.column("time")[k])));
  }
  return worst;
}

VectorXd values(std::initializer_list<double> list) {
  return Eigen::Map<const VectorXd>(list.begin(), static_cast<Index>(list.size()));
}

std::vector<std::string> names(const std::vector<sepcal::Variable>& table) {
  std::vector<std::string> result;
  for (const auto& variable : table) result.push_back(variable.name);
  return result;
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("Runge-Kutta's error falls with the fourth power of the step, inputs linear") {
  const double coarse = largest_error(41, 1);
  CHECK(coarse < 1e-3);
  CHECK(coarse / largest_error(81, 1) == Approx(16).epsilon(0.15));
  CHECK(largest_error(41, 2) / largest_error(41, 4) == Approx(16).epsilon(0.15));
  CHECK(largest_error(2001, 1) < 2e-10);
}

TEST_CASE("held inputs are the former row's until the next one") {
  const Record record = ramp(41);
  const VectorXd xi2 = values({w, d, g, x_0, v_0});
  const TrajectoryModel model(Oscillator{}, record,
                              {.inputs = InputsBetweenRows::hold, .substeps = 20});
  const VectorXd read = outputs_of(model, record, xi2, VectorXd::Zero(2));
  Eigen::Vector2d x(x_0, v_0);
  for (std::size_t k = 1; k < record.rows(); ++k) {
    const double u = record.column("u")[k - 1];
    const double dt = (record.column("time")[k] - record.column("time")[k - 1]);
    const double rest = g * u / (w * w);  // in closed form: free motion about it
    const double wd = w * std::sqrt(1.0 - d * d);
    const double a = x[0] - rest;
    const double b = (x[1] + d * w * a) / wd;
    const double c = std::cos(wd * dt);
    const double s = std::sin(wd * dt);
    const double fall = std::exp(-d * w * dt);
    x = {rest + fall * (a * c + b * s), fall * ((-d * w) * (a * c + b * s) + wd * (b * c - a * s))};
    CHECK(read[static_cast<Index>(k)] == Approx(x[0]).epsilon(1e-7));
  }
}

TEST_CASE("the tables: inputs with time, initial states last, of each segment its own") {
  const TrajectoryModel one(Oscillator{}, ramp(5));
  CHECK(names(one.tables().inputs) == Names{"u", "time"});
  CHECK(names(one.tables().nonlinear) == Names{"w", "d", "g", "x_0", "v_0"});
  const TrajectoryModel three(Oscillator{}, three_segments());
  CHECK(names(three.tables().nonlinear) == Names{"w", "d", "g", "x_0[one]", "v_0[one]", "x_0[two]",
                                                 "v_0[two]", "x_0[three]", "v_0[three]"});
  Record unnamed = three_segments();
  unnamed.cut({{"", 0, 50}, {"", 50, 120}});
  const TrajectoryModel two(Oscillator{}, unnamed);
  CHECK(names(two.tables().nonlinear) ==
        Names{"w", "d", "g", "x_0[1]", "v_0[1]", "x_0[2]", "v_0[2]"});
  const TrajectoryModel linear(LinearOscillator{}, unnamed);
  CHECK(names(linear.tables().linear) == Names{"b", "g", "x_0[1]", "v_0[1]", "x_0[2]", "v_0[2]"});
  CHECK(names(linear.tables().nonlinear) == Names{"w", "d"});
  const TrajectoryModel measured(Oscillator{}, ramp(5), {.measured = {"v"}, .outputs = {"v_m"}});
  CHECK(names(measured.tables().inputs) == Names{"u", "v", "time"});
  CHECK(names(measured.tables().outputs) == Names{"v_m"});
  CHECK(measured.tables().linear.empty());
  CHECK(names(measured.tables().nonlinear) == Names{"w", "d", "g", "x_0"});
}

TEST_CASE("D is that of central differences to 1e-7, in three segments") {
  const Record record = three_segments();
  const VectorXd xi1 = values({0.2, -0.3});
  const VectorXd xi2 = values({w, d, g, 0.5, 0.3, -0.4, 0.1, 0.9, -0.8});
  for (const bool about_start : {false, true}) {
    const TrajectoryModel model(Oscillator{}, record, {.scales_about_start = about_start});
    CHECK(error_of_tangent(model, record, xi2, xi1) < 1e-7);
  }
  const TrajectoryModel held(Oscillator{}, record,
                             {.inputs = InputsBetweenRows::hold, .substeps = 3});
  CHECK(error_of_tangent(held, record, xi2, xi1) < 1e-7);
  const TrajectoryModel linear(LinearOscillator{}, record);
  CHECK(error_of_tangent(linear, record, values({w, d}),
                         values({0.1, g, 0.5, 0.3, -0.4, 0.1, 0.9, -0.8})) < 1e-7);
}

TEST_CASE("blocks of seven rows give the bits of one block") {
  const Record record = three_segments();
  const VectorXd xi1 = values({0.2, -0.3});
  const VectorXd xi2 = values({w, d, g, 0.5, 0.3, -0.4, 0.1, 0.9, -0.8});
  const TrajectoryModel model(Oscillator{}, record, {.scales_about_start = true});
  for (const VectorXd* at : {static_cast<const VectorXd*>(nullptr), &xi1}) {
    const MatrixXd whole = rows_of(model, record, xi2, at);
    CHECK(whole.allFinite());
    CHECK(rows_of(model, record, xi2, at, 7) == whole);
    CHECK(rows_of(model, record, xi2, at, 1) == whole);
  }
}

TEST_CASE("what is linear by superposition is the joint model's own trajectory") {
  const Record record = three_segments();
  const TrajectoryModel separable(LinearOscillator{}, record);
  const TrajectoryModel joint(LinearOscillator{}, record, {.separable = false});
  const VectorXd starts = values({0.5, 0.3, -0.4, 0.1, 0.9, -0.8});
  VectorXd linear(8);
  linear << 0.1, g, starts;
  VectorXd nonlinear(9);
  nonlinear << w, d, g, starts;
  const VectorXd one = outputs_of(separable, record, values({w, d}), linear);
  const VectorXd other = outputs_of(joint, record, nonlinear, values({0.1}));
  CHECK((one - other).cwiseAbs().maxCoeff() < 1e-13);
  // A and b are the same wherever they are asked for.
  const MatrixXd with_tangent = rows_of(separable, record, values({w, d}), &linear);
  const MatrixXd without = rows_of(separable, record, values({w, d}), nullptr);
  CHECK((with_tangent.leftCols(8) - without.leftCols(8)).cwiseAbs().maxCoeff() < 1e-13);
  CHECK((with_tangent.col(10) - without.col(8)).cwiseAbs().maxCoeff() < 1e-13);
}

TEST_CASE("a measured state is read where the others are integrated") {
  // x' = v with v read: x is the integral of lines, the trapezoidal rule.
  const Record plain = three_segments();
  Record record = plain;
  record.view("v", plain.column("v_m"));
  record.cut({{"", 0, 50}});
  const TrajectoryModel model(Oscillator{}, record, {.measured = {"v"}});
  const VectorXd xi2 = values({w, d, g, x_0});
  const VectorXd read = outputs_of(model, record, xi2, VectorXd::Zero(2));
  double x = x_0;
  for (Index k = 0; k < 50; ++k) {
    const auto row = static_cast<std::size_t>(k);
    if (k > 0) x += 0.025 * (record.column("v")[row - 1] + record.column("v")[row]);
    CHECK(read[k] == Approx(x).epsilon(1e-12));
    CHECK(read[50 + k] == record.column("v")[row]);
  }
  const MatrixXd D = rows_of(model, record, xi2, &xi2).middleCols(2, 4);  // any xi1
  CHECK(D.leftCols(3).isZero());
}

TEST_CASE("multiple shooting cuts segments into pieces with their own initial states") {
  const Record record = three_segments();
  const TrajectoryModel model(Oscillator{}, record, {.shoot = 1.5});
  CHECK(names(model.tables().nonlinear) == Names{"w", "d", "g", "x_0[one]", "v_0[one]",
                                                 "x_0[one.2]", "v_0[one.2]", "x_0[two]", "v_0[two]",
                                                 "x_0[two.2]", "v_0[two.2]", "x_0[two.3]",
                                                 "v_0[two.3]", "x_0[three]", "v_0[three]"});
  const auto starts = model.initial_states(record);
  CHECK(starts.at("x_0[one.2]") == record.column("x_m")[30]);
  CHECK(starts.at("v_0[two.3]") == record.column("v_m")[110]);
  VectorXd xi2 = VectorXd::Constant(15, 0.1);
  xi2.head(3) << w, d, g;
  xi2[5] = 0.77;  // x_0[one.2]
  CHECK(outputs_of(model, record, xi2, VectorXd::Zero(2))[30] == 0.77);
  CHECK(error_of_tangent(model, record, xi2, values({0.2, -0.3})) < 1e-7);
}

TEST_CASE("a state that runs away makes rows that are no numbers, up to the next start") {
  const Record record = three_segments();
  const TrajectoryModel model(Oscillator{}, record);
  VectorXd xi2 = values({w, -1e6, g, 0.5, 0.3, -0.4, 0.1, 0.0, 0.0});
  const MatrixXd rows = rows_of(model, record, xi2, nullptr);
  CHECK(std::isfinite(rows(0, 2)));
  CHECK(std::isnan(rows(49, 2)));
  CHECK(std::isfinite(rows(50, 2)));
  CHECK(std::isnan(rows(110, 2)));
  CHECK(std::isfinite(rows(111, 2)));
}

namespace {

struct RateNeverSet : Oscillator {
  template <class U, class X>
  sepcal::Rate<X, 2> rate(const sepcal::Vec<X, 2>& x, const sepcal::Vec<U, 1>& /*u*/,
                          const sepcal::Vec<X, 3>& /*p*/) const {
    sepcal::Rate<X, 2> dx;
    dx[0] = x[1];
    return dx;
  }
};

/// Says of a parameter that multiplies the state that it is linear.
struct NotLinear : LinearOscillator {
  static constexpr std::array<std::string_view, 1> linear_dynamic{"w"};
};

/// x(k+1) = a x(k) + u(k), read as it is.
struct Discrete {
  static constexpr bool discrete = true;
  static constexpr std::array inputs{sepcal::Quantity{"u", "1"}};
  static constexpr std::array states{sepcal::Quantity{"x", "1"}};
  static constexpr std::array outputs{sepcal::Quantity{"x_m", "1"}};
  static constexpr std::array<sepcal::Quantity, 0> linear{};
  static constexpr std::array nonlinear{sepcal::Quantity{"a", "1", 0, 1}};
  static constexpr std::array<sepcal::Quantity, 0> noise{};

  template <class U, class X>
  sepcal::Vec<X, 1> next(const sepcal::Vec<X, 1>& x, const sepcal::Vec<U, 1>& u,
                         const sepcal::Vec<X, 1>& a) const {
    return sepcal::Vec<X, 1>(a[0] * x[0] + u[0]);
  }
  template <class U, class X>
  sepcal::Affine<X, 1, 0> at(const sepcal::Vec<X, 1>& x, const sepcal::Vec<U, 1>& /*u*/,
                             const sepcal::Vec<X, 1>& /*a*/) const {
    sepcal::Affine<X, 1, 0> z;
    z.b = x;
    return z;
  }
};

}  // namespace

TEST_CASE("check_model() integrates a few steps, and sees what is never set") {
  const Record record = three_segments();
  const TrajectoryModel sound(Oscillator{}, record);
  CHECK_NOTHROW(check_model(sound, record, sound.initial_states(record)));
  CHECK_NOTHROW(check_model(TrajectoryModel(LinearOscillator{}, record), record));
  CHECK_THROWS_WITH_AS(check_model(TrajectoryModel(RateNeverSet{}, record), record),
                       Contains("is not a finite number"), Error);
  CHECK_THROWS_WITH_AS(check_model(TrajectoryModel(NotLinear{}, record), record),
                       Contains("changes with the linear parameters"), Error);
}

TEST_CASE("a fit starts initial states where the record has them, and samples the others") {
  const Record record = three_segments();
  const TrajectoryModel model(Oscillator{}, record);
  const auto starts = model.starting_values(record);
  CHECK(starts.size() == 6);
  CHECK(starts.at("x_0[two]") == record.column("x_m")[50]);
  sepcal::FitOptions options;
  options.samples = 5;
  options.coloured_errors = false;
  const sepcal::StageOne one = sepcal::stage_one(model, record, options);
  for (Index s = 0; s < one.samples.cols(); ++s) {
    CHECK(one.samples(3, s) == starts.at("x_0[one]"));
    CHECK(one.samples(8, s) == starts.at("v_0[three]"));
  }
  options.sampling_distribution["x_0[one]"] = {0.0, 1.0};
  CHECK(sepcal::stage_one(model, record, options).samples(3, 0) != starts.at("x_0[one]"));
  CHECK(TrajectoryModel(LinearOscillator{}, record).starting_values(record).empty());
}

TEST_CASE("a model in discrete time goes from row to row") {
  const Record record = three_segments().select("two");
  const TrajectoryModel model(Discrete{}, record);
  const VectorXd read = outputs_of(model, record, values({0.9, 0.5}), VectorXd(0));
  double x = 0.5;
  for (Index k = 0; k < read.size(); ++k) {
    CHECK(read[k] == Approx(x).epsilon(1e-14));
    x = 0.9 * x + record.column("u")[50 + static_cast<std::size_t>(k)];
  }
  CHECK(error_of_tangent(model, record, values({0.9, 0.5}), VectorXd(0)) < 1e-7);
}

TEST_CASE("misuse is named") {
  const Record record = three_segments();
  const auto make = [&](const TrajectoryOptions& options) {
    return TrajectoryModel(Oscillator{}, record, options);
  };
  CHECK_THROWS_WITH_AS(make({.measured = {"y"}}), "the model has no state 'y'; it has x, v", Error);
  CHECK_THROWS_WITH_AS(make({.outputs = {"y_m"}}), "the model has no output 'y_m'; it has x_m, v_m",
                       Error);
  CHECK_THROWS_WITH_AS(make({.measured = {"x", "v"}}),
                       "all states are measured; there is nothing to integrate", Error);
  CHECK_THROWS_WITH_AS(make({.substeps = 0}), "substeps must be at least 1", Error);
  CHECK_THROWS_WITH_AS(make({.shoot = 0}), "shoot must be a time above 0 s", Error);
  CHECK_THROWS_WITH_AS(make({.shoot = 1e-3}), doctest::Contains("shoot cuts "), Error);
  CHECK_THROWS_WITH_AS(TrajectoryModel(Oscillator{}, TrajectoryOptions{.shoot = 1}),
                       Contains("make the model of the record"), Error);
  Record backwards;
  backwards.add("time", {0, 1, 1, 2}).add("u", {0, 0, 0, 0});
  CHECK_THROWS_WITH_AS(TrajectoryModel(Oscillator{}, backwards),
                       "time doesn't increase in row 2 (counted from 0); sort the rows, or cut "
                       "segments there",
                       Error);
  Record timeless;
  timeless.add("u", {0, 0});
  CHECK_THROWS_WITH_AS(TrajectoryModel(Oscillator{}, timeless), Contains("column 'time'"), Error);
  Record otherwise = record;
  otherwise.cut({{"one", 10, 120}});
  CHECK_THROWS_WITH_AS(rows_of(make({}), otherwise, VectorXd::Zero(9), nullptr),
                       Contains("a segment begins in row 10"), Error);
}

}  // namespace trajectory_model_test
