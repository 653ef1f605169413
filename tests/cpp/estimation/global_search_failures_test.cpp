// SPDX-License-Identifier: BSD-3-Clause
// Where a global search can't go on: models that are not finite, parameters without bounds, and
// models that throw while NLopt asks.
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "estimation/global_search.hpp"
#include "profile_cost.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "small_models.hpp"

namespace global_search_failures_test {

using doctest::Approx;
using Eigen::Vector2d;
using Eigen::VectorXd;
using sepcal::FitOptions;
using sepcal::stage_one;
using sepcal::StageOne;
using sepcal::test::global;
using sepcal::test::Simulated;

namespace {

/// x^2 + 1 in one parameter, which throws beyond a number of calls.
class Failing final : public sepcal::estimation::Objective {
 public:
  Failing(const sepcal::model::Sweep& sweep, int calls)
      : sepcal::estimation::Objective(sweep, {}), calls_(calls) {}
  int parameters() const override { return 1; }
  double square(const VectorXd& x) override {
    if (calls_-- == 0) throw std::domain_error("out of range");
    return x.squaredNorm() + 1.0;
  }
  bool linearise(const VectorXd& x, VectorXd& residual, Eigen::MatrixXd& jacobian) override {
    residual = Vector2d(x[0], std::sqrt(square(x) - x.squaredNorm()));
    jacobian = Vector2d(1, 0);
    return true;
  }

 private:
  int calls_;
};

}  // namespace

TEST_CASE("where a model is not finite the search turns away; nowhere finite is an error") {
  sepcal::Record record;
  record.add("u", {1, 800, 2}).add("z", {1.2, 1e9, 1.5});
  const auto growth = sepcal::block_model(sepcal::test::Growth{});
  FitOptions options = global(50);  // exp(800 c) overflows for c > 0.89
  const StageOne result = stage_one(*growth, record, options);
  CHECK(std::isinf(result.trace_r.maxCoeff()));
  CHECK(result.minima.size() >= 1);
  CHECK(result.xi2[0] == Approx(std::log(1e9) / 800).epsilon(1e-3));
  options.bounds["c"] = {1, 2};
  CHECK_THROWS_WITH_AS(stage_one(*growth, record, options),
                       doctest::Contains("not finite at any of the 50"), sepcal::Error);
}

TEST_CASE("a parameter without finite bounds is an error that says what to do") {
  const Simulated wave = sepcal::test::simulate_scalar_1(100);
  FitOptions options = global();
  options.bounds["b"] = {0, sepcal::infinity};
  options.sampling_distribution["b"] = {0.1, 0.3};
  CHECK_THROWS_WITH_AS(stage_one(*wave.model, wave.record, options),
                       doctest::Contains("'b' has no finite bounds for a global search; give it"),
                       sepcal::Error);
}

TEST_CASE("what a model throws comes out as it was thrown") {
  const Simulated wave = sepcal::test::simulate_scalar_1(10);
  const sepcal::model::Measurements measurements(*wave.model, wave.record);
  sepcal::base::ThreadPool pool(1);
  const sepcal::model::Sweep sweep(*wave.model, measurements, pool);
  const std::vector<sepcal::Variable> x{{"x", "1", -1.0, 2.0}};
  const sepcal::numerics::Box box{VectorXd::Constant(1, -1.0), VectorXd::Constant(1, 2.0)};
  const VectorXd width = VectorXd::Constant(1, 1.5);
  Failing soon(sweep, 7);
  CHECK_THROWS_WITH_AS(sepcal::estimation::search_globally(soon, x, 50, {}), "out of range",
                       std::domain_error);
  Failing sooner(sweep, 2);
  CHECK_THROWS_WITH_AS(sepcal::estimation::descend(sooner, VectorXd::Ones(1), box, width),
                       "out of range", std::domain_error);
  Failing never(sweep, -1);
  const sepcal::estimation::Descent descent =
      sepcal::estimation::descend(never, VectorXd::Ones(1), box, width);
  CHECK(descent.converged);
  CHECK(std::abs(descent.x[0]) < 1e-5);
}

}  // namespace global_search_failures_test
