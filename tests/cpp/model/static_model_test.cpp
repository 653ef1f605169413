// SPDX-License-Identifier: BSD-3-Clause
// A struct turned into blocks of rows [A | D | b].
#include "sepcal/static_model.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "block_inputs.hpp"
#include "dense_reference.hpp"
#include "sepcal/error.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace static_model_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::test::BlockInputs;
using sepcal::test::Growth;
using sepcal::test::Line;
using sepcal::test::Simulated;

namespace {

BlockInputs inputs_of(const Simulated& simulated) {
  return sepcal::test::block_inputs(*simulated.model, simulated.record);
}

/// z = s sqrt(u), with inputs in double alone.
struct DoublesOnly {
  static constexpr std::array inputs{sepcal::Quantity{"u", "1"}};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"s", "1"}};
  static constexpr std::array<sepcal::Quantity, 0> nonlinear{};
  sepcal::Affine<double, 1, 1> at(const sepcal::Vec<double, 1>& u,
                                  const sepcal::Vec<double, 0>&) const {
    sepcal::Affine<double, 1, 1> z;
    z.A << std::sqrt(u[0]);
    z.b << 0.0;
    return z;
  }
};

}  // namespace

TEST_CASE("the tables are the struct's, bounds and all") {
  const sepcal::Tables tables = sepcal::tables_of<sepcal::FiveHoleProbe>();
  CHECK(tables.n_u() == 14);
  CHECK(tables.n_z() == 3);
  CHECK(tables.n_1() == 5);
  CHECK(tables.n_2() == 5);
  CHECK(tables.linear[2].name == "w_n");
  CHECK(tables.linear[2].unit == "m/s");
  CHECK(tables.nonlinear[4].name == "eps_phi");
  CHECK(tables.nonlinear[4].lower == -0.2618);
}

TEST_CASE("output j takes the rows from j times the block's length on, with at()'s A and b") {
  const auto flight = sepcal::test::simulate_five_hole(7);
  const sepcal::FiveHoleProbe probe{4.5, 4.0, {0.35, -0.1, -0.02}};
  const auto inputs = inputs_of(flight);
  MatrixXd rows(21, 6);
  flight.model->evaluate({inputs.pointers, 7, 0, true}, flight.xi2.data(), nullptr, nullptr, rows);
  for (Index k = 0; k < 7; ++k) {
    sepcal::Vec<double, 14> u;
    for (Index i = 0; i < 14; ++i) u[i] = inputs.pointers[static_cast<std::size_t>(i)][k];
    const sepcal::Vec<double, 5> xi2 = flight.xi2;
    const auto z = probe.at(u, xi2);
    for (Index j = 0; j < 3; ++j) {
      CHECK((rows.row(7 * j + k).head<5>() - z.A.row(j)).norm() < 1e-14 * z.A.row(j).norm());
      CHECK(rows(7 * j + k, 5) == doctest::Approx(z.b[j]).epsilon(1e-13));
    }
  }
}

TEST_CASE("D is the derivative of A xi1 + b, for all four models") {
  for (const Simulated& simulated : sepcal::test::simulate_all(40)) {
    CAPTURE(simulated.name);
    const auto& tables = simulated.model->tables();
    const auto inputs = inputs_of(simulated);
    MatrixXd rows(40 * tables.n_z(), tables.n_1() + tables.n_2() + 1);
    simulated.model->evaluate({inputs.pointers, 40, 0, true}, simulated.xi2.data(),
                              simulated.xi1.data(), nullptr, rows);
    const MatrixXd expected =
        sepcal::test::dense_rows(*simulated.model, simulated.record, simulated.xi1, simulated.xi2);
    const MatrixXd D = rows.middleCols(tables.n_1(), tables.n_2());
    const MatrixXd numeric = expected.middleCols(tables.n_1(), tables.n_2());
    CHECK((D - numeric).cwiseAbs().maxCoeff() < 1e-9 * numeric.cwiseAbs().maxCoeff());
    CHECK((rows.leftCols(tables.n_1()) - expected.leftCols(tables.n_1())).norm() < 1e-12);
    const VectorXd b = sepcal::test::dense_values(*simulated.model, simulated.record, simulated.xi2)
                           .rightCols<1>();
    CHECK((rows.rightCols<1>() - b).norm() < 1e-12);
  }
}

TEST_CASE("a model with nothing linear gives [D | b], one with nothing nonlinear [A | b]") {
  const double u[] = {0.5, -2.0};
  const double* const inputs[] = {u};
  const double xi2 = 0.3;
  const double nothing = 0;
  MatrixXd rows(2, 2);
  sepcal::block_model(Growth{})->evaluate({inputs, 2, 0, true}, &xi2, &nothing, nullptr, rows);
  MatrixXd expected(2, 2);
  expected << 0.5 * std::exp(0.15), std::exp(0.15), -2 * std::exp(-0.6), std::exp(-0.6);
  CHECK((rows - expected).norm() < 1e-15);

  MatrixXd linear(2, 3);
  const double xi1[] = {1, 1};
  sepcal::block_model(Line{})->evaluate({inputs, 2, 0, true}, nullptr, xi1, nullptr, linear);
  MatrixXd line(2, 3);
  line << 0.5, 1, 0, -2, 1, 0;
  CHECK(linear == line);
}

TEST_CASE("the derivatives by the inputs are those of A xi1 + b, for all four models") {
  for (const Simulated& simulated : sepcal::test::simulate_all(20)) {
    CAPTURE(simulated.name);
    for (int i = 0; i < simulated.model->tables().n_u(); ++i) {
      CAPTURE(i);
      const sepcal::test::InputTangents both = sepcal::test::input_tangents(
          *simulated.model, simulated.record, simulated.xi1, simulated.xi2, {i});
      CHECK((both.given - both.numeric).norm() < 1e-8 * (1.0 + both.numeric.norm()));
    }
  }
}

TEST_CASE("the derivatives come in the order asked for, an input twice where it is asked twice") {
  const Simulated flight = sepcal::test::simulate_magnetometer(5);
  const auto of = [&](const std::vector<int>& inputs) {
    return sepcal::test::input_tangents(*flight.model, flight.record, flight.xi1, flight.xi2,
                                        inputs)
        .given;
  };
  const MatrixXd all = of({0, 1, 2});
  CHECK(of({2, 0, 2}) == all(Eigen::all, {2, 0, 2}));
  CHECK(of({}).cols() == 0);
}

TEST_CASE("a model that takes inputs in double alone is differentiated by differences") {
  const auto model = sepcal::block_model(DoublesOnly{});
  const double xi1 = 2;
  const int wanted[] = {0};
  for (const double size : {1.0, 1e6, 1e-9}) {  // a step must suit the input's own size
    CAPTURE(size);
    const double u[] = {0.5 * size, 3.0 * size, 2.0 * size};
    const double* const inputs[] = {u};
    MatrixXd columns(3, 1);
    model->input_tangent({inputs, 3, 0, true}, &xi1, &xi1, wanted, columns);
    for (int row = 0; row < 3; ++row) {
      const double exact = 1 / std::sqrt(u[row]);
      CHECK(std::abs(columns(row, 0) - exact) < 1e-8 * exact);
    }
  }
  const double u = 1.0;
  const double* const inputs[] = {&u};
  MatrixXd none(1, 0);
  CHECK_NOTHROW(model->input_tangent({inputs, 1, 0, true}, &xi1, &xi1, {}, none));
}

}  // namespace static_model_test
