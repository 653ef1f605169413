// SPDX-License-Identifier: BSD-3-Clause
// Noise as instruments have it, against dense covariances and in draws of such noise.
#include "diagnosis/instrument_noise.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <numbers>
#include <random>

#include "diagnosis/projection.hpp"
#include "flights_with_effects.hpp"
#include "numerics/tails.hpp"
#include "sepcal/static_model.hpp"

namespace instrument_noise_test {

using namespace sepcal;
using namespace sepcal::test;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A line and two sines through one output, with an error that wanders by 0.3 for 20 s.
struct Bench {
  explicit Bench(const VectorXd& z) {
    const Index n = z.size();
    std::vector<double> times;
    for (Index t = 0; t < n; ++t) times.push_back(0.5 * static_cast<double>(t));
    record.add("time", times);
    record.add("x", std::vector<double>(times.size(), 1.0));
    record.add("z", std::vector<double>(z.begin(), z.end()));
    record.cut({{"", 0, times.size()}});
  }

  Record record;
};

/// z = a x.
struct Constant {
  static constexpr std::array inputs{Quantity{"x", "1"}};
  static constexpr std::array outputs{Quantity{"z", "m/s"}};
  static constexpr std::array linear{Quantity{"a", "m/s"}};
  static constexpr std::array<Quantity, 0> nonlinear{};

  template <class U, class X>
  Affine<X, 1, 1> at(const Vec<U, 1>& u, const Vec<X, 0>& /*xi2*/) const {
    Affine<X, 1, 1> z;
    z.A(0, 0) = X(u[0]);
    z.b[0] = X(Real<X>(0));
    return z;
  }
};

DiagnosedFit fit_constant(const Record& record) {
  const auto model = block_model(Constant{});
  DiagnosedFit fitted{.model = model,
                      .kit = plain_kit(model->tables()),
                      .effects = {},
                      .record = record,
                      .rows = record.segments(),
                      .fit = fit(*model, record)};
  fitted.kit.error_budget = {
      {.name = "sensor", .unit = "m/s", .size = 0.3, .time_s = 20.0, .outputs = {"z"}}};
  return fitted;
}

VectorXd white(Index n, double size, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0.0, size);
  return VectorXd::NullaryExpr(n, [&] { return normal(generator); });
}

/// What is asked of the noise of a fit to these readings.
template <class Ask>
auto ask_noise(const VectorXd& measured, Ask ask) {
  const Bench bench(measured);
  const DiagnosedFit fitted = fit_constant(bench.record);
  base::ThreadPool pool(1);
  diagnosis::CandidateRoom room(fitted, pool);
  room.orthonormalise();
  const diagnosis::NullHypothesis null = diagnosis::find_plain_null(room.fit());
  diagnosis::InstrumentNoise noise(room, fitted.kit, null, {});
  return ask(noise);
}

double log10_tail(const diagnosis::InstrumentNoise& noise, const VectorXd& column) {
  return noise.tails({diagnosis::Columns(MatrixXd(column))}).front().log10_p;
}

TEST_CASE("a tail is that of generalised least squares in the covariance") {
  const Index n = 300;
  VectorXd z = white(n, 0.1, 1);
  for (Index t = 0; t < n; ++t) z[t] += 0.4 * std::sin(0.05 * static_cast<double>(t));
  VectorXd line(n);
  for (Index t = 0; t < n; ++t) line[t] = static_cast<double>(t) - 0.5 * static_cast<double>(n - 1);
  line.normalize();
  const double found = ask_noise(z, [&](const auto& noise) { return log10_tail(noise, line); });

  // The same over every noise of the set, by dense Cholesky factors.
  const VectorXd e = z.array() - z.mean();
  double largest = -infinity;
  const double differences = [&] {
    double sum = 0.0;
    for (Index t = 1; t + 1 < n; ++t) sum += std::pow(e[t - 1] - 2.0 * e[t] + e[t + 1], 2);
    return sum / (6.0 * static_cast<double>(n - 2));
  }();
  for (const double size : {0.0, 0.15, 0.3}) {
    MatrixXd covariance(n, n);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        covariance(i, j) =
            size * size * std::exp(-0.5 * std::abs(static_cast<double>(i - j)) / 20.0) +
            (i == j ? differences : 0.0);
      }
    }
    const Eigen::LLT<MatrixXd> factor(covariance);
    MatrixXd columns(n, 3);
    columns << VectorXd::Ones(n), line, e;
    factor.matrixL().solveInPlace(columns);
    const auto left_by = [&](Index k) {
      const MatrixXd basis = columns.leftCols(k);
      return (columns.col(2) - basis * basis.colPivHouseholderQr().solve(columns.col(2)))
          .squaredNorm();
    };
    const double variance = std::max(1.0, left_by(2) / static_cast<double>(n - 2));
    const double F = (left_by(1) - left_by(2)) / variance;
    largest = std::max(largest, numerics::log10_f_tail(F, 1.0, static_cast<double>(n - 2)));
  }
  // Large differences are held to four robust deviations there: of white noise, hardly any.
  CHECK(found == doctest::Approx(largest).epsilon(0.02));
}

TEST_CASE("noise that wanders within the bounds is seldom significant, an effect beyond them is") {
  const Index n = 300;
  constexpr int flights = 200;
  int by_chance = 0;
  int seen = 0;
  for (int flight = 0; flight < flights; ++flight) {
    const auto seed = static_cast<std::uint64_t>(flight);
    const VectorXd steps = white(n, 1.0, 1000 + seed);
    const double decay = std::exp(-0.5 / 20.0);
    double wander = steps[0] * 0.3;
    VectorXd z = white(n, 0.1, 5000 + seed);
    for (Index t = 0; t < n; ++t) {
      if (t > 0) wander = decay * wander + 0.3 * std::sqrt(1.0 - decay * decay) * steps[t];
      z[t] += wander;
    }
    VectorXd line(n);
    for (Index t = 0; t < n; ++t) line[t] = static_cast<double>(t) - 0.5 * (n - 1.0);
    const auto tail_of = [&](const VectorXd& measured) {
      return ask_noise(measured,
                       [&](const auto& noise) { return log10_tail(noise, line.normalized()); });
    };
    by_chance += tail_of(z) < std::log10(0.05);
    const VectorXd with =
        z + 0.9 * line / std::sqrt(line.squaredNorm() / n);  // three times the bound
    seen += tail_of(with) < std::log10(1e-4);
  }
  CHECK(by_chance <= 19);  // a rate of 5 % does so in 99 of 100 sets of seeds
  CHECK(seen >= 190);
}

TEST_CASE("what the log rules out excuses nothing, and what wanders less than its bound is noise") {
  const Index n = 400;
  constexpr int flights = 200;
  const auto swing = [&](double period) {
    VectorXd column(n);
    for (Index t = 0; t < n; ++t)
      column[t] = std::sin(2.0 * std::numbers::pi * static_cast<double>(t) / period);
    return VectorXd(column.normalized());
  };
  const VectorXd slow = swing(200.0);  // rows of half a second
  const VectorXd faster = swing(25.0);
  const auto tails_of = [&](const VectorXd& measured, bool asks_the_log) {
    return ask_noise(measured, [&](auto& noise) {
      if (asks_the_log) noise.set_beside(diagnosis::Columns(MatrixXd(faster)));
      return std::pair(log10_tail(noise, slow), log10_tail(noise, faster));
    });
  };
  for (const double size : {0.0, 0.03, 0.1, 0.2, 0.3}) {
    CAPTURE(size);
    int slow_by_chance = 0;
    int faster_by_chance = 0;
    for (int flight = 0; flight < flights; ++flight) {
      const auto seed = static_cast<std::uint64_t>(flight);
      const VectorXd steps = white(n, 1.0, 20000 + seed);
      const double decay = std::exp(-0.5 / 20.0);
      double wander = size * steps[0];
      VectorXd z = white(n, 0.1, 30000 + seed);
      for (Index t = 0; t < n; ++t) {
        if (t > 0) wander = decay * wander + size * std::sqrt(1.0 - decay * decay) * steps[t];
        z[t] += wander;
      }
      const auto [of_slow, of_faster] = tails_of(z, true);
      slow_by_chance += of_slow < std::log10(0.05);
      faster_by_chance += of_faster < std::log10(0.05);
    }
    CHECK(slow_by_chance <= 19);
    CHECK(faster_by_chance <= 19);
  }
  constexpr double six_errors = 6.0 * 0.1;
  int seen_in_bounds = 0;
  int seen_in_the_log = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const VectorXd with = white(n, 0.1, 40000 + seed) + six_errors * faster;
    seen_in_bounds += tails_of(with, false).second < std::log10(0.01);
    seen_in_the_log += tails_of(with, true).second < std::log10(0.01);
  }
  CAPTURE(seen_in_bounds);
  CHECK(seen_in_the_log >= 40);
  CHECK(seen_in_bounds <= 25);
}

TEST_CASE("bounds are the caller's where it knows them, and a name must be one") {
  const Bench bench(white(200, 0.1, 3));
  const DiagnosedFit fitted = fit_constant(bench.record);
  base::ThreadPool pool(1);
  diagnosis::CandidateRoom room(fitted, pool);
  room.orthonormalise();
  const diagnosis::NullHypothesis null = diagnosis::find_plain_null(room.fit());
  const diagnosis::InstrumentNoise noise(room, fitted.kit, null, {{"sensor", 2.0}});
  CHECK(noise.bounds().front().size == 2.0);
  CHECK_THROWS_WITH_AS((diagnosis::InstrumentNoise(room, fitted.kit, null, {{"velocity", 1.0}})),
                       "nothing called 'velocity' wanders; there is: sensor", Error);
}

}  // namespace instrument_noise_test
