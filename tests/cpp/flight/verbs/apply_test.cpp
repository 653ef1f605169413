// SPDX-License-Identifier: BSD-3-Clause
// The corrected log: what was there to the byte, numbers that a perfect sensor gives, empty cells
// where there is nothing to correct.
#include "sepcal/flight/apply.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "flights_with_effects.hpp"
#include "temporary_folder.hpp"

namespace apply_test {

using namespace sepcal;
using namespace sepcal::test;

namespace {

/// Without errors: airspeed sqrt(2 (pt - ps) / rho), alpha and beta as read.
Calibration make_perfect_probe() {
  std::map<std::string, double> zero = FiveHoleTruth{}.parameters;
  for (auto& [name, value] : zero) value = 0.0;
  return make_calibration(five_hole_probe(4.0, 5.0, {0, 0, 0}), zero);
}

/// C = diag(2, 4, 1), n = (1, 2, 3) uT.
Calibration make_scaled_magnetometer() {
  std::map<std::string, double> values = MagnetometerTruth{}.parameters;
  for (auto& [name, value] : values) value = 0.0;
  values["lambda_x"] = 1.0;
  values["lambda_y"] = 3.0;
  values["n_x"] = 1.0;
  values["n_y"] = 2.0;
  values["n_z"] = 3.0;
  return make_calibration(magnetometer_probe(std::nullopt), values);
}

/// A five-hole probe whose one effect is `effect`, at the values of a simulated flight.
Calibration calibrate_hidden(const char* probe, const SizedEffect& effect) {
  return calibrate_with(probe, fly(probe, {effect}, {.noise = 1e-6, .seed = 2}), {effect.name});
}

SimulatedFlight without(SimulatedFlight flight, const std::vector<std::string>& columns) {
  std::erase_if(flight.columns, [&](const SimulatedColumn& column) {
    return std::ranges::find(columns, column.name) != columns.end();
  });
  return flight;
}

/// The largest difference between two flights' first corrected columns.
double difference(const Calibration& calibration, const SimulatedFlight& one,
                  const SimulatedFlight& other) {
  const auto a = apply(calibration, make_flight(one));
  const auto b = apply(calibration, make_flight(other));
  double worst = 0.0;
  for (std::size_t row = 0; row < one.rows(); ++row) {
    worst = std::max(worst, std::abs(a[0].values[row] - b[0].values[row]));
  }
  return worst;
}

}  // namespace

TEST_CASE("columns and rows are copied as they stand, the corrected ones come after them") {
  const TemporaryFolder folder;
  const std::string log = folder.write(
      "\xEF\xBB\xBFmz_ut, \"mx_ut\",note,my_nt\r\n"
      "3.50,1.0 ,\"a, \"\"b\"\"\",2000\r\n"
      " 4,5,,1e4");
  const std::string corrected = (folder.path() / "corrected.csv").string();
  const Applied applied = apply_to_file(make_scaled_magnetometer(), log, corrected);
  CHECK(applied.rows == 2);
  CHECK(applied.rows_left_empty == 0);
  CHECK(applied.headers == std::vector<std::string>{"mx_cal_ut", "my_cal_ut", "mz_cal_ut"});
  CHECK(read_bytes(corrected) ==
        "mz_ut, \"mx_ut\",note,my_nt,mx_cal_ut,my_cal_ut,mz_cal_ut\n"
        "3.50,1.0 ,\"a, \"\"b\"\"\",2000,0,0,0.5\n"
        " 4,5,,1e4,2,2,1\n");
}

TEST_CASE("rows without a correction get empty cells and are counted") {
  const TemporaryFolder folder;
  const std::string log = folder.write(
      "pt_pa,ps_pa,dpa_pa,dpb_pa,rho_kgpm3\n"
      "90050,90000,20,-25,1\n"
      "90000,90000,20,-25,1\n");
  const std::string corrected = (folder.path() / "corrected.csv").string();
  const Applied applied = apply_to_file(make_perfect_probe(), log, corrected);
  CHECK(applied.rows == 2);
  CHECK(applied.rows_left_empty == 1);
  CHECK(applied.notes.size() == 1);
  const Flight flight = read_csv(corrected);
  CHECK(flight.find("airspeed_cal_mps")->values[0] == doctest::Approx(10.0).epsilon(1e-14));
  CHECK(flight.find("alpha_cal_rad")->values[0] == doctest::Approx(0.1).epsilon(1e-14));
  CHECK(flight.find("beta_cal_rad")->values[0] == doctest::Approx(-0.1).epsilon(1e-14));
  const std::string text = read_bytes(corrected);
  CHECK(text.ends_with("90000,90000,20,-25,1,,,\n"));

  const auto columns = apply(make_perfect_probe(), read_csv(log));
  REQUIRE(columns.size() == 3);
  CHECK(columns[0].header == "airspeed_cal_mps");
  CHECK(columns[0].values[0] == doctest::Approx(10.0).epsilon(1e-14));
  CHECK(std::isnan(columns[0].values[1]));
}

TEST_CASE("whatever is refused leaves the output as it was") {
  const TemporaryFolder folder;
  const Calibration calibration = make_scaled_magnetometer();
  const std::string output = folder.write("old", "corrected.csv");
  const auto check_kept = [&](std::string_view bytes,
                              std::initializer_list<std::string_view> words) {
    const std::string log = folder.write(bytes);
    check_refused([&] { apply_to_file(calibration, log, output); }, words);
    CHECK(read_bytes(output) == "old");
  };
  check_kept("mx_ut,my_ut\n1,2\n", {"flight.csv", "'mz_ut' is missing", "the file has: mx_ut"});
  check_kept("mx_ut,my_ut,mz_ut\n1,2,x\n4,5,6\n",
             {"flight.csv line 2", "'mz_ut'", "drop_invalid drops"});
  check_kept("mx_ut,my_ut,mz_ut\n1,2,x\n", {"flight.csv line 2", "none in any of 1 rows"});
  check_kept("mx_ut,my_ut,mz_ut\n1,2,3\n4,5\n6,7,8\n", {"flight.csv line 3", "2 cells"});
  check_kept("mx_ut,my_ut,mz_ut,my_cal_ut\n1,2,3,4\n", {"'my_cal_ut' already", "original log"});
  check_refused([&] { apply_to_file(calibration, "nowhere.csv", output); },
                {"nowhere.csv", "no such file"});
  const std::string log = folder.write("mx_ut,my_ut,mz_ut\n1,2,3\n");
  check_refused([&] { apply_to_file(calibration, log, log); }, {log, "name another file"});
  check_refused([&] { apply_to_file(calibration, log, (folder.path() / "x" / "y").string()); },
                {"isn't there", "make it first"});
  CHECK(read_bytes(output) == "old");
}

TEST_CASE("progress is told while the log is read") {
  const TemporaryFolder folder;
  const std::string log = folder.write("mx_ut,my_ut,mz_ut\n1,2,3\n");
  double last = 0.0;
  apply_to_file(make_scaled_magnetometer(), log, (folder.path() / "corrected.csv").string(),
                [&](double fraction) { last = fraction; });
  CHECK(last == 1.0);
}

TEST_CASE("a row in which a driver is no number is left empty and counted") {
  const Calibration calibration = calibrate_hidden("five-hole", {"airspeed_bias[flap]", {0.7}});
  SimulatedFlight flight = fly("five-hole", {{"airspeed_bias[flap]", {0.7}}});
  const auto flap = std::ranges::find(flight.columns, "flap", &SimulatedColumn::name);
  flap->values[7] = not_a_number;
  const auto columns = apply(calibration, make_flight(flight));
  for (const CorrectedColumn& column : columns) {
    REQUIRE(column.values.size() == flight.rows());
    for (std::size_t row = 0; row < flight.rows(); ++row) {
      CHECK(std::isnan(column.values[row]) == (row == 7));
    }
  }
  const TemporaryFolder folder;
  const std::string log = folder.write("");
  std::ofstream stream(log);
  write_csv(flight, stream);
  stream.close();
  const Applied applied =
      apply_to_file(calibration, log, (folder.path() / "corrected.csv").string());
  CHECK(applied.rows == flight.rows());
  CHECK(applied.rows_left_empty == 1);
}

TEST_CASE("a driver that isn't logged is an error that names the effect and the column") {
  const SimulatedFlight air = fly("five-hole", {});
  const auto refused = [](const Calibration& calibration, const SimulatedFlight& flight,
                          std::initializer_list<std::string_view> words) {
    check_refused([&] { apply(calibration, make_flight(flight)); }, words);
  };
  refused(calibrate_hidden("five-hole", {"airspeed_bias[flap]", {0.7}}), without(air, {"flap"}),
          {"flight: ", "effect airspeed_bias[flap] needs flap, which is not logged",
           "the flight has: time_s"});
  refused(calibrate_hidden("five-hole", {"upwash", {0.4}}), without(air, {"q_radps"}),
          {"effect upwash needs q, which is not logged"});
  refused(calibrate_hidden("five-hole", {"density_error", {5.0}}), without(air, {"temp_k"}),
          {"effect density_error needs temperature"});
  refused(calibrate_hidden("magnetometer", {"bias_step", {2.0}}),
          without(fly("magnetometer", {}), {"time_s"}), {"effect bias_step needs time"});
}

TEST_CASE("effects on the world need no driver and change no reading") {
  for (const SizedEffect& effect : {SizedEffect{"wind[altitude_m]", {0.01}},
                                    {"heading_bias", {0.03}},
                                    {"lever_arm", {0.1, 0.2, -0.3}}}) {
    CAPTURE(effect.name);
    Calibration calibration = calibrate_hidden("five-hole", effect);
    const SimulatedFlight flight = fly("five-hole", {});
    const std::vector<std::string> readings{"pt_pa", "ps_pa", "dpa_pa", "dpb_pa", "rho_kgpm3"};
    SimulatedFlight bare = flight;
    std::erase_if(bare.columns, [&](const SimulatedColumn& column) {
      return std::ranges::find(readings, column.name) == readings.end();
    });
    CHECK(difference(calibration, flight, bare) == 0.0);
    calibration.options.effects.clear();
    CHECK(difference(calibration, flight, flight) == 0.0);
  }
  const Calibration turned = calibrate_hidden("magnetometer", {"field_declination", {0.05}});
  const SimulatedFlight flight = fly("magnetometer", {});
  SimulatedFlight bare = flight;
  std::erase_if(bare.columns, [](const auto& column) { return !column.name.starts_with('m'); });
  CHECK(difference(turned, flight, bare) == 0.0);
}

TEST_CASE("drivers that aren't columns of their own are computed") {
  const SizedEffect loss{"airspeed_scale[alpha^2]", {-0.8}};
  const SizedEffect propwash{"pressure_offset[throttle]", {20.0}};
  const SimulatedFlight lossy = fly("five-hole", {loss});
  const auto columns = apply(calibrate_hidden("five-hole", loss), make_flight(lossy));
  const auto truth = true_readings("five-hole", {loss}, {});
  CHECK(std::abs(columns[0].values[200] - truth[0][200]) < 1e-5);
  // The density from temperature and static pressure: the simulator's air is a perfect gas.
  const SimulatedFlight tube = fly("pitot-static", {propwash});
  CHECK(difference(calibrate_hidden("pitot-static", propwash), tube, without(tube, {"rho_kgpm3"})) <
        1e-4);
}

TEST_CASE("a field's rate comes from the body rates or, without them, from the readings") {
  const SizedEffect eddy{"eddy_currents", {0.002}};
  const Calibration calibration = calibrate_hidden("magnetometer", eddy);
  const Conditions fast{.rows = 1600};
  const SimulatedFlight flight = fly("magnetometer", {eddy}, fast);
  const auto truth = true_readings("magnetometer", {eddy}, fast);
  const auto worst = [&](const SimulatedFlight& log) {
    const auto columns = apply(calibration, make_flight(log));
    double most = 0.0;
    for (std::size_t row = 0; row < log.rows(); ++row) {
      const double error = columns[0].values[row] - truth[0][static_cast<Eigen::Index>(row)];
      most = std::max(most, std::abs(error));
    }
    return most;
  };
  CHECK(worst(flight) < 1e-5);
  // By differences over 0.05 s: a natural spline's slope at a segment's ends is off by 0.1 uT/s.
  CHECK(worst(without(flight, {"p_radps", "q_radps", "r_radps"})) < 2e-3);
}

}  // namespace apply_test
