// SPDX-License-Identifier: BSD-3-Clause
// Columns over a layout's rows that are made where they are asked for, a few rows or one output at
// a time. A candidate's are many times as large as what they are made of: none is kept whole.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "diagnosis/linearisation.hpp"

namespace sepcal::diagnosis {

class Columns {
 public:
  /// Fills the rows from `first` of count() on, all of one output.
  using Fill = std::function<void(Eigen::Index first, Eigen::Ref<Eigen::MatrixXd> rows)>;
  using Rows = Eigen::Ref<const Eigen::MatrixXd>;

  Columns() = default;  // none
  Columns(Eigen::Index cols, Fill fill);

  /// Those of a matrix of count() rows.
  Columns(Eigen::MatrixXd matrix);  // NOLINT(*-explicit-*)
  template <class Derived>
  Columns(const Eigen::MatrixBase<Derived>& matrix)  // NOLINT(*-explicit-*)
      : Columns(Eigen::MatrixXd(matrix)) {}

  Eigen::Index cols() const { return cols_; }
  void fill(Eigen::Index first, Eigen::Ref<Eigen::MatrixXd> rows) const;
  Eigen::MatrixXd rows(Eigen::Index first, Eigen::Index count) const;
  Eigen::MatrixXd dense(const RowLayout& layout) const;  // count() x cols()

  /// Calls visit(at, rows) for columns from `at` on, some at a time: those of a matrix are not
  /// copied.
  void visit(Eigen::Index first, Eigen::Index count,
             const std::function<void(Eigen::Index at, const Rows& rows)>& visit) const;

 private:
  friend Columns join(const Columns& left, const Columns& right);
  friend Columns view(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

  struct Part {  // made, or those of a matrix
    Eigen::Index cols = 0;
    Fill fill = {};
    const double* data = nullptr;
    Eigen::Index stride = 0;                           // from column to column of the matrix
    std::shared_ptr<const Eigen::MatrixXd> kept = {};  // where that is its own

    auto rows(Eigen::Index first, Eigen::Index count) const {
      return Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>(
          data + first, count, cols, Eigen::OuterStride<>(stride));  // NOLINT(*-pointer-arithmetic)
    }
  };

  Eigen::Index cols_ = 0;
  std::vector<Part> parts_ = {};
};

/// Side by side.
Columns join(const Columns& left, const Columns& right);

/// Those of a matrix (count() rows) that outlives them.
Columns view(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// Those that are asked for again and again: kept whole where they are few.
Columns keep_few(const RowLayout& layout, const Columns& columns);

/// Some of them.
Columns select(const Columns& columns, const std::vector<Eigen::Index>& chosen);

/// Rows that are few enough to stay in a cache with what is made of them.
inline constexpr Eigen::Index panel_rows = 512;

/// Calls visit(first, rows) for panels of count() rows.
template <class Visit>
void for_each_panel(const RowLayout& layout, const Visit& visit) {
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    for (Eigen::Index row = 0; row < layout.rows; row += panel_rows) {
      visit(layout.first(j) + row, std::min(panel_rows, layout.rows - row));
    }
  }
}

/// X'y.
Eigen::VectorXd multiply_transposed(const RowLayout& layout, const Columns& X,
                                    const Eigen::VectorXd& y);

/// y - X c.
Eigen::VectorXd subtract(const RowLayout& layout, Eigen::VectorXd y, const Columns& X,
                         const Eigen::VectorXd& c);

}  // namespace sepcal::diagnosis
