// SPDX-License-Identifier: BSD-3-Clause
// Estimates against time: recursive least squares beside fits of the rows so far, the extended
// filters of samples beside JointFilter, and models with a state from a calibration and from the
// first rows.
#include "sepcal/states/track.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "noises.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/short_period.hpp"
#include "sepcal/states/information_form.hpp"
#include "sepcal/states/joint_filter.hpp"
#include "short_periods.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace track_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Record;
using sepcal::ScalarExample2;
using sepcal::ShortPeriod;
using sepcal::start_from_fit;
using sepcal::start_from_rows;
using sepcal::StreamStart;
using sepcal::Track;
using sepcal::track;
using sepcal::TrackMethod;
using sepcal::TrackOptions;
using sepcal::TrajectoryModel;
using sepcal::TrajectoryOptions;
using sepcal::test::Draws;
using sepcal::test::fly_short_period;
using sepcal::test::Line;

namespace {

FitOptions known(const std::map<std::string, double>& noise) {
  FitOptions options;
  options.noise = noise;
  options.coloured_errors = false;
  options.threads = 1;
  return options;
}

TrackOptions by(TrackMethod method) { return {.method = method}; }

Record line(int rows, std::uint64_t seed) {
  Draws draws(seed);
  const std::vector<double> u = draws.uniform_column(static_cast<std::size_t>(rows), 0, 5);
  std::vector<double> z;
  for (const double x : u) z.push_back(2.0 * x - 1.0 + 0.1 * draws.normal());
  Record record;
  return record.add("u", u).add("z", z);
}

const std::map<std::string, double> of_example{{"z", 0.3}};

Record example(std::uint64_t seed) {
  Draws draws(seed);
  const std::vector<double> eta = draws.uniform_column(100, 1, 10);
  std::vector<double> z;
  for (const double x : eta) {
    z.push_back(2.0 * std::cos(1.05 * x + 0.1) + 1.0 + 0.3 * draws.normal());
  }
  Record record;
  return record.add("eta", eta).add("z", z);
}

const std::map<std::string, double> of_flight{{"alpha_m", 0.005}, {"q_m", 0.01}, {"az_m", 0.15}};

/// Names and truth of a track of the short period.
const std::map<std::string, double> truth{{"Za", -4.0},   {"Ma", -40.0}, {"Mq", -5.0},
                                          {"Zd", -0.35},  {"Md", -45.0}, {"b_alpha", 0.02},
                                          {"b_q", -0.01}, {"b_az", 0.5}};

void check_end(const Track& found) {
  const Index last = found.estimates.rows() - 1;
  for (std::size_t k = 0; k < found.names.size(); ++k) {
    const auto expected = truth.find(found.names[k]);
    if (expected == truth.end()) continue;
    const auto at = static_cast<Index>(k);
    const double sd = found.standard_deviations(last, at);
    INFO(found.names[k] << " " << found.estimates(last, at) << " +- " << sd);
    CHECK(std::abs(found.estimates(last, at) - expected->second) < 4.0 * sd);
  }
  CHECK(found.refused == 0);
}

}  // namespace

TEST_CASE("recursive least squares of a linear model is the batch of the rows so far, to 1e-12") {
  const Record record = line(60, 1);
  const auto noise = known({{"z", 0.1}});
  const StreamStart start = start_from_rows(Line{}, record, 5, noise);
  const Track found = track(Line{}, record, start, by(TrackMethod::rls));
  CHECK(found.names == std::vector<std::string>{"s", "c"});
  REQUIRE(found.estimates.rows() == 55);
  CHECK(found.time.empty());
  double worst = 0.0;
  for (int k = 0; k < 55; ++k) {
    CHECK(found.rows[static_cast<std::size_t>(k)] == static_cast<std::size_t>(k) + 5);
    MatrixXd H(k + 6, 2);
    VectorXd z(k + 6);
    for (int i = 0; i < k + 6; ++i) {
      const auto at = static_cast<std::size_t>(i);
      H.row(i) << record.column("u")[at], 1.0;
      z[i] = record.column("z")[at];
    }
    const VectorXd x = H.colPivHouseholderQr().solve(z);
    const MatrixXd P = 0.01 * (H.transpose() * H).inverse();
    worst = std::max(worst, (found.estimates.row(k).transpose() - x).cwiseAbs().maxCoeff());
    worst =
        std::max(worst, (found.standard_deviations.row(k).transpose() - P.diagonal().cwiseSqrt())
                            .cwiseAbs()
                            .maxCoeff());
  }
  MESSAGE("from the batch " << worst);
  CHECK(worst < 1e-12);
  // Nothing is nonlinear: the filters are the same recursion.
  for (const TrackMethod method : {TrackMethod::ekf, TrackMethod::iekf, TrackMethod::srif}) {
    const Track same = track(Line{}, record, start, by(method));
    CHECK((same.estimates - found.estimates).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((same.standard_deviations - found.standard_deviations).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((same.innovations - found.innovations).cwiseAbs().maxCoeff() < 1e-11);
  }
}

TEST_CASE("filters of samples on a computer are those of fixed size that fly") {
  const Record record = example(2);
  const StreamStart start = start_from_rows(ScalarExample2{}, record, 30, known(of_example));
  for (const TrackMethod method : {TrackMethod::ekf, TrackMethod::iekf, TrackMethod::srif}) {
    const Track found = track(ScalarExample2{}, record, start, by(method));
    using Form = sepcal::InformationForm<4>;
    sepcal::JointFilter<ScalarExample2, Form> filter(
        {}, {start.xi, Form::of_information_root(start.information_root<4>())});
    for (std::size_t row = 30; row < 100; ++row) {
      const sepcal::Vec<double, 1> u(record.column("eta")[row]);
      const sepcal::Vec<double, 1> z(record.column("z")[row]);
      const Eigen::Matrix<double, 1, 1> R(0.09);
      const auto innovation =
          method == TrackMethod::iekf ? filter.update_iterated(u, z, R) : filter.update(u, z, R);
      const auto at = static_cast<Index>(row - 30);
      const VectorXd sd = filter.filter().covariance().diagonal().cwiseSqrt();
      CHECK((found.estimates.row(at).transpose() - filter.filter().x()).norm() < 1e-10);
      CHECK((found.standard_deviations.row(at).transpose() - sd).norm() < 1e-10);
      if (method != TrackMethod::iekf) {
        CHECK(found.innovations(at, 0) == Approx(innovation.e[0]).epsilon(1e-9));
      }
    }
    CHECK(found.not_converged == 0);
  }
}

TEST_CASE("from a calibration of another record, with a parameter held") {
  FitOptions options = known(of_example);
  options.fix = {{"d", 1.0}};
  const Fit fit = sepcal::fit(ScalarExample2{}, example(3), options);
  const Track found =
      track(ScalarExample2{}, example(4), start_from_fit(fit), by(TrackMethod::ekf));
  CHECK(found.estimates.rows() == 100);
  CHECK((found.estimates.col(1).array() == 1.0).all());  // a, d, b, c
  CHECK((found.standard_deviations.col(1).array() == 0.0).all());
  const double both = 1.0 / std::sqrt(2.0);  // twice the rows
  CHECK(found.standard_deviations(99, 0) == Approx(both * fit["a"].standard_error).epsilon(0.15));
  CHECK(std::abs(found.estimates(99, 2) - 0.05) < 4.0 * found.standard_deviations(99, 2));
}

TEST_CASE("the short period from its first five seconds, by every method") {
  const Record record = fly_short_period({});
  for (const TrackMethod method :
       {TrackMethod::rls, TrackMethod::ekf, TrackMethod::iekf, TrackMethod::srif}) {
    FitOptions fit = known(of_flight);
    TrackOptions options = by(method);
    if (method != TrackMethod::rls) {
      options.process_noise = fit.process_noise = {{"alpha", 1e-4}, {"q", 1e-3}};
      fit.method = sepcal::FitMethod::filter_error;
    }
    const StreamStart start = start_from_rows(ShortPeriod{}, record, 250, fit);
    const Track found = track(ShortPeriod{}, record, start, options);
    CHECK(found.estimates.rows() == 750);
    CHECK(found.time.front() == Approx(5.0));
    check_end(found);
    const auto Za = std::ranges::find(found.names, "Za") - found.names.begin();
    CHECK(found.standard_deviations(749, Za) < 0.7 * found.standard_deviations(0, Za));
  }
}

namespace {

/// The short period's states, linear and other parameters, by the very filter that flies.
template <class Form>
void check_beside_flight(const Record& record, const StreamStart& start, const Track& found,
                         const TrackOptions& options) {
  using Filter = sepcal::JointFilter<ShortPeriod, Form>;
  constexpr int n = Filter::n;
  REQUIRE(found.names.size() == n);
  // The start's order is Zd Md and x(0) among the linear ones; the filter's is the tables'.
  std::vector<std::string> names = {"alpha_0", "q_0", "b_alpha", "b_q", "b_az"};
  for (const auto& parameter : ShortPeriod::nonlinear) names.emplace_back(parameter.name);
  Eigen::Vector<double, n> s;
  std::vector<int> order;
  for (int k = 0; k < n; ++k) {
    const auto at = std::ranges::find(start.names, names[static_cast<std::size_t>(k)]);
    order.push_back(static_cast<int>(at - start.names.begin()));
    s[k] = start.xi[order.back()];
  }
  const MatrixXd P = (start.R.transpose() * start.R).inverse()(order, order);
  Filter filter({}, {s, Form(Eigen::Matrix<double, n, n>(P))});
  const auto read = [&](std::size_t row) {
    return sepcal::StateRow<ShortPeriod>{
        record.column("time")[row],
        {record.column("elevator")[row], record.column("airspeed")[row]},
        {}};
  };
  const Eigen::Matrix2d Q = Eigen::Matrix2d::Zero();
  const Eigen::Matrix3d R =
      Eigen::Vector3d(start.noise[0], start.noise[1], start.noise[2]).cwiseAbs2().asDiagonal();
  for (std::size_t row = 1; row < record.length(); ++row) {
    filter.predict(read(row - 1), read(row), Q);
    if (row < start.rows) continue;
    const Eigen::Vector3d z(record.column("alpha_m")[row], record.column("q_m")[row],
                            record.column("az_m")[row]);
    const auto u = read(row).u;
    if (options.method == TrackMethod::iekf) {
      filter.update_iterated(u, z, R);
    } else {
      filter.update(u, z, R);
    }
    const auto at = static_cast<Index>(row - start.rows);
    const VectorXd sd = filter.filter().covariance().diagonal().cwiseSqrt();
    for (int k = 0; k < n; ++k) {
      const auto& name = k < 2 ? std::string(ShortPeriod::states[static_cast<std::size_t>(k)].name)
                               : names[static_cast<std::size_t>(k)];
      const auto place = std::ranges::find(found.names, name) - found.names.begin();
      CHECK(std::abs(found.estimates(at, place) - filter.filter().x()[k]) < 1e-7 * sd[k]);
      CHECK(found.standard_deviations(at, place) == Approx(sd[k]).epsilon(1e-7));
    }
  }
}

}  // namespace

TEST_CASE("a track of a model with a state is the joint filter that flies") {
  const Record record = fly_short_period({});
  const StreamStart start = start_from_rows(ShortPeriod{}, record, 400, known(of_flight));
  for (const TrackMethod method : {TrackMethod::ekf, TrackMethod::iekf, TrackMethod::srif}) {
    const TrackOptions options = by(method);
    const Track found = track(ShortPeriod{}, record, start, options);
    CAPTURE(method);
    constexpr int n = sepcal::JointSizes<ShortPeriod>::n;
    if (method == TrackMethod::srif) {
      check_beside_flight<sepcal::InformationForm<n>>(record, start, found, options);
    } else {
      check_beside_flight<sepcal::SquareRootForm<n>>(record, start, found, options);
    }
  }
}

TEST_CASE("without process noise the filter ends where output error of all rows does") {
  const Record record = fly_short_period({});
  const StreamStart start = start_from_rows(ShortPeriod{}, record, 500, known(of_flight));
  const Track found = track(ShortPeriod{}, record, start, by(TrackMethod::iekf));
  const TrajectoryModel<ShortPeriod> model(ShortPeriod{}, record);
  const Fit fit = sepcal::fit(model, record, known(of_flight));
  const Index last = found.estimates.rows() - 1;
  for (std::size_t k = 2; k < found.names.size(); ++k) {
    const auto& parameter = fit[found.names[k]];
    const auto at = static_cast<Index>(k);
    INFO(parameter.name);
    CHECK(std::abs(found.estimates(last, at) - parameter.value) <
          0.1 * parameter.standard_error_white);
    CHECK(found.standard_deviations(last, at) ==
          Approx(parameter.standard_error_white).epsilon(0.05));
  }
}

TEST_CASE("from another flight's calibration, over two segments, with readings missing") {
  const Record first = fly_short_period({});
  const TrajectoryModel<ShortPeriod> model(ShortPeriod{}, first);
  const Fit fit = sepcal::fit(model, first, known(of_flight));
  Record second = fly_short_period({.start = {0.03, 0.1}, .seed = 2});
  std::vector<double> alpha(second.column("alpha_m").begin(), second.column("alpha_m").end());
  for (std::size_t row = 100; row < 200; ++row) alpha[row] = std::nan("");
  Record record;
  for (const std::string& name : second.names()) {
    const auto column = second.column(name);
    record.add(name, name == "alpha_m" ? alpha : std::vector<double>(column.begin(), column.end()));
  }
  record.cut({{"a", 0, 600}, {"b", 620, 1000}});
  TrackOptions options = by(TrackMethod::srif);
  options.initial_states = {{"alpha", 0.1}, {"q", 0.5}};
  options.process_noise = {{"alpha", 1e-4}, {"q", 1e-3}};
  const Track found = track(ShortPeriod{}, record, start_from_fit(fit), options);
  CHECK(found.estimates.rows() == 980);
  CHECK(found.rows[600] == 620);
  CHECK(std::isnan(found.innovations(150, 0)));
  CHECK_FALSE(std::isnan(found.innovations(150, 1)));
  CHECK(found.standard_deviations(600, 0) > 5.0 * found.standard_deviations(599, 0));
  CHECK(found.standard_deviations(600, 5) <= found.standard_deviations(599, 5));
  check_end(found);
}

TEST_CASE("where nothing is said of the states of a new segment, they are as good as unknown") {
  const Record first = fly_short_period({});
  const TrajectoryModel<ShortPeriod> model(ShortPeriod{}, first);
  const Fit fit = sepcal::fit(model, first, known(of_flight));
  const Record second = fly_short_period({.start = {0.03, 0.1}, .seed = 2});
  TrackOptions vague = by(TrackMethod::iekf);
  vague.process_noise = {{"alpha", 1e-4}, {"q", 1e-3}};
  TrackOptions told = vague;
  told.initial_states = {{"alpha", 10.0}, {"q", 10.0}};
  const Track found = track(ShortPeriod{}, second, start_from_fit(fit), vague);
  const Track other = track(ShortPeriod{}, second, start_from_fit(fit), told);
  const Index last = found.estimates.rows() - 1;
  for (Index k = 0; k < found.estimates.cols(); ++k) {
    const double sd = found.standard_deviations(last, k);
    CHECK(std::abs(found.estimates(last, k) - other.estimates(last, k)) < 0.02 * sd);
  }
  check_end(found);
}

TEST_CASE("as information, states that die away without noise leave the rest its digits") {
  // Along 60 s the faster mode dies away by e^-240: information on it grows as it does.
  const Record record = fly_short_period({.rows = 3000, .seed = 4});
  for (const std::size_t rows : {300U, 2000U}) {
    const StreamStart start = start_from_rows(ShortPeriod{}, record, rows, known(of_flight));
    const Track covariance = track(ShortPeriod{}, record, start, by(TrackMethod::ekf));
    const Track information = track(ShortPeriod{}, record, start, by(TrackMethod::srif));
    const Eigen::MatrixXd& sd = covariance.standard_deviations;
    CHECK(
        ((information.estimates - covariance.estimates).array().abs() <= 1e-5 * sd.array()).all());
    CHECK(((information.standard_deviations - sd).array().abs() <= 1e-6 * sd.array()).all());
  }
}

TEST_CASE("bad input is one line") {
  const Record record = fly_short_period({});
  const Record samples = example(5);
  const StreamStart start = start_from_rows(ShortPeriod{}, record, 300, known(of_flight));
  const StreamStart other = start_from_rows(ScalarExample2{}, samples, 30, known(of_example));
  const auto says = [&](const auto& run, const std::string& expected) {
    try {
      run();
      FAIL("no error: " << expected);
    } catch (const sepcal::Error& error) {
      CHECK(std::string(error.what()) == expected);
    }
  };
  says([&] { track(ShortPeriod{}, record, other, by(TrackMethod::ekf)); },
       "the start has no 'b_alpha'; it has a, d, b, c: start from this model and record");
  says([&] { track(Line{}, line(20, 1), other, by(TrackMethod::ekf)); },
       "the start has no 's'; it has a, d, b, c: start from this model and record");
  says([&] { track(ShortPeriod{}, record, start, {.process_noise = {{"speed", 1.0}}}); },
       "the model has no process noise 'speed'; it has alpha, q");
  says([&] { track(ShortPeriod{}, record, start, {.process_noise = {{"q", -1.0}}}); },
       "process noise 'q' needs a standard deviation of 0 or more");
  says([&] { track(ScalarExample2{}, samples, other, {.noise = {{"z", 0.0}}}); },
       "output 'z' needs a noise above 0, as every output does");
  says([&] { track(ScalarExample2{}, samples, other, {.process_noise = {{"a", 0.1}}}); },
       "the model has no process noise 'a'; it has none");
  const Record another = fly_short_period({.seed = 2});
  const StreamStart fitted = start_from_fit(
      fit(TrajectoryModel<ShortPeriod>(ShortPeriod{}, another), another, known(of_flight)));
  says(
      [&] {
        track(ShortPeriod{}, record, fitted,
              {.method = TrackMethod::srif, .initial_states = {{"alpha", 0.0}, {"q", 0.1}}});
      },
      "srif can't hold what is known exactly; give every state a deviation above 0 "
      "(initial_states), or take ekf");
  Record twice;
  for (const std::string& name : record.names()) {
    std::vector<double> column(record.column(name).begin(), record.column(name).end());
    if (name == "time") column[600] = column[599];
    twice.add(name, column);
  }
  Record broken;
  for (const std::string& name : record.names()) {
    std::vector<double> column(record.column(name).begin(), record.column(name).end());
    if (name == "elevator") column[600] = std::nan("");
    broken.add(name, column);
  }
  says([&] { track(ShortPeriod{}, broken, start); },
       "column 'elevator' is not a finite number in row 600 (counted from 0); only outputs may be "
       "missing");
  says([&] { track(ShortPeriod{}, twice, start); },
       "time doesn't increase in row 600 (counted from 0); sort the rows, or cut segments there");
  says([&] { track(ShortPeriod{}, record, start, {}, {.shoot = 2.0}); },
       "a track runs on; leave shoot out");
}

}  // namespace track_test
