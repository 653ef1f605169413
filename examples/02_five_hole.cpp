// SPDX-License-Identifier: BSD-3-Clause
// A five-hole probe calibrated from a log:  02_five_hole FLIGHT.csv BASE.json CORRECTED.csv
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "sepcal/error.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/calibration.hpp"

namespace {

/// 4.5 and 4.5 are the ports' sensitivities [1/rad], then comes the lever arm in body axes [m].
void run(const std::string& log, const std::string& base, const std::string& corrected) {
  const sepcal::Flight flight = sepcal::read_csv(log);
  auto probe = sepcal::five_hole_probe(4.5, 4.5, {0.35, 0.0, -0.02});
  const sepcal::Calibration calibration = sepcal::calibrate(std::move(probe), flight);
  sepcal::write_calibration(calibration, base);
  sepcal::apply_to_file(calibration, log, corrected);

  for (const sepcal::Parameter& p : calibration.fit.parameters) {
    std::printf("%-13s %9.5f +- %.5f %s\n", p.name.c_str(), p.value, p.standard_error,
                p.unit.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> files(argv + 1, argv + argc);
  if (files.size() != 3) {
    std::fprintf(stderr, "usage: 02_five_hole FLIGHT.csv BASE.json CORRECTED.csv\n");
    return 2;
  }
  try {
    run(files[0], files[1], files[2]);
  } catch (const sepcal::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
