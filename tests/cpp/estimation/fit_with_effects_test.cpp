// SPDX-License-Identifier: BSD-3-Clause
// A fit with effects by name: of z = s u + c it is a linear least squares problem, solved here by
// Eigen's QR.
#include "sepcal/fit_with_effects.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "numerics/decompositions.hpp"
#include "sepcal/error.hpp"
#include "sepcal/static_model.hpp"
#include "small_models.hpp"

namespace fit_with_effects_test {

using doctest::Approx;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::EffectSetting;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Record;

namespace {

constexpr int rows = 200;

const VectorXd u = VectorXd::LinSpaced(rows, 0.0, 50.0).array().sin();
const VectorXd t = VectorXd::LinSpaced(rows, 0.0, 19.9);
const VectorXd ripple = 0.01 * (VectorXd::LinSpaced(rows, 0.0, 900.0).array()).cos();

Record make_record(const VectorXd& z) {
  Record record;
  for (const auto& [name, values] : {std::pair{"u", &u}, {"time", &t}, {"z", &z}}) {
    record.add(name, std::vector<double>(values->begin(), values->end()));
  }
  return record;
}

Fit fit_line(const VectorXd& z, std::vector<EffectSetting>& settings,
             const FitOptions& options = {}) {
  const auto model = sepcal::block_model(sepcal::test::Line{});
  return fit_with_effects(model, sepcal::plain_kit(model->tables()), settings, make_record(z),
                          options);
}

VectorXd regress(const MatrixXd& columns, const VectorXd& z) {
  return columns.colPivHouseholderQr().solve(z);
}

}  // namespace

TEST_CASE("an effect on a linear parameter adds a column about the driver's mean") {
  const VectorXd z = 2.0 * u.array() + 0.3 * u.array() * t.array() + 1.0 + ripple.array();
  std::vector<EffectSetting> settings{{.name = "s[time]"}};
  const Fit fit = fit_line(z, settings);
  const double centre = t.mean();
  MatrixXd columns(rows, 3);
  columns << u, VectorXd::Ones(rows), u.cwiseProduct(VectorXd(t.array() - centre));
  const VectorXd expected = regress(columns, z);
  CHECK(*settings.front().centre == Approx(centre).epsilon(1e-14));
  CHECK(fit["s"].value == Approx(expected[0]).epsilon(1e-12));
  CHECK(fit["c"].value == Approx(expected[1]).epsilon(1e-12));
  CHECK(fit["s[time].s"].value == Approx(expected[2]).epsilon(1e-12));
  CHECK(fit.status == sepcal::FitStatus::converged);
}

TEST_CASE("what the settings hold already is used") {
  const VectorXd z = 2.0 * u.array() + 0.3 * t.array() + 1.0 + ripple.array();
  std::vector<EffectSetting> settings{{.name = "c[time]", .centre = 5.0, .known = true}};
  const Fit fit = fit_line(z, settings);
  MatrixXd columns(rows, 3);
  columns << u, VectorXd::Ones(rows), t.array() - 5.0;
  const VectorXd expected = regress(columns, z);
  CHECK(*settings.front().centre == 5.0);
  CHECK(fit["c"].value == Approx(expected[1]).epsilon(1e-12));
  CHECK(fit["c[time].s"].value == Approx(expected[2]).epsilon(1e-12));
}

TEST_CASE("an effect on an input is nonlinear and begins at zero: s (u + k t) + c") {
  const VectorXd z = 2.0 * (u.array() + 0.05 * t.array()) + 1.0 + ripple.array();
  std::vector<EffectSetting> settings{{.name = "u[time]", .centre = 0.0, .known = true}};
  for (const sepcal::SecondStage method :
       {sepcal::SecondStage::joint, sepcal::SecondStage::projected}) {
    const Fit fit = fit_line(z, settings, {.second_stage = method});
    MatrixXd columns(rows, 3);
    columns << u, VectorXd::Ones(rows), t;
    const VectorXd expected = regress(columns, z);
    CHECK(fit["s"].value == Approx(expected[0]).epsilon(1e-9));
    CHECK(fit["u[time].s"].value == Approx(expected[2] / expected[0]).epsilon(1e-9));
  }
}

TEST_CASE("a step's time is found between two rows and held") {
  VectorXd z = 2.0 * u + ripple;
  z.tail(rows - 120).array() += 0.7;
  std::vector<EffectSetting> settings{{.name = "c[step(time)]"}};
  const Fit fit = fit_line(z, settings);
  CHECK(*settings.front().t0 == Approx(0.5 * (t[119] + t[120])).epsilon(1e-12));
  CHECK(fit["c[step(time)].t0"].fixed);
  MatrixXd columns = MatrixXd::Zero(rows, 3);
  columns.col(0) = u;
  columns.col(1).setOnes();
  columns.col(2).tail(rows - 120).setOnes();
  CHECK(fit["c[step(time)].s"].value == Approx(regress(columns, z)[2]).epsilon(1e-12));
}

TEST_CASE("rows that a late driver reaches across an edge are left out") {
  const VectorXd z = 2.0 * u.array() + 0.3 * t.array() + 1.0 + ripple.array();
  std::vector<EffectSetting> settings{{.name = "c[delay(u)]"}};
  const Fit fit = fit_line(z, settings, {.bounds = {{"c[delay(u)].tau", {-0.31, 0.31}}}});
  CHECK(fit.rows == rows - 8);  // four of 0.1 s at either end
}

TEST_CASE("without effects it is the fit of the model") {
  const VectorXd z = 2.0 * u.array() + 1.0 + ripple.array();
  std::vector<EffectSetting> none;
  const Fit fit = fit_line(z, none);
  MatrixXd columns(rows, 2);
  columns << u, VectorXd::Ones(rows);
  CHECK(fit["s"].value == Approx(regress(columns, z)[0]).epsilon(1e-12));
  CHECK(fit.parameters.size() == 2);
}

TEST_CASE("misuse is refused by name") {
  std::vector<EffectSetting> unknown{{.name = "w[time]"}};
  CHECK_THROWS_WITH_AS(fit_line(u, unknown), doctest::Contains("'w[time]'"), sepcal::Error);
  std::vector<EffectSetting> missing{{.name = "c[heat]"}};
  CHECK_THROWS_WITH_AS(fit_line(u, missing), doctest::Contains("'heat'"), sepcal::Error);
}

}  // namespace fit_with_effects_test
