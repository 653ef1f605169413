// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/bounded_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "numerics/decompositions.hpp"
#include "sepcal/detail/eigen.hpp"

namespace sepcal::numerics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

enum class Side { free, lower, upper };

class DenseLeastSquares final : public LeastSquares {
 public:
  DenseLeastSquares(const MatrixXd& R, const VectorXd& q)
      : R_(R), q_(q), lengths_(R.colwise().norm()) {}

  VectorXd lengths() const override { return lengths_; }

  VectorXd pull(const VectorXd& x) const override { return R_.transpose() * (q_ - R_ * x); }

  VectorXd minimise_over(const std::vector<Index>& free, VectorXd x) const override {
    x(free).setZero();
    VectorXd lengths = lengths_(free);
    for (double& length : lengths) length = length > 0 ? length : 1.0;
    const MatrixXd columns = R_(Eigen::all, free) * lengths.cwiseInverse().asDiagonal();
    const VectorXd left = q_ - R_ * x;
    x(free) = columns.completeOrthogonalDecomposition().solve(left).cwiseQuotient(lengths);
    return x;
  }

 private:
  const MatrixXd& R_;
  const VectorXd& q_;
  VectorXd lengths_;
};

class ActiveSet {
 public:
  ActiveSet(const LeastSquares& problem, const Box& box)
      : problem_(problem), box_(box), lengths_(problem.lengths()) {
    x_ = VectorXd::Zero(lengths_.size());
    // What begins on a bound and is pushed against it stays there for now.
    const VectorXd pull = problem.pull(x_);
    for (Index k = 0; k < x_.size(); ++k) {
      sides_.push_back(box.lower[k] >= 0.0 && pull[k] <= 0   ? Side::lower
                       : box.upper[k] <= 0.0 && pull[k] >= 0 ? Side::upper
                                                             : Side::free);
    }
  }

  BoundedSolution solve() {
    const Index most_changes = 10 * x_.size();
    Index released = -1;
    Side left = Side::free;
    for (Index change = 0; change < most_changes; ++change) {
      const Index hit = advance(unbounded());
      if (hit < 0) {
        released = strongest_pull();
        if (released < 0) break;
        left = std::exchange(side(released), Side::free);
      } else if (hit == released && side(hit) == left) {
        break;  // rounding alone had freed it
      } else {
        released = -1;
      }
    }
    BoundedSolution solution{x_, {}};
    for (const Side at : sides_) solution.active.push_back(at != Side::free);
    return solution;
  }

 private:
  /// The minimum over the free parameters, the others where they are.
  VectorXd unbounded() const {
    std::vector<Index> free;
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      if (sides_[k] == Side::free) free.push_back(static_cast<Index>(k));
    }
    return free.empty() ? x_ : problem_.minimise_over(free, x_);
  }

  /// Goes towards `target` up to the first bound; which one, or -1 where none is in the way.
  Index advance(const VectorXd& target) {
    double part = 1.0;
    Index hit = -1;
    for (Index k = 0; k < x_.size(); ++k) {
      if (side(k) != Side::free) continue;
      const double step = target[k] - x_[k];
      const double bound = step < 0 ? box_.lower[k] : box_.upper[k];
      const double reach = (bound - x_[k]) / step;
      if ((step < 0 ? target[k] < bound : target[k] > bound) && reach < part) {
        part = reach;
        hit = k;
      }
    }
    x_ += part * (target - x_);
    if (hit >= 0) {
      const bool low = target[hit] < box_.lower[hit];
      x_[hit] = low ? box_.lower[hit] : box_.upper[hit];
      side(hit) = low ? Side::lower : Side::upper;
    }
    return hit;
  }

  /// The parameter that pulls hardest off its bound; -1 where none does.
  Index strongest_pull() const {
    const VectorXd pull = problem_.pull(x_);
    Index strongest = -1;
    double strength = 0.0;
    for (Index k = 0; k < x_.size(); ++k) {
      const Side at = sides_[static_cast<std::size_t>(k)];
      if (at == Side::free || !(lengths_[k] > 0)) continue;
      const double off = (at == Side::lower ? pull[k] : -pull[k]) / lengths_[k];
      if (off > strength) {
        strength = off;
        strongest = k;
      }
    }
    return strongest;
  }

  Side& side(Index k) { return sides_[static_cast<std::size_t>(k)]; }

  const LeastSquares& problem_;
  const Box& box_;
  VectorXd lengths_;
  VectorXd x_;
  std::vector<Side> sides_;
};

}  // namespace

BoundedSolution solve_bounded(const LeastSquares& problem, const Box& box) {
  return ActiveSet(problem, box).solve();
}

BoundedSolution solve_bounded(const MatrixXd& R, const VectorXd& q, const Box& box) {
  return solve_bounded(DenseLeastSquares(R, q), box);
}

}  // namespace sepcal::numerics
