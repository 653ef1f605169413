// SPDX-License-Identifier: BSD-3-Clause
// Every d serves all orders. After the grid, a parabola through an order's best three d proposes
// the next, until none promises to gain 0.05 in -2 ln L.
#include "noise/noise_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "noise/arfima_factor.hpp"
#include "noise/autoregression.hpp"
#include "noise/noise_room.hpp"

namespace sepcal::noise {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The d tried so far, with what Burg made of each.
class Scan {
 public:
  Scan(const NoiseRows& rows, int max_order) : rows_(rows), max_order_(max_order) {}

  void evaluate(double d) {
    const ArfimaFactor factor(rows_.free_level ? d - 1.0 : d, VectorXd(), rows_.blocks);
    VectorXd y = rows_.values;
    factor.whiten(y, rows_.blocks);
    BurgFit fit = fit_burg(y, rows_.blocks, max_order_);
    fit.criterion.array() += factor.log_determinant(rows_.blocks);
    tried_.emplace(d, std::move(fit));
  }

  auto find_best(int order) const {
    return std::ranges::min_element(
        tried_, {}, [order](const auto& tried) { return tried.second.criterion[order]; });
  }

  /// Narrows d around the best for an order.
  void refine(int order) {
    constexpr int most = 12;
    for (int k = 0; k < most; ++k) {
      const auto best = find_best(order);
      if (best == tried_.begin() || std::next(best) == tried_.end()) return;
      const auto value = [order](const auto& at) { return at->second.criterion[order]; };
      const auto left = std::prev(best);
      const auto right = std::next(best);
      const double a = best->first - left->first;
      const double b = right->first - best->first;
      const double fall = (value(best) - value(left)) / a;
      const double rise = (value(right) - value(best)) / b;
      const double curvature = (rise - fall) / (0.5 * (a + b));
      if (!(curvature > 0.0)) return;
      const double slope = (fall * b + rise * a) / (a + b);
      if (0.5 * slope * slope / curvature < 0.05) return;
      const double margin = 0.02;
      evaluate(std::clamp(best->first - slope / curvature, left->first + margin * a,
                          right->first - margin * b));
      if (std::min(a, b) < 1e-4) return;
    }
  }

 private:
  const NoiseRows& rows_;
  int max_order_;
  std::map<double, BurgFit> tried_;
};

/// The order and d of least AIC, d from `grid` on.
NoiseOrder choose(const NoiseRows& rows, int least, int most, const std::vector<double>& grid) {
  Scan scan(rows, most);
  for (const double d : grid) scan.evaluate(d);
  int chosen = least;
  double lowest = std::numeric_limits<double>::infinity();
  for (int order = least; order <= most; ++order) {
    scan.refine(order);
    const double criterion =
        scan.find_best(order)->second.criterion[order] + penalise(order, rows.values.size());
    if (criterion < lowest) {
      lowest = criterion;
      chosen = order;
    }
  }
  const auto best = scan.find_best(chosen);
  return {best->first, best->second.partial.head(chosen)};
}

}  // namespace

double penalise(Index order, Index rows) {
  const double parameters = static_cast<double>(order) + 2.0;  // phi, d and sigma
  const auto n = static_cast<double>(rows);
  return 2.0 * parameters * n / std::max(1.0, n - parameters - 1.0);
}

std::array<NoiseOrder, 2> choose_noise_orders(const VectorXd& e, const std::vector<Index>& lengths,
                                              const NoiseFitOptions& options) {
  const NoiseRows levels(e, lengths, false);
  const NoiseRows differences(e, lengths, true);
  const Index longest = *std::ranges::max_element(differences.blocks);
  const int most = static_cast<int>(std::min<Index>(
      {options.order.value_or(options.max_order), differences.values.size() / 10, longest / 4}));
  const int least = options.order ? most : 0;
  return {choose(levels, least, most, {0.0, 0.1, 0.2, 0.3, 0.4, 0.48}),
          choose(differences, least, most, {0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 0.999})};
}

}  // namespace sepcal::noise
