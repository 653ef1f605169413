// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/plausibility.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "numerics/decompositions.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/static_model.hpp"

namespace plausibility_test {

using namespace sepcal;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST_CASE("a prior's rows pull a least-squares estimate as a measurement of each parameter would") {
  // Two rows of [A | z - A x0] with x0 = (1, 2), and the prior 3 +- 0.5, -1 +- 2, solved by dense
  // QR.
  const VectorXd at = (VectorXd(2) << 1.0, 2.0).finished();
  MatrixXd A(2, 2);
  A << 2.0, 1.0, 0.5, -1.0;
  const VectorXd z = (VectorXd(2) << 7.0, -3.0).finished();
  const estimation::Prior prior{(VectorXd(2) << 3.0, -1.0).finished(),
                                (VectorXd(2) << 2.0, 0.5).finished()};

  TriangularFactor factor(3);
  MatrixXd rows(2, 3);
  rows << A, z - A * at;
  factor.absorb(rows);
  prior.join(factor, at);
  const VectorXd step =
      solve_triangular(factor.matrix().topLeftCorner(2, 2), factor.matrix().col(2).head(2)).x;

  MatrixXd all(4, 2);
  all << A, MatrixXd(prior.weight.asDiagonal());
  VectorXd measured(4);
  measured << z, prior.mean.cwiseProduct(prior.weight);
  const VectorXd expected = all.colPivHouseholderQr().solve(measured);
  CHECK((at + step - expected).norm() < 1e-13);
  CHECK(prior.square(at) == doctest::Approx(4.0 * 4.0 + 0.25 * 9.0));
}

TEST_CASE("the plausible length is half the bounds' width, or what makes a column as large as z") {
  Record record;
  record.add("eta", {0.0, 1.0, 2.0, 3.0}).add("z", {2.0, -2.0, 2.0, -2.0});
  const StaticModel model(ScalarExample1{});
  const model::Measurements measurements(model, record);
  TriangularFactor factor(4);
  MatrixXd rows(4, 4);  // columns a, c, b, r; rms 2, 1/2, 3 and rms(z) = 2
  rows << 2, 0.5, 3, 0, 2, -0.5, 3, 0, -2, 0.5, -3, 0, 2, 0.5, 3, 0;
  factor.absorb(rows);
  const VectorXd scale =
      estimation::plausible_scale(model.tables().parameters(), {factor}, measurements);
  CHECK(scale[0] == doctest::Approx(1.0));
  CHECK(scale[1] == doctest::Approx(4.0));
  CHECK(scale[2] == doctest::Approx(0.5));  // b is bounded: [-0.5, 0.5]
}

TEST_CASE("a loose prior is centred in the bounds or at zero, and ten lengths wide") {
  const std::vector<Variable> parameters{
      {"free", "1"}, {"bounded", "1", 2.0, 4.0}, {"unseen", "1"}};
  const estimation::Prior prior =
      estimation::loose_prior(parameters, (VectorXd(3) << 5.0, 1.0, infinity).finished());
  CHECK(prior.mean == (VectorXd(3) << 0.0, 3.0, 0.0).finished());
  CHECK(prior.weight.isApprox((VectorXd(3) << 0.02, 0.1, 0.1).finished()));
}

}  // namespace plausibility_test
