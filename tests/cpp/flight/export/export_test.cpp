// SPDX-License-Identifier: BSD-3-Clause
// Exports of calibrations whose numbers are plain: the autopilots' parameters by hand, the rotation
// that a symmetric matrix leaves, refusals, and a file that appears whole or not at all.
#include "sepcal/flight/export.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <filesystem>

#include "calibrated_flights.hpp"
#include "flight/export/polar.hpp"
#include "temporary_folder.hpp"

namespace export_test {

using namespace sepcal;
using namespace sepcal::test;

namespace {

/// C = diag(1.25, 0.8, 1) unless others are given, n = (10, -20, 30) uT, against the field's
/// strength.
Calibration make_magnetometer(const std::array<double, 3>& lambda = {0.25, -0.2, 0.0}) {
  return make_calibration(attitude_independent_probe(50.0), {{"lambda_x", lambda[0]},
                                                             {"lambda_y", lambda[1]},
                                                             {"lambda_z", lambda[2]},
                                                             {"alpha_xy", 0.0},
                                                             {"alpha_xz", 0.0},
                                                             {"alpha_yz", 0.0},
                                                             {"n_x", 10.0},
                                                             {"n_y", -20.0},
                                                             {"n_z", 30.0}});
}

double value_of(const Exported& exported, const std::string& name) {
  const auto found = std::ranges::find(exported.parameters, name, &VehicleParameter::name);
  REQUIRE(found != exported.parameters.end());
  return found->value;
}

/// Against the field itself: C = diag(1.25, 0.8, 1) after the rotations of eta [rad].
Calibration make_turned_magnetometer(const std::array<double, 3>& eta,
                                     const Mounting& mounting = {}) {
  return make_calibration(magnetometer_probe(std::nullopt, mounting), {{"lambda_x", 0.25},
                                                                       {"lambda_y", -0.2},
                                                                       {"lambda_z", 0.0},
                                                                       {"n_x", 10.0},
                                                                       {"n_y", -20.0},
                                                                       {"n_z", 30.0},
                                                                       {"alpha_xy", 0.0},
                                                                       {"alpha_xz", 0.0},
                                                                       {"alpha_yz", 0.0},
                                                                       {"eta_x", eta[0]},
                                                                       {"eta_y", eta[1]},
                                                                       {"eta_z", eta[2]}});
}

ExportOptions to(ExportTarget target) { return {.target = target, .force = true}; }

}  // namespace

TEST_CASE("parameters of ArduPilot: OFS is -n in mG, DIA times SCALE the inverse of C") {
  const Exported exported =
      export_calibration(make_magnetometer(), nullptr, to(ExportTarget::ardupilot));
  CHECK(value_of(exported, "COMPASS_OFS_X") == doctest::Approx(-100.0));
  CHECK(value_of(exported, "COMPASS_OFS_Y") == doctest::Approx(200.0));
  CHECK(value_of(exported, "COMPASS_OFS_Z") == doctest::Approx(-300.0));
  const double scale = value_of(exported, "COMPASS_SCALE");
  CHECK(scale == doctest::Approx((0.8 + 1.25 + 1.0) / 3.0));
  CHECK(value_of(exported, "COMPASS_DIA_X") * scale == doctest::Approx(0.8));
  CHECK(value_of(exported, "COMPASS_DIA_Y") * scale == doctest::Approx(1.25));
  CHECK(value_of(exported, "COMPASS_DIA_Z") * scale == doctest::Approx(1.0));
  CHECK(value_of(exported, "COMPASS_ODI_X") == doctest::Approx(0.0));
  CHECK(value_of(exported, "COMPASS_MOT_X") == 0.0);
}

TEST_CASE("a scale that ArduPilot would ignore is DIA's, with a note") {
  const Calibration half = make_magnetometer({-0.5, -0.5, -0.5});  // it reads half the field
  const Exported exported = export_calibration(half, nullptr, to(ExportTarget::ardupilot));
  CHECK(value_of(exported, "COMPASS_SCALE") == 1.0);
  CHECK(value_of(exported, "COMPASS_DIA_Z") == doctest::Approx(2.0));
  CHECK(value_of(exported, "COMPASS_OFS_X") == doctest::Approx(-100.0));
  REQUIRE(exported.notes.size() == 1);
  CHECK(exported.notes[0].find("scaled by 2, and ArduPilot ignores") != std::string::npos);
  CHECK(exported.text.find(exported.notes[0]) != std::string::npos);
}

TEST_CASE("parameters of PX4: OFF is n in gauss, SCALE the inverse of C") {
  const Exported exported = export_calibration(make_magnetometer(), nullptr, to(ExportTarget::px4));
  CHECK(value_of(exported, "CAL_MAG0_XOFF") == doctest::Approx(0.1));
  CHECK(value_of(exported, "CAL_MAG0_YOFF") == doctest::Approx(-0.2));
  CHECK(value_of(exported, "CAL_MAG0_ZOFF") == doctest::Approx(0.3));
  CHECK(value_of(exported, "CAL_MAG0_XSCALE") == doctest::Approx(0.8));
  CHECK(value_of(exported, "CAL_MAG0_YSCALE") == doctest::Approx(1.25));
}

TEST_CASE("a matrix is a rotation after a symmetric one") {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1.0, 2.0, -2.0) / 3.0).toRotationMatrix();
  Eigen::Matrix3d S;
  S << 1.1, 0.05, -0.02, 0.05, 0.9, 0.03, -0.02, 0.03, 1.0;
  const exporting::Polar parts = exporting::polar(turn * S);
  CHECK(parts.angle == doctest::Approx(0.3));
  CHECK((parts.rotation - turn).norm() < 1e-14);
  CHECK((parts.symmetric - S).norm() < 1e-14);
}

TEST_CASE("without a flight a calibration is kept, a refit refused") {
  const Calibration straight = make_turned_magnetometer({0.0, 0.0, 0.0});
  const Exported exported = export_calibration(straight, nullptr, to(ExportTarget::px4));
  CHECK(exported.rotation == ExportRotation::keep);
  CHECK_FALSE(exported.other_approximation.has_value());
  CHECK(value_of(exported, "CAL_MAG0_XSCALE") == doctest::Approx(0.8));
  CHECK(value_of(exported, "CAL_MAG0_YSCALE") == doctest::Approx(1.25));
  CHECK(value_of(exported, "CAL_MAG0_XODIAG") == doctest::Approx(0.0));
  CHECK(value_of(exported, "CAL_MAG0_XOFF") == doctest::Approx(0.1));
  CHECK(exported.approximation->rotation_deg == doctest::Approx(0.0));
  ExportOptions refit = to(ExportTarget::px4);
  refit.rotation = ExportRotation::refit;
  check_refused([&] { export_calibration(straight, nullptr, refit); }, {"fitted anew", "flight"});
  const Exported turned = export_calibration(make_turned_magnetometer({0.0, 0.0, 0.02}), nullptr,
                                             to(ExportTarget::px4));
  CHECK(turned.approximation->rotation_deg > 0.5);
}

TEST_CASE("a sensor on its head, a quarter turned, has its number and its axes") {
  const Calibration turned = make_turned_magnetometer({0.0, 0.0, 0.0}, {180.0, 0.0, 90.0});
  const Exported exported = export_calibration(turned, nullptr, to(ExportTarget::px4));
  CHECK(value_of(exported, "CAL_MAG0_ROT") == 10.0);  // x_body = y, y_body = x, z_body = -z
  CHECK(value_of(exported, "CAL_MAG0_XOFF") == doctest::Approx(-0.2));
  CHECK(value_of(exported, "CAL_MAG0_YOFF") == doctest::Approx(0.1));
  CHECK(value_of(exported, "CAL_MAG0_ZOFF") == doctest::Approx(-0.3));
  CHECK(value_of(exported, "CAL_MAG0_XSCALE") == doctest::Approx(1.25));
  CHECK(value_of(exported, "CAL_MAG0_YSCALE") == doctest::Approx(0.8));
}

TEST_CASE("a mounting within 5 deg of a multiple of 45 is that one, else custom") {
  const auto rotation = [](double yaw) {
    const Calibration turned = make_turned_magnetometer({0.0, 0.0, 0.0}, {0.0, 0.0, yaw});
    return value_of(export_calibration(turned, nullptr, to(ExportTarget::px4)), "CAL_MAG0_ROT");
  };
  CHECK(rotation(40.1) == 1.0);
  CHECK(rotation(49.9) == 1.0);
  CHECK(rotation(39.9) == 100.0);
  CHECK(rotation(-45.0) == 7.0);
  CHECK(rotation(450.0) == 2.0);
}

TEST_CASE("a header says what its names begin with") {
  ExportOptions options = to(ExportTarget::c);
  options.sensor = 2;
  const Exported exported = export_calibration(make_magnetometer(), nullptr, options);
  CHECK(exported.text.find("static inline int sepcal_magnetometer_2_correct(") !=
        std::string::npos);
  CHECK(exported.parameters.empty());
  CHECK_FALSE(exported.approximation.has_value());
}

TEST_CASE("a header in float has floats, and of an autopilot there is none") {
  ExportOptions options = to(ExportTarget::cpp);
  options.single = true;
  const std::string text = export_calibration(make_magnetometer(), nullptr, options).text;
  CHECK(text.find("inline constexpr float n[3] = {10.0f, -20.0f, 30.0f};") != std::string::npos);
  CHECK(text.find("double") == std::string::npos);
  options.target = ExportTarget::px4;
  check_refused([&] { export_calibration(make_magnetometer(), nullptr, options); },
                {"single is of a header"});
}

TEST_CASE("what is not fit to be used is refused, and no file is left") {
  const TemporaryFolder folder;
  const std::string output = (folder.path() / "vehicle.h").string();
  const auto refuse = [&](ExportOptions options, std::initializer_list<std::string_view> words) {
    Calibration unsettled = make_magnetometer();
    unsettled.fit.status = FitStatus::not_converged;
    check_refused([&] { export_to_file(unsettled, nullptr, options, output); }, words);
    CHECK_FALSE(std::filesystem::exists(output));
  };
  refuse({.target = ExportTarget::c}, {"did not converge", "force"});
  refuse({.target = ExportTarget::px4, .sensor = 4, .force = true}, {"sensor 4", "0 to 3"});
  refuse({.target = ExportTarget::c, .without = {"bias[x]"}, .force = true}, {"without bias[x]"});
  refuse({.target = ExportTarget::ardupilot, .device_id = 3, .force = true}, {"device_id", "PX4"});
  refuse({.target = ExportTarget::px4, .rotation = ExportRotation::keep, .force = true},
         {"rotation", "known field"});
}

}  // namespace export_test
