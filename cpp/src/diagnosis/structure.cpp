// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/structure.hpp"

#include <cmath>

namespace sepcal::diagnosis {

Structure measure_structure(const LinearisedFit& fit, const Eigen::VectorXd& residual,
                            double reduction, int added, PseBound bound) {
  const RowLayout& layout = fit.layout;
  Structure found{.sse = residual.squaredNorm(), .sse_reduction = reduction};
  const auto N = static_cast<double>(layout.count());
  const auto p = static_cast<double>(fit.parameters.size());
  const auto q = static_cast<double>(added);
  const double freedom = N - p - q;
  if (freedom > 0.0) found.partial_f = reduction / q * freedom / (found.sse - reduction);
  double variance = 0.0;  // of z in units of the RMSE, the mean of the outputs'
  for (const UsedOutput& output : layout.outputs) {
    variance += output.variance / std::pow(output.scale, 2);
  }
  variance /= static_cast<double>(layout.outputs.size());
  const double share = bound == PseBound::sidpac ? 0.5 : 1.0;
  const double s2max = variance > 0.0 ? share * variance : not_a_number;
  found.pse_without = (found.sse + 2.0 * s2max * p) / N;
  if (variance > 0.0) {
    const double total =
        variance * (N - static_cast<double>(layout.outputs.size()));  // each about its mean
    found.r_squared_without = 1.0 - found.sse / total;
    found.r_squared = 1.0 - (found.sse - reduction) / total;
  }
  found.pse = (found.sse - reduction + 2.0 * s2max * (p + q)) / N;
  return found;
}

}  // namespace sepcal::diagnosis
