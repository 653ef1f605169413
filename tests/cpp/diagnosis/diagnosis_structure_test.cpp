// SPDX-License-Identifier: BSD-3-Clause
// Partial F, PSE and the reduction of SSE by least squares of nested models and by a dense QR.
#include "diagnosis/structure.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "draws.hpp"
#include "linearisations.hpp"

namespace diagnosis_structure_test {

using namespace sepcal;
using namespace sepcal::test;
using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index rows = 120;
constexpr Index N = 2 * rows;  // of two outputs
constexpr Index p = 3;

/// Two outputs, three columns of a model and two of a candidate.
struct Bench {
  diagnosis::RowLayout layout = make_layout({{"a", rows}}, {0.5, 2.0});
  MatrixXd J = MatrixXd(N, p);
  MatrixXd G = MatrixXd(N, 2);
  VectorXd z = VectorXd(N);
  diagnosis::LinearisedFit fit;

  Bench() {
    Draws draws(11);
    for (MatrixXd* columns : {&J, &G}) {
      for (Index k = 0; k < columns->cols(); ++k) {
        const std::vector<double> column = draws.uniform_column(N, -1.0, 1.0);
        columns->col(k) = Eigen::Map<const VectorXd>(column.data(), N);
      }
    }
    const std::vector<double> noise = draws.uniform_column(N, -1.0, 1.0);
    z = J * VectorXd::LinSpaced(p, 1.0, 2.0) + 0.2 * G.col(0) +
        Eigen::Map<const VectorXd>(noise.data(), N);
    layout.outputs[0].variance = 3.0;
    layout.outputs[1].variance = 10.0;
    fit = fit_to(layout, J, z);
  }

  double sse_of(const MatrixXd& columns) const {
    return (z - columns * least_squares(columns, z)).squaredNorm();
  }
  MatrixXd both() const {
    MatrixXd columns(N, p + G.cols());
    columns << J, G;
    return columns;
  }
};

}  // namespace

TEST_CASE("they are those of nested least squares") {
  const Bench bench;
  const double without = bench.sse_of(bench.J);
  const double with = bench.sse_of(bench.both());
  const Structure found = diagnosis::measure_structure(bench.fit, bench.fit.residual,
                                                       without - with, 2, PseBound::sidpac);
  CHECK(found.sse == Approx(without));
  CHECK(found.partial_f == Approx((without - with) / 2.0 / (with / (N - p - 2))));
  const double variance = 0.5 * (3.0 / 0.25 + 10.0 / 4.0);  // of z in units of the RMSE
  CHECK(found.pse == Approx(with / N + 2.0 * 0.5 * variance * (p + 2) / N));
  CHECK(found.pse_without == Approx(without / N + 2.0 * 0.5 * variance * p / N));
  const Structure classic = diagnosis::measure_structure(bench.fit, bench.fit.residual,
                                                         without - with, 2, PseBound::classic);
  CHECK(classic.pse == Approx(with / N + 2.0 * variance * (p + 2) / N));
  CHECK(classic.partial_f == found.partial_f);
}

TEST_CASE("the reduction is the square of T's last column behind the model's") {
  const Bench bench;
  MatrixXd columns(N, p + 3);
  columns << bench.J, bench.G, bench.z;
  const MatrixXd T =
      columns.householderQr().matrixQR().topRows(p + 3).triangularView<Eigen::Upper>();
  CHECK(T.col(p + 2).segment(p, 2).squaredNorm() ==
        Approx(bench.sse_of(bench.J) - bench.sse_of(bench.both())));
}

TEST_CASE("what can't be said is no number") {
  Bench bench;
  for (diagnosis::UsedOutput& output : bench.fit.layout.outputs) output.variance = 0.0;
  const Structure flat =
      diagnosis::measure_structure(bench.fit, bench.fit.residual, 1.0, 1, PseBound::sidpac);
  CHECK(std::isnan(flat.pse));
  CHECK(std::isfinite(flat.partial_f));
  const Structure full =
      diagnosis::measure_structure(bench.fit, bench.fit.residual, 1.0, N - p, PseBound::sidpac);
  CHECK(std::isnan(full.partial_f));
}

}  // namespace diagnosis_structure_test
