// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/residual_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "base/parts_of_record.hpp"
#include "flight/verbs/at_bound.hpp"
#include "flight/verbs/misfits.hpp"
#include "flight/verbs/residual_channels.hpp"
#include "flight/verbs/validation.hpp"
#include "flight/verbs/worst_windows.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"

namespace sepcal::verbs {

Eigen::MatrixXd residuals_of(const BlockModel& model, const Record& record, const Fit& fit,
                             base::ThreadPool& pool) {
  const model::Measurements measurements(model, record);
  return model::Sweep(model, measurements, pool).residuals(fit.xi1(), fit.xi2());
}

namespace {

/// What was measured, in the rows of the residuals.
Eigen::MatrixXd outputs_of(const Tables& tables, const Record& record) {
  Eigen::MatrixXd z(static_cast<Eigen::Index>(record.rows()), tables.n_z());
  Eigen::Index row = 0;
  for (const Segment& segment : record.segments()) {
    for (std::size_t at = segment.first; at < segment.last; ++at, ++row) {
      for (Eigen::Index j = 0; j < z.cols(); ++j) {
        z(row, j) = record.column(tables.outputs[static_cast<std::size_t>(j)].name)[at];
      }
    }
  }
  return z;
}

/// The same record without the rows in which an output has no residual (rows).
Record with_readings(Record record, const Eigen::VectorXd& residual) {
  std::vector<Segment> readings;
  Eigen::Index at = 0;
  for (const Segment& segment : record.segments()) {
    bool follows = false;
    for (std::size_t row = segment.first; row < segment.last; ++row, ++at) {
      const bool there = !std::isnan(residual[at]);
      if (there && !follows) readings.push_back({segment.label, row, row});
      if (there) readings.back().last = row + 1;
      follows = there;
    }
  }
  return record.cut(std::move(readings));
}

/// compare_channels() of outputs that have a residual in every row, and of each other one by
/// itself.
std::vector<ChannelMisfit> follow_channels(const Record& channels, const Tables& tables,
                                           const Eigen::MatrixXd& residuals,
                                           base::ThreadPool& pool) {
  std::vector<Eigen::Index> whole;
  std::vector<ChannelMisfit> found;
  const auto of_outputs = [&](const Record& record, const std::vector<Eigen::Index>& outputs,
                              const Eigen::MatrixXd& r) {
    std::vector<std::string> names;
    for (const Eigen::Index j : outputs) {
      names.push_back(tables.outputs[static_cast<std::size_t>(j)].name);
    }
    for (ChannelMisfit& one : compare_channels(record, tables, names, r, pool)) {
      found.push_back(std::move(one));
    }
  };
  for (Eigen::Index j = 0; j < residuals.cols(); ++j) {
    const Eigen::VectorXd r = residuals.col(j);
    if (!r.array().isNaN().any()) {
      whole.push_back(j);
      continue;
    }
    std::vector<double> readings;
    std::ranges::copy_if(r, std::back_inserter(readings), [](double x) { return !std::isnan(x); });
    if (readings.empty()) continue;
    of_outputs(with_readings(channels, r), {j},
               Eigen::VectorXd::Map(readings.data(), static_cast<Eigen::Index>(readings.size())));
  }
  if (!whole.empty()) of_outputs(channels, whole, residuals(Eigen::all, whole));
  std::ranges::stable_sort(found, std::ranges::greater{}, &ChannelMisfit::share_smooth);
  return found;
}

}  // namespace

Comparison compare_residuals(Eigen::MatrixXd residuals, const Tables& tables, const Record& record,
                             const Record& channels, const Flight& flight, const Fit& fit,
                             base::ThreadPool& pool) {
  Comparison result;
  result.flight = {flight.name(), flight.sha256(), flight.rows(), record.rows()};
  result.status = fit.status;
  result.message = fit.message;
  result.at_bound = names_at_bound(fit);
  result.residuals = std::move(residuals);
  result.method = fit.method;
  result.modelled = outputs_of(tables, record) - result.residuals;
  result.time = base::gather_time(record);
  result.overall = measure_whole(record, tables.outputs, result.residuals);
  result.where = measure_parts(record, tables.outputs, result.residuals);
  result.validation = validate_outputs(tables.outputs, result.modelled, result.residuals);
  result.channels = follow_channels(channels, tables, result.residuals, pool);
  result.windows = find_worst_windows(result.time, result.residuals, result.overall, fit.noise);
  return result;
}

}  // namespace sepcal::verbs
