// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/axes.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace sepcal::checks {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;

/// The best of what was tried; the log as it stands is tried first.
class AxisSearch {
 public:
  void enter(std::string axes, double agreement) {
    if (first_) best_.agreement_as_logged = agreement;
    if (first_ || agreement > best_.agreement) {
      best_.axes = std::move(axes);
      best_.agreement = agreement;
    }
    first_ = false;
  }
  const BetterAxes& best() const { return best_; }

 private:
  bool first_ = true;
  BetterAxes best_;
};

std::string name_axes(std::span<const char* const> names, std::span<const int> order,
                      unsigned signs) {
  std::string text;
  for (std::size_t i = 0; i < order.size(); ++i) {
    text += i == 0 ? "" : ", ";
    text += (signs >> i & 1U) != 0 ? "-" : "";
    text += names[static_cast<std::size_t>(order[i])];
  }
  return text;
}

}  // namespace

std::optional<BetterAxes> find_track_axes(const std::vector<std::array<double, 3>>& moving) {
  if (moving.empty()) return std::nullopt;
  constexpr std::array names{"vn", "ve"};
  AxisSearch search;
  for (const std::array<int, 2> order : {std::array{0, 1}, std::array{1, 0}}) {
    for (unsigned signs = 0; signs < 4; ++signs) {
      double sum = 0.0;
      for (const auto& row : moving) {
        const double north = (signs & 1U ? -1 : 1) * row[static_cast<std::size_t>(order[0])];
        const double east = (signs & 2U ? -1 : 1) * row[static_cast<std::size_t>(order[1])];
        sum += std::cos(std::atan2(east, north) - row[2]);
      }
      search.enter(name_axes(names, order, signs), sum / static_cast<double>(moving.size()));
    }
  }
  const BetterAxes& best = search.best();
  if (best.agreement_as_logged < 0.5 && best.agreement > 0.85) return best;
  if (best.agreement_as_logged < 0.3) return BetterAxes{"", 0.0, best.agreement_as_logged};
  return std::nullopt;
}

std::optional<BetterAxes> find_field_axes(const Matrix3Xd& read, const Matrix3Xd& truth) {
  if (truth.cols() < 2) return std::nullopt;
  const Matrix3Xd m = read.colwise() - read.rowwise().mean();
  const Matrix3Xd h = truth.colwise() - truth.rowwise().mean();
  const Matrix3d products = m * h.transpose();  // (i, j): of the reading i and the true j
  const double scale = m.norm() * h.norm();
  if (!(scale > 0)) return std::nullopt;
  constexpr std::array names{"mx", "my", "mz"};
  AxisSearch search;
  std::array order{0, 1, 2};
  do {
    for (unsigned signs = 0; signs < 8; ++signs) {
      double sum = 0.0;
      for (unsigned j = 0; j < 3; ++j) {
        sum += (signs >> j & 1U ? -1 : 1) * products(order[j], j);
      }
      search.enter(name_axes(names, order, signs), sum / scale);
    }
  } while (std::ranges::next_permutation(order).found);
  const auto& [axes, agreement, as_logged] = search.best();
  if (agreement > 0.9 && as_logged < 0.9 && 5 * (1 - agreement) < 1 - as_logged)
    return search.best();
  return std::nullopt;
}

}  // namespace sepcal::checks
