// SPDX-License-Identifier: BSD-3-Clause
// Output error of a short period by sepcal.
#include <array>

#include "benchmark.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/models/short_period.hpp"

namespace benchmark {
namespace {

constexpr int rows = 1000;
constexpr double airspeed = 25.0;               // m/s
constexpr std::array noise{0.005, 0.01, 0.15};  // rad, rad/s, m/s^2
constexpr std::array names{"Za",      "Ma",  "Mq",   "Zd",      "Md",
                           "b_alpha", "b_q", "b_az", "alpha_0", "q_0"};

sepcal::Record record_of(const std::vector<double>& numbers) {
  sepcal::Record record;
  int first = 0;
  for (const char* name : {"time", "elevator", "alpha_m", "q_m", "az_m"}) {
    record.view(name, std::span(numbers).subspan(static_cast<std::size_t>(first++) * rows, rows));
  }
  return record.add("airspeed", std::vector<double>(rows, airspeed));
}

Answer by_sepcal(const sepcal::Record& record, const sepcal::FitOptions& options) {
  const sepcal::TrajectoryModel<sepcal::ShortPeriod> model({}, record);
  const sepcal::Fit fit = sepcal::fit(model, record, options);
  Answer answer;
  for (const char* name : names) answer.push_back(fit[name].value);
  return answer;
}

}  // namespace

bool run_output_error(const std::string& method, const std::vector<double>& numbers, int repeats) {
  const sepcal::Record record = record_of(numbers);
  sepcal::FitOptions options;
  options.threads = 1;
  options.noise = {{"alpha_m", noise[0]}, {"q_m", noise[1]}, {"az_m", noise[2]}};
  options.coloured_errors = method == "coloured";
  if (method == "start") options.start = {{"Za", -3.0}, {"Ma", -30.0}, {"Mq", -4.0}};
  if (method == "start" || method == "no-start" || method == "coloured") {
    report(repeats, [&] { return by_sepcal(record, options); });
  } else {
    return false;
  }
  return true;
}

}  // namespace benchmark
