// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/innovation_summary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "estimation/block_errors.hpp"

namespace sepcal::estimation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

InnovationSummary summarise(const InnovationModel& innovations, const BlockModel& model,
                            const Record& record, const VectorXd& theta) {
  const Index n_z = innovations.outputs();
  InnovationSummary summary{VectorXd::Zero(n_z), VectorXd::Zero(n_z), VectorXd::Zero(n_z)};
  const auto [e, sd] = innovations.innovations(theta);
  Memory memory(n_z);
  for (const Segment& segment : record.segments()) {
    const auto first = static_cast<Index>(segment.first);
    const auto rows = static_cast<Index>(segment.rows());
    const MatrixXd here = e.middleRows(first, rows);
    const auto there = here.array().isFinite();
    summary.squares +=
        there.select(here.array().square(), 0.0).matrix().colwise().sum().transpose();
    summary.counts += there.cast<double>().matrix().colwise().sum().transpose();
    const MatrixXd w = here.cwiseQuotient(sd.middleRows(first, rows));
    memory.add(w.array().isNaN().select(0.0, w));
    for (Index j = 0; j < n_z; ++j) {
      const std::span<const double> values =
          record.column(model.tables().outputs[static_cast<std::size_t>(j)].name);
      for (const double value : values.subspan(segment.first, segment.rows())) {
        if (std::isfinite(value)) summary.readings[j] += value * value;
      }
    }
  }
  summary.memory = memory.rows();
  return summary;
}

std::vector<TriangularFactor> score_blocks(const InnovationModel& innovations, const Record& record,
                                           const VectorXd& theta, const std::vector<Index>& columns,
                                           int blocks) {
  std::vector<TriangularFactor> factors(static_cast<std::size_t>(blocks),
                                        TriangularFactor(static_cast<int>(columns.size())));
  if (blocks == 0) return factors;
  const std::vector<Index> cuts = cut_blocks(static_cast<Index>(record.rows()), blocks);
  const Index each = innovations.rows_a_sample();
  std::size_t block = 0;
  Index sample = 0;
  innovations.scores(theta, [&](std::size_t /*row*/, MatrixXd& rows) {
    const Index end = sample + rows.rows() / each;
    for (Index first = sample; first < end;) {
      while (cuts[block + 1] <= first) ++block;
      const Index last = std::min(end, cuts[block + 1]);
      MatrixXd chosen =
          rows.middleRows((first - sample) * each, (last - first) * each)(Eigen::all, columns);
      factors[block].absorb(chosen);
      first = last;
    }
    sample = end;
  });
  return factors;
}

double likelihood_constant(std::size_t readings) {
  return 0.5 * static_cast<double>(readings) * std::log(2.0 * std::numbers::pi);
}

}  // namespace sepcal::estimation
