// SPDX-License-Identifier: BSD-3-Clause
// A plain Pitot-static tube in a simulated flight: z = s_va V_met + c_va, and effects at the tube,
// V = V_met (1 + scale) + bias, rho V^2/2 = rho V_met^2/2 + offset, undone by hand.
#include <doctest/doctest.h>
#include <cmath>
#include <functional>

#include "calibrated_flights.hpp"
#include "simulated_flights.hpp"

namespace simulate_pitot_static_test {

namespace {

using namespace sepcal;
using namespace sepcal::test;
using Eigen::ArrayXd;

constexpr double s_va = 0.95, c_va = -0.6;

struct Tube {
  ArrayXd north, east;  // the wind [m/s]
  ArrayXd scale, bias;  // of the airspeed that the tube meets
  ArrayXd offset;       // of its pressure [Pa]
};

using Correction = std::function<void(const SimulatedFlight&, Tube&)>;

/// The reading by hand, at every row.
ArrayXd expect_reading(const SimulatedFlight& flight, const Correction& correct) {
  const ArrayXd zero = ArrayXd::Zero(static_cast<Eigen::Index>(flight.rows()));
  Tube tube{zero - 3.8, zero + 2.4, zero, zero, zero};
  correct(flight, tube);
  const ArrayXd V =
      ((values(flight, "vn_mps") - tube.north).square() +
       (values(flight, "ve_mps") - tube.east).square() + values(flight, "vd_mps").square())
          .sqrt();
  const ArrayXd free = (V - tube.bias) / (1 + tube.scale);
  const ArrayXd met = (free.square() - 2 * tube.offset / values(flight, "rho_kgpm3")).sqrt();
  return s_va * met + c_va;
}

void check_effects(const std::vector<SizedEffect>& effects, const Correction& correct) {
  const SimulatedFlight flight =
      simulate_pitot_static(hiding(quiet(PitotStaticTruth{}), effects), condensed(300));
  const ArrayXd read = values(flight, "airspeed_mps");
  CAPTURE(effects.empty() ? "none" : effects.front().name);
  CHECK((read - expect_reading(flight, correct)).abs().maxCoeff() < 1e-9);
  if (effects.empty()) return;
  const ArrayXd plain = expect_reading(flight, [](const SimulatedFlight&, Tube&) {});
  CHECK((read - plain).abs().maxCoeff() > 1e-3);
}

ArrayXd since_third(const SimulatedFlight& flight) {
  const ArrayXd t = values(flight, "time_s");
  return t - (t[0] + (t[t.size() - 1] - t[0]) / 3);
}

}  // namespace

TEST_CASE("the tube reads the speed through the air, scaled and shifted") {
  check_effects({}, [](const SimulatedFlight&, Tube&) {});
}

TEST_CASE("effects act at the tube") {
  check_effects({{"wind[altitude_m]", {0.05, -0.02}}}, [](const SimulatedFlight& flight, Tube& t) {
    const ArrayXd height = values(flight, "altitude_m") - values(flight, "altitude_m").mean();
    t.north += 0.05 * height;
    t.east -= 0.02 * height;
  });
  check_effects({{"airspeed_scale[flap]", {0.04}}, {"airspeed_bias[current_a]", {-0.03}}},
                [](const SimulatedFlight& flight, Tube& t) {
                  t.scale = 0.04 * values(flight, "flap");
                  t.bias = -0.03 * values(flight, "current_a");
                });
  check_effects({{"propwash", {12.0}}, {"airspeed_scale[q]", {0.1}}},
                [](const SimulatedFlight& flight, Tube& t) {
                  t.offset = 12.0 * values(flight, "throttle");
                  t.scale = 0.1 * values(flight, "q_radps");
                });
  check_effects({{"pressure_offset", {9.0}}},
                [](const SimulatedFlight&, Tube& t) { t.offset += 9.0; });
  check_effects({{"icing_ramp", {-5e-4}}}, [](const SimulatedFlight& flight, Tube& t) {
    t.scale = -5e-4 * since_third(flight).max(0.0);
  });
  check_effects({{"water_blockage", {-0.1}}}, [](const SimulatedFlight& flight, Tube& t) {
    t.scale = (since_third(flight) >= 0.0).select(-0.1, 0.0 * t.scale);
  });
  check_effects({{"density_error", {8.0}}}, [](const SimulatedFlight& flight, Tube& t) {
    t.scale = 8.0 / (2 * values(flight, "temp_k"));
  });
  check_effects({{"compressibility", {4.0}}}, [](const SimulatedFlight& flight, Tube& t) {
    const ArrayXd ratio = values(flight, "dp_pa") / values(flight, "ps_pa");
    const ArrayXd mach = (5 * ((ratio + 1).pow(2.0 / 7.0) - 1)).sqrt();
    const ArrayXd sound = (1.4 * values(flight, "ps_pa") / values(flight, "rho_kgpm3")).sqrt();
    t.scale = 4.0 * (sound * mach / values(flight, "airspeed_mps") - 1);
  });
}

TEST_CASE("a late or a lagging tube") {
  const PitotStaticTruth truth = quiet(PitotStaticTruth{});
  const SimulatedFlight plain = simulate_pitot_static(truth, condensed(6000));
  const SimulatedFlight late =
      simulate_pitot_static(hiding(truth, {{"time_offset", {-0.04}}}), condensed(6000));
  CHECK(worst_difference(plain, late, "airspeed_mps", 2) < 1e-9);  // early
  CHECK(worst_difference(plain, late, "airspeed_mps") > 1e-3);
  CHECK(worst_difference(plain, late, "rho_kgpm3") == 0);
  const SimulatedFlight lagging =
      simulate_pitot_static(hiding(truth, {{"pneumatic_lag", {0.4}}}), condensed(6000));
  const ArrayXd undone = undo_lag(lagging, "airspeed_mps", 0.4);
  const ArrayXd whole = values(plain, "airspeed_mps");
  CHECK((undone - whole.segment(2, undone.size())).abs().maxCoeff() < 1e-4);
  CHECK(worst_difference(plain, lagging, "airspeed_mps") > 0.05);
}

TEST_CASE("only the reading carries noise, and dp agrees with it") {
  PitotStaticTruth truth;
  truth.noise = {0.4};
  const SimulatedFlight noisy = simulate_pitot_static(truth, {.seed = 3});
  const SimulatedFlight clean = simulate_pitot_static(quiet(truth));
  REQUIRE(noisy.rows() == 37001);
  for (const SimulatedColumn& column : noisy.columns) {
    CAPTURE(column.name);
    CHECK((column.values != clean.column(column.name)) ==
          (column.name == "airspeed_mps" || column.name == "dp_pa"));
  }
  const ArrayXd error = values(noisy, "airspeed_mps") - values(clean, "airspeed_mps");
  // 4.5 standard errors each, a chance of 7e-6.
  CHECK(std::abs(error.mean()) < 4.5 * 0.4 / std::sqrt(37001.0));
  CHECK(std::abs(error.square().mean() / 0.16 - 1) < 4.5 * std::sqrt(2 / 37001.0));
  const ArrayXd z = values(noisy, "airspeed_mps");
  CHECK((values(noisy, "dp_pa") - 0.5 * values(noisy, "rho_kgpm3") * z.square()).abs().maxCoeff() <
        1e-10);
}

TEST_CASE("the tube flies where the five-hole probe does") {
  FiveHoleTruth probe = quiet(FiveHoleTruth{});
  probe.parameters["w_d"] = 0;
  const SimulatedFlight one = simulate_five_hole(probe, condensed(200));
  const SimulatedFlight other = simulate_pitot_static(quiet(PitotStaticTruth{}), condensed(200));
  for (const char* name : {"time_s", "roll_rad", "yaw_rad", "p_radps", "vn_mps", "ve_mps", "vd_mps",
                           "ps_pa", "temp_k", "rho_kgpm3", "altitude_m", "throttle", "flap"}) {
    CHECK(worst_difference(one, other, name) == 0);
  }
  CHECK(other.truth == PitotStaticTruth{}.parameters);
  CHECK(one.maneuver == other.maneuver);
}

TEST_CASE("a tube that can't read is refused") {
  const auto refuse = [](const char* name, double value, const char* word) {
    PitotStaticTruth truth;
    truth.parameters[name] = value;
    check_refused([&] { simulate_pitot_static(truth, condensed(20)); }, {word, "choose"});
  };
  refuse("s_va", 0.0, "s_va = 0");
  refuse("s_va", -1.0, "s_va = -1");
  refuse("c_va", -40.0, "c_va");
  PitotStaticTruth truth;
  truth.parameters["w_x"] = 1;
  check_refused([&] { simulate_pitot_static(truth, condensed(20)); }, {"'w_x'", "s_va"});
  truth = {};
  truth.noise = {-1};
  check_refused([&] { simulate_pitot_static(truth, condensed(20)); }, {"airspeed noise -1"});
  for (const SizedEffect& effect : {SizedEffect{"airspeed_bias[throttle]", {90.0}},
                                    SizedEffect{"pressure_offset[throttle]", {3000.0}},
                                    SizedEffect{"airspeed_scale[flap]", {-2.0}}}) {
    check_refused(
        [&] { simulate_pitot_static(hiding(PitotStaticTruth{}, {effect}), condensed(50)); },
        {"nothing to read", "smaller"});
  }
}

}  // namespace simulate_pitot_static_test
