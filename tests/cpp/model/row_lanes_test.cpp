// SPDX-License-Identifier: BSD-3-Clause
// Rows dealt to lanes against one factor that sees them all.
#include "model/row_lanes.hpp"

#include <doctest/doctest.h>

#include "model/sweep.hpp"
#include "simulated_records.hpp"

namespace row_lanes_test {

using Eigen::Index;
using Eigen::MatrixXd;
using sepcal::TriangularFactor;
using sepcal::model::RowLanes;

namespace {

constexpr Index columns = 6;

double off(const std::vector<MatrixXd>& blocks) {
  RowLanes lanes(columns);
  TriangularFactor expected(columns);
  sepcal::model::RowScratch scratch;
  for (const MatrixXd& block : blocks) {
    auto by_lanes = scratch.shape(block.rows(), columns);
    by_lanes = block;
    MatrixXd by_rows = block;
    lanes.absorb(by_lanes);
    expected.absorb(by_rows);
  }
  CHECK(lanes.is_safe());
  return (lanes.merge().matrix() - expected.matrix()).norm() / expected.matrix().norm();
}

}  // namespace

TEST_CASE("rows in lanes have the factor that they have one after another") {
  sepcal::test::Draws draws(91);
  std::vector<MatrixXd> blocks;
  for (const Index rows : {64, 8, 256, 29, 1}) blocks.push_back(draws.normal_matrix(rows, columns));
  CHECK(off(blocks) < 1e-14);
}

TEST_CASE("a column may be zero in all rows, or in the first of them only, or from some row on") {
  sepcal::test::Draws draws(92);
  std::vector<MatrixXd> blocks;
  for (int k = 0; k < 6; ++k) {
    MatrixXd block = draws.normal_matrix(64, columns);
    block.col(1).setZero();
    if (k < 3) block.col(4).setZero();
    if (k > 1) block.col(0).setZero();
    if (k == 4) block.setZero();
    blocks.push_back(block);
  }
  CHECK(off(blocks) < 1e-14);
  CHECK(off({MatrixXd::Zero(64, columns), draws.normal_matrix(8, columns)}) < 1e-14);
}

TEST_CASE("a number that is not finite is seen wherever it stands") {
  sepcal::test::Draws draws(93);
  sepcal::model::RowScratch scratch;
  auto rows = scratch.shape(64, columns);
  rows = draws.normal_matrix(64, columns);
  rows.col(2).setZero();
  rows(40, 2) = sepcal::not_a_number;
  RowLanes lanes(columns);
  lanes.absorb(rows);
  CHECK((!lanes.is_safe() || !lanes.merge().all_finite()));
}

}  // namespace row_lanes_test
