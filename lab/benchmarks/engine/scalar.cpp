// SPDX-License-Identifier: BSD-3-Clause
// sepcal on many small problems: trials of scalar example 1, a fit each.
#include "benchmark.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/fit_trials.hpp"
#include "trials_file.hpp"

namespace benchmark {
namespace {

Answer fit_each(const TrialsFile& file, const sepcal::FitOptions& options) {
  const sepcal::StaticModel model(sepcal::ScalarExample1{});
  Answer answer;
  for (std::size_t trial = 0; trial < file.trials; ++trial) {
    sepcal::Record record;
    record.view("eta", file.eta).view("z", file.z(trial));
    const sepcal::Fit fit = sepcal::fit(model, record, options);
    for (const sepcal::Parameter& parameter : fit.parameters) answer.push_back(parameter.value);
  }
  return answer;
}

/// All trials at once.
Answer fit_together(const TrialsFile& file, const sepcal::FitOptions& options) {
  sepcal::Record design;
  design.view("eta", file.eta);
  const std::span<const double> all(file.z(0).data(), file.trials * file.rows);
  const sepcal::TrialFits fits =
      sepcal::fit_trials(sepcal::ScalarExample1{}, design, {{"z", all}}, options);
  Answer answer;
  for (const auto trial : fits.estimates.rowwise()) {
    answer.insert(answer.end(), trial.begin(), trial.end());
  }
  return answer;
}

}  // namespace

bool run_scalar(const std::string& method, const std::vector<double>& numbers, int repeats) {
  const TrialsFile file(numbers);
  sepcal::FitOptions options;
  options.threads = 1;
  if (method != "default") options.samples = 0;
  if (method == "no-samples-white" || method == "together") options.coloured_errors = false;
  if (method == "together") {
    report(repeats, [&] { return fit_together(file, options); });
  } else if (method == "default" || method == "no-samples" || method == "no-samples-white") {
    report(repeats, [&] { return fit_each(file, options); });
  } else {
    return false;
  }
  return true;
}

}  // namespace benchmark
