// SPDX-License-Identifier: BSD-3-Clause
// The compressed problem that Ceres is given = a plain ceres::Problem with one block a sample.
#include <ceres/autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <doctest/doctest.h>

#include "estimation/minimise.hpp"
#include "simulated_records.hpp"

namespace compressed_problem_test {

using doctest::Approx;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr std::size_t rows = 120;
const Vector3d noise(0.1, 0.2, 0.3);

struct SampleResidual {
  sepcal::Vec<double, 14> u = sepcal::Vec<double, 14>::Zero();  // the ports stay at zero
  Vector3d z;

  template <class T>
  bool operator()(const T* x1, const T* x2, T* residual) const {
    const sepcal::FiveHoleProbe probe{4.5, 4.0, {0.35, -0.1, -0.02}};
    const Eigen::Map<const sepcal::Vec<T, 5>> xi1(x1);
    const sepcal::Vec<T, 5> xi2 = Eigen::Map<const sepcal::Vec<T, 5>>(x2);
    const auto model = probe.at(u, xi2);
    for (int j = 0; j < 3; ++j) {
      residual[j] = (T(z[j]) - model.b[j] - model.A.row(j).dot(xi1)) / noise[j];
    }
    return true;
  }
};

void add_samples(ceres::Problem& problem, const sepcal::Record& record, double* xi1, double* xi2) {
  const auto tables = sepcal::tables_of<sepcal::FiveHoleProbe>();
  for (std::size_t k = 0; k < rows; ++k) {
    auto* sample = new SampleResidual;
    for (std::size_t i = 0; i < 11; ++i) {
      sample->u[static_cast<int>(i)] = record.column(tables.inputs[i].name)[k];
    }
    for (std::size_t j = 0; j < 3; ++j) {
      sample->z[static_cast<int>(j)] = record.column(tables.outputs[j].name)[k];
    }
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SampleResidual, 3, 5, 5>(sample),
                             nullptr, xi1, xi2);
  }
}

}  // namespace

TEST_CASE("cost, gradient and solution of the compressed problem are those of the plain one") {
  const auto flight = sepcal::test::simulate_five_hole(rows);
  const sepcal::model::Measurements measurements(*flight.model, flight.record);
  sepcal::base::ThreadPool pool(1);
  const sepcal::model::Sweep sweep(*flight.model, measurements, pool);
  sepcal::estimation::JointObjective objective(sweep, noise.cwiseInverse());

  VectorXd x(10);
  x << 0.05, 0.2, 1, 1, 0, 0, 0, 0, 0, 0;
  VectorXd xi1 = x.head<5>();
  VectorXd xi2 = x.tail<5>();
  ceres::Problem plain;
  add_samples(plain, flight.record, xi1.data(), xi2.data());

  double cost = 0;
  std::vector<double> gradient;
  ceres::Problem::EvaluateOptions order;
  order.parameter_blocks = {xi1.data(), xi2.data()};
  plain.Evaluate(order, &cost, nullptr, &gradient, nullptr);
  VectorXd residual;
  MatrixXd jacobian;
  REQUIRE(objective.linearise(x, residual, jacobian));
  CHECK(0.5 * residual.squaredNorm() == Approx(cost).epsilon(1e-12));
  CHECK(0.5 * objective.square(x) == Approx(cost).epsilon(1e-12));
  const VectorXd expected = Eigen::Map<const VectorXd>(gradient.data(), 10);
  CHECK((jacobian.transpose() * residual - expected).norm() < 1e-11 * expected.norm());

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-16;
  options.parameter_tolerance = 1e-16;
  options.gradient_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &plain, &summary);
  const VectorXd free = VectorXd::Constant(10, sepcal::infinity);
  const auto descent = sepcal::estimation::minimise(
      objective, x, {-free, free}, {.iterations = 100, .function_tolerance = 1e-16});
  CHECK(descent.converged);
  CHECK(descent.square == Approx(2 * summary.final_cost).epsilon(1e-13));
  VectorXd solution(10);
  solution << xi1, xi2;
  CHECK((descent.x - solution).cwiseAbs().maxCoeff() < 1e-8);
}

TEST_CASE("a descent stays in its box, starts in it, and stops at its number of iterations") {
  const auto flight = sepcal::test::simulate_five_hole(rows);
  const sepcal::model::Measurements measurements(*flight.model, flight.record);
  sepcal::base::ThreadPool pool(1);
  const sepcal::model::Sweep sweep(*flight.model, measurements, pool);
  sepcal::estimation::ProjectedObjective objective(sweep, noise.cwiseInverse());
  VectorXd lower = VectorXd::Constant(5, -0.05);
  VectorXd upper = VectorXd::Constant(5, 0.04);
  const auto bounded = sepcal::estimation::minimise(objective, VectorXd::Constant(5, 9.0),
                                                    {lower, upper}, {.iterations = 100});
  CHECK(bounded.converged);
  CHECK((bounded.x.array() >= lower.array()).all());
  CHECK((bounded.x.array() <= upper.array()).all());
  CHECK(bounded.x[0] == 0.04);  // the truth is at 0.1
  CHECK_FALSE(
      sepcal::estimation::minimise(objective, VectorXd::Zero(5), {lower, upper}, {.iterations = 1})
          .converged);
}

}  // namespace compressed_problem_test
