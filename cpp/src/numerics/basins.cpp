// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/basins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "numerics/nearest_points.hpp"

namespace sepcal::numerics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Indices = std::vector<Index>;

/// Sets of samples; each is known by one of them, which `pour` says.
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

/// Who is whose neighbour, point after point.
class Neighbours {
 public:
  /// The 4 n nearest of every point, made mutual: fewer leave a narrow valley in pieces. What
  /// chance crowded together, apart from all others, is joined to the nearest of these.
  explicit Neighbours(const MatrixXd& points) : count_(points.cols()) {
    if (points.rows() == 1) {
      join_along_line(points);
    } else {
      join_nearest(points);
    }
    sort_pairs();
  }

  std::span<const Index> of(Index s) const {
    const std::size_t first = begins_[static_cast<std::size_t>(s)];
    return {all_.data() + first, begins_[static_cast<std::size_t>(s) + 1] - first};
  }

 private:
  /// On a line there is an order: two on either side.
  void join_along_line(const MatrixXd& points) {
    Indices order(static_cast<std::size_t>(count_));
    std::iota(order.begin(), order.end(), Index{0});
    std::ranges::sort(order, {}, [&](Index s) { return std::pair(points(0, s), s); });
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (std::size_t k = i + 1; k < std::min(i + 3, order.size()); ++k) {
        pairs_.emplace_back(order[i], order[k]);
      }
    }
  }

  void join_nearest(const MatrixXd& points) {
    NearestPoints tree(points);
    const Index near = std::min(4 * points.rows(), count_ - 1);
    Pools pools(count_);
    Indices found;
    for (Index s = 0; s < count_; ++s) {
      tree.find(s, near, found);
      for (const Index other : found) join(s, other, pools);
    }
    while (join_crowds(tree, pools)) {
    }
  }

  void join(Index s, Index other, Pools& pools) {
    pairs_.emplace_back(s, other);
    pools.pour(pools.lowest(s), pools.lowest(other));
  }

  /// Joins every crowd but the largest to the point nearest to it. Whether there were several.
  bool join_crowds(const NearestPoints& tree, Pools& pools) {
    Indices crowd(static_cast<std::size_t>(count_));
    Indices size(static_cast<std::size_t>(count_), 0);
    for (Index s = 0; s < count_; ++s) {
      crowd[static_cast<std::size_t>(s)] = pools.lowest(s);
      ++size[static_cast<std::size_t>(pools.lowest(s))];
    }
    const auto largest = static_cast<Index>(std::ranges::max_element(size) - size.begin());
    if (count_ == 0 || size[static_cast<std::size_t>(largest)] == count_) return false;
    struct Bridge {
      double square = std::numeric_limits<double>::infinity();
      Index from = -1;
      Index to = -1;
    };
    std::map<Index, Bridge> bridges;  // of each crowd
    for (Index s = 0; s < count_; ++s) {
      const Index own = crowd[static_cast<std::size_t>(s)];
      if (own == largest) continue;
      Bridge& bridge = bridges[own];
      const auto [square, other] = tree.find_other(s, crowd, bridge.square);
      if (other >= 0) bridge = {square, s, other};
    }
    for (const auto& [name, bridge] : bridges) join(bridge.from, bridge.to, pools);
    return true;
  }

  void sort_pairs() {
    begins_.assign(static_cast<std::size_t>(count_) + 1, 0);
    for (const auto& [s, other] : pairs_) {
      ++begins_[static_cast<std::size_t>(s)];
      ++begins_[static_cast<std::size_t>(other)];
    }
    std::exclusive_scan(begins_.begin(), begins_.end(), begins_.begin(), std::size_t{0});
    all_.resize(begins_.back());
    std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
    for (const auto& [s, other] : pairs_) {
      all_[next[static_cast<std::size_t>(s)]++] = other;
      all_[next[static_cast<std::size_t>(other)]++] = s;
    }
  }

  Index count_;
  std::vector<std::pair<Index, Index>> pairs_;
  std::vector<std::size_t> begins_;
  Indices all_;
};

}  // namespace

std::vector<Basin> find_basins(const MatrixXd& points, const VectorXd& values) {
  const Neighbours neighbours(points);
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
    for (const Index other : neighbours.of(s)) {
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
