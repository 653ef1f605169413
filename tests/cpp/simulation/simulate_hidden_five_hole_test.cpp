// SPDX-License-Identifier: BSD-3-Clause
// Effects hidden in a five-hole probe's flight: the wind triangle closes again once the effect is
// undone by its definition, written out by hand on the logged columns.
#include <doctest/doctest.h>
#include <cmath>
#include <functional>

#include "numerics/decompositions.hpp"
#include "simulated_flights.hpp"

namespace simulate_hidden_five_hole_test {

namespace {

using namespace sepcal;
using namespace sepcal::test;

/// One row as it was logged, and what a correction of it may change.
struct Row {
  const SimulatedFlight& flight;
  std::size_t k;
  double v;            // as read, sqrt(2 (pt - ps)/rho)
  double alpha, beta;  // as read
  Vector3d wind, lever_arm;
  double gain = 0;   // of v beside 1 + lambda_va
  double extra = 0;  // joins the airspeed
  double late_yaw = 0;
  Matrix3d mounting = Matrix3d::Identity();

  double operator()(const char* name) const { return at(flight, name, k); }
};

using Correction = std::function<void(Row&)>;

/// Eqs. 36-41 by hand, with the correction: the ground velocity of one row.
Vector3d ground_velocity(const SimulatedFlight& flight, std::size_t k, const FiveHoleTruth& truth,
                         const Correction& correct) {
  const auto x = [&](const char* name) { return truth.parameters.at(name); };
  const double impact = at(flight, "pt_pa", k) - at(flight, "ps_pa", k);
  Row row{flight,
          k,
          std::sqrt(2 * impact / at(flight, "rho_kgpm3", k)),
          at(flight, "dpa_pa", k) / (truth.k_alpha * impact),
          at(flight, "dpb_pa", k) / (truth.k_beta * impact),
          {x("w_n"), x("w_e"), x("w_d")},
          Vector3d(truth.lever_arm.data())};
  correct(row);
  const double alpha = (1 + x("lambda_alpha")) * row.alpha + x("b_alpha");
  const double beta = (1 + x("lambda_beta")) * row.beta + x("b_beta");
  const double airspeed = (1 + x("lambda_va") + row.gain) * row.v + x("b_va") + row.extra;
  const double c = std::cos(x("eps_phi")), s = std::sin(x("eps_phi"));
  const Matrix3d probe_to_body = (Matrix3d() << 1, 0, 0, 0, c, s, 0, -s, c).finished();
  const Vector3d direction(std::cos(alpha) * std::cos(beta), std::sin(beta),
                           std::sin(alpha) * std::cos(beta));
  const Vector3d body = airspeed * row.mounting * probe_to_body * direction -
                        at(flight, rates, k).cross(row.lever_arm);
  const double cy = std::cos(row.late_yaw), sy = std::sin(row.late_yaw);
  const Matrix3d turn_back = (Matrix3d() << cy, sy, 0, -sy, cy, 0, 0, 0, 1).finished();
  return turn_back * body_to_ned(flight, k) * body + row.wind;
}

void check_effects(const std::vector<SizedEffect>& effects, const Correction& correct) {
  const FiveHoleTruth truth = quiet(FiveHoleTruth{});
  for (const SimulationOptions& options : {condensed(300), SimulationOptions{.rate = 1.0}}) {
    const SimulatedFlight flight = simulate_five_hole(hiding(truth, effects), options);
    double worst = 0, uncorrected = 0;
    for (std::size_t k = 0; k < flight.rows(); ++k) {
      const Vector3d logged = at(flight, velocity, k);
      worst = std::max(worst, (ground_velocity(flight, k, truth, correct) - logged).norm());
      uncorrected =
          std::max(uncorrected, (ground_velocity(flight, k, truth, [](Row&) {}) - logged).norm());
    }
    CAPTURE(effects.front().name);
    CHECK(worst < 1e-9);
    CHECK(uncorrected > 3e-3);  // the effect is at work
  }
}

double mean_of(const SimulatedFlight& flight, const char* name) {
  return values(flight, name).mean();
}

/// Seconds since a third of the record, or a negative number before.
double since_third(const Row& row) {
  const auto& t = row.flight.column("time_s");
  return row("time_s") - (t.front() + (t.back() - t.front()) / 3);
}

}  // namespace

TEST_CASE("the wind follows its driver") {
  check_effects({{"wind[altitude_m]", {0.05, -0.02}}}, [](Row& row) {
    const double height = row("altitude_m") - mean_of(row.flight, "altitude_m");
    row.wind += Vector3d(0.05 * height, -0.02 * height, 0);
  });
  check_effects({{"wind_drift", {0.01}}}, [](Row& row) {
    const double later = row("time_s") - mean_of(row.flight, "time_s");
    row.wind += Vector3d(0.01 * later, 0.01 * later, 0);
  });
  check_effects({{"wind[alpha]", {2.0, 1.0}}},
                [](Row& row) { row.wind += Vector3d(2 * row.alpha, row.alpha, 0); });
}

TEST_CASE("the airspeed has a scale and a bias that follow their drivers") {
  check_effects({{"airspeed_scale[alpha^2]", {-3.0}}},
                [](Row& row) { row.gain = -3.0 * row.alpha * row.alpha; });
  check_effects({{"airspeed_scale[beta^2]", {5.0}}},
                [](Row& row) { row.gain = 5.0 * row.beta * row.beta; });
  check_effects({{"airspeed_scale[flap]", {0.03}}},
                [](Row& row) { row.gain = 0.03 * row("flap"); });
  check_effects({{"airspeed_bias[current_a]", {-0.05}}},
                [](Row& row) { row.extra = -0.05 * row("current_a"); });
  check_effects({{"icing_ramp", {-2e-4}}},
                [](Row& row) { row.gain = -2e-4 * std::max(since_third(row), 0.0); });
  check_effects({{"water_blockage", {-0.05}}},
                [](Row& row) { row.gain = since_third(row) >= 0 ? -0.05 : 0.0; });
}

TEST_CASE("a pressure offset changes the airspeed as read, not the angles") {
  check_effects({{"propwash", {-20.0}}}, [](Row& row) {
    row.v = std::sqrt(row.v * row.v - 2 * 20.0 * row("throttle") / row("rho_kgpm3"));
  });
  check_effects({{"pressure_offset[temp_k]", {30.0}}}, [](Row& row) {
    const double warmth = row("temp_k") - mean_of(row.flight, "temp_k");
    row.v = std::sqrt(row.v * row.v + 2 * 30.0 * warmth / row("rho_kgpm3"));
  });
}

TEST_CASE("the flow angles are off by what their drivers say, themselves among them") {
  check_effects({{"alpha_offset[q]", {0.05}}},
                [](Row& row) { row.alpha += 0.05 * row("q_radps"); });
  check_effects({{"alpha_offset[alpha^2]", {0.8}}},
                [](Row& row) { row.alpha += 0.8 * row.alpha * row.alpha; });
  check_effects({{"alpha_offset[beta]", {0.3}}, {"beta_offset[alpha]", {-0.2}}}, [](Row& row) {
    const double alpha = row.alpha;
    row.alpha += 0.3 * row.beta;
    row.beta -= 0.2 * alpha;
  });
  check_effects({{"upwash", {0.4}}}, [](Row& row) { row.alpha += 0.4 * row("q_radps") / row.v; });
  check_effects({{"sidewash", {-0.3}}}, [](Row& row) { row.beta -= 0.3 * row("p_radps") / row.v; });
}

TEST_CASE("heading, lever arm and mounting") {
  check_effects({{"heading_bias", {0.03}}}, [](Row& row) { row.late_yaw = 0.03; });
  check_effects({{"lever_arm", {0.2, -0.1, 0.3}}},
                [](Row& row) { row.lever_arm += Vector3d(0.2, -0.1, 0.3); });
  check_effects({{"mounting_error", {0.04, -0.03}}}, [](Row& row) {
    const double cp = std::cos(0.04), sp = std::sin(0.04);
    const double cy = std::cos(-0.03), sy = std::sin(-0.03);
    const Matrix3d pitch = (Matrix3d() << cp, 0, sp, 0, 1, 0, -sp, 0, cp).finished();
    const Matrix3d yaw = (Matrix3d() << cy, -sy, 0, sy, cy, 0, 0, 0, 1).finished();
    row.mounting = yaw * pitch;
  });
}

TEST_CASE("the density may be another, and air can be compressed") {
  check_effects({{"density_error", {6.0}}},
                [](Row& row) { row.v *= 1 + 6.0 / (2 * row("temp_k")); });
  check_effects({{"compressibility", {3.0}}}, [](Row& row) {
    const double ratio = (row("pt_pa") - row("ps_pa")) / row("ps_pa");
    const double mach = std::sqrt(5 * (std::pow(ratio + 1, 2.0 / 7.0) - 1));
    row.gain = 3.0 * (std::sqrt(1.4 * row("ps_pa") / row("rho_kgpm3")) * mach / row.v - 1);
  });
}

TEST_CASE("a spline over alpha as read ends at its last coefficient") {
  const std::vector<double> heights{0.004, -0.002, 0.006, 0.002};
  for (const char* port : {"airspeed_scale", "alpha_offset"}) {
    const SizedEffect effect{std::string(port) + "[spline(alpha,5)]", heights};
    const FiveHoleTruth truth = quiet(FiveHoleTruth{});
    const SimulatedFlight flight = simulate_five_hole(hiding(truth, {effect}), condensed(300));
    const Eigen::ArrayXd alpha = values(flight, "dpa_pa") / truth.k_alpha /
                                 (values(flight, "pt_pa") - values(flight, "ps_pa"));
    Eigen::Index lowest = 0, highest = 0;
    alpha.minCoeff(&lowest);
    alpha.maxCoeff(&highest);
    const auto check = [&](Eigen::Index k, double height) {
      const auto correct = [&](Row& row) {
        if (std::string(port) == "airspeed_scale") row.gain = height;
        if (std::string(port) == "alpha_offset") row.alpha += height;
      };
      const auto row = static_cast<std::size_t>(k);
      CHECK((ground_velocity(flight, row, truth, correct) - at(flight, velocity, row)).norm() <
            1e-9);
    };
    CAPTURE(effect.name);
    check(lowest, 0.0);
    check(highest, 0.002);
  }
}

TEST_CASE("effects work together") {
  check_effects({{"wind[altitude_m]", {0.05}},
                 {"pressure_offset[throttle]", {15.0}},
                 {"airspeed_scale[alpha^2]", {-3.0}},
                 {"airspeed_bias[flap]", {0.4}},
                 {"alpha_offset[current_a]", {0.001}},
                 {"heading_bias", {-0.02}}},
                [](Row& row) {
                  const double height = row("altitude_m") - mean_of(row.flight, "altitude_m");
                  row.wind += Vector3d(0.05 * height, 0.05 * height, 0);
                  row.gain = -3.0 * row.alpha * row.alpha;
                  row.extra = 0.4 * row("flap");
                  row.alpha += 0.001 * row("current_a");
                  row.late_yaw = -0.02;
                  row.v = std::sqrt(row.v * row.v + 2 * 15.0 * row("throttle") / row("rho_kgpm3"));
                });
}

TEST_CASE("late air data are those of before; the navigation is not late") {
  const FiveHoleTruth truth = quiet(FiveHoleTruth{});
  const SimulationOptions options{.rate = 50.0};
  const SimulatedFlight plain = simulate_five_hole(truth, options);
  const SimulatedFlight late =
      simulate_five_hole(hiding(truth, {{"time_offset", {0.08}}}), options);
  for (const char* name : {"pt_pa", "ps_pa", "dpa_pa", "dpb_pa", "rho_kgpm3"}) {
    CAPTURE(name);
    CHECK(worst_difference(late, plain, name, 4) < 1e-7);
    CHECK(worst_difference(late, plain, name) > 1e-6);
  }
  for (const char* name : {"time_s", "roll_rad", "yaw_rad", "q_radps", "vn_mps", "altitude_m"}) {
    CHECK(worst_difference(late, plain, name) == 0);
  }
}

TEST_CASE("lagging pressures keep their equation") {
  const FiveHoleTruth truth = quiet(FiveHoleTruth{});
  const SimulatedFlight plain = simulate_five_hole(truth, condensed(24000));
  const double tau = 0.15;
  const SimulatedFlight lagging =
      simulate_five_hole(hiding(truth, {{"pneumatic_lag", {tau}}}), condensed(24000));
  for (const char* name : {"pt_pa", "ps_pa", "dpa_pa", "dpb_pa"}) {
    CAPTURE(name);
    const Eigen::ArrayXd undone = undo_lag(lagging, name, tau);
    CHECK((undone - values(plain, name).segment(2, undone.size())).abs().maxCoeff() < 1e-3);
    CHECK(worst_difference(lagging, plain, name) > 1.0);
  }
  CHECK(worst_difference(lagging, plain, "rho_kgpm3") == 0);
  CHECK(worst_difference(lagging, plain, "vn_mps") == 0);
}

}  // namespace simulate_hidden_five_hole_test
