// SPDX-License-Identifier: BSD-3-Clause
// Recursive maximum likelihood: at a theta that stays the pass is the batch's; along flights of a
// short period that nobody has fitted whole it ends where filter error does.
#include "sepcal/states/recursive_likelihood.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/short_period.hpp"
#include "sepcal/states/track.hpp"
#include "short_periods.hpp"

namespace recursive_likelihood_test {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::FitMethod;
using sepcal::FitOptions;
using sepcal::Record;
using sepcal::RecursiveLikelihood;
using sepcal::ShortPeriod;
using sepcal::StateRow;
using sepcal::StreamStart;
using sepcal::Track;
using sepcal::TrackMethod;
using sepcal::TrajectoryModel;
using sepcal::TriangularFactor;
using sepcal::test::fly_short_period;
using sepcal::test::ShortPeriodFlight;

using Likelihood = RecursiveLikelihood<ShortPeriod>;

Record stirred(std::uint64_t seed) {
  ShortPeriodFlight flight;
  flight.process_noise = {0.003, 0.09};
  flight.seed = seed;
  return fly_short_period(flight);
}

StateRow<ShortPeriod> row_of(const Record& record, std::size_t k) {
  StateRow<ShortPeriod> row;
  row.time = record.column("time")[k];
  row.u = {record.column("elevator")[k], record.column("airspeed")[k]};
  return row;
}

Eigen::Vector3d readings_of(const Record& record, std::size_t k) {
  return {record.column("alpha_m")[k], record.column("q_m")[k], record.column("az_m")[k]};
}

/// b_alpha b_q b_az Za Ma Mq Zd Md alpha_0 q_0 ln q (2) ln r (3), as the model's tables have them.
Likelihood::Theta truth() {
  Likelihood::Theta theta;
  theta << 0.02, -0.01, 0.5, -4, -40, -5, -0.35, -45, 0.01, -0.05, std::log(0.003), std::log(0.09),
      std::log(0.005), std::log(0.01), std::log(0.15);
  return theta;
}

/// Of each of these, its place in the tables of a trajectory.
const std::vector<Index> in_trajectory{0, 1, 2, 7, 8, 9, 3, 4, 5, 6, 10, 11, 12, 13, 14};

Likelihood start_at(const Likelihood::Theta& theta, const Likelihood::Root& R) {
  const Likelihood::Theta bound = Likelihood::Theta::Constant(1e3);
  return {{}, theta, R, -bound, bound, Likelihood::Free::Constant(true)};
}

FitOptions by_filter_error() {
  FitOptions options;
  options.method = FitMethod::filter_error;
  return options;
}

}  // namespace

TEST_CASE("at a theta that stays the recursion is the batch's pass") {
  const Record record = stirred(3);
  const TrajectoryModel<ShortPeriod> model(ShortPeriod(), record);
  const auto batch = model.innovations(record);
  const Likelihood::Theta theta = 1.02 * truth();
  VectorXd whole(theta.size());
  for (Index i = 0; i < theta.size(); ++i) {
    whole[in_trajectory[static_cast<std::size_t>(i)]] = theta[i];
  }
  TriangularFactor factor(static_cast<int>(theta.size()) + 1);
  const double cost =
      batch->scores(whole, [&](std::size_t, MatrixXd& rows) { factor.absorb(rows); }).cost;
  Likelihood stream = start_at(theta, Likelihood::Root::Zero());
  for (std::size_t k = 0; k < record.length(); ++k) {
    if (k > 0) stream.predict(row_of(record, k - 1), row_of(record, k));
    stream.update(row_of(record, k).u, readings_of(record, k));
  }
  CHECK(std::abs(stream.recursion().cost() - cost) <= 1e-12 * std::abs(cost));
  const Index n = theta.size();
  const MatrixXd T = factor.matrix().topLeftCorner(n, n);
  const MatrixXd information = (T.transpose() * T)(in_trajectory, in_trajectory);
  const Likelihood::Root R = stream.recursion().information_root();
  const MatrixXd recursive = R.transpose() * R;
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < n; ++k) {
      const double scale = std::sqrt(information(i, i) * information(k, k));
      CHECK(std::abs(recursive(i, k) - information(i, k)) <= 1e-12 * scale);
    }
  }
}

TEST_CASE("from the first rows' fit a track by rml ends where filter error of all rows does" *
          doctest::test_suite("slow")) {
  double worst = 0.0;
  int held = 0;
  int of = 0;
  const std::map<std::string, double> true_values{
      {"Za", -4},    {"Ma", -40},     {"Mq", -5},       {"Md", -45},
      {"q_q", 0.09}, {"r_q_m", 0.01}, {"r_az_m", 0.15}, {"b_alpha", 0.02}};
  for (std::uint64_t seed = 20; seed < 30; ++seed) {
    const Record record = stirred(seed);
    const StreamStart start =
        sepcal::start_from_rows(ShortPeriod(), record, 400, by_filter_error());
    const Track track = sepcal::track(ShortPeriod(), record, start, {.method = TrackMethod::rml});
    CHECK(track.refused == 0);
    const sepcal::Fit whole =
        sepcal::fit(TrajectoryModel<ShortPeriod>(ShortPeriod(), record), record, by_filter_error());
    const Index last = track.estimates.rows() - 1;
    for (const auto& [name, true_value] : true_values) {
      CAPTURE(name);
      const auto place = std::ranges::find(track.names, name) - track.names.begin();
      const double value = track.estimates(last, place);
      const double sd = track.standard_deviations(last, place);
      REQUIRE(sd > 0.0);
      held += std::abs(value - true_value) < 1.96 * sd ? 1 : 0;
      ++of;
      const auto at = std::ranges::find(whole.noise_sizes, name, &sepcal::NoiseSize::name);
      const double batch = at == whole.noise_sizes.end() ? whole[name].value : at->value;
      worst = std::max(worst, std::abs(value - batch) / sd);
    }
  }
  CHECK(worst < 1.5);  // standard errors
  CHECK(held >= 68);  // of 80: 95 % hold, and fewer with a chance of 1e-4 were flights' independent
  CHECK(of == 80);
}

TEST_CASE("rml says what it has nothing to begin with") {
  const Record record = stirred(4);
  const StreamStart start = sepcal::start_from_rows(ShortPeriod(), record, 400);
  CHECK_THROWS_WITH_AS(
      sepcal::track(ShortPeriod(), record, start, {.method = TrackMethod::rml}),
      "rml has no size of the process noise 'alpha' to begin with: start by filter error, or give "
      "it",
      sepcal::Error);
}

}  // namespace recursive_likelihood_test
