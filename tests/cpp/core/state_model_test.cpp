// SPDX-License-Identifier: BSD-3-Clause
// What a state model says of itself: rates that start as no number, and where noise enters.
#include "sepcal/states/state_model.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/models/short_period.hpp"
#include "trajectories.hpp"

namespace state_model_test {

using sepcal::FlightPath;
using sepcal::Rate;
using sepcal::ShortPeriod;
using sepcal::Vec;

namespace {

struct NoStates : ShortPeriod {
  static constexpr std::array<sepcal::Quantity, 0> states{};
};

struct NoRate {
  static constexpr auto inputs = ShortPeriod::inputs;
  static constexpr auto states = ShortPeriod::states;
  static constexpr auto outputs = ShortPeriod::outputs;
  static constexpr auto linear = ShortPeriod::linear;
  static constexpr auto nonlinear = ShortPeriod::nonlinear;
  static constexpr auto noise = ShortPeriod::noise;
  sepcal::Affine<double, 3, 3> at(const Vec<double, 2>&, const Vec<double, 2>&,
                                  const Vec<double, 5>&) const {
    return {};
  }
};

static_assert(sepcal::StateModel<ShortPeriod>);
static_assert(sepcal::StateModel<FlightPath>);
static_assert(sepcal::StateModel<sepcal::FlightPathWithPosition>);
static_assert(sepcal::StateModel<sepcal::test::Oscillator>);
static_assert(!sepcal::StateModel<NoStates>);
static_assert(!sepcal::StateModel<NoRate>);

}  // namespace

TEST_CASE("a rate that isn't set is no number") {
  const Rate<double, 3> rate;
  CHECK(rate.array().isNaN().all());
}

TEST_CASE("noise enters at the states that it names, unless the model says otherwise") {
  const auto G = sepcal::noise_input(ShortPeriod{}, Vec<double, 2>(0, 0), Vec<double, 2>(0, 25),
                                     Vec<double, 5>(Vec<double, 5>::Zero()));
  CHECK(G.isIdentity());
}

TEST_CASE("the inertial unit's noise enters a flight path as its readings do") {
  const FlightPath path;
  Vec<double, 6> x;
  x << 50, 2, 5, 0.3, 0.2, 1.0;
  Vec<double, FlightPath::n_u> u = Vec<double, FlightPath::n_u>::Zero();
  u.head<6>() << 0.5, 0.1, -9.7, 0.1, 0.05, -0.02;
  const Vec<double, 6> p = Vec<double, 6>::Constant(0.01);
  const auto G = sepcal::noise_input(path, x, u, p);
  for (int i = 0; i < 6; ++i) {
    Vec<double, FlightPath::n_u> moved = u;
    moved[i] += 0.5;  // f is linear in them
    const Vec<double, 6> column = (path.rate(x, moved, p) - path.rate(x, u, p)) / 0.5;
    CHECK((G.col(i) - column).cwiseAbs().maxCoeff() < 1e-12);
  }
}

}  // namespace state_model_test
