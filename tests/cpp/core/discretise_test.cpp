// SPDX-License-Identifier: BSD-3-Clause
// Discretisation against quadrature of the integrals that define it, and against closed forms.
#include "sepcal/states/discretise.hpp"

#include <doctest/doctest.h>

#include <array>

#include "sepcal/detail/states/triangle.hpp"

namespace discretise_test {

using Eigen::Matrix2d;
using sepcal::discretise;
using sepcal::discretise_inputs;

namespace {

/// x'' = -2 zeta w x' - w^2 x in closed form: exp(F t), under-damped.
struct Mode {
  double frequency;  // rad/s
  double damping;

  Matrix2d rates() const {
    Matrix2d F;
    F << 0.0, 1.0, -frequency * frequency, -2.0 * damping * frequency;
    return F;
  }
  Matrix2d after(double t) const {
    const double s = damping * frequency;
    const double w = frequency * std::sqrt(1.0 - damping * damping);
    Matrix2d E;
    E << std::cos(w * t) + s / w * std::sin(w * t), std::sin(w * t) / w,
        -frequency * frequency / w * std::sin(w * t), std::cos(w * t) - s / w * std::sin(w * t);
    return std::exp(-s * t) * E;
  }
};

/// The integral of f over [0, end] by Gauss and Legendre, five points on each of 200 parts.
template <class Function>
auto integrate(const Function& f, double end) {
  constexpr std::array points{0.0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array weights{128.0 / 225.0, 0.47862867049936647, 0.23692688505618909};
  constexpr int parts = 200;
  const double half = 0.5 * end / parts;
  auto sum = (0.0 * f(0.0)).eval();
  for (int part = 0; part < parts; ++part) {
    const double middle = (2 * part + 1) * half;
    sum += half * weights[0] * f(middle);
    for (std::size_t k = 1; k < points.size(); ++k) {
      sum += half * weights[k] * (f(middle + half * points[k]) + f(middle - half * points[k]));
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("Phi and Q_d are exp(F dt) and its integral, by quadrature, dt from 0.02 to 1 s") {
  Matrix2d density;
  density << 0.3, 0.1, 0.1, 2.0;
  double worst = 0.0;
  for (const Mode& mode : {Mode{2.0, 0.1}, Mode{2.0, 0.7}, Mode{60.0, 0.5}}) {
    for (const double dt : {0.02, 0.1, 0.5, 1.0}) {
      const auto discrete = discretise<2>(mode.rates(), density, dt);
      const Matrix2d Q = integrate(
          [&](double s) { return (mode.after(s) * density * mode.after(s).transpose()).eval(); },
          dt);
      worst = std::max(worst, (discrete.Q_d - Q).norm() / Q.norm());
      CHECK((discrete.Phi - mode.after(dt)).norm() < 1e-11 * (1.0 + mode.after(dt).norm()));
    }
  }
  MESSAGE("Q_d from quadrature: " << worst);
  CHECK(worst < 1e-7);
}

TEST_CASE("Gamma Q / dt Gamma', which S 3.11 may mean, is an approximation") {
  const Mode mode{2.0, 0.1};
  const Eigen::Vector2d G(0.0, 1.0);
  const auto error = [&](double dt) {
    const Matrix2d exact = discretise<2>(mode.rates(), G * G.transpose(), dt).Q_d;
    const Eigen::Vector2d Gamma = discretise_inputs<2, 1>(mode.rates(), G, dt).held;
    return (Gamma * Gamma.transpose() / dt - exact).norm() / exact.norm();
  };
  MESSAGE("off by " << error(0.1) << " at 0.1 s, " << error(0.5) << " at 0.5 s");
  CHECK(error(0.5) > 0.05);
  CHECK(error(0.02) / error(0.01) == doctest::Approx(4.0).epsilon(0.05));  // of second order
}

TEST_CASE("closed forms: a random walk, its integral, a first-order lag over 1000 time constants") {
  using One = Eigen::Matrix<double, 1, 1>;
  CHECK(discretise<1>(One(0.0), One(3.0), 0.25).Q_d(0, 0) == doctest::Approx(0.75));
  Matrix2d F;
  F << 0.0, 1.0, 0.0, 0.0;
  const double dt = 0.4;
  Matrix2d expected;
  expected << dt * dt * dt / 3.0, dt * dt / 2.0, dt * dt / 2.0, dt;
  const auto walk = discretise<2>(F, Matrix2d(Eigen::Vector2d(0.0, 5.0).asDiagonal()), dt);
  CHECK((walk.Q_d - 5.0 * expected).norm() < 1e-14);
  for (const double dt_of_lag : {1e-6, 1.0, 1000.0}) {
    const double density = 1e-12;
    const double exact = density * -std::expm1(-2.0 * dt_of_lag) / 2.0;
    const auto lag = discretise<1>(One(-1.0), One(density), dt_of_lag);
    CHECK(lag.Q_d(0, 0) == doctest::Approx(exact).epsilon(1e-12));
  }
  CHECK(discretise<2>(F, Matrix2d::Zero(), dt).Q_d == Matrix2d::Zero());
  CHECK_FALSE(discretise<2>(F, Matrix2d::Constant(std::nan("")), dt).Q_d.allFinite());
  F(0, 0) = HUGE_VAL;
  CHECK_FALSE(discretise<2>(F, Matrix2d::Identity(), dt).Phi.allFinite());
}

TEST_CASE("a chain of integrators over a tenth of a millisecond keeps its smallest entries") {
  // Q_d(i, j) is a power of dt each; the smallest is 1e-17 of the largest. Exact by hand.
  Eigen::Matrix3d F = Eigen::Matrix3d::Zero();
  F(0, 1) = F(1, 2) = 1.0;
  const double dt = 1e-4;
  const auto chain =
      discretise<3>(F, Eigen::Matrix3d(Eigen::Vector3d(0.0, 0.0, 1.0).asDiagonal()), dt);
  const double factorial[] = {1.0, 1.0, 2.0};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int power = (2 - i) + (2 - j) + 1;
      const double exact = std::pow(dt, power) / (power * factorial[2 - i] * factorial[2 - j]);
      CHECK(chain.Q_d(i, j) == doctest::Approx(exact).scale(0.0).epsilon(1e-12));
    }
  }
  CHECK(sepcal::states::upper_root(chain.Q_d).allFinite());
}

TEST_CASE("inputs that are held or linear between samples, by quadrature") {
  const Mode mode{3.0, 0.2};
  Matrix2d B;
  B << 0.0, 1.0, 2.0, -0.5;
  const Eigen::Vector2d u0(1.0, -2.0);
  const Eigen::Vector2d u1(0.5, 3.0);
  for (const double dt : {0.02, 0.3, 1.0}) {
    const auto inputs = discretise_inputs<2, 2>(mode.rates(), B, dt);
    const auto forced = [&](auto u) {
      return integrate([&](double s) { return (mode.after(dt - s) * B * u(s)).eval(); }, dt);
    };
    const Eigen::Vector2d held = forced([&](double) { return u0; });
    const Eigen::Vector2d linear =
        forced([&](double s) { return Eigen::Vector2d(u0 + s / dt * (u1 - u0)); });
    CHECK((inputs.held * u0 - held).norm() < 1e-12);
    CHECK((inputs.begin * u0 + inputs.end * u1 - linear).norm() < 1e-12);
  }
}

TEST_CASE("units of the states cost transition and noise no digits") {
  Matrix2d F;
  F << -0.4, 1.0, -9.0, -0.6;
  Matrix2d density;
  density << 0.2, 0.05, 0.05, 0.4;
  const auto expected = discretise<2>(F, density, 0.1);
  for (const double unit : {1e6, 1e12}) {
    const Eigen::Vector2d units(unit, 1.0 / unit);
    const Eigen::Vector2d back = units.cwiseInverse();
    const auto found =
        discretise<2>(Matrix2d(units.asDiagonal() * F * back.asDiagonal()),
                      Matrix2d(units.asDiagonal() * density * units.asDiagonal()), 0.1);
    CHECK((back.asDiagonal() * found.Phi * units.asDiagonal() - expected.Phi).norm() < 1e-13);
    CHECK((back.asDiagonal() * found.Q_d * back.asDiagonal() - expected.Q_d).norm() <
          1e-13 * expected.Q_d.norm());
  }
}

TEST_CASE("noise that reaches states by a long way alone leaves them covariances that have roots") {
  // A turning aircraft's u v w, attitude and position, of which noise drives u alone.
  using Matrix9d = Eigen::Matrix<double, 9, 9>;
  const double dt = 0.1;
  Matrix9d F = Matrix9d::Zero();
  F.topLeftCorner<3, 3>() << 0, 0.1, -0.02, -0.1, 0, 0.05, 0.02, -0.05, 0;
  F.block<3, 3>(0, 3) << 0, -9.8, 0, 9.7, 0.05, 0, -1.2, -0.4, 0;
  F.block<3, 3>(3, 3) << 1e-3, 0.1, 0, -0.1, 0, 0, 0.02, 1e-3, 0;
  F.bottomLeftCorner<3, 3>() << 0.31, -0.94, 0.1, 0.94, 0.32, 0.02, -0.05, 0.09, 0.99;
  F.block<3, 3>(6, 3) << 0.9, -2, 38, 1.8, -1, -12, 0.2, -40, 0;
  for (const int driven : {0, 1, 2, 5}) {
    CAPTURE(driven);
    Matrix9d density = Matrix9d::Zero();
    density(driven, driven) = 1e-8;
    const Matrix9d Q = discretise<9>(F, density, dt).Q_d;
    CHECK(sepcal::states::upper_root(Q).allFinite());
    const Matrix9d exact = integrate(
        [&](double s) -> Matrix9d {
          const Matrix9d E = sepcal::matrix_exponential(Matrix9d(F * s));
          return E * density * E.transpose();
        },
        dt);
    for (int i = 0; i < 9; ++i) {
      for (int j = 0; j < 9; ++j) {
        CHECK(std::abs(Q(i, j) - exact(i, j)) <= 1e-11 * std::sqrt(exact(i, i) * exact(j, j)));
      }
    }
  }
}

}  // namespace discretise_test
