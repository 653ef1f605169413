// SPDX-License-Identifier: BSD-3-Clause
// Damped sinusoids from no start, against the truth, against a matrix pencil (Hua & Sarkar 1990)
// and, with noise, against the Cramer-Rao bound; both are written here.
#include "sepcal/models/damped_sinusoids.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <complex>

#include "draws.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/static_model.hpp"

namespace damped_sinusoids_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::DampedSinusoids;
using sepcal::Fit;
using sepcal::Record;
using sepcal::test::Draws;

namespace {

struct Mode {
  double omega;    // rad/s
  double damping;  // 1/s
  double cosine;
  double sine;
};

/// A wing's first bending and torsion after a pull: 2.3 and 3.1 Hz, dampings of 2 and 3 %.
constexpr std::array<Mode, 2> truth{Mode{19.5, 0.58, 0.4, 0.5}, Mode{14.5, 0.29, 1.0, -0.3}};
constexpr int rows = 200;
constexpr double interval = 0.02;  // s

VectorXd sample(const std::array<Mode, 2>& modes) {
  VectorXd z = VectorXd::Zero(rows);
  for (const Mode& mode : modes) {
    for (int k = 0; k < rows; ++k) {
      const double t = interval * k;
      z[k] += std::exp(-mode.damping * t) *
              (mode.cosine * std::cos(mode.omega * t) + mode.sine * std::sin(mode.omega * t));
    }
  }
  return z;
}

VectorXd noisy(double noise, std::uint64_t seed) {
  Draws draws(seed);
  return sample(truth) + noise * draws.normal_matrix(rows, 1);
}

Fit fit(const VectorXd& z) {
  Record record;
  VectorXd time(rows);
  for (int k = 0; k < rows; ++k) time[k] = interval * k;
  record.add("time", {time.begin(), time.end()}).add("z", {z.begin(), z.end()});
  sepcal::FitOptions options;
  options.bounds = {
      {"frequency_1", {0.0, 40.0}}, {"damping_1", {0.0, 5.0}}, {"damping_2", {0.0, 5.0}}};
  options.fix = {{"offset", 0.0}};
  options.coloured_errors = false;
  options.threads = 1;
  return sepcal::fit(DampedSinusoids<2>{}, record, options);
}

/// (omega_1, damping_1, omega_2, damping_2), the fastest first.
Eigen::Vector4d poles(const Fit& fit) {
  const double first = fit["frequency_1"].value;
  return {first, fit["damping_1"].value, first * fit["ratio_2"].value, fit["damping_2"].value};
}

/// The same by the matrix pencil: shifted halves of the right singular vectors that belong to the
/// signal have the poles exp((-damping +- i omega) dt) as their pencil's eigenvalues.
Eigen::Vector4d pencil(const VectorXd& z) {
  constexpr Index length = rows / 3;
  constexpr Index order = 4;
  MatrixXd hankel(rows - length, length + 1);
  for (Index i = 0; i < hankel.rows(); ++i) hankel.row(i) = z.segment(i, length + 1).transpose();
  const Eigen::BDCSVD<MatrixXd> svd(hankel, Eigen::ComputeThinV);
  const MatrixXd V = svd.matrixV().leftCols(order);
  const MatrixXd shift =
      V.topRows(length).completeOrthogonalDecomposition().solve(MatrixXd(V.bottomRows(length)));
  const Eigen::VectorXcd eigenvalues = shift.eigenvalues();
  std::vector<std::complex<double>> found;
  for (const std::complex<double>& eigenvalue : eigenvalues) {
    const std::complex<double> pole = std::log(eigenvalue) / interval;
    if (pole.imag() > 0) found.push_back(pole);
  }
  std::ranges::sort(found, [](auto a, auto b) { return a.imag() > b.imag(); });
  REQUIRE(found.size() == 2);
  return {found[0].imag(), -found[0].real(), found[1].imag(), -found[1].real()};
}

/// The bound for white noise of unit variance on poles(): the inverse of J'J, J by hand.
Eigen::Matrix4d cramer_rao() {
  MatrixXd J(rows, 8);
  for (int k = 0; k < rows; ++k) {
    const double t = interval * k;
    for (int m = 0; m < 2; ++m) {
      const Mode& mode = truth[static_cast<std::size_t>(m)];
      const double e = std::exp(-mode.damping * t);
      const double c = std::cos(mode.omega * t);
      const double s = std::sin(mode.omega * t);
      J(k, 2 * m) = e * t * (-mode.cosine * s + mode.sine * c);
      J(k, 2 * m + 1) = -t * e * (mode.cosine * c + mode.sine * s);
      J(k, 4 + 2 * m) = e * c;
      J(k, 5 + 2 * m) = e * s;
    }
  }
  return (J.transpose() * J).inverse().topLeftCorner<4, 4>();
}

const Eigen::Vector4d expected{truth[0].omega, truth[0].damping, truth[1].omega, truth[1].damping};

}  // namespace

TEST_CASE("without noise the truth is found from no start, as by the matrix pencil") {
  const Fit found = fit(sample(truth));
  CHECK(found.status == sepcal::FitStatus::converged);
  CHECK((poles(found) - expected).norm() < 1e-8);
  CHECK((poles(found) - pencil(sample(truth))).norm() < 1e-8);
  CHECK(found["cos_1"].value == Approx(truth[0].cosine).epsilon(1e-8));
  CHECK(found["sin_1"].value == Approx(truth[0].sine).epsilon(1e-8));
  CHECK(found["cos_2"].value == Approx(truth[1].cosine).epsilon(1e-8));
  CHECK(found["sin_2"].value == Approx(truth[1].sine).epsilon(1e-8));
}

TEST_CASE("with noise the errors are the Cramer-Rao bound's, and the pencil's no smaller") {
  constexpr int seeds = 60;
  constexpr double noise = 0.1;
  const Eigen::Matrix4d bound = noise * noise * cramer_rao();
  const Eigen::Matrix4d weight = bound.inverse();
  Eigen::Vector4d variance = Eigen::Vector4d::Zero();
  Eigen::Vector4d of_pencil = Eigen::Vector4d::Zero();
  double square = 0.0;
  double of_errors = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    const VectorXd z = noisy(noise, static_cast<std::uint64_t>(seed));
    const Fit found = fit(z);
    CHECK(found.status == sepcal::FitStatus::converged);
    const Eigen::Vector4d error = poles(found) - expected;
    variance += error.cwiseAbs2() / seeds;
    of_pencil += (pencil(z) - expected).cwiseAbs2() / seeds;
    square += error.dot(weight * error) / (4.0 * seeds);
    of_errors += std::pow(found["damping_2"].standard_error, 2) / bound(3, 3) / seeds;
  }
  MESSAGE("variance over the bound "
          << variance.cwiseQuotient(bound.diagonal()).transpose() << ", of the pencil "
          << of_pencil.cwiseQuotient(bound.diagonal()).transpose() << ", whole " << square
          << ", standard errors " << of_errors);
  // 240 squares: a standard deviation of 0.09; of 60 a variance's is 0.18.
  CHECK(std::abs(square - 1.0) < 0.36);
  CHECK((variance.cwiseQuotient(bound.diagonal()).array() < 1.8).all());
  CHECK((of_pencil.array() > 0.9 * variance.array()).all());
  CHECK(of_errors == Approx(1.0).epsilon(0.1));
}

TEST_CASE("one mode at irregular times, with an offset") {
  Draws draws(5);
  std::vector<double> time = draws.uniform_column(120, 0.0, 6.0);
  std::ranges::sort(time);
  std::vector<double> z;
  for (const double t : time) {
    z.push_back(0.7 + std::exp(-0.4 * t) * 1.5 * std::cos(9.0 * t + 0.6) + 0.02 * draws.normal());
  }
  Record record;
  record.add("time", time).add("z", z);
  sepcal::FitOptions options;
  options.bounds = {{"frequency_1", {0.0, 40.0}}, {"damping_1", {0.0, 5.0}}};
  options.threads = 1;
  const Fit found = sepcal::fit(DampedSinusoids<1>{}, record, options);
  CHECK(found.status == sepcal::FitStatus::converged);
  const auto near = [&](const char* name, double value) {
    INFO(name << " " << found[name].value << " +- " << found[name].standard_error);
    CHECK(std::abs(found[name].value - value) < 4.0 * found[name].standard_error);
  };
  near("frequency_1", 9.0);
  near("damping_1", 0.4);
  near("cos_1", 1.5 * std::cos(0.6));
  near("sin_1", -1.5 * std::sin(0.6));
  near("offset", 0.7);
}

}  // namespace damped_sinusoids_test
