// SPDX-License-Identifier: BSD-3-Clause
// Flight path reconstruction as a stream: biases of the inertial unit against time, from the first
// third of a flight whose motion is written down; with all states integrated, and with the heading
// measured.
#include <doctest/doctest.h>

#include <cmath>

#include "flight_paths.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/states/track.hpp"

namespace track_flight_path_test {

using Eigen::Index;
using sepcal::FitOptions;
using sepcal::FlightPath;
using sepcal::Record;
using sepcal::Track;
using sepcal::TrackMethod;
using sepcal::TrackOptions;
using sepcal::TrajectoryModel;
using sepcal::TrajectoryOptions;
using sepcal::test::write_flight;

namespace {

const std::map<std::string, double> errors{{"b_ax", 0.15},    {"b_ay", -0.1},  {"b_az", 0.2},
                                           {"b_p", 0.002},    {"b_q", -0.003}, {"b_r", 0.0015},
                                           {"lambda_v", 0.03}};

void check_end(const Track& found) {
  CHECK(found.refused == 0);
  for (std::size_t k = 0; k < found.names.size(); ++k) {
    const auto expected = errors.find(found.names[k]);
    if (expected == errors.end()) continue;
    const auto at = static_cast<Index>(k);
    const Index last = found.estimates.rows() - 1;
    const double sd = found.standard_deviations(last, at);
    INFO(found.names[k] << " " << found.estimates(last, at) << " +- " << sd);
    CHECK(std::abs(found.estimates(last, at) - expected->second) < 4.0 * sd);
    CHECK(sd < found.standard_deviations(0, at));
  }
}

}  // namespace

TEST_CASE("flight path reconstruction runs along a record from its first third") {
  const Record record = write_flight({}, 1500, 0.02, errors, 1.0);
  for (const bool measured : {false, true}) {
    TrajectoryOptions trajectory{.outputs = {"airspeed", "alpha", "beta", "roll", "pitch"}};
    (measured ? trajectory.measured : trajectory.outputs).emplace_back(measured ? "psi" : "yaw");
    Record logged = record;
    const auto yaw = record.column("yaw");
    logged.add("psi", {yaw.begin(), yaw.end()});
    const TrajectoryModel<FlightPath> model({}, sepcal::first_rows(logged, 500), trajectory);
    FitOptions fit;
    fit.coloured_errors = false;
    fit.start = model.initial_states(logged);
    fit.fix = {{"b_v", 0.0}, {"b_alpha", 0.0}, {"b_beta", 0.0}};
    if (!measured) fit.fix["b_psi"] = 0.0;
    fit.method = sepcal::FitMethod::filter_error;
    fit.process_noise = {{"ax", 1e-3}, {"ay", 1e-3}, {"az", 1e-3},
                         {"p", 1e-5},  {"q", 1e-5},  {"r", 1e-5}};
    const auto start = sepcal::start_from_rows(FlightPath{}, logged, 500, fit, trajectory);
    for (const TrackMethod method : {TrackMethod::ekf, TrackMethod::iekf}) {
      CAPTURE(measured);
      TrackOptions options{.method = method};
      options.process_noise = fit.process_noise;
      const Track found = sepcal::track(FlightPath{}, logged, start, options, trajectory);
      CHECK(found.estimates.rows() == 1000);
      check_end(found);
    }
  }
}

}  // namespace track_flight_path_test
