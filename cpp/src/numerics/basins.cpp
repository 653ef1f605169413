// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/basins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sepcal::numerics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Indices = std::vector<Index>;

/// The 4 n nearest neighbours of every point, made mutual: fewer leave a narrow valley in pieces.
std::vector<Indices> neighbours_of(const MatrixXd& points) {
  const Index count = points.cols();
  const Index near = std::min<Index>(4 * points.rows(), count - 1);
  std::vector<Indices> neighbours(static_cast<std::size_t>(count));
  Indices order(static_cast<std::size_t>(count));
  for (Index s = 0; s < count; ++s) {
    const VectorXd distance = (points.colwise() - points.col(s)).colwise().squaredNorm();
    std::iota(order.begin(), order.end(), Index{0});
    std::ranges::nth_element(order, order.begin() + near, {}, [&](Index i) { return distance[i]; });
    for (Index i = 0; i <= near; ++i) {
      const Index other = order[static_cast<std::size_t>(i)];
      if (other == s) continue;
      neighbours[static_cast<std::size_t>(s)].push_back(other);
      neighbours[static_cast<std::size_t>(other)].push_back(s);
    }
  }
  return neighbours;
}

/// Sets of flooded samples; each is known by its lowest.
class Pools {
 public:
  explicit Pools(Index count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }

  Index lowest(Index s) {
    while (parent(s) != s) s = parent(s) = parent(parent(s));
    return s;
  }

  void pour(Index higher, Index lower) { parent(higher) = lower; }

 private:
  Index& parent(Index s) { return parent_[static_cast<std::size_t>(s)]; }

  Indices parent_;
};

}  // namespace

std::vector<Basin> find_basins(const MatrixXd& points, const VectorXd& values) {
  const auto neighbours = neighbours_of(points);
  Indices rising(static_cast<std::size_t>(values.size()));
  std::iota(rising.begin(), rising.end(), Index{0});
  std::erase_if(rising, [&](Index s) { return !std::isfinite(values[s]); });
  const auto lower = [&](Index a, Index b) {
    return values[a] < values[b] || (values[a] == values[b] && a < b);
  };
  std::ranges::sort(rising, lower);

  Pools pools(values.size());
  std::vector<bool> flooded(static_cast<std::size_t>(values.size()), false);
  std::vector<Basin> basins;
  for (const Index s : rising) {
    flooded[static_cast<std::size_t>(s)] = true;
    for (const Index other : neighbours[static_cast<std::size_t>(s)]) {
      if (!flooded[static_cast<std::size_t>(other)]) continue;
      Index a = pools.lowest(s);
      Index b = pools.lowest(other);
      if (a == b) continue;
      if (lower(a, b)) std::swap(a, b);
      if (a != s) basins.push_back({a, values[s] - values[a]});  // s itself only wetted a slope
      pools.pour(a, b);
    }
  }
  for (const Index s : rising) {
    if (pools.lowest(s) == s) basins.push_back({s, std::numeric_limits<double>::infinity()});
  }
  std::ranges::stable_sort(basins, [&](const Basin& a, const Basin& b) {
    return a.depth > b.depth || (a.depth == b.depth && lower(a.lowest, b.lowest));
  });
  return basins;
}

}  // namespace sepcal::numerics
