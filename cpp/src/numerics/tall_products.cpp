// SPDX-License-Identifier: BSD-3-Clause
// A tile of A'B, four columns by two, is summed in registers over rows that stay in a cache.
#include "numerics/tall_products.hpp"

#include <algorithm>

#include "numerics/lanes.hpp"

namespace sepcal::numerics {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;

namespace {

constexpr Index rows_at_once = 512;

// NOLINTBEGIN(*-pointer-arithmetic,*-c-arrays,*-constant-array-index): lanes of a register.

/// Columns `stride` apart.
struct Tall {
  const double* first;
  Index stride;
};

template <Index p, Index q>
[[gnu::always_inline]] inline void add_tile(Tall A, Tall B, Index rows, double* sum,
                                            Index sum_stride) {
  Lanes sums[p][q] = {};
  Index t = 0;
  for (; t + lane_count <= rows; t += lane_count) {
    Lanes a[p];
    Lanes b[q];
#pragma GCC unroll 4
    for (Index i = 0; i < p; ++i) load(A.first + i * A.stride + t, a[i]);
#pragma GCC unroll 4
    for (Index j = 0; j < q; ++j) load(B.first + j * B.stride + t, b[j]);
#pragma GCC unroll 4
    for (Index i = 0; i < p; ++i) {
#pragma GCC unroll 4
      for (Index j = 0; j < q; ++j) sums[i][j] += a[i] * b[j];
    }
  }
#pragma GCC unroll 4
  for (Index i = 0; i < p; ++i) {
#pragma GCC unroll 4
    for (Index j = 0; j < q; ++j) {
      double product = add_lanes(sums[i][j]);
      for (Index late = t; late < rows; ++late) {
        product += A.first[i * A.stride + late] * B.first[j * B.stride + late];
      }
      sum[i + j * sum_stride] += product;
    }
  }
}

/// A panel's A'B, or of A'A (`square`) what is on and above the diagonal at least.
SEPCAL_EVERY_WIDTH void add_panel(Tall A, Index p, Tall B, Index q, bool square, Index rows,
                                  double* sum, Index sum_stride) {
  for (Index j = 0; j < q; j += 2) {
    const Tall b{B.first + j * B.stride, B.stride};
    const Index last = square ? std::min(p, j + 2) : p;
    for (Index i = 0; i < last; i += 4) {
      const Tall a{A.first + i * A.stride, A.stride};
      double* const at = sum + i + j * sum_stride;
      if (q - j > 1) {
        switch (p - i) {
          case 1:
            add_tile<1, 2>(a, b, rows, at, sum_stride);
            break;
          case 2:
            add_tile<2, 2>(a, b, rows, at, sum_stride);
            break;
          case 3:
            add_tile<3, 2>(a, b, rows, at, sum_stride);
            break;
          default:
            add_tile<4, 2>(a, b, rows, at, sum_stride);
        }
      } else {
        switch (p - i) {
          case 1:
            add_tile<1, 1>(a, b, rows, at, sum_stride);
            break;
          case 2:
            add_tile<2, 1>(a, b, rows, at, sum_stride);
            break;
          case 3:
            add_tile<3, 1>(a, b, rows, at, sum_stride);
            break;
          default:
            add_tile<4, 1>(a, b, rows, at, sum_stride);
        }
      }
    }
  }
}

/// y += p columns times their coefficients.
template <Index p>
[[gnu::always_inline]] inline void add_columns(Tall A, const double* c, Index rows, double* y) {
  Index t = 0;
  for (; t + lane_count <= rows; t += lane_count) {
    Lanes sum;
    load(y + t, sum);
#pragma GCC unroll 4
    for (Index i = 0; i < p; ++i) {
      Lanes a;
      load(A.first + i * A.stride + t, a);
      sum += c[i] * a;
    }
    store(sum, y + t);
  }
  for (; t < rows; ++t) {
    for (Index i = 0; i < p; ++i) y[t] += c[i] * A.first[i * A.stride + t];
  }
}

SEPCAL_EVERY_WIDTH void add_columns_of_panel(Tall A, Index p, const double* C, Index q, Index rows,
                                             double* Y, Index y_stride) {
  for (Index j = 0; j < q; ++j) {
    double* const y = Y + j * y_stride;
    for (Index i = 0; i < p; i += 4) {
      const Tall a{A.first + i * A.stride, A.stride};
      const double* const c = C + i + j * p;
      switch (p - i) {
        case 1:
          add_columns<1>(a, c, rows, y);
          break;
        case 2:
          add_columns<2>(a, c, rows, y);
          break;
        case 3:
          add_columns<3>(a, c, rows, y);
          break;
        default:
          add_columns<4>(a, c, rows, y);
      }
    }
  }
}

Tall rows_from(const Ref<const MatrixXd>& A, Index row) {
  return {A.data() + row, A.outerStride()};
}

// NOLINTEND(*-pointer-arithmetic,*-c-arrays,*-constant-array-index)

}  // namespace

void add_transposed_product(const Ref<const MatrixXd>& A, const Ref<const MatrixXd>& B,
                            Ref<MatrixXd> sum) {
  for (Index row = 0; row < A.rows(); row += rows_at_once) {
    add_panel(rows_from(A, row), A.cols(), rows_from(B, row), B.cols(), false,
              std::min(rows_at_once, A.rows() - row), sum.data(), sum.outerStride());
  }
}

void add_square(const Ref<const MatrixXd>& A, Ref<MatrixXd> sum) {
  MatrixXd own = MatrixXd::Zero(A.cols(), A.cols());
  for (Index row = 0; row < A.rows(); row += rows_at_once) {
    add_panel(rows_from(A, row), A.cols(), rows_from(A, row), A.cols(), true,
              std::min(rows_at_once, A.rows() - row), own.data(), own.outerStride());
  }
  sum += own.selfadjointView<Eigen::Upper>();
}

void add_product(const Ref<const MatrixXd>& A, const MatrixXd& C, Ref<MatrixXd> Y) {
  for (Index row = 0; row < A.rows(); row += rows_at_once) {
    const Tall panel = rows_from(A, row);
    add_columns_of_panel(panel, A.cols(), C.data(), C.cols(),
                         std::min(rows_at_once, A.rows() - row), Y.data() + row,
                         Y.outerStride());  // NOLINT(*-pointer-arithmetic)
  }
}

}  // namespace sepcal::numerics
