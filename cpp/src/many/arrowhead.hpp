// SPDX-License-Identifier: BSD-3-Clause
// Least squares whose matrix is an arrowhead: every flight has columns of its own and some that all
// share. A QR factorisation of one flight's [own | shared | q] eliminates its own columns exactly;
// what is left below merges over the flights by stacking.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "many/split.hpp"
#include "numerics/bounded_least_squares.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::many {

/// One flight's rows once its own columns are eliminated:
///   [ own  cross  rest  ]
///   [  0     shared     ]
struct Share {
  Eigen::MatrixXd own;      // n_own x n_own, upper
  Eigen::MatrixXd cross;    // n_own x n_shared
  Eigen::VectorXd rest;     // n_own
  TriangularFactor shared;  // of [shared | r], own columns projected out
};

/// `rows`: any number x (n_own + n_shared + 1), of [own | shared | r]. Rows that singular own
/// columns don't reach join the shared factor.
Share eliminate_own(Eigen::MatrixXd rows, Eigen::Index n_own);

/// The factors of [shared | r] of all flights, merged in their order.
TriangularFactor merge_shared(const std::vector<Share>& shares);

/// What all flights together say of the shared parameters, with `known` rows of [shared | r] beside
/// them: n_shared x n_shared, upper.
Eigen::MatrixXd shared_factor(const std::vector<Share>& shares, Eigen::MatrixXd known);

/// [own cross; 0 joint]: what all flights together say of one flight's own and of the shared
/// parameters. `joint`: n_shared x n_shared, upper.
Eigen::MatrixXd beside_others(const Share& share, const Eigen::MatrixXd& joint);

class Arrowhead final : public numerics::LeastSquares {
 public:
  /// `blocks`: a factor of [own | shared | q] each; they must outlive this.
  Arrowhead(const std::vector<TriangularFactor>& blocks, const Layout& layout)
      : blocks_(blocks), layout_(layout) {}

  Eigen::VectorXd lengths() const override;
  Eigen::VectorXd pull(const Eigen::VectorXd& x) const override;
  Eigen::VectorXd minimise_over(const std::vector<Eigen::Index>& free,
                                Eigen::VectorXd x) const override;

  /// |A x| and |q|.
  double length_of(const Eigen::VectorXd& x) const;
  double residual() const;

 private:
  const std::vector<TriangularFactor>& blocks_;
  Layout layout_;
};

}  // namespace sepcal::many
