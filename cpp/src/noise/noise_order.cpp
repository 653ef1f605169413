// SPDX-License-Identifier: BSD-3-Clause
// Every d serves all orders. After the grid, a parabola through an order's best three d proposes
// the next, until none promises to gain enough in -2 ln L.
#include "noise/noise_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/stop.hpp"
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
  /// `worthwhile`: what -2 ln L must promise to fall by for another d.
  Scan(const NoiseRows& rows, int max_order, double worthwhile)
      : rows_(rows), max_order_(max_order), worthwhile_(worthwhile) {}

  void evaluate(double d) {
    base::heed_stop();
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

  /// The criterion of white noise, once d = 0 was tried.
  double white() const { return tried_.at(0.0).criterion[0]; }

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
      if (0.5 * slope * slope / curvature < worthwhile_) return;
      const double margin = 0.02;
      evaluate(std::clamp(best->first - slope / curvature, left->first + margin * a,
                          right->first - margin * b));
      if (std::min(a, b) < 1e-4) return;
    }
  }

 private:
  const NoiseRows& rows_;
  int max_order_;
  double worthwhile_;
  std::map<double, BurgFit> tried_;
};

const std::vector<double> stationary_grid{0.0, 0.1, 0.2, 0.3, 0.4, 0.48};
const std::vector<double> free_grid{0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 0.999};

/// The highest order that rows of a free level have enough rows for.
int highest_order(const std::vector<Index>& lengths, int most) {
  Index rows = 0;
  Index longest = 0;
  for (const Index length : lengths) {
    rows += length - 1;
    longest = std::max(longest, length - 1);
  }
  return static_cast<int>(std::min<Index>({most, rows / 10, longest / 4}));
}

/// The order and d of least AIC, d from `grid` on.
NoiseOrder choose(const NoiseRows& rows, int least, int most, const std::vector<double>& grid) {
  Scan scan(rows, most, 0.05);
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
  const int most = highest_order(lengths, options.order.value_or(options.max_order));
  const int least = options.order ? most : 0;
  return {choose(levels, least, most, stationary_grid),
          choose(differences, least, most, free_grid)};
}

VectorXd scan_gains(const VectorXd& e, const std::vector<Index>& lengths) {
  const NoiseRows levels(e, lengths, false);
  const int most = highest_order(lengths, NoiseFitOptions().max_order);
  Scan scan(levels, most, 0.5);
  for (const double d : stationary_grid) scan.evaluate(d);
  VectorXd gains(most + 1);
  for (int order = 0; order <= most; ++order) {
    scan.refine(order);
    gains[order] = scan.white() - scan.find_best(order)->second.criterion[order];
  }
  return gains;
}

}  // namespace sepcal::noise
