// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/nearest_points.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace sepcal::numerics {

using Eigen::Index;
using Eigen::MatrixXd;

NearestPoints::NearestPoints(const MatrixXd& points)
    : n_(points.rows()),
      order_(static_cast<std::size_t>(points.cols())),
      point_(static_cast<std::size_t>(points.cols())) {
  std::iota(order_.begin(), order_.end(), Index{0});
  if (order_.empty()) return;
  grow(points, 0, points.cols());
  ordered_.reserve(static_cast<std::size_t>(points.size()));
  for (const Index i : order_) {
    point_[static_cast<std::size_t>(i)] = ordered_.data() + ordered_.size();
    ordered_.insert(ordered_.end(), points.col(i).begin(), points.col(i).end());
  }
}

std::size_t NearestPoints::grow(const MatrixXd& points, Index first, Index last) {
  constexpr Index in_a_leaf = 8;
  const std::size_t place = nodes_.size();
  nodes_.push_back({.first = first, .last = last});
  if (last - first <= in_a_leaf) return place;
  const auto begin = order_.begin() + first;
  const auto end = order_.begin() + last;
  double widest = -1.0;
  Index axis = 0;
  for (Index k = 0; k < n_; ++k) {
    double low = points(k, *begin);
    double high = low;
    for (auto i = begin; i != end; ++i) {
      low = std::min(low, points(k, *i));
      high = std::max(high, points(k, *i));
    }
    if (high - low > widest) {
      widest = high - low;
      axis = k;
    }
  }
  const Index half = first + (last - first) / 2;
  const auto middle = order_.begin() + half;
  std::ranges::nth_element(begin, middle, end, {}, [&](Index i) { return points(axis, i); });
  const double cut = points(axis, *middle);
  const std::size_t below = grow(points, first, half);
  const std::size_t above = grow(points, half, last);
  nodes_[place] = {first, last, axis, cut, below, above};
  return place;
}

/// From a point to that at a place of the tree's order.
double NearestPoints::square_to(const double* centre, Index place) const {
  const double* const point = ordered_.data() + place * n_;
  double square = 0.0;
  for (Index k = 0; k < n_; ++k) square += (point[k] - centre[k]) * (point[k] - centre[k]);
  return square;
}

void NearestPoints::look_at(const Node& leaf, const double* centre, Index s, std::size_t count) {
  for (Index i = leaf.first; i < leaf.last; ++i) {
    const Index other = order_[static_cast<std::size_t>(i)];
    if (other == s) continue;
    const Neighbour found{square_to(centre, i), other};
    if (nearest_.size() == count) {
      if (!(found < nearest_.back())) continue;
      nearest_.pop_back();
    }
    nearest_.insert(std::ranges::upper_bound(nearest_, found), found);
  }
}

void NearestPoints::search(const Node& node, const double* centre, Index s, std::size_t count) {
  if (node.above == 0) return look_at(node, centre, s, count);
  const double beyond = centre[node.axis] - node.cut;
  const bool is_above = beyond >= 0.0;
  search(nodes_[is_above ? node.above : node.below], centre, s, count);
  if (nearest_.size() < count || beyond * beyond <= nearest_.back().first) {
    search(nodes_[is_above ? node.below : node.above], centre, s, count);
  }
}

void NearestPoints::search_other(const Node& node, const double* centre, Index label,
                                 const std::vector<Index>& labels, Neighbour& nearest) const {
  if (node.above == 0) {
    for (Index i = node.first; i < node.last; ++i) {
      const Index other = order_[static_cast<std::size_t>(i)];
      if (labels[static_cast<std::size_t>(other)] == label) continue;
      nearest = std::min(nearest, Neighbour{square_to(centre, i), other});
    }
    return;
  }
  const double beyond = centre[node.axis] - node.cut;
  const bool is_above = beyond >= 0.0;
  search_other(nodes_[is_above ? node.above : node.below], centre, label, labels, nearest);
  if (beyond * beyond <= nearest.first) {
    search_other(nodes_[is_above ? node.below : node.above], centre, label, labels, nearest);
  }
}

NearestPoints::Neighbour NearestPoints::find_other(Index s, const std::vector<Index>& labels,
                                                   double limit) const {
  const auto own = static_cast<std::size_t>(s);
  Neighbour nearest{limit, -1};
  search_other(nodes_.front(), point_[own], labels[own], labels, nearest);
  return nearest.second < 0 ? Neighbour{std::numeric_limits<double>::infinity(), -1} : nearest;
}

void NearestPoints::find(Index s, Index count, std::vector<Index>& found) {
  nearest_.clear();
  found.clear();
  if (count == 0) return;
  search(nodes_.front(), point_[static_cast<std::size_t>(s)], s, static_cast<std::size_t>(count));
  for (const auto& [square, point] : nearest_) found.push_back(point);
}

}  // namespace sepcal::numerics
