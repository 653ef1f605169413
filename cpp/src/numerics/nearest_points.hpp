// SPDX-License-Identifier: BSD-3-Clause
// The nearest of scattered points, by a tree that halves them along the axis of their widest spread
// (Friedman, Bentley & Finkel 1977).
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace sepcal::numerics {

class NearestPoints {
 public:
  /// points: n x S, finite.
  explicit NearestPoints(const Eigen::MatrixXd& points);

  /// Sets `found` to the `count` points nearest to point s, less than S of them, itself left out,
  /// nearest first; of points as far away the one that comes first.
  void find(Eigen::Index s, Eigen::Index count, std::vector<Eigen::Index>& found);

  using Neighbour = std::pair<double, Eigen::Index>;  // squared distance, point

  /// The nearest to point s whose label is another, nearer than `limit` (squared distance);
  /// infinity and -1 where there is none. `labels`: one a point.
  Neighbour find_other(Eigen::Index s, const std::vector<Eigen::Index>& labels, double limit) const;

 private:
  /// Points of the tree's order, from `first` to before `last`; a leaf has no `above`.
  struct Node {
    Eigen::Index first = 0;
    Eigen::Index last = 0;
    Eigen::Index axis = 0;
    double cut = 0.0;
    std::size_t below = 0;  // among nodes_
    std::size_t above = 0;
  };
  std::size_t grow(const Eigen::MatrixXd& points, Eigen::Index first, Eigen::Index last);
  void search(const Node& node, const double* centre, Eigen::Index s, std::size_t count);
  double square_to(const double* centre, Eigen::Index place) const;
  void search_other(const Node& node, const double* centre, Eigen::Index label,
                    const std::vector<Eigen::Index>& labels, Neighbour& nearest) const;
  void look_at(const Node& leaf, const double* centre, Eigen::Index s, std::size_t count);

  Eigen::Index n_;
  std::vector<Eigen::Index> order_;
  std::vector<Node> nodes_;
  std::vector<double> ordered_;          // points one after another, in the tree's order
  std::vector<const double*> point_;     // where each of them is there
  std::vector<Neighbour> nearest_ = {};  // of a search: the nearest first
};

}  // namespace sepcal::numerics
