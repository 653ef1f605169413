// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/residual_comparison.hpp"

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
  result.channels = compare_channels(channels, tables, result.residuals, pool);
  result.windows = find_worst_windows(result.time, result.residuals, result.overall, fit.noise);
  return result;
}

}  // namespace sepcal::verbs
