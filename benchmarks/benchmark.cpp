// SPDX-License-Identifier: BSD-3-Clause
// sepcal_benchmark PROBLEM METHOD FILE REPEATS: solves the problem in FILE (doubles, binary),
// prints seconds and answer. scripts/benchmark runs it in turns with others.
#include "benchmark.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>

namespace benchmark {

void report(int repeats, const std::function<Answer()>& run) {
  double fastest = std::numeric_limits<double>::infinity();
  Answer answer;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    answer = run();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    fastest = std::min(fastest, took.count());
  }
  std::printf("%.9g", fastest);
  for (const double number : answer) std::printf(" %.17g", number);
  std::printf("\n");
}

}  // namespace benchmark

namespace {

std::vector<double> read(const char* name) {
  std::ifstream file(name, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  std::vector<double> numbers(bytes.size() / sizeof(double));
  std::copy_n(bytes.data(), numbers.size() * sizeof(double),
              reinterpret_cast<char*>(numbers.data()));
  return numbers;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 5) {
    std::fprintf(stderr, "usage: sepcal_benchmark output-error|smoother METHOD FILE REPEATS\n");
    return 2;
  }
  const std::string problem = arguments[1];
  const std::string method = arguments[2];
  const std::vector<double> numbers = read(arguments[3]);
  const int repeats = std::atoi(arguments[4]);
  const bool known = problem == "output-error"
                         ? benchmark::run_output_error(method, numbers, repeats)
                         : benchmark::run_smoother(method, numbers, repeats);
  if (!known) std::fprintf(stderr, "sepcal_benchmark: no method '%s'\n", method.c_str());
  return known ? 0 : 2;
}
