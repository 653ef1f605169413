// SPDX-License-Identifier: BSD-3-Clause
// sepcal_benchmark PROBLEM METHOD FILE REPEATS: solves the problem in FILE (doubles, binary),
// prints seconds and answer. scripts/benchmark runs it in turns with others.
#include "benchmark.hpp"

#include <cstdio>
#include <cstdlib>
#include <map>

int main(int count, char** arguments) {
  const std::map<std::string, decltype(&benchmark::run_smoother)> problems{
      {"five-hole", benchmark::run_five_hole},
      {"output-error", benchmark::run_output_error},
      {"smoother", benchmark::run_smoother},
  };
  const auto problem = problems.find(count == 5 ? arguments[1] : "");
  if (problem == problems.end()) {
    std::fprintf(stderr, "usage: sepcal_benchmark PROBLEM METHOD FILE REPEATS, PROBLEM one of");
    for (const auto& [name, run] : problems) std::fprintf(stderr, " %s", name.c_str());
    std::fprintf(stderr, "\n");
    return 2;
  }
  const std::string method = arguments[2];
  const std::vector<double> numbers = benchmark::read_doubles(arguments[3]);
  const bool known = problem->second(method, numbers, std::atoi(arguments[4]));
  if (!known) std::fprintf(stderr, "sepcal_benchmark: no method '%s'\n", method.c_str());
  return known ? 0 : 2;
}
