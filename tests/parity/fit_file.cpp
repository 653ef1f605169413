// SPDX-License-Identifier: BSD-3-Clause
// Fits one CSV flight with defaults on two threads and prints the calibration's JSON:
//   fit_file five-hole FLIGHT.csv K_ALPHA K_BETA X Y Z
//   fit_file magnetometer FLIGHT.csv NORTH EAST DOWN
#include <cstdlib>
#include <iostream>
#include <span>
#include <string>
#include <vector>

#include "sepcal/error.hpp"
#include "sepcal/flight/calibration.hpp"

namespace {

/// Throws sepcal::Error for another count of settings than the probe has.
std::map<std::string, std::vector<double>> name_settings(const std::string& probe,
                                                         const std::vector<double>& values) {
  if (probe == "five-hole" && values.size() == 5) {
    return {{"k_alpha", {values[0]}},
            {"k_beta", {values[1]}},
            {"lever_arm", {values[2], values[3], values[4]}}};
  }
  if (probe == "magnetometer" && values.size() == 3) return {{"field", values}};
  throw sepcal::Error("usage: fit_file five-hole|magnetometer FLIGHT.csv SETTING...");
}

void fit_file(std::span<const char* const> arguments) {
  if (arguments.size() < 3) throw sepcal::Error("usage: fit_file PROBE FLIGHT.csv SETTING...");
  const std::string probe = arguments[1];
  std::vector<double> values;
  for (const char* argument : arguments.subspan(3)) values.push_back(std::stod(argument));
  sepcal::CalibrationOptions options;
  options.fit.threads = 2;
  std::cout << to_json(calibrate(sepcal::make_probe(probe, name_settings(probe, values)),
                                 sepcal::read_csv(arguments[2]), options));
}

}  // namespace

int main(int count, char** arguments) {
  try {
    fit_file({arguments, static_cast<std::size_t>(count)});
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
