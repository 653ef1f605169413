// SPDX-License-Identifier: BSD-3-Clause
// The two compressed objectives against the dense, whitened problem.
#include "estimation/objective.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "dense_reference.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/static_model.hpp"
#include "simulated_records.hpp"

namespace objective_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::estimation::JointObjective;
using sepcal::estimation::ProjectedObjective;
using sepcal::test::Simulated;

namespace {

/// z = a cos(u + b) + c cos(u + b) + d: a and c are one and the same.
struct Twice {
  static constexpr std::array inputs{sepcal::Quantity{"eta", "rad"}};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"a", "1"}, sepcal::Quantity{"c", "1"},
                                     sepcal::Quantity{"d", "1"}};
  static constexpr std::array nonlinear{sepcal::Quantity{"b", "rad", -0.5, 0.5}};
  template <class U, class X>
  sepcal::Affine<X, 1, 3> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    using std::cos;
    const X wave = cos(u[0] + xi2[0]);
    sepcal::Affine<X, 1, 3> z;
    z.A << wave, wave, X(1.0);
    z.b << X(0.0);
    return z;
  }
};

VectorXd deviations(Index n_z) { return VectorXd::LinSpaced(n_z, 0.1, 0.3); }

/// What is left of whitened z - b after the best A xi1, by dense SVD.
VectorXd projected_residual(const Simulated& simulated, const VectorXd& xi2) {
  const Index n_z = simulated.model->tables().n_z();
  const MatrixXd values = sepcal::test::dense_values(*simulated.model, simulated.record, xi2);
  MatrixXd rows = values;
  rows.rightCols<1>() =
      sepcal::test::dense_outputs(*simulated.model, simulated.record) - values.rightCols<1>();
  rows = sepcal::test::whiten(rows, deviations(n_z));
  const MatrixXd A = rows.leftCols(rows.cols() - 1);
  const VectorXd y = rows.rightCols<1>();
  return y - A * Eigen::JacobiSVD<MatrixXd>(A, Eigen::ComputeThinU | Eigen::ComputeThinV).solve(y);
}

void check_joint(const Simulated& simulated) {
  const Index n_1 = simulated.xi1.size();
  const Index n_z = simulated.model->tables().n_z();
  const sepcal::model::Measurements measurements(*simulated.model, simulated.record);
  sepcal::base::ThreadPool pool(1);
  const sepcal::model::Sweep sweep(*simulated.model, measurements, pool);
  JointObjective objective(sweep, deviations(n_z).cwiseInverse());
  VectorXd x(n_1 + simulated.xi2.size());
  x << 1.1 * simulated.xi1, 0.7 * simulated.xi2;
  const MatrixXd dense =
      sepcal::test::whiten(sepcal::test::dense_rows(*simulated.model, simulated.record, x.head(n_1),
                                                    x.tail(simulated.xi2.size())),
                           deviations(n_z));
  const MatrixXd J = -dense.leftCols(x.size());
  const VectorXd r = dense.rightCols<1>();

  VectorXd residual;
  MatrixXd jacobian;
  REQUIRE(objective.linearise(x, residual, jacobian));
  CHECK(objective.parameters() == x.size());
  CHECK(residual.size() == objective.residuals());
  CHECK(residual.squaredNorm() == Approx(r.squaredNorm()).epsilon(1e-12));
  CHECK(objective.square(x) == Approx(r.squaredNorm()).epsilon(1e-12));
  const VectorXd gradient = J.transpose() * r;
  CHECK((jacobian.transpose() * residual - gradient).norm() < 1e-9 * gradient.norm());
  const MatrixXd hessian = J.transpose() * J;
  CHECK((jacobian.transpose() * jacobian - hessian).norm() < 1e-9 * hessian.norm());
}

void check_projected(const Simulated& simulated) {
  const Index n_z = simulated.model->tables().n_z();
  const sepcal::model::Measurements measurements(*simulated.model, simulated.record);
  sepcal::base::ThreadPool pool(1);
  const sepcal::model::Sweep sweep(*simulated.model, measurements, pool);
  ProjectedObjective objective(sweep, deviations(n_z).cwiseInverse());
  const VectorXd xi2 = 0.7 * simulated.xi2;
  const double square = projected_residual(simulated, xi2).squaredNorm();

  VectorXd residual;
  MatrixXd jacobian;
  REQUIRE(objective.linearise(xi2, residual, jacobian));
  CHECK(objective.parameters() == xi2.size());
  CHECK(residual.size() == objective.residuals());
  CHECK(residual.squaredNorm() == Approx(square).epsilon(1e-11));
  CHECK(objective.square(xi2) == Approx(square).epsilon(1e-11));
  // Kaufman's Jacobian has the exact gradient of the projected cost.
  const VectorXd gradient = 2.0 * jacobian.transpose() * residual;
  for (Index k = 0; k < xi2.size(); ++k) {
    const auto slope = [&](double step) {
      const VectorXd aside = step * VectorXd::Unit(xi2.size(), k);
      return (projected_residual(simulated, xi2 + aside).squaredNorm() -
              projected_residual(simulated, xi2 - aside).squaredNorm()) /
             (2.0 * step);
    };
    const double numeric = (4.0 * slope(5e-4) - slope(1e-3)) / 3.0;
    CHECK(std::abs(gradient[k] - numeric) < 1e-7 * gradient.norm());
  }
  // Its Gauss-Newton matrix is D' P D, P the projection off A's columns.
  const VectorXd xi1 = objective.linear_estimate(xi2);
  const MatrixXd dense = sepcal::test::whiten(
      sepcal::test::dense_rows(*simulated.model, simulated.record, xi1, xi2), deviations(n_z));
  const MatrixXd A = dense.leftCols(xi1.size());
  MatrixXd D = dense.middleCols(xi1.size(), xi2.size());
  D -= A * Eigen::JacobiSVD<MatrixXd>(A, Eigen::ComputeThinU | Eigen::ComputeThinV).solve(D);
  const MatrixXd hessian = D.transpose() * D;
  CHECK((jacobian.transpose() * jacobian - hessian).norm() < 1e-8 * hessian.norm());
}

/// Golub and Pereyra's Jacobian against differences of the projected residual.
void check_golub_pereyra(const Simulated& simulated) {
  const Index n_z = simulated.model->tables().n_z();
  const sepcal::model::Measurements measurements(*simulated.model, simulated.record);
  sepcal::base::ThreadPool pool(1);
  const sepcal::model::Sweep sweep(*simulated.model, measurements, pool);
  const VectorXd noise = deviations(n_z);
  ProjectedObjective objective(sweep, noise.cwiseInverse(), {},
                               sepcal::ProjectedJacobian::golub_pereyra);
  ProjectedObjective kaufman(sweep, noise.cwiseInverse());
  const VectorXd xi2 = 0.7 * simulated.xi2;
  VectorXd residual;
  MatrixXd jacobian;
  MatrixXd without;
  REQUIRE(kaufman.linearise(xi2, residual, without));
  REQUIRE(objective.linearise(xi2, residual, jacobian));

  const VectorXd r = projected_residual(simulated, xi2);
  MatrixXd J(r.size(), xi2.size());
  for (Index k = 0; k < xi2.size(); ++k) {
    const auto slope = [&](double step) -> VectorXd {
      const VectorXd aside = step * VectorXd::Unit(xi2.size(), k);
      return (projected_residual(simulated, xi2 + aside) -
              projected_residual(simulated, xi2 - aside)) /
             (2.0 * step);
    };
    J.col(k) = (4.0 * slope(5e-4) - slope(1e-3)) / 3.0;
  }
  const MatrixXd hessian = J.transpose() * J;
  CHECK((jacobian.transpose() * jacobian - hessian).norm() < 1e-8 * hessian.norm());
  const VectorXd gradient = J.transpose() * r;
  CHECK((jacobian.transpose() * residual - gradient).norm() < 1e-7 * gradient.norm());
  // Off the minimum the difference is not small: a test that Kaufman's would pass shows nothing.
  CHECK((without.transpose() * without - hessian).norm() > 1e-5 * hessian.norm());
}

/// Priors of one linear and one nonlinear parameter, as two more dense rows.
void check_with_priors(const Simulated& simulated) {
  const Index n_1 = simulated.xi1.size();
  const Index n = n_1 + simulated.xi2.size();
  const Index n_z = simulated.model->tables().n_z();
  const sepcal::model::Measurements measurements(*simulated.model, simulated.record);
  sepcal::base::ThreadPool pool(1);
  const sepcal::model::Sweep sweep(*simulated.model, measurements, pool);
  sepcal::estimation::Prior prior{VectorXd::Zero(n), VectorXd::Zero(n)};
  prior.mean[0] = 0.3;
  prior.weight[0] = 50.0;
  prior.mean[n_1] = 0.1;
  prior.weight[n_1] = 80.0;
  const VectorXd weights = deviations(n_z).cwiseInverse();
  VectorXd x(n);
  x << 1.1 * simulated.xi1, 0.7 * simulated.xi2;
  JointObjective joint(sweep, weights, {prior});
  JointObjective bare(sweep, weights);
  const double expected =
      bare.square(x) + std::pow(50.0 * (x[0] - 0.3), 2) + std::pow(80.0 * (x[n_1] - 0.1), 2);
  VectorXd residual;
  MatrixXd jacobian;
  REQUIRE(joint.linearise(x, residual, jacobian));
  CHECK(joint.square(x) == Approx(expected).epsilon(1e-12));
  CHECK(residual.squaredNorm() == Approx(expected).epsilon(1e-12));

  // Projected: the least of the joint cost over xi1, with the gradient of just that.
  ProjectedObjective projected(sweep, weights, {prior});
  const VectorXd xi2 = x.tail(n - n_1);
  VectorXd best(n);
  best << projected.linear_estimate(xi2), xi2;
  REQUIRE(joint.linearise(best, residual, jacobian));
  const VectorXd gradient = jacobian.transpose() * residual;
  CHECK(gradient.head(n_1).norm() < 1e-8 * (1.0 + gradient.tail(n - n_1).norm()));
  CHECK(projected.square(xi2) == Approx(joint.square(best)).epsilon(1e-11));
  REQUIRE(projected.linearise(xi2, residual, jacobian));
  CHECK(residual.squaredNorm() == Approx(joint.square(best)).epsilon(1e-11));
  CHECK((jacobian.transpose() * residual - gradient.tail(n - n_1)).norm() < 1e-8 * gradient.norm());
}

/// A loss: the sum of rho, its gradient, and the weighted rows' Gauss-Newton matrix.
void check_loss(const Simulated& simulated, sepcal::Loss kind) {
  const Index n_1 = simulated.xi1.size();
  const Index n_z = simulated.model->tables().n_z();
  const sepcal::model::Measurements measurements(*simulated.model, simulated.record);
  sepcal::base::ThreadPool pool(1);
  const sepcal::model::Sweep sweep(*simulated.model, measurements, pool);
  const sepcal::model::RobustLoss loss(kind, 0.0);
  const VectorXd noise = 0.1 * deviations(n_z);  // many rows past the width
  JointObjective objective(sweep, noise.cwiseInverse(), {}, loss);
  VectorXd x(n_1 + simulated.xi2.size());
  x << 1.1 * simulated.xi1, 0.7 * simulated.xi2;
  const MatrixXd dense =
      sepcal::test::whiten(sepcal::test::dense_rows(*simulated.model, simulated.record, x.head(n_1),
                                                    x.tail(simulated.xi2.size())),
                           noise);
  const MatrixXd J = -dense.leftCols(x.size());
  const VectorXd s = dense.rightCols<1>();
  const double sum = s.unaryExpr([&](double each) { return loss.cost(each); }).sum();
  const VectorXd w = s.unaryExpr([&](double each) { return loss.weight(each); });
  REQUIRE(w.minCoeff() < 0.9);

  VectorXd residual;
  MatrixXd jacobian;
  REQUIRE(objective.linearise(x, residual, jacobian));
  CHECK(objective.square(x) == Approx(sum).epsilon(1e-12));
  CHECK(residual.squaredNorm() == Approx(sum).epsilon(1e-12));
  const VectorXd gradient = J.transpose() * w.cwiseProduct(s);
  CHECK((jacobian.transpose() * residual - gradient).norm() < 1e-9 * gradient.norm());
  const MatrixXd hessian = J.transpose() * w.asDiagonal() * J;
  CHECK((jacobian.transpose() * jacobian - hessian).norm() < 1e-9 * hessian.norm());
}

}  // namespace

TEST_CASE("joint: cost, gradient and Gauss-Newton matrix are those of all rows") {
  for (const Simulated& simulated : sepcal::test::simulate_all(300)) {
    CAPTURE(simulated.name);
    check_joint(simulated);
  }
}

TEST_CASE("projected: cost, gradient and Kaufman's matrix are those of all rows") {
  for (const Simulated& simulated : sepcal::test::simulate_all(300)) {
    CAPTURE(simulated.name);
    check_projected(simulated);
  }
}

TEST_CASE("projected: Golub and Pereyra's Jacobian is that of the projected residual") {
  for (const Simulated& simulated : sepcal::test::simulate_all(300)) {
    CAPTURE(simulated.name);
    check_golub_pereyra(simulated);
  }
  check_golub_pereyra({"twice", sepcal::block_model(Twice{}), Eigen::Vector3d(1, 0.5, 0.2),
                       VectorXd::Constant(1, 0.3), sepcal::test::simulate_scalar_1(200).record});
}

TEST_CASE("a prior is one more measurement") {
  for (const Simulated& simulated : sepcal::test::simulate_all(300)) {
    CAPTURE(simulated.name);
    check_with_priors(simulated);
  }
}

TEST_CASE("joint: a loss keeps its true cost and gradient on the compressed problem") {
  for (const Simulated& simulated : sepcal::test::simulate_all(300)) {
    CAPTURE(simulated.name);
    check_loss(simulated, sepcal::Loss::huber);
    check_loss(simulated, sepcal::Loss::cauchy);
  }
}

TEST_CASE("projected: a singular A loses only what it does not see") {
  Simulated wave{"twice", sepcal::block_model(Twice{}), Eigen::Vector3d(1, 0.5, 0.2),
                 VectorXd::Constant(1, 0.3), sepcal::test::simulate_scalar_1(200).record};
  check_projected(wave);
}

TEST_CASE(
    "the linear estimate is weighted least squares (Eq. 27), also right after another point") {
  const Simulated flight = sepcal::test::simulate_five_hole(200);
  const sepcal::model::Measurements measurements(*flight.model, flight.record);
  sepcal::base::ThreadPool pool(1);
  const sepcal::model::Sweep sweep(*flight.model, measurements, pool);
  ProjectedObjective objective(sweep, deviations(3).cwiseInverse());
  (void)objective.square(VectorXd::Zero(5));
  const VectorXd xi1 = objective.linear_estimate(flight.xi2);
  const MatrixXd rows = sepcal::test::whiten(
      sepcal::test::dense_rows(*flight.model, flight.record, xi1, flight.xi2), deviations(3));
  CHECK((rows.leftCols<5>().transpose() * rows.rightCols<1>()).norm() <
        1e-9 * rows.leftCols<5>().norm());
}

TEST_CASE("projected: a bound of a linear parameter costs what holding it there costs") {
  const Simulated flight = sepcal::test::simulate_five_hole(200);
  const sepcal::model::Measurements measurements(*flight.model, flight.record);
  sepcal::base::ThreadPool pool(1);
  const sepcal::model::Sweep sweep(*flight.model, measurements, pool);
  ProjectedObjective objective(sweep, deviations(3).cwiseInverse());
  sepcal::numerics::Box box{VectorXd::Constant(5, -sepcal::infinity),
                            VectorXd::Constant(5, sepcal::infinity)};
  CHECK(objective.square_within(flight.xi2, box) == objective.square(flight.xi2));

  box.lower[0] = objective.linear_estimate(flight.xi2)[0] + 0.1;
  MatrixXd rows = sepcal::test::dense_values(*flight.model, flight.record, flight.xi2);
  rows.col(5) = sepcal::test::dense_outputs(*flight.model, flight.record) - rows.col(5);
  rows = sepcal::test::whiten(rows, deviations(3));
  const VectorXd held = rows.col(5) - box.lower[0] * rows.col(0);
  const MatrixXd others = rows.middleCols(1, 4);
  const VectorXd left = held - others * others.colPivHouseholderQr().solve(held);
  CHECK(objective.square_within(flight.xi2, box) == Approx(left.squaredNorm()).epsilon(1e-9));
}

}  // namespace objective_test
