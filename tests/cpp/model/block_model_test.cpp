// SPDX-License-Identifier: BSD-3-Clause
// The waist: names are checked, and a trajectory model carries its state within a segment only.
#include "sepcal/detail/block_model.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "dense_reference.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "simulated_records.hpp"

namespace block_model_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double interval = 0.1;  // s

/// A sensor with a first-order lag: x += dt / tau (u - x), z = gain x + bias. x starts at u.
class LaggedSensor final : public sepcal::BlockModel {
 public:
  LaggedSensor()
      : BlockModel(
            {{{"u", "1"}}, {{"z", "1"}}, {{"gain", "1"}, {"bias", "1"}}, {{"tau", "s", 0.3, 5}}}) {}

  struct State final : sepcal::Carry {
    double x = 0;
    double slope = 0;  // dx / dtau
  };

  std::unique_ptr<sepcal::Carry> new_carry() const override { return std::make_unique<State>(); }

  void evaluate(const sepcal::Block& block, const double* xi2, const double* xi1,
                sepcal::Carry* carry, Eigen::Ref<MatrixXd> rows) const override {
    auto& state = dynamic_cast<State&>(*carry);
    const double tau = xi2[0];
    const auto last = rows.cols() - 1;
    for (std::size_t k = 0; k < block.rows; ++k) {
      const double u = block.inputs[0][k];
      if (k == 0 && block.starts_segment) {
        state.x = u;
        state.slope = 0;
      } else {
        const double share = interval / tau;
        state.slope += -share / tau * (u - state.x) - share * state.slope;
        state.x += share * (u - state.x);
      }
      const auto row = static_cast<Index>(k);
      rows(row, 0) = state.x;
      rows(row, 1) = 1.0;
      if (xi1 != nullptr) rows(row, 2) = xi1[0] * state.slope;
      rows(row, last) = 0.0;
    }
  }
};

constexpr std::size_t first_segment = 700;
constexpr std::size_t all_rows = 1200;

sepcal::Record simulate_lag() {
  sepcal::test::Draws draws(41);
  sepcal::Record record;
  record.add("u", draws.uniform_column(all_rows, -1, 3));
  record.cut({{"one", 0, first_segment}, {"two", first_segment, all_rows}});
  sepcal::test::add_outputs(record, LaggedSensor(), Eigen::Vector2d(2.0, -1.0),
                            VectorXd::Constant(1, 0.8), VectorXd::Constant(1, 0.05), draws);
  return record;
}

/// Sum of squares at tau, gain and bias solved in closed form: simple linear regression on x.
double brute_force(const sepcal::Record& record, double tau, double& gain, double& bias) {
  std::vector<double> x(all_rows);
  const auto u = record.column("u");
  const auto z = record.column("z");
  double mean_x = 0;
  double mean_z = 0;
  for (std::size_t k = 0; k < all_rows; ++k) {
    const bool starts = k == 0 || k == first_segment;
    x[k] = starts ? u[k] : x[k - 1] + interval / tau * (u[k] - x[k - 1]);
    mean_x += x[k] / static_cast<double>(all_rows);
    mean_z += z[k] / static_cast<double>(all_rows);
  }
  double xx = 0, xz = 0, zz = 0;
  for (std::size_t k = 0; k < all_rows; ++k) {
    xx += (x[k] - mean_x) * (x[k] - mean_x);
    xz += (x[k] - mean_x) * (z[k] - mean_z);
    zz += (z[k] - mean_z) * (z[k] - mean_z);
  }
  gain = xz / xx;
  bias = mean_z - gain * mean_x;
  return zz - xz * xz / xx;
}

}  // namespace

TEST_CASE("a model whose names clash can't be made") {
  class Clash final : public sepcal::BlockModel {
   public:
    Clash() : BlockModel({{}, {{"z", "1"}}, {{"a", "1"}}, {{"a", "1"}}}) {}
    void evaluate(const sepcal::Block&, const double*, const double*, sepcal::Carry*,
                  Eigen::Ref<MatrixXd>) const override {}
  };
  CHECK_THROWS_WITH_AS(Clash(), doctest::Contains("'a'"), sepcal::Error);
}

TEST_CASE("a trajectory model fitted over two segments is the brute-force minimum") {
  const sepcal::Record record = simulate_lag();
  sepcal::FitOptions options;
  options.samples = 30;
  const auto fit = sepcal::fit(LaggedSensor(), record, options);
  CHECK(fit.status == sepcal::FitStatus::converged);

  double lower = 0.6;
  double upper = 1.0;
  double gain = 0;
  double bias = 0;
  for (int i = 0; i < 100; ++i) {  // ternary search: the sum of squares is convex near its minimum
    const double a = lower + (upper - lower) / 3;
    const double b = upper - (upper - lower) / 3;
    (brute_force(record, a, gain, bias) < brute_force(record, b, gain, bias) ? upper : lower) =
        brute_force(record, a, gain, bias) < brute_force(record, b, gain, bias) ? b : a;
  }
  const double least = brute_force(record, 0.5 * (lower + upper), gain, bias);
  // A search on values can't see below the square root of rounding.
  CHECK(fit["tau"].value == Approx(0.5 * (lower + upper)).epsilon(1e-6));
  CHECK(brute_force(record, fit["tau"].value, gain, bias) <= least * (1 + 1e-12));
  CHECK(fit["gain"].value == Approx(gain).epsilon(1e-10));
  CHECK(fit["bias"].value == Approx(bias).epsilon(1e-10));
  CHECK(fit.rmse[0].value * fit.rmse[0].value * 1200 == Approx(least).epsilon(1e-10));
}

TEST_CASE("the state crosses blocks and forgets at a segment's edge") {
  sepcal::Record record = simulate_lag();
  sepcal::FitOptions options;
  options.samples = 0;
  const auto cut = sepcal::fit(LaggedSensor(), record, options);
  record.cut({{"whole", 0, all_rows}});
  const auto uncut = sepcal::fit(LaggedSensor(), record, options);
  CHECK(std::abs(cut["tau"].value - uncut["tau"].value) > 1e-9);

  // One segment of 700 rows spans three blocks: as many squares as one block would give.
  record.cut({{"one", 0, first_segment}});
  const auto one = sepcal::fit(LaggedSensor(), record, options);
  const VectorXd r =
      sepcal::test::dense_rows(LaggedSensor(), record, one.xi1(), one.xi2()).rightCols<1>();
  CHECK(one.rmse[0].value == Approx(std::sqrt(r.squaredNorm() / first_segment)).epsilon(1e-12));
}

TEST_CASE("a trajectory model with a parameter fixed still carries its state") {
  const sepcal::Record record = simulate_lag();
  sepcal::FitOptions options;
  options.samples = 0;
  const auto free = sepcal::fit(LaggedSensor(), record, options);
  options.fix = {{"tau", free["tau"].value}};
  const auto held = sepcal::fit(LaggedSensor(), record, options);
  CHECK(held["gain"].value == Approx(free["gain"].value).epsilon(1e-10));
  CHECK(held.rmse[0].value == Approx(free.rmse[0].value).epsilon(1e-12));
}

TEST_CASE("a model that carries a state can't be differentiated by its inputs, and says so") {
  const LaggedSensor model;
  const double u = 0.5;
  const double* const inputs[] = {&u};
  const double xi1[] = {1, 0};
  const int wanted[] = {0};
  MatrixXd columns(1, 1);
  CHECK_THROWS_WITH_AS(model.input_tangent({inputs, 1, 0, true}, &u, xi1, wanted, columns),
                       doctest::Contains("carries a state can't be differentiated by its input"),
                       sepcal::Error);
}

}  // namespace block_model_test
