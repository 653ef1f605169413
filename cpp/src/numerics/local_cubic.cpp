// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/local_cubic.hpp"

#include <algorithm>
#include <limits>

#include "numerics/decompositions.hpp"

namespace sepcal::numerics {
namespace {

/// Rows [first, last).
struct Window {
  std::size_t first;
  std::size_t last;

  std::size_t rows() const { return last - first; }
};

Window window_about(std::span<const double> time, double centre, double width) {
  const double slack = 1e-6 * width;  // rows that lie on an edge are in, whatever rounding says
  const double latest = std::max(time.front(), time.back() - width);
  const double begin = std::clamp(centre - 0.5 * width, time.front(), latest);
  const auto first = std::ranges::lower_bound(time, begin - slack);
  const auto last = std::ranges::upper_bound(time, begin + width + slack);
  return {static_cast<std::size_t>(first - time.begin()),
          static_cast<std::size_t>(last - time.begin())};
}

}  // namespace

std::size_t fewest_rows(std::span<const double> time, double window) {
  std::size_t fewest = time.size();
  for (const double t : time) fewest = std::min(fewest, window_about(time, t, window).rows());
  return fewest;
}

std::vector<double> differentiate_locally(std::span<const double> time,
                                          std::span<const double> values, double window) {
  std::vector<double> slopes(time.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t row = 0; row < time.size(); ++row) {
    const Window rows = window_about(time, time[row], window);
    if (rows.rows() < 4) continue;
    const auto n = static_cast<Eigen::Index>(rows.rows());
    Eigen::MatrixXd powers(n, 4);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double s = (time[rows.first + static_cast<std::size_t>(i)] - time[row]) / window;
      powers.row(i) << 1.0, s, s * s, s * s * s;
    }
    const Eigen::Map<const Eigen::VectorXd> there(values.data() + rows.first, n);
    if (!there.allFinite()) continue;
    slopes[row] = powers.householderQr().solve(there)[1] / window;
  }
  return slopes;
}

}  // namespace sepcal::numerics
