// SPDX-License-Identifier: BSD-3-Clause
// A model with parameters held is the same function of those that are left.
#include "model/fixed_model.hpp"

#include <doctest/doctest.h>

#include "block_inputs.hpp"
#include "dense_reference.hpp"
#include "simulated_records.hpp"

namespace fixed_model_test {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using sepcal::model::FixedModel;

namespace {

const auto flight = sepcal::test::simulate_five_hole(30);

MatrixXd evaluate(const sepcal::BlockModel& model, const VectorXd& xi2, const VectorXd* xi1) {
  const auto inputs = sepcal::test::block_inputs(model, flight.record);
  const auto& tables = model.tables();
  MatrixXd rows(90, tables.n_1() + (xi1 ? tables.n_2() : 0) + 1);
  model.evaluate({inputs.pointers, 30, 0, true}, xi2.data(), xi1 ? xi1->data() : nullptr, nullptr,
                 rows);
  return rows;
}

}  // namespace

TEST_CASE("held parameters leave the tables, the others keep their order and bounds") {
  const FixedModel model(*flight.model, {{"b_va", 1.0}, {"lambda_alpha", 0.1}, {"eps_phi", 0.0}});
  const auto& tables = model.tables();
  REQUIRE(tables.n_1() == 4);
  REQUIRE(tables.n_2() == 3);
  CHECK(tables.linear[0].name == "lambda_va");
  CHECK(tables.linear[1].name == "w_n");
  CHECK(tables.nonlinear[0].name == "b_alpha");
  CHECK(tables.nonlinear[2].name == "b_beta");
  CHECK(tables.nonlinear[1].upper == 0.5);
}

TEST_CASE("prediction and derivatives are those of the whole model at the held values") {
  const VectorXd& all_1 = flight.xi1;
  const VectorXd& all_2 = flight.xi2;
  const FixedModel model(*flight.model,
                         {{"b_va", all_1[1]}, {"w_d", all_1[4]}, {"b_alpha", all_2[1]}});
  const VectorXd xi1 = Vector3d(all_1[0], all_1[2], all_1[3]);
  VectorXd xi2(4);
  xi2 << all_2[0], all_2[2], all_2[3], all_2[4];

  const MatrixXd whole = evaluate(*flight.model, all_2, &all_1);
  const MatrixXd part = evaluate(model, xi2, &xi1);
  REQUIRE(part.cols() == 8);
  CHECK(part.leftCols<3>() == whole(Eigen::all, {0, 2, 3}));
  CHECK(part.middleCols<4>(3) == whole(Eigen::all, {5, 7, 8, 9}));
  const VectorXd predicted = part.leftCols<3>() * xi1 + part.col(7);
  CHECK((predicted - whole.leftCols<5>() * all_1 - whole.col(10)).norm() < 1e-12);

  const MatrixXd values = evaluate(model, xi2, nullptr);
  CHECK((values.leftCols<3>() - part.leftCols<3>()).norm() < 1e-12);
  CHECK((values.col(3) - part.col(7)).norm() < 1e-12);
}

TEST_CASE("with every linear parameter held only b and D are left") {
  std::map<std::string, double> fixed;
  for (int k = 0; k < 5; ++k) {
    fixed[flight.model->tables().linear[static_cast<std::size_t>(k)].name] = flight.xi1[k];
  }
  const FixedModel model(*flight.model, fixed);
  CHECK(model.tables().n_1() == 0);
  const VectorXd some = VectorXd::Zero(1);  // a place to point at: there is nothing to read
  const MatrixXd whole = evaluate(*flight.model, flight.xi2, &flight.xi1);
  const MatrixXd part = evaluate(model, flight.xi2, &some);
  REQUIRE(part.cols() == 6);
  CHECK(part.leftCols<5>() == whole.middleCols<5>(5));
}

TEST_CASE("the derivatives by the inputs are the whole model's at the held values") {
  const FixedModel model(*flight.model, {{"b_va", 0.4}, {"b_alpha", -0.05}});
  VectorXd all_1 = flight.xi1;
  VectorXd all_2 = flight.xi2;
  all_1[1] = 0.4;
  all_2[1] = -0.05;
  const VectorXd xi1 = all_1(std::vector<int>{0, 2, 3, 4});
  const VectorXd xi2 = all_2(std::vector<int>{0, 2, 3, 4});
  const std::vector<int> inputs{8, 2, 12};
  const auto part = sepcal::test::input_tangents(model, flight.record, xi1, xi2, inputs);
  const auto whole =
      sepcal::test::input_tangents(*flight.model, flight.record, all_1, all_2, inputs);
  CHECK(part.given == whole.given);
  CHECK((part.given - part.numeric).norm() < 1e-8 * part.numeric.norm());
}

}  // namespace fixed_model_test
