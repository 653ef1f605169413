// SPDX-License-Identifier: BSD-3-Clause
// Data compatibility of a recorded flight (NASA's F/A-18 HARV, longitudinal) against the answer
// that SIDPAC publishes for it. Skipped where the record is absent: it isn't sepcal's to ship.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/models/flight_path.hpp"

namespace harv_test {

using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::FlightPath;
using sepcal::InputsBetweenRows;
using sepcal::Record;
using sepcal::TrajectoryModel;

namespace {

constexpr double foot = 0.3048;  // m

std::filesystem::path recorded(const std::string& file) {
  const char* folder = std::getenv("SEPCAL_FIXTURES");
  return folder == nullptr ? std::filesystem::path() : std::filesystem::path(folder) / file;
}

/// The columns by header.
std::map<std::string, std::vector<double>> read_columns(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  std::vector<std::string> headers;
  std::istringstream header(line);
  for (std::string name; std::getline(header, name, ',');) headers.push_back(name);
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (const std::string& name : headers) {
      std::getline(cells, cell, ',');
      columns[name].push_back(std::stod(cell));
    }
  }
  return columns;
}

/// In metres, with v = V sin beta, phi and psi as columns: they are measured here.
Record read_harv(const std::filesystem::path& file) {
  auto columns = read_columns(file);
  for (const char* name : {"ax_ftps2", "ay_ftps2", "az_ftps2", "airspeed_ftps"}) {
    for (double& value : columns.at(name)) value *= foot;
  }
  std::vector<double> v;
  for (std::size_t k = 0; k < columns.at("time_s").size(); ++k) {
    v.push_back(columns.at("airspeed_ftps")[k] * std::sin(columns.at("beta_rad")[k]));
  }
  Record record;
  record.add("v", v).add("phi", columns.at("roll_rad")).add("psi", columns.at("yaw_rad"));
  const std::map<std::string, std::string> headers{
      {"time", "time_s"},   {"ax", "ax_ftps2"},     {"ay", "ay_ftps2"},
      {"az", "az_ftps2"},   {"p", "p_radps"},       {"q", "q_radps"},
      {"r", "r_radps"},     {"beta", "beta_rad"},   {"airspeed", "airspeed_ftps"},
      {"roll", "roll_rad"}, {"alpha", "alpha_rad"}, {"pitch", "pitch_rad"},
      {"yaw", "yaw_rad"}};
  for (const auto& [name, header] : headers) {
    record.add(name, columns.at(header));
  }
  return record;
}

struct Published {
  std::string name;
  double value;
  double deviation;  // Cramer-Rao, white
  double unit;       // in m
};

const std::array published{
    Published{"b_ax", -0.16654, 0.00595, foot}, Published{"b_az", -0.13388, 0.00970, foot},
    Published{"b_q", 0.0017840, 6.35e-6, 1.0}, Published{"lambda_alpha", 0.076171, 0.00680, 1.0},
    Published{"lambda_theta", 0.038720, 0.00118, 1.0}};

}  // namespace

TEST_CASE("HARV longitudinal: SIDPAC's numbers within a tenth of a standard deviation") {
  const auto file = recorded("harv_longitudinal.csv");
  if (!std::filesystem::exists(file)) {
    MESSAGE("skipped: no harv_longitudinal.csv; set SEPCAL_FIXTURES to its folder");
    return;
  }
  const Record record = read_harv(file);
  const TrajectoryModel<FlightPath> model(FlightPath{.gravity = 32.174 * foot}, record,
                                          {.inputs = InputsBetweenRows::hold,
                                           .measured = {"v", "phi", "psi"},
                                           .outputs = {"airspeed", "alpha", "pitch"},
                                           .scales_about_start = true});
  FitOptions options;
  options.fix = {{"u_0", 313.0304 * foot}, {"w_0", 114.0908 * foot}, {"theta_0", 0.239107}};
  for (const char* name : {"b_ay", "b_p", "b_r", "lambda_v", "b_v", "b_alpha", "b_theta"}) {
    options.fix[name] = 0.0;
  }
  options.start = {{"b_ax", 0.0}};
  const Fit fit = sepcal::fit(model, record, options);
  CHECK(fit.status == sepcal::FitStatus::converged);
  for (const auto& [name, value, deviation, unit] : published) {
    CHECK(std::abs(fit[name].value / unit - value) < 0.1 * deviation);
    CHECK(fit[name].standard_error_white / unit == doctest::Approx(deviation).epsilon(0.01));
    CHECK(fit[name].standard_error > 1.5 * fit[name].standard_error_white);
    MESSAGE(name, " ", fit[name].value / unit, " +- ", fit[name].standard_error_white / unit,
            ", by a noise model ", fit[name].standard_error / unit, "; published ", value, " +- ",
            deviation);
  }
  const std::array rms{1.0548 * foot, 0.006261, 0.001402};
  for (std::size_t j = 0; j < rms.size(); ++j) {
    CHECK(fit.rmse[j].value == doctest::Approx(rms[j]).epsilon(1e-3));
  }
}

TEST_CASE("HARV with all 24 parameters: psi_0 with b_psi is unseen, and named") {
  const auto file = recorded("harv_longitudinal.csv");
  if (!std::filesystem::exists(file)) {
    MESSAGE("skipped: no harv_longitudinal.csv; set SEPCAL_FIXTURES to its folder");
    return;
  }
  const Record record = read_harv(file);
  const TrajectoryModel<FlightPath> model(
      FlightPath{.gravity = 32.174 * foot}, record,
      {.outputs = {"airspeed", "beta", "alpha", "roll", "pitch", "yaw"}});
  FitOptions options;
  options.start = model.initial_states(record);
  options.coloured_errors = false;
  const Fit fit = sepcal::fit(model, record, options);
  REQUIRE(fit.parameters.size() == 24);
  CHECK(fit.status == sepcal::FitStatus::not_identifiable);
  REQUIRE(fit.identifiability.unobservable.size() == 1);
  const auto& unseen = fit.identifiability.unobservable.front();
  MESSAGE(unseen.text);
  CHECK(std::set<std::string>(unseen.parameters.begin(), unseen.parameters.end()) ==
        std::set<std::string>{"b_psi", "psi_0"});
}

}  // namespace harv_test
