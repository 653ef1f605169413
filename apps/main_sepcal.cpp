// SPDX-License-Identifier: BSD-3-Clause
// sepcal: every instrument by one program, where there is no Python.
#include "programs.hpp"
#include "sepcal.hpp"
#include "starting.hpp"

int main(int argc, char** argv) {
  using namespace sepcal::app;
  return start("sepcal", [&] {
    return run_sepcal({{"mag", run_mag, mag_table},
                       {"pitot", run_pitot, pitot_table},
                       {"aircraft", run_aircraft, aircraft_table}},
                      {}, argc, argv);
  });
}
