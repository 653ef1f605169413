// SPDX-License-Identifier: BSD-3-Clause
// The second step of Haupt and Kasdin as a model: one row whose p outputs are S y-hat, S' S the
// first step's information, and their prediction S f(xi) (Eqs. 31, 32).
#pragma once

#include "sepcal/detail/rivals/haupt_kasdin.hpp"
#include "sepcal/record.hpp"

namespace sepcal::rivals {

class SecondStepModel final : public BlockModel {
 public:
  /// `root`: S, p x p. `change` must outlive it.
  SecondStepModel(const ChangeOfVariables& change, Eigen::MatrixXd root);

  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                Eigen::Ref<Eigen::MatrixXd> rows) const override;

  /// The row, of the first step's states.
  Record measure(const Eigen::VectorXd& states) const;

  /// S df/dxi (p x n).
  Eigen::MatrixXd slopes(const Eigen::VectorXd& xi) const;

 private:
  /// Throws Error for another number of states than the first step's.
  void check(Eigen::Index states) const;

  const ChangeOfVariables& change_;
  Eigen::MatrixXd root_;
};

}  // namespace sepcal::rivals
