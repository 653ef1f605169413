// SPDX-License-Identifier: BSD-3-Clause
// sepcal_benchmark PROBLEM METHOD FILE REPEATS: sepcal, and Ceres on a trajectory, solve the
// problem in FILE (doubles, binary) and print seconds and answer. scripts/benchmark runs it in
// turns with others.
#include "benchmark.hpp"

int main(int count, char** arguments) {
  return benchmark::run_problem(
      {
          {"filter-error", benchmark::run_filter_error},
          {"five-hole", benchmark::run_five_hole},
          {"limits", benchmark::run_limits},
          {"output-error", benchmark::run_output_error},
          {"scalar", benchmark::run_scalar},
          {"smoother", benchmark::run_smoother},
      },
      count, arguments);
}
