// SPDX-License-Identifier: BSD-3-Clause
#include "program.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>

namespace benchmark {

double thread_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

namespace {

void print(double seconds, const Answer& answer) {
  std::printf("%.9g", seconds);
  for (const double number : answer) std::printf(" %.17g", number);
  std::printf("\n");
}

}  // namespace

void report(int repeats, const std::function<Answer()>& run) {
  double fastest = std::numeric_limits<double>::infinity();
  Answer answer;
  for (int i = 0; i < repeats; ++i) {
    const double begin = thread_seconds();
    answer = run();
    fastest = std::min(fastest, thread_seconds() - begin);
  }
  print(fastest, answer);
}

void report_wall(const std::function<Answer()>& run) {
  const auto begin = std::chrono::steady_clock::now();
  const Answer answer = run();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  print(took.count(), answer);
}

std::vector<double> read_doubles(const char* name) {
  std::ifstream file(name, std::ios::binary | std::ios::ate);
  if (!file) {
    std::fprintf(stderr, "%s: can't be read\n", name);
    std::exit(2);
  }
  const auto bytes = static_cast<std::size_t>(file.tellg());
  std::vector<double> numbers(bytes / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(bytes));
  return numbers;
}

int run_problem(const std::map<std::string, RunProblem>& problems, int count, char** arguments) {
  const auto problem = problems.find(count == 5 ? arguments[1] : "");
  if (problem == problems.end()) {
    std::fprintf(stderr, "usage: %s PROBLEM METHOD FILE REPEATS, PROBLEM one of", arguments[0]);
    for (const auto& [name, run] : problems) std::fprintf(stderr, " %s", name.c_str());
    std::fprintf(stderr, "\n");
    return 2;
  }
  const std::string method = arguments[2];
  const std::string file = arguments[3];
  const auto numbers = file == "-" ? std::vector<double>() : read_doubles(file.c_str());
  const bool known = problem->second(method, numbers, std::atoi(arguments[4]));
  if (!known) std::fprintf(stderr, "%s: no method '%s'\n", arguments[0], method.c_str());
  return known ? 0 : 2;
}

}  // namespace benchmark
