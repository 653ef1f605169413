// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/cost_landscape.hpp"

#include <algorithm>
#include <cmath>

#include "base/thread_pool.hpp"
#include "estimation/problem.hpp"
#include "estimation/sampling.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The fit's question, with the parameters of effects held at its answer.
FitOptions landscape_options(const Calibration& calibration, const BlockModel& model,
                             const Record& record) {
  FitOptions options = calibration.probe->complete(calibration.options.fit, record);
  options.start.clear();
  options.prior.clear();
  options.sampling_distribution.clear();
  options.sampling = Sampling::low_discrepancy;
  const std::vector<Variable> own = calibration.probe->model().tables().parameters();
  for (const Variable& parameter : model.tables().parameters()) {
    const bool is_own = std::ranges::find(own, parameter.name, &Variable::name) != own.end();
    if (is_own || options.fix.contains(parameter.name)) continue;
    options.bounds.erase(parameter.name);
    options.fix[parameter.name] = calibration.fit[parameter.name].value;
  }
  return options;
}

/// Even values of each of one or two parameters.
MatrixXd even_points(const std::vector<Variable>& parameters, bool many_rows) {
  const auto n = static_cast<Index>(parameters.size());
  const Index each = n == 1 ? (many_rows ? 51 : 201) : (many_rows ? 21 : 41);
  MatrixXd points(n, n == 1 ? each : each * each);
  const auto value = [&](Index k, Index i) {
    const Variable& parameter = parameters[static_cast<std::size_t>(k)];
    return parameter.lower + (parameter.upper - parameter.lower) * static_cast<double>(i) /
                                 static_cast<double>(each - 1);
  };
  for (Index i = 0; i < points.cols(); ++i) {
    points(0, i) = value(0, i % each);
    if (n == 2) points(1, i) = value(1, i / each);
  }
  return points;
}

}  // namespace

CostLandscape find_cost_landscape(const Calibration& given, const Flight& flight) {
  PreparedFlight prepared = prepare(given, flight);
  const Calibration calibration = along(given, prepared);
  const EffectiveFlight effective = with_effects_of(calibration, prepared);
  const Record& record = effective.prepared.record;
  FitOptions options = landscape_options(calibration, *effective.model, record);
  const estimation::Problem problem(*effective.model, options);
  CostLandscape landscape{.parameters = problem.nonlinear(), .points = {}, .trace_r = {}};
  const bool is_bounded = std::ranges::all_of(landscape.parameters, [](const Variable& one) {
    return std::isfinite(one.lower) && std::isfinite(one.upper);
  });
  if (landscape.parameters.empty() || !is_bounded) return {};
  const bool other = is_other_flight(given, flight);
  const model::Measurements measurements(problem.model(),
                                         record.select(other ? "" : options.stage_one_segments));
  const bool many_rows = measurements.rows() > 100'000;
  if (landscape.parameters.size() <= 2) {
    landscape.points = even_points(landscape.parameters, many_rows);
  } else {
    options.samples = many_rows ? 500 : 2000;
    landscape.points = estimation::draw_samples(landscape.parameters, options);
  }
  base::ThreadPool pool(options.threads);
  const model::Sweep sweep(problem.model(), measurements, pool);
  landscape.trace_r =
      sweep.sample_squares(landscape.points, {}) / static_cast<double>(measurements.rows());
  return landscape;
}

}  // namespace sepcal
