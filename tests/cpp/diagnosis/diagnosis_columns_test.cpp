// SPDX-License-Identifier: BSD-3-Clause
// Columns that are made a few rows at a time, against the whole matrices.
#include "diagnosis/columns.hpp"

#include <doctest/doctest.h>

#include "diagnosis/noise_hypothesis.hpp"
#include "linearisations.hpp"
#include "simulated_records.hpp"

namespace diagnosis_columns_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;

namespace {

double worst(const MatrixXd& difference) { return difference.cwiseAbs().maxCoeff(); }

/// Longer than a panel, no multiple of one.
constexpr Index rows = 3 * diagnosis::panel_rows / 2 + 7;

}  // namespace

TEST_CASE("joined, chosen and seen through a view, columns are those of the matrices") {
  test::Draws draws(4);
  const diagnosis::RowLayout layout = test::make_layout({{"", rows}}, {1.0, 2.0});
  const MatrixXd left = draws.normal_matrix(2 * rows, 3);
  const MatrixXd right = draws.normal_matrix(2 * rows, 2);
  MatrixXd both(2 * rows, 5);
  both << left, right;
  const diagnosis::Columns joined = diagnosis::join(diagnosis::view(left), right);
  CHECK(joined.dense(layout) == both);
  CHECK(joined.rows(rows + 5, 11) == both.middleRows(rows + 5, 11));
  CHECK(diagnosis::select(joined, {4, 0}).dense(layout) == both(Eigen::all, {4, 0}));
  const VectorXd y = draws.normal_matrix(2 * rows, 1);
  CHECK(diagnosis::view(y).dense(layout) == y);
  const VectorXd c = VectorXd::LinSpaced(5, -1.0, 1.0);
  CHECK(worst(diagnosis::multiply_transposed(layout, joined, y) - both.transpose() * y) < 1e-10);
  CHECK(worst(diagnosis::subtract(layout, y, joined, c) - (y - both * c)) < 1e-13);
}

TEST_CASE("products are the same however many columns there are, a few of them in memory at once") {
  test::Draws draws(9);
  const diagnosis::RowLayout layout = test::make_layout({{"", rows}}, {1.0, 1.0});
  for (const Index count : {5, 63, 64, 150}) {
    CAPTURE(count);
    const MatrixXd X = draws.normal_matrix(2 * rows, count);
    const VectorXd e = draws.normal_matrix(2 * rows, 1);
    MatrixXd white(2 * rows, count + 1);
    white << X, e;
    white.bottomRows(rows) *= 3.0;
    Index most = 0;
    const MatrixXd products = diagnosis::white_products(
        layout, diagnosis::view(X), e, [&](std::size_t j, Eigen::Ref<MatrixXd> columns) {
          most = std::max(most, columns.cols());
          if (j == 1) columns *= 3.0;
        });
    CHECK(worst(products - white.transpose() * white) < 1e-9);
    CHECK(most <= 64);
  }
}

TEST_CASE("products beyond some columns are those of what least squares on them leaves") {
  test::Draws draws(2);
  const MatrixXd known = draws.normal_matrix(rows, 4);
  MatrixXd columns(rows, 7);
  columns << known, draws.normal_matrix(rows, 3) + known.leftCols(3);
  MatrixXd left = columns.rightCols(3);
  for (auto column : left.colwise()) column -= known * test::least_squares(known, column);
  CHECK(worst(diagnosis::products_beyond(columns.transpose() * columns, 4) -
              left.transpose() * left) < 1e-9);
}

}  // namespace diagnosis_columns_test
