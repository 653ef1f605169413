// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/columns.hpp"

#include "numerics/tall_products.hpp"

namespace sepcal::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

Columns::Columns(Index cols, Fill fill) : cols_(cols) {
  parts_.push_back({.cols = cols, .fill = std::move(fill)});
}

Columns::Columns(MatrixXd matrix) {
  const auto kept = std::make_shared<const MatrixXd>(std::move(matrix));
  *this = view(*kept);
  parts_.front().kept = kept;
}

void Columns::fill(Index first, Ref<MatrixXd> rows) const {
  for (Index row = 0; row < rows.rows(); row += panel_rows) {
    auto panel = rows.middleRows(row, std::min(panel_rows, rows.rows() - row));
    Index at = 0;
    for (const Part& part : parts_) {
      if (part.fill) {
        part.fill(first + row, panel.middleCols(at, part.cols));
      } else {
        panel.middleCols(at, part.cols) = part.rows(first + row, panel.rows());
      }
      at += part.cols;
    }
  }
}

void Columns::visit(Index first, Index count,
                    const std::function<void(Index at, const Rows& rows)>& visit) const {
  Index at = 0;
  for (const Part& part : parts_) {
    if (part.fill) {
      MatrixXd made(count, part.cols);
      part.fill(first, made);
      visit(at, made);
    } else {
      visit(at, part.rows(first, count));
    }
    at += part.cols;
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
  Columns both = left;
  both.cols_ += right.cols_;
  both.parts_.insert(both.parts_.end(), right.parts_.begin(), right.parts_.end());
  return both;
}

Columns view(const Ref<const MatrixXd>& matrix) {
  Columns seen;
  seen.cols_ = matrix.cols();
  seen.parts_.push_back(
      {.cols = matrix.cols(), .data = matrix.data(), .stride = matrix.outerStride()});
  return seen;
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
    X.visit(first, rows, [&](Index at, const Columns::Rows& part) {
      numerics::add_transposed_product(part, y.segment(first, rows), sum.segment(at, part.cols()));
    });
  });
  return sum;
}

VectorXd subtract(const RowLayout& layout, VectorXd y, const Columns& X, const VectorXd& c) {
  for_each_panel(layout, [&](Index first, Index rows) {
    X.visit(first, rows, [&](Index at, const Columns::Rows& part) {
      numerics::add_product(part, -c.segment(at, part.cols()), y.segment(first, rows));
    });
  });
  return y;
}

}  // namespace sepcal::diagnosis
