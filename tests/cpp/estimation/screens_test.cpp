// SPDX-License-Identifier: BSD-3-Clause
// Eqs. 17 and 18 in closed form for the paper's first example, and what stage one does with them.
#include "estimation/screens.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "numerics/decompositions.hpp"
#include "profile_cost.hpp"
#include "sepcal/error.hpp"

namespace screens_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::FitOptions;
using sepcal::Screens;
using sepcal::stage_one;
using sepcal::StageOne;
using sepcal::test::Simulated;

namespace {

FitOptions screened(const Screens& screens, int samples = 40) {
  FitOptions options;
  options.samples = samples;
  options.screens = screens;
  return options;
}

/// The same wave with the sign of A's first column turned.
struct Mirrored {
  static constexpr std::array inputs{sepcal::Quantity{"eta", "rad"}};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"a", "1"}, sepcal::Quantity{"c", "1"}};
  static constexpr std::array nonlinear{sepcal::Quantity{"b", "rad", -0.5, 0.5}};
  static constexpr bool nested_duals = true;
  template <class U, class X>
  sepcal::Affine<X, 1, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    auto z = sepcal::ScalarExample1{}.at(u, xi2);
    z.A(0, 0) = -z.A(0, 0);
    return z;
  }
};

/// A = 3 + (k^3 + l^3 + k l) u, b = ((k - 0.25)^3 + l^2) u. Of their sums the Hessians are
///   [6 k, 1; 1, 6 l] sum u   and   diag(6 (k - 0.25), 2) sum u.
struct Bent {
  static constexpr std::array inputs{sepcal::Quantity{"u", "1"}};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"a", "1"}};
  static constexpr std::array nonlinear{sepcal::Quantity{"k", "1", -1, 1},
                                        sepcal::Quantity{"l", "1", -1, 1}};
  static constexpr bool nested_duals = true;
  template <class U, class X>
  sepcal::Affine<X, 1, 1> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 2>& xi2) const {
    const X k = xi2[0];
    const X l = xi2[1];
    const X from_there = k - 0.25;
    sepcal::Affine<X, 1, 1> z;
    z.A << (k * k * k + l * l * l + k * l) * u[0] + 3.0;
    z.b << (from_there * from_there * from_there + l * l) * u[0];
    return z;
  }
};

/// Scalar example 2 for which nothing but at() in plain duals is known.
struct Plain : sepcal::ScalarExample2 {
  static constexpr bool nested_duals = false;
};

}  // namespace

TEST_CASE("Eqs. 17 and 18 of example 1 are what cosines and sines say") {
  const Simulated wave = sepcal::test::simulate_scalar_1(150);
  const auto eta = wave.record.column("eta");
  const auto check = [&](double l_2) {
    const StageOne result =
        stage_one(*wave.model, wave.record, screened({.t_1 = 100, .t_2 = 100, .l_2 = l_2}));
    REQUIRE(result.screens.has_value());
    for (Index s = 0; s < result.samples.cols(); ++s) {
      const double b = result.samples(0, s);
      double cosines = 0;
      double squares = 0;
      double slopes = 0;
      for (const double each : eta) {
        cosines += std::cos(each + b);
        squares += std::pow(std::cos(each + b), 2);
        slopes += std::pow(std::sin(each + b), 2);
      }
      const double reach = l_2 > 0 ? l_2 : std::max(0.5 - b, b + 0.5);
      CHECK(result.screens->ratio_a[s] ==
            Approx(std::sqrt(slopes / (squares + 150)) * reach).epsilon(1e-12));
      CHECK(result.screens->ratio_b[s] ==
            Approx(std::sqrt(slopes / squares) * reach).epsilon(1e-12));
      CHECK(result.screens->curvature_a[s] == Approx(-cosines * 0.25).epsilon(1e-10));
      CHECK(result.screens->curvature_b[s] == Approx(-cosines * 0.25).epsilon(1e-10));
      CHECK(result.screens->accepted[s]);
    }
  };
  check(0.3);
  check(0.0);
}

TEST_CASE("where second derivatives are not known, differences of the first stand for them") {
  const Simulated wave = sepcal::test::simulate_scalar_2(150);
  const auto plain = sepcal::block_model(Plain{});
  const auto exact = stage_one(*wave.model, wave.record, screened({}));
  const auto differenced = stage_one(*plain, wave.record, screened({}));
  const VectorXd difference = exact.screens->curvature_a - differenced.screens->curvature_a;
  CHECK(difference.cwiseAbs().maxCoeff() < 1e-6 * exact.screens->curvature_a.cwiseAbs().maxCoeff());
  CHECK((exact.screens->curvature_b - differenced.screens->curvature_b).norm() <
        1e-6 * exact.screens->curvature_b.norm());
  CHECK(exact.screens->ratio_a.isApprox(differenced.screens->ratio_a, 1e-13));
}

TEST_CASE("the smallest eigenvalue is that of the sum of second derivatives, fixed ones left out") {
  const Simulated flight = sepcal::test::simulate_five_hole(60);
  FitOptions options = screened({}, 4);
  options.fix = {{"b_va", -0.7}, {"b_alpha", 0.03}};
  const StageOne result = stage_one(*flight.model, flight.record, options);
  const VectorXd widths = Eigen::Vector4d(0.5, 0.5, sepcal::FiveHoleProbe::ten_degrees, 0.2618);
  const std::vector<Index> free{0, 2, 3, 4};
  for (Index s = 0; s < 4; ++s) {
    VectorXd xi2(5);
    xi2[1] = 0.03;
    xi2(free) = result.samples.col(s);
    const auto summed = [&](const VectorXd& x) -> Eigen::Vector2d {  // of A's free columns, of b
      const MatrixXd values = sepcal::test::dense_values(*flight.model, flight.record, x);
      return {values.leftCols(5).sum() - values.col(1).sum(),
              values.col(5).sum() - 0.7 * values.col(1).sum()};
    };
    constexpr double h = 1e-3;
    MatrixXd bends[2] = {MatrixXd(4, 4), MatrixXd(4, 4)};
    for (Index i = 0; i < 4; ++i) {
      for (Index k = 0; k < 4; ++k) {
        const auto moved = [&](double by_i, double by_k) {
          VectorXd x = xi2;
          x[free[static_cast<std::size_t>(i)]] += by_i * h;
          x[free[static_cast<std::size_t>(k)]] += by_k * h;
          return summed(x);
        };
        const Eigen::Vector2d bend =
            (moved(1, 1) - moved(1, -1) - moved(-1, 1) + moved(-1, -1)) / (4 * h * h);
        for (Index m = 0; m < 2; ++m) bends[m](i, k) = bend[m] * widths[i] * widths[k];
      }
    }
    const auto smallest = [](const MatrixXd& H) {
      return Eigen::SelfAdjointEigenSolver<MatrixXd>(H).eigenvalues()[0];
    };
    CHECK(result.screens->curvature_a[s] == Approx(smallest(bends[0])).epsilon(1e-4));
    CHECK(result.screens->curvature_b[s] == Approx(smallest(bends[1])).epsilon(1e-4));
  }
}

TEST_CASE("b = 0 passes both conditions") {
  const Simulated tone = sepcal::test::simulate_tone(3);
  const StageOne result = stage_one(*tone.model, tone.record, screened({.t_2 = 1e-9}));
  CHECK(result.screens->ratio_b.isZero(0));
  CHECK(result.screens->accepted.all());
}

TEST_CASE("Eq. 18 changes sign with a column: reported, and no reason to reject unless asked") {
  const Simulated wave = sepcal::test::simulate_scalar_1(150);
  const auto mirrored = sepcal::block_model(Mirrored{});
  const StageOne as_it_is = stage_one(*wave.model, wave.record, screened({}));
  const StageOne turned = stage_one(*mirrored, wave.record, screened({}));
  CHECK(as_it_is.screens->curvature_a.isApprox(-turned.screens->curvature_a, 1e-9));
  CHECK(as_it_is.screens->accepted.all());
  CHECK(turned.screens->accepted.all());
  CHECK(as_it_is.xi2[0] == Approx(turned.xi2[0]).epsilon(1e-8));

  Screens convex;
  convex.convex = true;
  // Of the wave neither A nor b is convex at any sample, of its mirror image only A is.
  CHECK((as_it_is.screens->curvature_b.array() < 0).all());
  CHECK((turned.screens->curvature_a.array() > 0).all());
  for (const sepcal::BlockModel* model : {wave.model.get(), mirrored.get()}) {
    CHECK_THROWS_WITH_AS(stage_one(*model, wave.record, screened(convex)),
                         doctest::Contains("not convex by Eq. 18; don't ask for convex"),
                         sepcal::Error);
  }
}

TEST_CASE("convex accepts the samples at which both Hessians are positive definite, and no other") {
  Simulated bent{
      "bent", sepcal::block_model(Bent{}), VectorXd::Ones(1), Eigen::Vector2d(0.7, 0.6), {}};
  sepcal::test::Draws draws(8);
  const auto u = draws.uniform_column(50, 0.1, 1);
  bent.record.add("u", u);
  add_outputs(bent.record, *bent.model, bent.xi1, bent.xi2, VectorXd::Constant(1, 0.01), draws);
  const double sum = std::accumulate(u.begin(), u.end(), 0.0);
  Screens convex;
  convex.convex = true;
  const StageOne all = stage_one(*bent.model, bent.record, screened({}, 300));
  const StageOne some = stage_one(*bent.model, bent.record, screened(convex, 300));
  CHECK(all.screens->accepted.all());
  Index accepted = 0;
  Index by_a_alone = 0;
  for (Index s = 0; s < 300; ++s) {
    const double k = some.samples(0, s);
    const double l = some.samples(1, s);
    const double smallest = 3 * (k + l) - std::sqrt(9 * (k - l) * (k - l) + 1);
    CHECK(some.screens->curvature_a[s] == Approx(smallest * sum).epsilon(1e-9));
    CHECK(some.screens->curvature_b[s] == Approx(std::min(6 * k - 1.5, 2.0) * sum).epsilon(1e-9));
    const bool a_is_convex = k > 0 && l > 0 && 36 * k * l > 1;
    const bool b_is_convex = k > 0.25;
    CHECK(some.screens->accepted[s] == (a_is_convex && b_is_convex));
    accepted += a_is_convex && b_is_convex ? 1 : 0;
    by_a_alone += a_is_convex && !b_is_convex ? 1 : 0;
  }
  // Of the square's area 17 and 4 %, by integration.
  CHECK(accepted > 30);
  CHECK(by_a_alone > 3);
  const VectorXd usable = some.screens->accepted.select(all.trace_r, sepcal::infinity);
  CHECK(some.best_trace_r == usable.minCoeff());
}

TEST_CASE("rejected samples keep their Tr[R] but are neither best nor a start") {
  const Simulated wave = sepcal::test::simulate_scalar_1(150);
  const StageOne all = stage_one(*wave.model, wave.record, screened({}));
  const double threshold =
      0.5 * (all.screens->ratio_a.minCoeff() + all.screens->ratio_a.maxCoeff());
  const StageOne some = stage_one(*wave.model, wave.record, screened({.t_1 = threshold}));
  CHECK(some.trace_r == all.trace_r);
  CHECK(some.screens->ratio_a == all.screens->ratio_a);
  CHECK((some.screens->accepted == (all.screens->ratio_a.array() <= threshold)).all());
  const VectorXd usable = some.screens->accepted.select(all.trace_r, sepcal::infinity);
  Index best = 0;
  CHECK(some.best_trace_r == usable.minCoeff(&best));
  CHECK(some.best == all.samples.col(best));
  CHECK(some.minima.size() == 1);
}

TEST_CASE("screens that reject everything are an error, whose thresholds let a sample pass") {
  const Simulated wave = sepcal::test::simulate_scalar_1(150);
  const auto least = [&](const Screens& screens) {
    const auto result = stage_one(*wave.model, wave.record, screened({}));
    return (screens.t_1 < 1 ? result.screens->ratio_a : result.screens->ratio_b).minCoeff();
  };
  const Screens tight{.t_1 = 0.01};
  try {
    stage_one(*wave.model, wave.record, screened(tight));
    FAIL("not refused");
  } catch (const sepcal::Error& error) {
    const std::string text = error.what();
    CAPTURE(text);
    const std::string before = "loosen t_1 to at least ";
    REQUIRE(text.find("the screens reject all 40 samples") == 0);
    REQUIRE(text.find(before) != std::string::npos);
    const double advised = std::stod(text.substr(text.find(before) + before.size()));
    CHECK(advised >= least(tight));
    CHECK(advised < 1.02 * least(tight));
    CHECK(stage_one(*wave.model, wave.record, screened({.t_1 = advised})).minima.size() == 1);
  }
  CHECK_THROWS_WITH_AS(stage_one(*wave.model, wave.record, screened({.t_1 = 0.01, .t_2 = 0.01})),
                       doctest::Contains(" and t_2 to at least "), sepcal::Error);
}

TEST_CASE("a global search is screened like samples, on any number of threads") {
  const Simulated wave = sepcal::test::simulate_scalar_1(150);
  FitOptions options = screened({.t_1 = 0.4, .l_2 = 0.6}, 60);
  options.search = sepcal::Search::global;
  options.threads = 1;
  const StageOne one = stage_one(*wave.model, wave.record, options);
  CHECK((one.screens->accepted == (one.screens->ratio_a.array() <= 0.4)).all());
  options.threads = 3;
  const StageOne several = stage_one(*wave.model, wave.record, options);
  CHECK(several.screens->ratio_a == one.screens->ratio_a);
  CHECK(several.screens->curvature_a == one.screens->curvature_a);
}

TEST_CASE("thresholds that mean nothing, and l_2 without bounds, are errors") {
  const Simulated wave = sepcal::test::simulate_scalar_1(50);
  const auto refused = [&](const Screens& screens, const char* text) {
    CHECK_THROWS_WITH_AS(stage_one(*wave.model, wave.record, screened(screens)),
                         doctest::Contains(text), sepcal::Error);
  };
  refused({.t_1 = 0}, "t_1 and t_2 must be positive");
  refused({.t_2 = std::nan("")}, "t_1 and t_2 must be positive");
  refused({.l_2 = -1}, "l_2 must be positive, or 0");
  FitOptions options = screened({});
  options.bounds["b"] = {-sepcal::infinity, sepcal::infinity};
  options.sampling_distribution["b"] = {0.1, 0.3};
  CHECK_THROWS_WITH_AS(stage_one(*wave.model, wave.record, options),
                       doctest::Contains("'b' has no finite bounds, from which the screens' l_2"),
                       sepcal::Error);
}

}  // namespace screens_test
