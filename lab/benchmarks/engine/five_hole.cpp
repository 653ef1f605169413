// SPDX-License-Identifier: BSD-3-Clause
// sepcal on a five-hole flight: the whole fit, and its stages by themselves.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "benchmark.hpp"
#include "counting.hpp"
#include "estimation/minima.hpp"
#include "estimation/problem.hpp"
#include "estimation/sampling.hpp"
#include "estimation/stage_two.hpp"
#include "five_hole_file.hpp"
#include "model/sweep.hpp"
#include "numerics/basins.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/fit_with_effects.hpp"
#include "sepcal/lanes.hpp"
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
  for (const char* name : {"roll", "pitch", "yaw", "p", "q", "r", "pt", "ps", "dpa", "dpb", "rho",
                           "vn", "ve", "vd", "time", "throttle"}) {
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

std::vector<sepcal::EffectSetting> two_effects() {
  return {{.name = "wind[time]"}, {.name = "pressure_offset[throttle]"}};
}

Answer fit_with_two_effects(const sepcal::FiveHoleProbe& probe, const Record& record,
                            const FitOptions& options) {
  auto settings = two_effects();
  const Fit fit = sepcal::fit_with_effects(
      std::make_shared<const sepcal::StaticModel<sepcal::FiveHoleProbe>>(probe),
      sepcal::effect_kit("five-hole"), settings, record, options);
  Answer answer;
  Answer of_effects;
  for (const sepcal::Parameter& parameter : fit.parameters) {
    const bool is_effects = parameter.name.find('[') != std::string::npos;
    (is_effects ? of_effects : answer).push_back(parameter.value);
  }
  answer.insert(answer.end(), of_effects.begin(), of_effects.end());
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

/// The probe as a user's own model, and the same that doesn't tell what of it depends on u alone.
using OwnProbe = sepcal::InLanes<sepcal::FiveHoleProbe>;
struct UnpreparedProbe : sepcal::FiveHoleProbe {
  using LanesOf = UnpreparedProbe;
  void prepare() const = delete;
};

/// The least sum of squares among the samples; the answer, its root.
Answer sample(const sepcal::BlockModel& model, const Record& record, const FitOptions& options) {
  sepcal::base::ThreadPool pool(options.threads);
  const sepcal::estimation::Problem problem(model, options);
  const sepcal::model::Measurements measurements(problem.model(), record);
  const sepcal::model::Sweep sweep(problem.model(), measurements, pool);
  const auto samples = sepcal::estimation::draw_samples(problem.nonlinear(), options);
  return {std::sqrt(sweep.sample_squares(samples, {}).minCoeff())};
}

/// Stage one's samples, those that it descends from in front; their number is added to `answer`,
/// then they are.
void list_samples(const sepcal::BlockModel& model, const StageOne& one, const FitOptions& options,
                  Answer& answer) {
  const sepcal::estimation::Problem problem(model, options);
  const Eigen::VectorXd widths = sepcal::estimation::half_widths(problem);
  const auto basins = sepcal::numerics::find_basins(
      widths.cwiseInverse().asDiagonal() * one.samples, one.trace_r.array().log().matrix());
  std::vector<Eigen::Index> order;
  for (const auto& basin : basins) order.push_back(basin.lowest);
  order.resize(std::min(order.size(), static_cast<std::size_t>(options.descents)));
  answer.push_back(static_cast<double>(order.size()));
  for (Eigen::Index s = 0; s < one.samples.cols(); ++s) {
    if (std::ranges::find(order, s) == order.end()) order.push_back(s);
  }
  for (const Eigen::Index s : order) {
    const auto sample = one.samples.col(s);
    answer.insert(answer.end(), sample.begin(), sample.end());
  }
}

/// The best sample with its xi1 and its noise (13), then list_samples(): what peers start from.
Answer find_start(const sepcal::BlockModel& model, const Record& record, FitOptions options) {
  const StageOne one = sepcal::stage_one(model, record, options);
  const FitOptions asked = options;
  options.samples = 0;
  for (int k = 0; k < nonlinear; ++k) {
    const auto& parameter = sepcal::FiveHoleProbe::nonlinear[static_cast<std::size_t>(k)];
    options.start[std::string(parameter.name)] = one.best[k];
  }
  const StageOne there = sepcal::stage_one(model, record, options);
  Answer answer = together(there.xi1, there.xi2);
  answer.insert(answer.end(), there.noise.begin(), there.noise.end());
  list_samples(model, one, asked, answer);
  return answer;
}

/// What the two effects' drivers are taken about.
Answer find_centres(const sepcal::BlockModel& model, Record record) {
  auto settings = two_effects();
  sepcal::make_effects(sepcal::effect_kit("five-hole"), model, settings, record);
  Answer answer;
  for (const auto& setting : settings) answer.push_back(setting.centre.value_or(0.0));
  return answer;
}

/// Operations a row and sample in stage one: of the model behind what is computed once a row or
/// once a sample, and of Householder's reflections of the columns that aren't zero.
Answer count_operations() {
  using Probe = sepcal::FiveHoleProbe;
  const Probe probe{4.5, 4.5, Eigen::Vector3d(0.35, 0.0, -0.02)};
  sepcal::Vec<double, 14> u;
  u << 0.1, 0.2, 0.3, 0.01, 0.02, 0.03, 101600.0, 101325.0, 60.0, 30.0, 1.2, 0.0, 0.0, 0.0;
  sepcal::Vec<Counted, nonlinear> xi2;
  for (Counted& x : xi2) x = 0.1;
  const auto prepared = probe.prepare<double>(u);
  const auto settled = Probe::settle<Counted>(xi2);
  Counted::operations = 0;
  const auto z = Probe::combine<double, Counted>(prepared, settled);
  long operations = Counted::operations + outputs;  // z - b
  for (int j = 0; j < outputs; ++j) {
    long columns = 1;  // z - b
    for (int c = 0; c < linear; ++c) columns += z.A(j, c).value != 0.0 ? 1 : 0;
    operations += 2 * columns * columns;  // a row joins a triangle of `columns`
  }
  return {static_cast<double>(operations)};
}

}  // namespace

bool run_five_hole(const std::string& method, const std::vector<double>& numbers, int repeats) {
  const FiveHoleFile file(numbers);
  const sepcal::FiveHoleProbe probe{file.k_alpha, file.k_beta, Eigen::Vector3d(file.arm)};
  const sepcal::StaticModel model(probe);
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
  if (method == "operations") {
    report(1, count_operations);
  } else if (method == "start") {
    report(1, [&] { return find_start(model, record, options); });
  } else if (method == "centres") {
    report(1, [&] { return find_centres(model, record); });
  } else if (method == "fit-with-effects") {
    report(repeats, [&] { return fit_with_two_effects(probe, record, options); });
  } else if (method == "sampling") {
    report(repeats, [&] { return sample(model, record, options); });
  } else if (method == "sampling-own") {
    report(repeats, [&] { return sample(*sepcal::block_model(OwnProbe{probe}), record, options); });
  } else if (method == "sampling-unprepared") {
    report(repeats,
           [&] { return sample(*sepcal::block_model(UnpreparedProbe{probe}), record, options); });
  } else if (method == "stage-one") {
    report(repeats, in_stage_one);
  } else if (method == "stage-two") {
    report(repeats, [&] { return stage_two(model, record, file, options); });
  } else if (method == "known-noise") {
    report(repeats, [&] { return stage_two(model, record, file, known); });
  } else if (method.starts_with("wall-")) {  // and how many threads
    options.threads = std::atoi(method.c_str() + 5);
    report_wall([&] { return values_of(sepcal::fit(model, record, options)); });
  } else if (method == "fit") {
    report(repeats, [&] { return values_of(sepcal::fit(model, record, options)); });
  } else {
    return false;
  }
  return true;
}

}  // namespace benchmark
