// SPDX-License-Identifier: BSD-3-Clause
// sepcal_benchmark_peers_* PROBLEM METHOD FILE REPEATS: Eigen and Ceres. It knows nothing of
// sepcal, so that it may be compiled with any flags.
#include "peers/peers.hpp"

int main(int count, char** arguments) {
  return benchmark::run_problem(
      {
          {"five-hole", benchmark::run_five_hole_peers},
          {"output-error", benchmark::run_output_error_peers},
          {"scalar", benchmark::run_scalar_peers},
      },
      count, arguments);
}
