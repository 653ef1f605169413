// SPDX-License-Identifier: BSD-3-Clause
// States and parameters together: the information form against formulas with inverses, and the
// short period with process noise, flown here by small steps of Euler and Maruyama.
#include "sepcal/states/joint_filter.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>

#include "draws.hpp"
#include "noises.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/detail/states/joseph_form.hpp"
#include "sepcal/models/short_period.hpp"
#include "sepcal/states/information_form.hpp"
#include "short_periods.hpp"

namespace joint_filter_test {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using sepcal::Filter;
using sepcal::FilterStatus;
using sepcal::InformationForm;
using sepcal::JointFilter;
using sepcal::JosephForm;
using sepcal::Linearisation;
using sepcal::ShortPeriod;
using sepcal::SquareRootForm;
using sepcal::StateRow;
using sepcal::test::Draws;

namespace {

using Ten = Eigen::Vector<double, 10>;
using Square = Eigen::Matrix<double, 10, 10>;

// s = alpha, q, b_alpha, b_q, b_az, Za, Ma, Mq, Zd, Md.
const Ten truth = (Ten() << 0, 0, 0.02, -0.01, 0.5, -4, -40, -5, -0.35, -45).finished();
const Vector3d noise(0.005, 0.01, 0.15);
const Vector2d density(0.003, 0.09);  // of alpha' and q', per sqrt(s)
constexpr double airspeed = 25.0;
constexpr double dt = 0.02;

struct Row {
  StateRow<ShortPeriod> inputs;
  Vector3d z;
};

/// 20 s at 50 Hz, with twenty steps of the stochastic equations from row to row.
std::vector<Row> fly(std::uint64_t seed) {
  constexpr int steps = 20;
  Draws draws(seed);
  std::vector<Row> rows;
  Vector2d x(0.01, -0.05);
  for (int k = 0; k < 1000; ++k) {
    Row row;
    row.inputs.time = dt * k;
    row.inputs.u = {sepcal::test::excitation(dt * k), airspeed};
    const double u = row.inputs.u[0];
    row.z = Vector3d(x[0] + truth[2], x[1] + truth[3],
                     airspeed * (truth[5] * x[0] + truth[8] * u) + truth[4]) +
            noise.cwiseProduct(draws.normal_matrix(3, 1));
    rows.push_back(row);
    const double next = sepcal::test::excitation(dt * (k + 1));
    for (int i = 0; i < steps; ++i) {
      const double h = dt / steps;
      const double between = u + (next - u) * (i + 0.5) / steps;
      const Vector2d rate(truth[5] * x[0] + x[1] + truth[8] * between,
                          truth[6] * x[0] + truth[7] * x[1] + truth[9] * between);
      x += h * rate + std::sqrt(h) * density.cwiseProduct(draws.normal_matrix(2, 1));
    }
  }
  return rows;
}

/// Parameters 20 % off, either way.
template <class Form>
JointFilter<ShortPeriod, Form> begin(std::uint64_t seed) {
  Draws draws(seed);
  Ten s = Ten::Zero();
  Ten sd;
  sd << 0.05, 0.3, 0.05, 0.05, 1.0, 0.8, 8.0, 1.0, 0.2, 9.0;
  s.tail<5>() = truth.tail<5>() + sd.tail<5>().cwiseProduct(draws.normal_matrix(5, 1));
  return {ShortPeriod{}, Filter<10, Form>(s, Form::of_covariance_root(sd.asDiagonal()))};
}

template <class Form>
JointFilter<ShortPeriod, Form> track(const std::vector<Row>& rows, std::uint64_t seed,
                                     bool iterated) {
  auto filter = begin<Form>(seed);
  const Matrix2d Q = density.cwiseAbs2().asDiagonal();
  const Matrix3d R = noise.cwiseAbs2().asDiagonal();
  int refused = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& row = rows[k];
    const auto innovation = iterated ? filter.update_iterated(row.inputs.u, row.z, R)
                                     : filter.update(row.inputs.u, row.z, R);
    refused += innovation.status == FilterStatus::refused ? 1 : 0;
    if (k + 1 == rows.size()) break;
    refused += filter.predict(row.inputs, rows[k + 1].inputs, Q) == FilterStatus::ok ? 0 : 1;
  }
  CHECK(refused == 0);
  return filter;
}

}  // namespace

TEST_CASE("the information form is the filter of the textbook, with noise in part of the states") {
  Draws draws(41);
  const auto covariance = [&](int n) {
    const MatrixXd root = draws.normal_matrix(n, n + 2);
    return MatrixXd(root * root.transpose() / n);
  };
  const Matrix3d P_0 = covariance(3);
  Filter<3, InformationForm<3>> filter(Vector3d(1, 2, 3), P_0);
  Vector3d x(1, 2, 3);
  Matrix3d P = P_0;
  for (int k = 0; k < 12; ++k) {
    const Matrix3d Phi = Matrix3d::Identity() + 0.3 * draws.normal_matrix(3, 3);
    const Eigen::Matrix<double, 3, 2> Gamma = draws.normal_matrix(3, 2);
    Matrix2d Q = covariance(2);
    if (k % 2 == 0) Q.row(1).setZero(), Q.col(1).setZero();
    const Eigen::Matrix<double, 2, 3> C = draws.normal_matrix(2, 3);
    const Matrix2d R = covariance(2);
    Vector2d y = draws.normal_matrix(2, 1);
    if (k == 5) y[1] = std::nan("");

    const auto innovation = filter.update(y, Linearisation<2, 3>{C * x, C}, R);
    CHECK(innovation.status == FilterStatus::ok);
    const int there = k == 5 ? 1 : 2;
    const MatrixXd H = C.topRows(there);
    const MatrixXd Lambda = H * P * H.transpose() + R.topLeftCorner(there, there);
    const MatrixXd K = P * H.transpose() * Lambda.inverse();
    CHECK((innovation.covariance().topLeftCorner(there, there) - Lambda).norm() < 1e-11);
    x += K * (y.head(there) - H * x);
    P = (P.inverse() + H.transpose() * R.topLeftCorner(there, there).inverse() * H).inverse();
    CHECK((filter.x() - x).norm() < 1e-10 * x.norm());
    CHECK((filter.covariance() - P).norm() < 1e-10 * P.norm());

    x = Phi * x;
    P = Phi * P * Phi.transpose() + Gamma * Q * Gamma.transpose();
    filter.predict(sepcal::Transition<3, 2>{Phi * filter.x(), Phi, Gamma, Q});
    CHECK((filter.covariance() - P).norm() < 1e-10 * P.norm());
    x = filter.x();
  }
}

TEST_CASE("what the information form can't hold is refused and changes nothing") {
  Filter<2, InformationForm<2>> filter(Vector2d(1, 2), Matrix2d::Identity());
  const sepcal::Transition<2> forgets{Vector2d::Zero(), Matrix2d::Zero(), Matrix2d::Identity(),
                                      Matrix2d::Identity()};
  CHECK(filter.predict(forgets) == FilterStatus::refused);  // Phi has no inverse
  CHECK(filter.x() == Vector2d(1, 2));
  CHECK((filter.covariance() - Matrix2d::Identity()).norm() < 1e-14);
  Filter<2, InformationForm<2>> certain(Vector2d(1, 2), Matrix2d(Vector2d(1, 0).asDiagonal()));
  using One = Eigen::Matrix<double, 1, 1>;
  const Linearisation<1, 2> seen{Eigen::Vector<double, 1>(1.0), Eigen::RowVector2d(1, 1)};
  CHECK(certain.update(Eigen::Vector<double, 1>(2.0), seen, One(1.0)).status ==
        FilterStatus::refused);
}

TEST_CASE("the three forms are one filter, extended and iterated") {
  const auto rows = fly(3);
  for (const bool iterated : {false, true}) {
    const auto root = track<SquareRootForm<10>>(rows, 3, iterated);
    const auto joseph = track<JosephForm<10>>(rows, 3, iterated);
    const auto information = track<InformationForm<10>>(rows, 3, iterated);
    const Ten sd = root.filter().covariance().diagonal().cwiseSqrt();
    const auto off = [&](const auto& other) {
      return (other.filter().x() - root.filter().x()).cwiseQuotient(sd).norm();
    };
    CHECK(off(joseph) < 1e-6);
    CHECK(off(information) < 1e-6);
    const Square P = root.filter().covariance();
    CHECK((information.filter().covariance() - P).norm() < 1e-6 * P.norm());
  }
}

TEST_CASE("of flights with process noise the parameters come within their standard deviations") {
  // 12 flights, starts drawn from P(0): 60 intervals of a parameter, 120 states and biases.
  constexpr int flights = 12;
  for (const bool iterated : {false, true}) {
    int missed = 0;
    Ten square = Ten::Zero();
    for (std::uint64_t seed = 10; seed < 10 + flights; ++seed) {
      const auto filter = track<SquareRootForm<10>>(fly(seed), seed, iterated);
      const Ten error = filter.filter().x() - truth;
      const Ten sd = filter.filter().covariance().diagonal().cwiseSqrt();
      for (int k = 5; k < 10; ++k) missed += std::abs(error[k]) > 1.96 * sd[k] ? 1 : 0;
      square += error.cwiseQuotient(truth.cwiseAbs().cwiseMax(1e-3)).cwiseAbs2() / flights;
    }
    MESSAGE((iterated ? "iterated" : "extended")
            << ": rms % of Za Ma Mq Zd Md " << 100 * square.tail<5>().cwiseSqrt().transpose()
            << ", missed " << missed << " of " << 5 * flights);
    CHECK_FALSE(sepcal::test::outside_binomial(missed, 5 * flights, 0.05));
    // The prototype's augmented filters on such flights: 0.5 2.9 5.2 4.3 2.4 %.
    const Eigen::Vector<double, 5> limits(1.0, 6.0, 10.0, 9.0, 5.0);
    CHECK((100 * square.tail<5>().cwiseSqrt().array() < limits.array()).all());
  }
}

TEST_CASE("a new segment begins a new state and keeps what is known of the parameters") {
  auto filter = track<SquareRootForm<10>>(fly(5), 5, false);
  const Ten s = filter.filter().x();
  const Square P = filter.filter().covariance();
  const Matrix2d U = Vector2d(0.1, 0.2).asDiagonal();
  filter.restart(Vector2d(0.3, 0.4), U);
  const Square after = filter.filter().covariance();
  CHECK(filter.x() == Vector2d(0.3, 0.4));
  CHECK(filter.filter().x().tail<8>() == s.tail<8>());
  CHECK((after.bottomRightCorner<8, 8>() - P.bottomRightCorner<8, 8>()).norm() < 1e-12 * P.norm());
  CHECK((after.topLeftCorner<2, 2>() - U * U).norm() < 1e-15);
  CHECK(after.topRightCorner<2, 8>().norm() == 0.0);
}

}  // namespace joint_filter_test
