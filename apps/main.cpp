// SPDX-License-Identifier: BSD-3-Clause
// The main of a program of one instrument. CMake says which: SEPCAL_PROGRAM is its name,
// SEPCAL_RUN its function.
#include "programs.hpp"
#include "starting.hpp"

int main(int argc, char** argv) {
  return sepcal::app::start(SEPCAL_PROGRAM,
                            [&] { return sepcal::app::SEPCAL_RUN(SEPCAL_PROGRAM, argc, argv); });
}
