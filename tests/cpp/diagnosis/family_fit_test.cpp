// SPDX-License-Identifier: BSD-3-Clause
// Columns and noise estimated together: coefficients by dense generalised least squares in the
// noise that was found, and the fits of many residuals as those of one at a time.
#include "diagnosis/family_fit.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "diagnosis/known_products.hpp"
#include "diagnosis/projection.hpp"
#include "linearisations.hpp"
#include "noises.hpp"

namespace family_fit_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;
using namespace sepcal::test;
using noise::NoiseFamilies;
using noise::NoiseFamily;

namespace {

constexpr Index rows = 240;  // in two runs, of each of two outputs
constexpr Index outputs = 2;
const std::vector<int> orders(outputs, 2);

struct Bench {
  diagnosis::RowLayout layout = make_layout({{"a", 150}, {"b", 90}}, {1.0, 2.0});
  NoiseFamilies families{layout.runs};
  MatrixXd columns = make_columns();

  MatrixXd make_columns() const {
    MatrixXd made(outputs * rows, 4);
    for (Index t = 0; t < made.rows(); ++t) {
      const auto at = static_cast<double>(t);
      made.row(t) << 1.0, at, std::sin(0.05 * at), std::cos(0.3 * at);
    }
    return diagnosis::orthonormal_basis(made);
  }

  /// Noise of this kind, and something of every column.
  VectorXd residual(const std::string& kind, std::uint64_t seed) const {
    Draws draws(seed);
    VectorXd e(outputs * rows);
    for (Index j = 0; j < outputs; ++j) e.segment(j * rows, rows) = draw_noise(kind, rows, draws);
    return e + columns * VectorXd::LinSpaced(columns.cols(), -3.0, 5.0);
  }

  /// The inverse of the noise's covariance, from the noise that white innovations become.
  MatrixXd precision(const diagnosis::NoiseMembers& members) const {
    MatrixXd inverse = MatrixXd::Zero(outputs * rows, outputs * rows);
    for (Index j = 0; j < outputs; ++j) {
      MatrixXd factor = MatrixXd::Identity(rows, rows);
      for (auto column : factor.colwise()) {
        families.colour(members[static_cast<std::size_t>(j)], column);
      }
      inverse.block(j * rows, j * rows, rows, rows) = (factor * factor.transpose()).inverse();
    }
    return inverse;
  }

  std::array<diagnosis::FamilyFit, 2> fit(const MatrixXd& of, const VectorXd& e) const {
    const auto products = [&](const diagnosis::NoiseMembers& noise) {
      return family_products(families, layout, noise, of, e);
    };
    auto fits = fit_families(families, layout, of, e, orders, products);
    for (diagnosis::FamilyFit& fit : fits) finish_fit(products, fit);
    return fits;
  }
};

}  // namespace

TEST_CASE("coefficients are those of dense generalised least squares in the noise found") {
  const Bench bench;
  for (const std::string& kind : noise_kinds) {
    CAPTURE(kind);
    const VectorXd e = bench.residual(kind, 7);
    for (const diagnosis::FamilyFit& fit : bench.fit(bench.columns, e)) {
      const MatrixXd weighted = bench.columns.transpose() * bench.precision(fit.noise);
      const MatrixXd normal = weighted * bench.columns;
      const VectorXd expected = normal.ldlt().solve(weighted * e);
      CHECK((fit.coefficients - expected).norm() < 1e-6 * expected.norm());
      CHECK(fit.covariance.isApprox(normal.inverse(), 1e-6));
    }
  }
}

TEST_CASE("products beside known columns are those of all columns, whitened") {
  const Bench bench;
  Draws draws(21);
  const MatrixXd added = draws.normal_matrix(outputs * rows, 2);
  for (const std::string& kind : noise_kinds) {
    const VectorXd e = bench.residual(kind, 5);
    const diagnosis::KnownProducts known(bench.families, bench.layout, bench.columns, e, orders);
    for (const std::uint64_t seed : {11UL, 12UL}) {  // of each family twice: some is known by then
      for (const diagnosis::FamilyFit& fit : bench.fit(bench.columns, bench.residual(kind, seed))) {
        for (const Index count : {0, 2}) {
          CAPTURE(kind);
          CAPTURE(count);
          const MatrixXd X = added.leftCols(count);
          MatrixXd all(outputs * rows, bench.columns.cols() + count + 1);
          all << bench.columns, X, e;
          const MatrixXd expected = all.transpose() * bench.precision(fit.noise) * all;
          const VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
          const MatrixXd off = known.beside(fit.noise, X) - expected;
          CHECK((scale.asDiagonal() * off * scale.asDiagonal()).cwiseAbs().maxCoeff() < 1e-7);
          const MatrixXd plain =
              family_products(bench.families, bench.layout, fit.noise,
                              diagnosis::Columns(MatrixXd(all.leftCols(all.cols() - 1))), e);
          const MatrixXd apart = known.beside(fit.noise, X) - plain;
          CHECK((scale.asDiagonal() * apart * scale.asDiagonal()).cwiseAbs().maxCoeff() < 1e-10);
        }
      }
    }
  }
}

TEST_CASE("more columns are no less likely than the first of them") {
  const Bench bench;
  const diagnosis::FamilyRegression regression(bench.families, bench.layout, bench.columns, orders);
  for (const std::string& kind : noise_kinds) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      CAPTURE(kind);
      CAPTURE(seed);
      const diagnosis::FamilyRegression::Residual residual =
          regression.take(bench.residual(kind, seed));
      for (const NoiseFamily family : noise::noise_families) {
        const diagnosis::FamilyFit first = residual.fit(family, 2);
        const auto [without, with] = residual.compare(first.noise, 2);
        CHECK(std::abs(without - first.minus_two_log_likelihood) <
              0.05);  // a round that gains little
        CHECK(with <= without);
      }
    }
  }
}

TEST_CASE("many residuals' fits are those of one at a time, also of the first columns") {
  const Bench bench;
  const diagnosis::FamilyRegression regression(bench.families, bench.layout, bench.columns, orders);
  for (const std::string& kind : noise_kinds) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const VectorXd e = bench.residual(kind, seed);
      const diagnosis::FamilyRegression::Residual residual = regression.take(e);
      for (const Index count : {Index{2}, regression.columns()}) {
        const MatrixXd first = bench.columns.leftCols(count);
        const auto expected = bench.fit(first, e);
        for (std::size_t k = 0; k < expected.size(); ++k) {
          CAPTURE(kind);
          CAPTURE(count);
          CAPTURE(k);
          const diagnosis::FamilyFit fit = residual.fit(noise::noise_families[k], count);
          CHECK(fit.minus_two_log_likelihood ==
                Approx(expected[k].minus_two_log_likelihood).epsilon(1e-9));
          CHECK((fit.coefficients - expected[k].coefficients).norm() < 1e-7);
          CHECK(fit.covariance.isApprox(expected[k].covariance, 1e-7));
        }
      }
    }
  }
}

}  // namespace family_fit_test
