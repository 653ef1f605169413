// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/misfits.hpp"

#include <cmath>

#include "base/parts_of_record.hpp"
#include "base/thread_pool.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/composition.hpp"

namespace sepcal::verbs {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The values of a stretch that are there.
std::vector<double> present(const MatrixXd& residuals, Index output, const Segment& stretch) {
  std::vector<double> values;
  for (std::size_t row = stretch.first; row < stretch.last; ++row) {
    const double value = residuals(static_cast<Index>(row), output);
    if (!std::isnan(value)) values.push_back(value);
  }
  return values;
}

/// Sums of one output over stretches; lag-one correlation is about the common mean, of readings
/// that follow each other.
Misfit measure(const base::Part& part, const MatrixXd& residuals, Index output,
               const Variable& quantity) {
  Misfit misfit{.segment = part.name, .output = quantity.name, .unit = quantity.unit};
  std::vector<std::vector<double>> stretches;
  double sum = 0.0;
  double square = 0.0;
  for (const Segment& stretch : part.stretches) {
    stretches.push_back(present(residuals, output, stretch));
    const Eigen::Map<const VectorXd> values(stretches.back().data(),
                                            static_cast<Index>(stretches.back().size()));
    sum += values.sum();
    square += values.squaredNorm();
    misfit.rows += stretches.back().size();
  }
  const auto rows = static_cast<double>(misfit.rows);
  misfit.mean = sum / rows;
  misfit.rmse = std::sqrt(square / rows);
  double product = 0.0;
  for (const std::vector<double>& stretch : stretches) {
    if (stretch.empty()) continue;
    const auto n = static_cast<Index>(stretch.size());
    const auto centred =
        (Eigen::Map<const VectorXd>(stretch.data(), n).array() - misfit.mean).eval();
    product += (centred.head(n - 1) * centred.tail(n - 1)).sum();
  }
  const double variance = square - rows * misfit.mean * misfit.mean;
  misfit.lag_one = misfit.rows > 2 && variance > 0 ? product / variance : not_a_number;
  return misfit;
}

std::vector<Misfit> measure_each(const std::vector<base::Part>& parts,
                                 const std::vector<Variable>& outputs, const MatrixXd& residuals) {
  std::vector<Misfit> misfits;
  for (const base::Part& part : parts) {
    for (std::size_t j = 0; j < outputs.size(); ++j) {
      misfits.push_back(measure(part, residuals, static_cast<Index>(j), outputs[j]));
    }
  }
  return misfits;
}

}  // namespace

std::vector<Misfit> measure_whole(const Record& record, const std::vector<Variable>& outputs,
                                  const MatrixXd& residuals) {
  return measure_each({{"", base::join_segments(record.segments())}}, outputs, residuals);
}

std::vector<Misfit> measure_parts(const Record& record, const std::vector<Variable>& outputs,
                                  const MatrixXd& residuals) {
  constexpr std::size_t spans_without_labels = 10;
  const std::vector<Segment> joined = base::join_segments(record.segments());
  std::vector<base::Part> parts = base::parts_by_label(joined);
  if (parts.size() < 2)
    parts = base::parts_by_time(joined, base::gather_time(record), spans_without_labels);
  return measure_each(parts, outputs, residuals);
}

std::vector<Misfit> measure_parts(const DiagnosedFit& fitted) {
  Record rows = fitted.record;
  std::vector<EffectSetting> settings = fitted.effects;
  const auto model =
      compose(fitted.model, make_effects(fitted.kit, *fitted.model, settings, rows), rows);
  rows.cut(fitted.rows);
  const model::Measurements measurements(*model, rows);
  base::ThreadPool pool(1);
  const model::Sweep sweep(*model, measurements, pool);
  return measure_parts(rows, fitted.model->tables().outputs,
                       sweep.residuals(fitted.fit.xi1(), fitted.fit.xi2()));
}

}  // namespace sepcal::verbs
