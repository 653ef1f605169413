// SPDX-License-Identifier: BSD-3-Clause
// Effects on the time axis: each kind alone and all together against closed forms of signals that
// are known at any time, their derivatives, and that no row of another segment has a share.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "composed_checks.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/effects/magnetic.hpp"
#include "sepcal/detail/run_time_effect.hpp"
#include "small_models.hpp"

namespace delays_test {

using Eigen::Index;
using Eigen::VectorXd;
using sepcal::block_model;
using sepcal::BlockModel;
using sepcal::compose;
using sepcal::Delay;
using sepcal::Effect;
using sepcal::Record;
using namespace sepcal::test;

namespace {

constexpr double interval = 0.02;  // s
constexpr double omega = 1.5;      // rad/s
const std::vector<std::string> air_data{"pt", "ps", "dpa", "dpb", "rho"};

Effect in_time(const std::string& name, Delay::Kind kind, double longest,
               std::vector<std::string> inputs = {}) {
  Effect effect{.name = name};
  effect.delays.push_back({kind, {name + ".tau", "s", -longest, longest}, std::move(inputs)});
  return effect;
}

/// The signal's derivative by differences: known at any time, unlike a record's.
std::function<double(double)> rate(const std::function<double(double)>& signal) {
  return [=](double t) {
    const auto slope = [&](double h) { return (signal(t + h) - signal(t - h)) / (2 * h); };
    return (4 * slope(5e-4) - slope(1e-3)) / 3;
  };
}

/// The largest difference of the model's prediction over `record` from z (n_z * N), relative to z.
double difference(const BlockModel& model, const Record& record, const NamedValues& values,
                  const VectorXd& z) {
  const VectorXd predicted = predict(model, record, values);
  REQUIRE(predicted.size() == z.size());
  return (predicted - z).cwiseAbs().maxCoeff() / z.cwiseAbs().maxCoeff();
}

/// z = s u + c with u = sin(omega t): what a chain of delays makes of it, by its phasor.
struct Wave {
  std::vector<double> time = uneven_times(600, interval);
  Record record = sample({{"u", [](double t) { return std::sin(omega * t); }}}, time);

  /// Over the rows farther than `margin` [s] from the edges.
  double difference_from(std::complex<double> phasor, const std::vector<Effect>& effects,
                         NamedValues values, double margin = 0.6) const {
    values["s"] = 2.0;
    values["c"] = 0.3;
    const auto model = compose(block_model(Line{}), effects, record);
    const Record inner = without_edges(record, margin);
    VectorXd z(static_cast<Index>(inner.rows()));
    const std::size_t first = inner.segments().front().first;
    for (Index k = 0; k < z.size(); ++k) {
      const double t = time[first + static_cast<std::size_t>(k)];
      z[k] = 0.3 + 2.0 * std::imag(phasor * std::polar(1.0, omega * t));
    }
    check_tangent(*model, inner, values, 1e-5);
    return difference(*model, inner, values, z);
  }
};

const std::complex<double> i(0.0, 1.0);

}  // namespace

TEST_CASE("inputs_late: what was logged at t belongs to t - tau") {
  const Wave wave;
  for (const double tau : {-0.3, 0.0, 0.17}) {
    CHECK(wave.difference_from(std::exp(i * omega * tau),
                               {in_time("late", Delay::Kind::inputs_late, 0.5, {"u"})},
                               {{"late.tau", tau}}) < 1e-7);
  }
}

TEST_CASE("outputs_late: the outputs follow the inputs at t - tau") {
  const Wave wave;
  for (const double tau : {-0.3, 0.0, 0.17}) {
    CHECK(wave.difference_from(std::exp(-i * omega * tau),
                               {in_time("late", Delay::Kind::outputs_late, 0.5)},
                               {{"late.tau", tau}}) < 1e-7);
  }
}

TEST_CASE("a clock that drifts is late by a share of tau that grows, and no more at either end") {
  const Wave wave;
  const double first = 2.0;
  const double last = 9.0;
  for (const auto kind : {Delay::Kind::inputs_late, Delay::Kind::outputs_late}) {
    Effect drift = in_time("drift", kind, 0.5, {"u"});
    if (kind == Delay::Kind::outputs_late) drift.delays.front().inputs.clear();
    drift.delays.front().grows = {first, last};
    const auto model = compose(block_model(Line{}), {drift}, wave.record);
    const Record inner = without_edges(wave.record, sepcal::reach({drift}));
    const double sign = kind == Delay::Kind::inputs_late ? 1.0 : -1.0;
    for (const double tau : {-0.3, 0.45}) {
      const NamedValues values{{"drift.tau", tau}, {"s", 2.0}, {"c", 0.3}};
      VectorXd z(static_cast<Index>(inner.rows()));
      const std::size_t begin = inner.segments().front().first;
      for (Index k = 0; k < z.size(); ++k) {
        const double t = wave.time[begin + static_cast<std::size_t>(k)];
        const double share = std::min(1.0, std::max(0.0, (t - first) / (last - first)));
        z[k] = 0.3 + 2.0 * std::sin(omega * (t + sign * tau * share));
      }
      CHECK(difference(*model, inner, values, z) < 1e-5);  // of the interpolation
      check_tangent(*model, inner, values, 1e-5);
    }
  }
}

TEST_CASE("inputs_lagging: undoes tau du/dt + u = u0") {
  const Wave wave;
  for (const double tau : {0.05, 0.4}) {
    CHECK(wave.difference_from(1.0 + i * omega * tau,
                               {in_time("lag", Delay::Kind::inputs_lagging, 0.5, {"u"})},
                               {{"lag.tau", tau}}) < 3e-6);  // of a spline's slope, 1e-5 tau omega
  }
}

TEST_CASE(
    "outputs_lagging: a first-order lag, to 1e-4 near a segment's begin, else to the spline") {
  const Wave wave;
  const std::vector<Effect> lag{in_time("lag", Delay::Kind::outputs_lagging, 0.2)};
  for (const double tau : {0.02, 0.1, 0.2}) {
    CAPTURE(tau);
    const std::complex<double> phasor = 1.0 / (1.0 + i * omega * tau);
    CHECK(wave.difference_from(phasor, lag, {{"lag.tau", tau}}, sepcal::reach(lag)) < 1e-4);
    CHECK(wave.difference_from(phasor, lag, {{"lag.tau", tau}}, 23.0 * 0.2) < 1e-7);
  }
}

TEST_CASE("all four kinds at once are the product of the four, in any order") {
  const Wave wave;
  const Effect a = in_time("a", Delay::Kind::inputs_late, 0.3, {"u"});
  const Effect b = in_time("b", Delay::Kind::inputs_lagging, 0.3, {"u"});
  const Effect c = in_time("c", Delay::Kind::outputs_late, 0.3);
  const Effect d = in_time("d", Delay::Kind::outputs_lagging, 0.1);
  const NamedValues values{{"a.tau", 0.2}, {"b.tau", 0.15}, {"c.tau", -0.1}, {"d.tau", 0.08}};
  const std::complex<double> phasor =
      std::exp(i * omega * (0.2 + 0.1)) * (1.0 + i * omega * 0.15) / (1.0 + i * omega * 0.08);
  CHECK(wave.difference_from(phasor, {a, b, c, d}, values, 3.0) < 3e-6);
  CHECK(wave.difference_from(phasor, {d, c, b, a}, values, 3.0) < 3e-6);
}

TEST_CASE("five-hole: late or lagging air data are the probe's own readings at another time") {
  const Signals signals = five_hole_signals();
  const std::vector<double> time = uneven_times(400, interval);
  const Record record = sample(signals, time);
  const Record inner = without_edges(record, 0.5);
  const auto expected = [&](const Signals& read, double lead) {
    Record then = sample(read, time, lead, air_data);
    return then.cut(inner.segments());
  };
  Draws draws(451);
  NamedValues values = draw_values(sepcal::tables_of<sepcal::FiveHoleProbe>(), draws);

  const auto late = compose(block_model(five_holes),
                            {in_time("late", Delay::Kind::inputs_late, 0.5, air_data)}, record);
  values["late.tau"] = 0.33;
  CHECK(difference(*late, inner, values,
                   predict(*block_model(five_holes), expected(signals, 0.33), values)) < 1e-7);
  check_tangent(*late, inner, values, 1e-5);

  const std::vector<std::string> pressures{"pt", "ps", "dpa", "dpb"};
  const auto lagging =
      compose(block_model(five_holes),
              {in_time("lag", Delay::Kind::inputs_lagging, 0.5, pressures)}, record);
  values["lag.tau"] = 0.2;
  Signals undone = signals;
  for (const std::string& name : pressures) {
    undone[name] = [own = signals.at(name), slope = rate(signals.at(name))](double t) {
      return own(t) + 0.2 * slope(t);
    };
  }
  CHECK(difference(*lagging, inner, values,
                   predict(*block_model(five_holes), expected(undone, 0.0), values)) < 1e-5);
  check_tangent(*lagging, inner, values, 1e-5);
}

TEST_CASE("late outputs: every physical input is shifted, a yaw that wraps too, a driver is not") {
  const std::vector<double> time = uneven_times(400, interval);
  const Signals signals = five_hole_signals();
  const Record record = sample(signals, time);
  const Record inner = without_edges(record, 0.5);
  Effect wind{.name = "wind"};
  wind.varying.push_back(
      {sepcal::power_driver({"altitude_m", "m"}, 300, 1), {{"n", "w_n"}}, "m/s"});
  Effect wash{.name = "wash"};
  wash.corrections.push_back(sepcal::driven_inputs(
      "wash", sepcal::power_driver({"throttle", ""}, 0, 1),
      {{"s", sepcal::Variable(sepcal::port("pressure_offset", "Pa"))}}, "Pa", 50.0));
  const auto model = compose(block_model(five_holes),
                             {wind, in_time("late", Delay::Kind::outputs_late, 0.5), wash}, record);
  const auto host = compose(block_model(five_holes), {wind, wash}, record);
  Draws draws(452);
  NamedValues values = draw_values(model->tables(), draws);
  values["late.tau"] = 0.21;
  Record then = sample(signals, time, -0.21, names_of(block_model(five_holes)->tables().inputs));
  then.cut(inner.segments());
  CHECK(difference(*model, inner, values, predict(*host, then, values)) < 1e-7);
  check_tangent(*model, inner, values, 1e-5);
}

TEST_CASE("magnetometer: a lag with a correction and a term averages what they make of the field") {
  const std::vector<double> time = uneven_times(400, interval);
  const Signals signals = magnetometer_signals();
  const Record record = sample(signals, time);
  const Record inner = without_edges(record, 1.45);
  const std::vector<Effect> others{
      sepcal::effect("field_declination", sepcal::effects::FieldDeclination{}),
      sepcal::effect("cubic_nonlinearity", sepcal::effects::CubicNonlinearity{})};
  std::vector<Effect> all = others;
  all.push_back(in_time("lag", Delay::Kind::outputs_lagging, 0.2));
  const auto model = compose(block_model(sepcal::Magnetometer{}), all, record);
  const auto host = compose(block_model(sepcal::Magnetometer{}), others, record);
  Draws draws(453);
  NamedValues values = draw_values(model->tables(), draws);
  for (const char* name : {"d_x", "d_y", "d_z", "c_x", "c_y", "c_z"}) {
    values[std::string("cubic_nonlinearity.") + name] *= 1e-3;
  }
  values["lag.tau"] = 0.05;
  // The average by many small steps: the integral over ages x of exp(-x) z(t - tau x), Simpson.
  VectorXd z = VectorXd::Zero(3 * static_cast<Index>(inner.rows()));
  constexpr int steps = 600;
  constexpr double width = 30.0 / steps;
  for (int n = 0; n <= steps; ++n) {
    const double weight = (n == 0 || n == steps ? 1.0 : n % 2 == 1 ? 4.0 : 2.0) * width / 3.0;
    Record then = sample(signals, time, -0.05 * width * n, {"hx", "hy", "hz", "roll", "pitch"});
    then.cut(inner.segments());
    z += weight * std::exp(-width * n) * predict(*host, then, values);
  }
  CHECK(difference(*model, inner, values, z) < 1e-5);
  check_tangent(*model, inner, values, 1e-5);
}

TEST_CASE("no row of another segment has a share in a shifted block") {
  const Signals signals = magnetometer_signals();
  Record record = sample(signals, uneven_times(120, interval));
  record.cut({{"first", 0, 70}, {"second", 70, 120}});
  std::vector<double> other(record.column("hx").begin(), record.column("hx").end());
  for (std::size_t k = 70; k < other.size(); ++k) other[k] = 1e6;
  const Record changed = with_column(record, "hx", other);
  const std::vector<Effect> effects{in_time("late", Delay::Kind::outputs_late, 0.5),
                                    in_time("lag", Delay::Kind::outputs_lagging, 0.1)};
  NamedValues values{{"late.tau", -0.4}, {"lag.tau", 0.03}};
  Draws draws(454);
  const NamedValues others = draw_values(sepcal::tables_of<sepcal::Magnetometer>(), draws);
  values.insert(others.begin(), others.end());
  const auto rows_of = [&](const Record& logged) {
    const auto model = compose(block_model(sepcal::Magnetometer{}), effects, logged);
    return tangent_rows(*model, logged, values, 25);
  };
  const Eigen::MatrixXd before = rows_of(record);
  const Eigen::MatrixXd after = rows_of(changed);
  for (Index j = 0; j < 3; ++j) {
    CHECK(before.middleRows(120 * j, 70) == after.middleRows(120 * j, 70));
    CHECK(before.middleRows(120 * j + 70, 50) != after.middleRows(120 * j + 70, 50));
  }
}

}  // namespace delays_test
