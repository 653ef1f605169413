// SPDX-License-Identifier: BSD-3-Clause
// sepcal on a five-hole flight: the whole fit, and its stages by themselves.
#include <algorithm>
#include <cmath>

#include "benchmark.hpp"
#include "estimation/problem.hpp"
#include "estimation/sampling.hpp"
#include "estimation/stage_two.hpp"
#include "five_hole_file.hpp"
#include "model/sweep.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/models/five_hole_probe.hpp"

namespace benchmark {
namespace {

using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Record;
using sepcal::StageOne;

Record record_of(const FiveHoleFile& file) {
  using F = FiveHoleFile;
  Record record;
  int which = F::roll;
  for (const char* name :
       {"roll", "pitch", "yaw", "p", "q", "r", "pt", "ps", "dpa", "dpb", "rho", "vn", "ve", "vd"}) {
    record.view(name, {file.column(static_cast<F::Column>(which++)), file.rows});
  }
  return record;
}

Answer together(const Eigen::VectorXd& first, const Eigen::VectorXd& then) {
  Answer all(first.begin(), first.end());
  all.insert(all.end(), then.begin(), then.end());
  return all;
}

Answer values_of(const Fit& fit) {
  Answer answer;
  for (const sepcal::Parameter& parameter : fit.parameters) answer.push_back(parameter.value);
  return answer;
}

/// Stage two alone, from the file's start.
Answer stage_two(const sepcal::BlockModel& model, const Record& record, const FiveHoleFile& file,
                 const FitOptions& options) {
  sepcal::base::ThreadPool pool(options.threads);
  const sepcal::estimation::Problem problem(model, options);
  const sepcal::model::Measurements measurements(problem.model(), record);
  StageOne start;
  start.xi1 = Eigen::Map<const Eigen::VectorXd>(file.start, linear);
  start.xi2 = Eigen::Map<const Eigen::VectorXd>(file.start + linear, nonlinear);
  start.noise = Eigen::Map<const Eigen::VectorXd>(file.start_noise, outputs);
  start.unique_minimum = true;
  const auto two = sepcal::estimation::run_stage_two(problem, measurements, start, pool);
  return {two.x.begin(), two.x.end()};
}

/// One factor of [A | z - b] at every sample; the answer, the root of the least sum of squares.
Answer sample(const sepcal::BlockModel& model, const Record& record, const FitOptions& options) {
  sepcal::base::ThreadPool pool(options.threads);
  const sepcal::estimation::Problem problem(model, options);
  const sepcal::model::Measurements measurements(problem.model(), record);
  const sepcal::model::Sweep sweep(problem.model(), measurements, pool);
  const auto samples = sepcal::estimation::draw_samples(problem.nonlinear(), options);
  double least = sepcal::infinity;
  for (const auto& factor : sweep.sample_factors(samples, {})) {
    least = std::min(least, std::abs(factor.matrix()(linear, linear)));
  }
  return {least};
}

/// The best sample with its xi1 and its noise (13), then all samples: where peers start.
Answer find_start(const sepcal::BlockModel& model, const Record& record, FitOptions options) {
  const StageOne one = sepcal::stage_one(model, record, options);
  options.samples = 0;
  for (int k = 0; k < nonlinear; ++k) {
    const auto& parameter = sepcal::FiveHoleProbe::nonlinear[static_cast<std::size_t>(k)];
    options.start[std::string(parameter.name)] = one.best[k];
  }
  const StageOne there = sepcal::stage_one(model, record, options);
  Answer answer = together(there.xi1, there.xi2);
  answer.insert(answer.end(), there.noise.begin(), there.noise.end());
  answer.insert(answer.end(), one.samples.reshaped().begin(), one.samples.reshaped().end());
  return answer;
}

}  // namespace

bool run_five_hole(const std::string& method, const std::vector<double>& numbers, int repeats) {
  const FiveHoleFile file(numbers);
  const sepcal::StaticModel model(sepcal::FiveHoleProbe{
      file.k_alpha, file.k_beta, Eigen::Vector3d(file.arm[0], file.arm[1], file.arm[2])});
  const Record record = record_of(file);
  FitOptions options;
  options.threads = 1;
  if (file.samples > 0) options.samples = static_cast<int>(file.samples);
  FitOptions known = options;
  known.noise = {{"vn", file.noise[0]}, {"ve", file.noise[1]}, {"vd", file.noise[2]}};
  const auto in_stage_one = [&] {
    const StageOne one = sepcal::stage_one(model, record, options);
    return together(one.xi1, one.xi2);
  };
  if (method == "start") {
    report(1, [&] { return find_start(model, record, options); });
  } else if (method == "sampling") {
    report(repeats, [&] { return sample(model, record, options); });
  } else if (method == "stage-one") {
    report(repeats, in_stage_one);
  } else if (method == "stage-two") {
    report(repeats, [&] { return stage_two(model, record, file, options); });
  } else if (method == "known-noise") {
    report(repeats, [&] { return stage_two(model, record, file, known); });
  } else if (method == "fit") {
    report(repeats, [&] { return values_of(sepcal::fit(model, record, options)); });
  } else {
    return false;
  }
  return true;
}

}  // namespace benchmark
