// SPDX-License-Identifier: BSD-3-Clause
// The corrected log: what was there to the byte, numbers that a perfect sensor gives, empty cells
// where there is nothing to correct.
#include "sepcal/flight/apply.hpp"

#include <cmath>

#include "calibrated_flights.hpp"
#include "temporary_folder.hpp"

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
      "1050,1000,20,-25,1\n"
      "1000,1000,20,-25,1\n");
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
  CHECK(text.ends_with("1000,1000,20,-25,1,,,\n"));

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
  check_kept("mx_ut,my_ut,mz_ut\n1,2,x\n", {"flight.csv line 2", "'mz_ut'", "drop_invalid drops"});
  check_kept("mx_ut,my_ut,mz_ut\n1,2,3\n4,5\n", {"flight.csv line 3", "2 cells"});
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
