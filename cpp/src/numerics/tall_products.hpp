// SPDX-License-Identifier: BSD-3-Clause
// Products of tall matrices of few columns, in the widest registers that the processor has. Columns
// are contiguous and may be any distance apart. All widths give the same digits.
#pragma once

#include <Eigen/Core>

namespace sepcal::numerics {

/// sum += A'B, A of rows x p, B of rows x q, sum of p x q.
void add_transposed_product(const Eigen::Ref<const Eigen::MatrixXd>& A,
                            const Eigen::Ref<const Eigen::MatrixXd>& B,
                            Eigen::Ref<Eigen::MatrixXd> sum);

/// sum += A'A.
void add_square(const Eigen::Ref<const Eigen::MatrixXd>& A, Eigen::Ref<Eigen::MatrixXd> sum);

/// Y += A C, A of rows x p, C of p x q, Y of rows x q.
void add_product(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::MatrixXd& C,
                 Eigen::Ref<Eigen::MatrixXd> Y);

}  // namespace sepcal::numerics
