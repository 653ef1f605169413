// SPDX-License-Identifier: BSD-3-Clause
#include "model/differences.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sepcal::model {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Function = std::function<VectorXd(double)>;

constexpr double relative_step = 0x1p-11;  // balances h^4 against rounding / h
constexpr double agreement = 1e-5;         // of differences over h and 2h; the error is its square
constexpr double shrink = 0.125;           // divides a gap that is truncation by 64
constexpr int most_shrinks = 6;

/// Zero in place of what is not finite.
double largest(const VectorXd& values) {
  return values.size() == 0 ? 0.0
                            : values.array().isFinite().select(values, 0.0).cwiseAbs().maxCoeff();
}

struct Central {
  VectorXd derivative;
  double gap = 0.0;       // of the differences over h and 2h
  double rounding = 0.0;  // what of it may be rounding
};

Central difference_centrally(const Function& g, double h) {
  const VectorXd above = g(h);
  const VectorXd near = (above - g(-h)) / (2.0 * h);
  const VectorXd far = (g(2.0 * h) - g(-2.0 * h)) / (4.0 * h);
  constexpr double units = 64.0 * std::numeric_limits<double>::epsilon();
  return {(4.0 * near - far) / 3.0, largest(near - far), units * largest(above) / h};
}

/// While h is too long, the gap may grow as h shrinks, up to the slope of the bends; then it falls.
VectorXd refine_centrally(const Function& g, double h) {
  Central current = difference_centrally(g, h);
  Central best = current;
  for (int i = 0; i < most_shrinks; ++i) {
    if (current.gap <= std::max(agreement * largest(current.derivative), current.rounding)) break;
    h *= shrink;
    current = difference_centrally(g, h);
    if (current.gap < best.gap) best = current;
  }
  return best.derivative;
}

/// Towards positive t for h > 0, else towards negative t.
VectorXd difference_on_one_side(const Function& g, double h) {
  return (-25.0 * g(0.0) + 48.0 * g(h) - 36.0 * g(2.0 * h) + 16.0 * g(3.0 * h) - 3.0 * g(4.0 * h)) /
         (12.0 * h);
}

}  // namespace

VectorXd differentiate(const Function& g, double scale, double lower, double upper) {
  const double h = std::exp2(std::floor(std::log2(relative_step * scale)));  // x + h is then exact
  const bool leaves_below = -2.0 * h < lower;
  const bool leaves_above = 2.0 * h > upper;
  VectorXd derivative = leaves_below   ? difference_on_one_side(g, h)
                        : leaves_above ? difference_on_one_side(g, -h)
                                       : refine_centrally(g, h);
  for (const double side : {h, -h}) {
    if (derivative.allFinite()) break;
    derivative = derivative.array().isFinite().select(derivative, difference_on_one_side(g, side));
  }
  return derivative;
}

void differentiate_by_inputs(const std::function<VectorXd(const Block&)>& predict,
                             const Block& block, std::span<const int> inputs,
                             // NOLINTNEXTLINE(performance-unnecessary-value-param): an output
                             Eigen::Ref<Eigen::MatrixXd> columns) {
  std::vector<const double*> pointers(block.inputs.begin(), block.inputs.end());
  const auto rows = static_cast<Index>(block.rows);
  VectorXd moved(rows);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const double*& pointer = pointers[static_cast<std::size_t>(inputs[i])];
    const double* const original = pointer;
    const Eigen::Map<const VectorXd> column(original, rows);
    pointer = moved.data();
    const auto along = [&](double step) {
      moved.array() = column.array() + step;
      return predict({pointers, block.rows, block.first, block.starts_segment});
    };
    const double spread = std::sqrt((column.array() - column.mean()).square().mean());
    const double size = column.cwiseAbs().maxCoeff();
    const bool varies = spread > 1e-9 * size;  // what is less is rounding of the mean
    const double scale = varies ? spread : size > 0 ? size : 1.0;
    columns.col(static_cast<Index>(i)) = differentiate(along, scale, -infinity, infinity);
    pointer = original;
  }
}

}  // namespace sepcal::model
