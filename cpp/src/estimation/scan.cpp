// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/scan.hpp"

#include <algorithm>
#include <cmath>

#include "base/thread_pool.hpp"
#include "model/fixed_model.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/error.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd in_order(const std::vector<Variable>& parameters, const ScanPoint& point) {
  VectorXd values = VectorXd::Zero(static_cast<Index>(parameters.size()));
  for (Index k = 0; k < values.size(); ++k) {
    const auto at = point.values.find(parameters[static_cast<std::size_t>(k)].name);
    if (at != point.values.end()) values[k] = at->second;
  }
  return values;
}

}  // namespace

double scan(const BlockModel& model, const Record& record, const ScanPoint& point,
            const std::string& parameter, const std::vector<double>& candidates) {
  const auto all = model.tables().parameters();
  if (std::ranges::find(all, parameter, &Variable::name) == all.end()) {
    throw Error("there is no parameter '" + parameter + "'");
  }
  const model::Measurements measurements(model, record);
  base::ThreadPool pool(point.threads);
  std::map<std::string, double> held = point.held;
  double least = infinity;
  double best = not_a_number;
  for (const double candidate : candidates) {
    held[parameter] = candidate;
    const model::FixedModel fixed(model, held);
    const Tables& tables = fixed.tables();
    const auto factors =
        model::Sweep(fixed, measurements, pool)
            .tangent_factors(in_order(tables.linear, point), in_order(tables.nonlinear, point));
    const TriangularFactor factor = combine(factors, VectorXd::Ones(tables.n_z()));
    if (!factor.all_finite()) continue;
    const double square = remaining_square(factor);
    if (square >= least) continue;
    least = square;
    best = candidate;
  }
  if (std::isnan(best)) {
    throw Error("the model is not finite at any value tried of '" + parameter + "'");
  }
  return best;
}

double scan_step(const BlockModel& model, const Record& record, const ScanPoint& point,
                 const std::string& parameter, const Interval& within) {
  constexpr std::size_t coarse = 200;
  const auto time = record.column("time");
  std::vector<double> between;
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first + 1; row < segment.last; ++row) {
      const double middle = 0.5 * (time[row - 1] + time[row]);
      if (middle >= within.lower && middle <= within.upper) between.push_back(middle);
    }
  }
  if (between.empty()) {
    throw Error("no two rows of the record have a time between them at which '" + parameter +
                "' could be; widen its bounds or log more rows");
  }
  const std::size_t stride = std::max<std::size_t>(1, between.size() / coarse);
  std::vector<double> candidates;
  for (std::size_t i = 0; i < between.size(); i += stride) candidates.push_back(between[i]);
  const double about = scan(model, record, point, parameter, candidates);
  if (stride == 1) return about;
  const auto best = std::ranges::lower_bound(between, about) - between.begin();
  const auto reach = static_cast<std::ptrdiff_t>(stride);
  const auto first = std::max<std::ptrdiff_t>(0, best - reach);
  const auto last = std::min(static_cast<std::ptrdiff_t>(between.size()), best + reach + 1);
  return scan(model, record, point, parameter, {between.begin() + first, between.begin() + last});
}

}  // namespace sepcal::estimation
