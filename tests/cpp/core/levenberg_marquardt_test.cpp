// SPDX-License-Identifier: BSD-3-Clause
// The small refinement against minima that are known, and against Ceres' of the same record.
#include "sepcal/detail/states/levenberg_marquardt.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "draws.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/states/model_rows.hpp"
#include "sepcal/fit.hpp"

namespace levenberg_marquardt_test {

using doctest::Approx;
using Eigen::Vector2d;
using sepcal::infinity;
using sepcal::LeastSquaresStatus;
using Rows = sepcal::LeastSquaresRows<1, 2>;
using One = Eigen::Matrix<double, 1, 1>;

namespace {

const Vector2d unbounded = Vector2d::Constant(infinity);

/// Rosenbrock's valley as two residuals, 10 (y - x^2) and 1 - x: zero at (1, 1).
Rows valley(int k, const Vector2d& p) {
  if (k == 0) {
    return {One(-10.0 * (p[1] - p[0] * p[0])), Eigen::RowVector2d(-20.0 * p[0], 10.0), One(1.0)};
  }
  return {One(1.0 - p[0]), Eigen::RowVector2d(1.0, 0.0), One(1.0)};
}

}  // namespace

TEST_CASE("Rosenbrock's valley is walked to its end") {
  const auto end = sepcal::refine(valley, 2, Vector2d(-1.2, 1.0), (-unbounded).eval(), unbounded);
  CHECK(end.status() == LeastSquaresStatus::converged);
  CHECK(end.p()[0] == Approx(1.0).epsilon(1e-9));
  CHECK(end.p()[1] == Approx(1.0).epsilon(1e-9));
  CHECK(end.iterations() < 50);
}

TEST_CASE(
    "a bound that stands before the minimum holds, and the other parameter is best beside it") {
  // With x <= 1/2 the valley's floor is y = x^2, and the cost falls until the bound: (1/2, 1/4).
  const auto end =
      sepcal::refine(valley, 2, Vector2d(-1.2, 1.0), (-unbounded).eval(), Vector2d(0.5, infinity));
  CHECK(end.status() == LeastSquaresStatus::converged);
  CHECK(end.p()[0] == 0.5);
  CHECK(end.p()[1] == Approx(0.25).epsilon(1e-9));
  CHECK(end.held(0));
  CHECK_FALSE(end.held(1));
  // From beyond its bounds it begins at them.
  const auto outside =
      sepcal::refine(valley, 2, Vector2d(3.0, 1.0), (-unbounded).eval(), Vector2d(0.5, infinity));
  CHECK(outside.p()[1] == Approx(0.25).epsilon(1e-9));
}

TEST_CASE("parameters that push each other against their bounds end where the gradient says so") {
  // H = [1 0.8; 0 0.6], z = (1400, 1800), p0 >= 0, p1 <= 1000: the best is (600, 1000) wherever it
  // begins, a hair beside the second bound too.
  const auto linear = [](int, const Vector2d& p) {
    Eigen::Matrix2d H;
    H << 1.0, 0.8, 0.0, 0.6;
    const Vector2d z(1400.0, 1800.0);
    return sepcal::LeastSquaresRows<2, 2>{z - H * p, H, Eigen::Matrix2d::Identity()};
  };
  for (const double beside : {0.0, 1e-13, 1e-10, 1e-4, 10.0}) {
    const auto end = sepcal::refine(linear, 1, Vector2d(0.0, 1000.0 - beside),
                                    Vector2d(0.0, -infinity), Vector2d(infinity, 1000.0));
    CAPTURE(beside);
    CHECK(end.status() == LeastSquaresStatus::converged);
    CHECK((end.p() - Vector2d(600.0, 1000.0)).norm() < 1e-6);
    CHECK(end.held(1));
    CHECK_FALSE(end.held(0));
  }
}

TEST_CASE("linear problems with random bounds end where no parameter can gain") {
  sepcal::test::Draws draws(31);
  using Vector4d = Eigen::Vector4d;
  int active = 0;
  for (int problem = 0; problem < 500; ++problem) {
    Eigen::Matrix<double, 6, 4> H;
    Eigen::Vector<double, 6> z;
    for (double& value : H.reshaped()) value = draws.normal();
    for (double& value : z) value = 10.0 * draws.normal();
    Vector4d lower;
    Vector4d upper;
    Vector4d start;
    for (int k = 0; k < 4; ++k) {
      lower[k] = draws.uniform(-8.0, 2.0);
      upper[k] = lower[k] + draws.uniform(0.0, 6.0);
      start[k] = draws.uniform(-10.0, 10.0);
    }
    const auto sample = [&](int, const Vector4d& p) {
      return sepcal::LeastSquaresRows<6, 4>{z - H * p, H, Eigen::Matrix<double, 6, 6>::Identity()};
    };
    const auto end = sepcal::refine(sample, 1, start, lower, upper);
    CHECK(end.status() == LeastSquaresStatus::converged);
    const Vector4d gradient = H.transpose() * (z - H * end.p());  // up it the cost falls
    for (int k = 0; k < 4; ++k) {
      active += end.held(k) ? 1 : 0;
      if (end.p()[k] > lower[k] + 1e-12) CHECK(gradient[k] > -1e-7);
      if (end.p()[k] < upper[k] - 1e-12) CHECK(gradient[k] < 1e-7);
    }
  }
  CHECK(active > 500);
}

TEST_CASE("rows whose squares overflow, and bounds that cross, are refused at once") {
  const auto large = [](int, const Eigen::Vector<float, 1>& p) {
    using Single = Eigen::Matrix<float, 1, 1>;
    return sepcal::LeastSquaresRows<1, 1, float>{Single(1.5e19F - p[0]), Single(1e10F),
                                                 Single(1.0F)};
  };
  using Single = Eigen::Vector<float, 1>;
  const auto end = sepcal::refine(large, 4, Single(0.0F), Single(-1.0F), Single(1.0F));
  CHECK(end.status() == LeastSquaresStatus::refused);
  CHECK(sepcal::refine(valley, 2, Vector2d(0, 0), Vector2d(2.5, -1), Vector2d(1, 1)).status() ==
        LeastSquaresStatus::refused);
  CHECK(sepcal::refine(valley, 2, Vector2d(std::nan(""), 0), Vector2d(-1, -1), Vector2d(1, 1))
            .status() == LeastSquaresStatus::refused);
}

TEST_CASE("what cannot end well ends in a status") {
  const auto blind = [](int, const Vector2d& p) {  // p[0] + p[1] alone is seen
    return Rows{One(1.0 - p[0] - p[1]), Eigen::RowVector2d(1.0, 1.0), One(1.0)};
  };
  CHECK(sepcal::refine(blind, 3, Vector2d(0, 0), (-unbounded).eval(), unbounded).status() ==
        LeastSquaresStatus::not_determined);
  // A parameter that nothing tells of stands at a bound, and is no more determined for that.
  const auto unseen = [](int, const Vector2d& p) {
    return Rows{One(1.0 - p[0]), Eigen::RowVector2d(1.0, 0.0), One(1.0)};
  };
  CHECK(sepcal::refine(unseen, 3, Vector2d(0, 0), Vector2d(-infinity, 0), unbounded).status() ==
        LeastSquaresStatus::not_determined);
  CHECK(sepcal::refine(unseen, 3, Vector2d(0, 0), Vector2d(-infinity, 0), Vector2d(infinity, 0))
            .status() == LeastSquaresStatus::converged);  // but held by equal bounds
  const auto nowhere = [](int, const Vector2d&) {
    return Rows{One(1.0), Eigen::RowVector2d(infinity, 1.0), One(1.0)};
  };
  CHECK(sepcal::refine(nowhere, 3, Vector2d(0, 0), (-unbounded).eval(), unbounded).status() ==
        LeastSquaresStatus::refused);
  const auto no_noise = [](int, const Vector2d& p) {
    return Rows{One(1.0 - p[0]), Eigen::RowVector2d(1.0, 0.0), One(-1.0)};
  };
  CHECK(sepcal::refine(no_noise, 3, Vector2d(0, 0), (-unbounded).eval(), unbounded).status() ==
        LeastSquaresStatus::refused);
  // Slopes that lie: no step makes the cost fall, and the damping grows until it stops.
  const auto lying = [](int k, const Vector2d& p) {
    return Rows{One(k + p[k]), Eigen::RowVector2d(k == 0 ? 1.0 : 0.0, k == 0 ? 0.0 : 1.0),
                One(1.0)};
  };
  const auto stuck = sepcal::refine(lying, 2, Vector2d(3, 3), (-unbounded).eval(), unbounded);
  CHECK(stuck.status() == LeastSquaresStatus::not_converged);
  CHECK(stuck.iterations() <= 50);
  const auto hurried = sepcal::refine(valley, 2, Vector2d(-1.2, 1.0), (-unbounded).eval(),
                                      unbounded, {.iterations = 3});
  CHECK(hurried.status() == LeastSquaresStatus::not_converged);
  CHECK(hurried.iterations() == 3);
}

TEST_CASE("a trial that is not finite is not taken, and a shorter step is") {
  // ln p has no value for p < 0, where the first undamped step from 0.1 towards e^-5 leads.
  const auto logarithm = [](int, const Eigen::Vector<double, 1>& p) {
    return sepcal::LeastSquaresRows<1, 1>{One(-5.0 - std::log(p[0])), One(1.0 / p[0]), One(1.0)};
  };
  using Single = Eigen::Vector<double, 1>;
  const auto end = sepcal::refine(logarithm, 1, Single(0.1), Single(-infinity), Single(infinity));
  CHECK(end.p()[0] == Approx(std::exp(-5.0)).epsilon(1e-9));
}

TEST_CASE("the paper's second example ends where Ceres ends, within 1e-9 standard errors") {
  using sepcal::ScalarExample2;
  sepcal::test::Draws draws(7);
  const std::vector<double> eta = draws.uniform_column(200, 1.0, 10.0);
  std::vector<double> z;
  for (const double angle : eta)
    z.push_back(1.8 * std::cos(angle * 1.05 + 0.1) + 0.6 + 0.3 * draws.normal());
  sepcal::Record record;
  record.add("eta", eta).add("z", z);
  sepcal::FitOptions options;
  options.noise = {{"z", 0.3}};
  options.coloured_errors = false;
  options.threads = 1;
  const sepcal::Fit fit = sepcal::fit(ScalarExample2{}, record, options);

  const auto sample = [&](int k, const Eigen::Vector4d& p) {
    const auto at = static_cast<std::size_t>(k);
    return sepcal::model_rows<ScalarExample2, double>({}, Eigen::Vector<double, 1>(eta[at]),
                                                      Eigen::Vector<double, 1>(z[at]),
                                                      Eigen::Vector<double, 1>(0.3), p);
  };
  const Eigen::Vector4d lower(-infinity, -infinity, -0.5, -1.0);
  const auto end =
      sepcal::refine(sample, 200, Eigen::Vector4d(0.8, 0.6, 0.0, 0.0), lower, (-lower).eval());
  REQUIRE(end.status() == LeastSquaresStatus::converged);
  const Eigen::Vector4d errors = end.rows().covariance().diagonal().cwiseSqrt();
  const std::array<const char*, 4> names{"a", "d", "b", "c"};
  for (int k = 0; k < 4; ++k) {
    const auto& parameter = fit[names[static_cast<std::size_t>(k)]];
    CHECK(std::abs(end.p()[k] - parameter.value) < 1e-7 * errors[k]);
    CHECK(errors[k] == Approx(parameter.standard_error_white).epsilon(1e-6));
  }
}

}  // namespace levenberg_marquardt_test
