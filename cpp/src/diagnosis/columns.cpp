// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/columns.hpp"

#include "numerics/tall_products.hpp"

namespace sepcal::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

Columns::Columns(MatrixXd matrix)
    : cols_(matrix.cols()),
      fill_([kept = std::make_shared<const MatrixXd>(std::move(matrix))](
                Index first, Ref<MatrixXd> rows) { rows = kept->middleRows(first, rows.rows()); }) {
}

void Columns::fill(Index first, Ref<MatrixXd> rows) const {
  for (Index row = 0; row < rows.rows(); row += panel_rows) {
    fill_(first + row, rows.middleRows(row, std::min(panel_rows, rows.rows() - row)));
  }
}

MatrixXd Columns::rows(Index first, Index count) const {
  MatrixXd made(count, cols_);
  fill(first, made);
  return made;
}

MatrixXd Columns::dense(const RowLayout& layout) const {
  MatrixXd whole(layout.count(), cols_);
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    fill(layout.first(j), whole.middleRows(layout.first(j), layout.rows));
  }
  return whole;
}

Columns join(const Columns& left, const Columns& right) {
  return {left.cols() + right.cols(), [left, right](Index first, Ref<MatrixXd> rows) {
            left.fill(first, rows.leftCols(left.cols()));
            right.fill(first, rows.rightCols(right.cols()));
          }};
}

Columns view(const Ref<const MatrixXd>& matrix) {
  return {matrix.cols(),
          [matrix = Eigen::Map<const MatrixXd, 0, Eigen::OuterStride<>>(
               matrix.data(), matrix.rows(), matrix.cols(),
               Eigen::OuterStride<>(matrix.outerStride()))](Index first, Ref<MatrixXd> rows) {
            rows = matrix.middleRows(first, rows.rows());
          }};
}

Columns keep_few(const RowLayout& layout, const Columns& columns) {
  constexpr Index few = 6;
  return columns.cols() > few ? columns : Columns(columns.dense(layout));
}

Columns select(const Columns& columns, const std::vector<Index>& chosen) {
  return {static_cast<Index>(chosen.size()), [columns, chosen](Index first, Ref<MatrixXd> rows) {
            rows = columns.rows(first, rows.rows())(Eigen::all, chosen);
          }};
}

VectorXd multiply_transposed(const RowLayout& layout, const Columns& X, const VectorXd& y) {
  VectorXd sum = VectorXd::Zero(X.cols());
  for_each_panel(layout, [&](Index first, Index rows) {
    numerics::add_transposed_product(X.rows(first, rows), y.segment(first, rows), sum);
  });
  return sum;
}

VectorXd subtract(const RowLayout& layout, VectorXd y, const Columns& X, const VectorXd& c) {
  for_each_panel(layout, [&](Index first, Index rows) {
    numerics::add_product(X.rows(first, rows), -c, y.segment(first, rows));
  });
  return y;
}

}  // namespace sepcal::diagnosis
