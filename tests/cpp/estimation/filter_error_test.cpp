// SPDX-License-Identifier: BSD-3-Clause
// Filter error: the likelihood against the joint density of all readings written out, its score
// against differences of it; fits of flights whose noise is drawn by small steps, and what a fit
// says where there is nothing to say. (Fisher's information: studies/scores_study.cpp.)
#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include "draws.hpp"
#include "estimation/scoring.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/models/short_period.hpp"
#include "sepcal/states/smooth_record.hpp"
#include "short_periods.hpp"
#include "trajectories.hpp"

namespace filter_error_test {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Affine;
using sepcal::Fit;
using sepcal::FitMethod;
using sepcal::FitOptions;
using sepcal::FitStatus;
using sepcal::InnovationModel;
using sepcal::Quantity;
using sepcal::Rate;
using sepcal::Record;
using sepcal::ShortPeriod;
using sepcal::TrajectoryModel;
using sepcal::TriangularFactor;
using sepcal::Vec;
using sepcal::test::fly_short_period;
using sepcal::test::ShortPeriodFlight;

/// A pendulum with friction whose noise grows with its angle: nothing about it is linear but a
/// bias.
struct Pendulum {
  static constexpr std::array inputs{Quantity{"torque", "1/s^2"}};
  static constexpr std::array states{Quantity{"angle", "rad"}, Quantity{"rate", "rad/s"}};
  static constexpr std::array outputs{Quantity{"sine", "1"}, Quantity{"rate_m", "rad/s"}};
  static constexpr std::array linear{Quantity{"bias", "rad/s"}, Quantity{"scale", "1"}};
  static constexpr std::array nonlinear{Quantity{"stiffness", "1/s^2", 0, 100},
                                        Quantity{"friction", "1/s", 0, 10},
                                        Quantity{"share", "1", -5, 5}};
  static constexpr std::array noise{Quantity{"gust", "rad/s^2/sqrt(Hz)"},
                                    Quantity{"angle", "rad/sqrt(s)"}};

  static constexpr bool acts_on(int parameter, int output) { return parameter == 1 - output; }

  template <class U, class X>
  Rate<X, 2> rate(const Vec<X, 2>& x, const Vec<U, 1>& u, const Vec<X, 3>& p) const {
    using std::sin;
    return Vec<X, 2>(x[1], u[0] - p[0] * sin(x[0]) - p[1] * x[1] * x[1] * x[1]);
  }
  template <class U, class X>
  Eigen::Matrix<X, 2, 2> noise_input(const Vec<X, 2>& x, const Vec<U, 1>& /*u*/,
                                     const Vec<X, 3>& p) const {
    Eigen::Matrix<X, 2, 2> G = Eigen::Matrix<X, 2, 2>::Zero();
    G(1, 0) = 1.0 + p[2] * x[0] * x[0];
    G(0, 1) = X(1.0);
    return G;
  }
  template <class U, class X>
  Affine<X, 2, 2> at(const Vec<X, 2>& x, const Vec<U, 1>& /*u*/, const Vec<X, 3>& /*p*/) const {
    using std::sin;
    Affine<X, 2, 2> z;
    z.A.setZero();
    z.A(0, 1) = sin(x[0]);
    z.A(1, 0) = X(1.0);
    z.b << sin(x[0]), x[1];
    return z;
  }
};

Record swing(int rows, std::uint64_t seed) {
  sepcal::test::Draws draws(seed);
  std::vector<double> time;
  std::vector<double> torque;
  std::vector<double> sine;
  std::vector<double> rate;
  double angle = 0.4;
  double speed = 0.0;
  for (int k = 0; k < rows; ++k) {
    const double t = 0.05 * k + (k % 3 == 0 ? 0.01 : 0.0);
    const double push = 2.0 * std::sin(1.3 * t);
    time.push_back(t);
    torque.push_back(push);
    sine.push_back(std::sin(angle) + 0.02 * draws.normal());
    rate.push_back(speed + 0.1 + 0.05 * draws.normal());
    for (int i = 0; i < 10; ++i) {
      speed += 0.005 * (push - 9.0 * std::sin(angle) - 0.3 * speed * speed * speed) +
               std::sqrt(0.005) * 0.5 * draws.normal();
      angle += 0.005 * speed;
    }
  }
  Record record;
  record.add("time", time).add("torque", torque).add("sine", sine).add("rate_m", rate);
  return record;
}

VectorXd gradient_of(const InnovationModel& model, const VectorXd& theta) {
  TriangularFactor factor(static_cast<int>(model.size()) + 1);
  model.scores(theta, [&](std::size_t, MatrixXd& rows) { factor.absorb(rows); });
  const Index n = model.size();
  return -(factor.matrix().topLeftCorner(n, n).transpose() * factor.matrix().topRightCorner(n, 1));
}

/// Differences of fourth order.
template <class Function>
VectorXd differences(const Function& f, const VectorXd& at, double step) {
  VectorXd result(at.size());
  for (Index i = 0; i < at.size(); ++i) {
    const double h = step * std::max(1.0, std::abs(at[i]));
    const auto moved = [&](double steps) {
      VectorXd to = at;
      to[i] += steps * h;
      return f(to);
    };
    result[i] = (8.0 * (moved(1) - moved(-1)) - (moved(2) - moved(-2))) / (12.0 * h);
  }
  return result;
}

/// -ln of the joint normal density of all readings of a short period (but for its constant): mean
/// and covariance row by row, written out, no filter. theta: b_alpha, b_q, b_az, Zd, Md, alpha_0,
/// q_0, Za, Ma, Mq, ln q (2), ln r (3).
double joint_density(const Record& record, const VectorXd& theta) {
  const auto u = record.column("elevator");
  const auto t = record.column("time");
  const auto N = static_cast<Index>(record.length());
  Eigen::Matrix2d F;
  F << theta[7], 1, theta[8], theta[9];
  const Eigen::Vector2d B(theta[3], theta[4]);
  Eigen::Matrix<double, 3, 2> C;
  C << 1, 0, 0, 1, 25 * theta[7], 0;
  VectorXd mean(3 * N);
  VectorXd y(3 * N);
  Eigen::Vector2d x = theta.segment<2>(5);
  MatrixXd state = MatrixXd::Zero(2 * N, 2 * N);  // covariance of all states
  for (Index k = 0; k < N; ++k) {
    const auto row = static_cast<std::size_t>(k);
    mean.segment<3>(3 * k) = C * x + theta.head<3>();
    mean[3 * k + 2] += 25 * theta[3] * u[row];
    y.segment<3>(3 * k) << record.column("alpha_m")[row], record.column("q_m")[row],
        record.column("az_m")[row];
    if (k + 1 == N) break;
    const double dt = t[row + 1] - t[row];
    // Runge and Kutta's fourth order of x' = F x + c, c at the beginning, the middle and the end.
    const auto follow = [&](const MatrixXd& from, const MatrixXd& c0, const MatrixXd& c1,
                            const MatrixXd& c2) -> MatrixXd {
      const MatrixXd k1 = F * from + c0;
      const MatrixXd k2 = F * (from + dt / 2 * k1) + c1;
      const MatrixXd k3 = F * (from + dt / 2 * k2) + c1;
      const MatrixXd k4 = F * (from + dt * k3) + c2;
      return from + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    };
    const Eigen::Matrix2d I = Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d none = Eigen::Matrix2d::Zero();
    const Eigen::Matrix2d Phi = follow(I, none, none, none);
    const Eigen::Matrix2d mean_noise = follow(none, I, I, I);
    const Eigen::Matrix2d slope = follow(none, -std::sqrt(3.0) * I, none, std::sqrt(3.0) * I);
    x = follow(x, B * u[row], B * (u[row] + u[row + 1]) / 2, B * u[row + 1]);
    const Eigen::Vector2d density = (2.0 * theta.segment<2>(10)).array().exp();
    const MatrixXd past = state.block(2 * k, 0, 2, 2 * (k + 1));
    state.block(2 * k + 2, 0, 2, 2 * (k + 1)) = Phi * past;
    state.block(0, 2 * k + 2, 2 * (k + 1), 2) = (Phi * past).transpose();
    state.block<2, 2>(2 * k + 2, 2 * k + 2) =
        Phi * state.block<2, 2>(2 * k, 2 * k) * Phi.transpose() +
        mean_noise * (density / dt).asDiagonal() * mean_noise.transpose() +
        slope * (density / dt).asDiagonal() * slope.transpose();
  }
  MatrixXd Sigma(3 * N, 3 * N);
  for (Index i = 0; i < N; ++i) {
    for (Index k = 0; k < N; ++k) {
      Sigma.block<3, 3>(3 * i, 3 * k) = C * state.block<2, 2>(2 * i, 2 * k) * C.transpose();
    }
    Sigma.block<3, 3>(3 * i, 3 * i).diagonal().array() += (2.0 * theta.tail<3>()).array().exp();
  }
  const Eigen::LLT<MatrixXd> root(Sigma);
  const VectorXd w = root.matrixL().solve(y - mean);
  return 0.5 * w.squaredNorm() + MatrixXd(root.matrixL()).diagonal().array().log().sum();
}

VectorXd short_period_theta() {
  VectorXd theta(15);
  theta << 0.02, -0.01, 0.5, -0.35, -45, 0.01, -0.05, -4, -40, -5, std::log(0.003), std::log(0.09),
      std::log(0.005), std::log(0.01), std::log(0.15);
  return theta;
}

ShortPeriodFlight stirred(std::uint64_t seed, std::size_t rows = 1000) {
  ShortPeriodFlight flight;
  flight.process_noise = {0.003, 0.09};
  flight.seed = seed;
  flight.rows = rows;
  return flight;
}

FitOptions by_filter_error() {
  FitOptions options;
  options.method = FitMethod::filter_error;
  return options;
}

const sepcal::NoiseSize& size_of(const Fit& fit, const std::string& name) {
  return *std::ranges::find(fit.noise_sizes, name, &sepcal::NoiseSize::name);
}

}  // namespace

TEST_CASE("the likelihood is the joint density of all readings, and its score the gradient") {
  ShortPeriodFlight flight = stirred(1, 60);
  flight.interval = 0.002;  // steps so short that the series in Phi - I is exact
  const Record record = fly_short_period(flight);
  const TrajectoryModel<ShortPeriod> model(ShortPeriod(), record);
  const auto likelihood = model.innovations(record);
  REQUIRE(likelihood);
  VectorXd theta = short_period_theta();
  theta.array() *= 1.03;
  const InnovationModel::Value value = likelihood->value(theta);
  CHECK(value.cost == doctest::Approx(joint_density(record, theta)).epsilon(1e-10));
  CHECK(value.readings == 180);
  const VectorXd expected =
      differences([&](const VectorXd& at) { return joint_density(record, at); }, theta, 1e-3);
  const VectorXd gradient = gradient_of(*likelihood, theta);
  for (Index i = 0; i < theta.size(); ++i) {
    CAPTURE(i);
    CHECK(gradient[i] ==
          doctest::Approx(expected[i]).epsilon(1e-7).scale(expected.cwiseAbs().mean()));
  }
}

TEST_CASE("the score of a nonlinear model is the gradient of its likelihood") {
  const Record record = swing(80, 3);
  std::vector<double> sine(record.column("sine").begin(), record.column("sine").end());
  for (const std::size_t row : {5UL, 6UL, 40UL}) sine[row] = sepcal::not_a_number;  // missing
  Record with_gaps;
  for (const std::string name : {"time", "torque", "rate_m"}) {
    with_gaps.add(name,
                  std::vector<double>(record.column(name).begin(), record.column(name).end()));
  }
  with_gaps.add("sine", sine);
  for (const auto inputs : {sepcal::InputsBetweenRows::linear, sepcal::InputsBetweenRows::hold}) {
    const TrajectoryModel<Pendulum> model(Pendulum(), with_gaps, {.inputs = inputs});
    const auto likelihood = model.innovations(with_gaps);
    VectorXd theta(likelihood->size());
    // bias, scale, stiffness, friction, share, angle_0, rate_0, ln q, ln r
    theta << 0.12, 0.05, 8.7, 0.28, 0.6, 0.42, 0.03, std::log(0.5), std::log(0.05), std::log(0.025),
        std::log(0.06);
    const VectorXd gradient = gradient_of(*likelihood, theta);
    const VectorXd expected =
        differences([&](const VectorXd& at) { return likelihood->value(at).cost; }, theta, 1e-3);
    for (Index i = 0; i < theta.size(); ++i) {
      CAPTURE(i);
      CHECK(gradient[i] ==
            doctest::Approx(expected[i]).epsilon(1e-8).scale(expected.cwiseAbs().mean()));
    }
    CHECK(likelihood->value(theta).readings == 157);
  }
}

TEST_CASE("the likelihood at a fit's parameters is that of the smoother's filter") {
  const Record record = fly_short_period(stirred(2, 300));
  const TrajectoryModel<ShortPeriod> model(ShortPeriod(), record);
  const VectorXd theta = short_period_theta();
  std::map<std::string, double> values;
  const std::vector<sepcal::Variable> names = model.tables().parameters();
  for (std::size_t k = 0; k < names.size(); ++k) {
    values[names[k].name] = theta[static_cast<Index>(k)];
  }
  const sepcal::SmoothedRecord smoothed =
      sepcal::smooth(model, record, values,
                     {.process = {{"alpha", 0.003}, {"q", 0.09}},
                      .outputs = {{"alpha_m", 0.005}, {"q_m", 0.01}, {"az_m", 0.15}},
                      .start = {{"alpha", 1e-9}, {"q", 1e-9}}});
  CHECK(model.innovations(record)->value(theta).cost ==
        doctest::Approx(smoothed.cost).epsilon(1e-10));
}

TEST_CASE("filter error finds parameters and noises of flights with turbulence") {
  const Record record = fly_short_period(stirred(5));
  const Fit fit =
      sepcal::fit(TrajectoryModel<ShortPeriod>(ShortPeriod(), record), record, by_filter_error());
  INFO(fit.message);
  CHECK(fit.status == FitStatus::converged);
  CHECK(fit.method == FitMethod::filter_error);
  for (const auto& [name, truth] : std::map<std::string, double>{
           {"Za", -4}, {"Ma", -40}, {"Mq", -5}, {"Zd", -0.35}, {"Md", -45}, {"b_alpha", 0.02}}) {
    CAPTURE(name);
    CHECK(std::abs(fit[name].value - truth) < 4.0 * fit[name].standard_error);
    CHECK(fit[name].standard_error > 0.0);
  }
  for (const auto& [name, truth] : std::map<std::string, double>{{"q_alpha", 0.003},
                                                                 {"q_q", 0.09},
                                                                 {"r_alpha_m", 0.005},
                                                                 {"r_q_m", 0.01},
                                                                 {"r_az_m", 0.15}}) {
    CAPTURE(name);
    const sepcal::NoiseSize& size = size_of(fit, name);
    CHECK(std::abs(std::log(size.value / truth)) < 4.0 * size.standard_error / size.value);
    CHECK_FALSE(size.at_floor);
  }
  CHECK(2.0 * (fit.log_likelihood - fit.log_likelihood_without) > 50.0);
}

TEST_CASE("separated, the parameters are those of the joint fit") {
  const Record record = fly_short_period(stirred(6));
  const TrajectoryModel<ShortPeriod> separable(ShortPeriod(), record);
  const TrajectoryModel<ShortPeriod> joint(ShortPeriod(), record, {.separable = false});
  FitOptions options = by_filter_error();
  options.hessian = sepcal::Hessian::observed;
  const Fit one = sepcal::fit(separable, record, options);
  options.start = {{"Za", -4.5}, {"Ma", -35}, {"Mq", -4}, {"Zd", -0.3}, {"Md", -40}};
  const Fit other = sepcal::fit(joint, record, options);
  for (const sepcal::Parameter& parameter : one.parameters) {
    CAPTURE(parameter.name);
    CHECK(std::abs(parameter.value - other[parameter.name].value) <
          1e-8 * parameter.standard_error);
    CHECK(parameter.standard_error ==
          doctest::Approx(other[parameter.name].standard_error).epsilon(1e-4));
  }
}

TEST_CASE("separated and joint, from different starts, scoring ends in one point") {
  const Record record = fly_short_period(stirred(6));
  const TrajectoryModel<ShortPeriod> separable(ShortPeriod(), record);
  const TrajectoryModel<ShortPeriod> joint(ShortPeriod(), record, {.separable = false});
  const VectorXd here = short_period_theta();
  VectorXd there(here.size());  // in the joint model's order, up to 2 % off
  std::vector<Index> place(static_cast<std::size_t>(here.size()));
  const std::vector<sepcal::Variable> ours = separable.tables().parameters();
  const std::vector<sepcal::Variable> theirs = joint.tables().parameters();
  for (std::size_t i = 0; i < place.size(); ++i) {
    place[i] = static_cast<Index>(i);
    if (i < theirs.size()) {
      place[i] = std::ranges::find(ours, theirs[i].name, &sepcal::Variable::name) - ours.begin();
    }
    there[static_cast<Index>(i)] = here[place[i]] * (1.0 + 0.02 * std::sin(3.0 * double(i)));
  }
  const auto first = separable.innovations(record);
  const auto second = joint.innovations(record);
  // Each step of Fisher's scoring leaves a tenth or so of the way; Newton's square it.
  for (const auto& [promise, newton, near] :
       {std::tuple{1e-10, false, 1e-4}, {1e-18, false, 1e-8}, {1e-10, true, 1e-8}}) {
    CAPTURE(promise);
    CAPTURE(newton);
    const auto end = [&](const InnovationModel& model, const VectorXd& theta) {
      sepcal::estimation::Scoring scoring{
          .model = model,
          .free = std::vector<Index>(place.size()),
          .box = {VectorXd::Constant(theta.size(), -1e6), VectorXd::Constant(theta.size(), 1e6)},
          .prior = {VectorXd::Zero(theta.size()), VectorXd::Zero(theta.size())},
          .promise = promise};
      std::iota(scoring.free.begin(), scoring.free.end(), 0);
      sepcal::estimation::Scored at = minimise_by_scoring(scoring, theta);
      CHECK(at.converged);
      return newton ? finish_by_newton(scoring, at) : at;
    };
    const sepcal::estimation::Scored one = end(*first, here);
    const sepcal::estimation::Scored other = end(*second, there);
    const MatrixXd R = one.factor.matrix().topLeftCorner(here.size(), here.size());
    const VectorXd sd = R.inverse().rowwise().norm();
    const VectorXd off = other.theta - one.theta(place);
    CHECK((off.array() / sd(place).array()).abs().maxCoeff() < near);
  }
}

TEST_CASE("without turbulence process noise ends at its floor, which is said") {
  ShortPeriodFlight calm;
  calm.seed = 8;
  const Record record = fly_short_period(calm);
  const Fit fit =
      sepcal::fit(TrajectoryModel<ShortPeriod>(ShortPeriod(), record), record, by_filter_error());
  INFO(fit.message);
  CHECK(fit.status == FitStatus::converged);
  for (const std::string name : {"q_alpha", "q_q"}) {
    CAPTURE(name);
    const sepcal::NoiseSize& size = size_of(fit, name);
    const std::size_t from = fit.message.find("no process noise");  // one sentence names them all
    const bool said = from != std::string::npos &&
                      fit.message.find("'" + name.substr(2) + "'", from) != std::string::npos;
    CHECK(said == size.at_floor);
    CHECK(size.value < (name == "q_q" ? 0.02 : 0.001));
  }
  CHECK(2.0 * (fit.log_likelihood - fit.log_likelihood_without) < 8.0);
}

TEST_CASE("that it is output error is said where no process noise is left alone") {
  FitOptions options = by_filter_error();
  const std::string none = "the record shows no process noise 'alpha', which ended at the floor";
  for (const double q : {0.09, 0.0}) {
    CAPTURE(q);
    options.process_noise = {{"q", q}};
    ShortPeriodFlight flight = stirred(10);
    flight.process_noise = {0.0, q};
    const Record flown = fly_short_period(flight);
    const Fit fit = sepcal::fit(TrajectoryModel<ShortPeriod>(ShortPeriod(), flown), flown, options);
    INFO(fit.message);
    REQUIRE(size_of(fit, "q_alpha").at_floor);
    CHECK(fit.message.find(none) != std::string::npos);
    const bool same = fit.message.find("where output error is the same") != std::string::npos;
    CHECK(same == (q == 0.0));
  }
}

TEST_CASE("filter error refuses what it can't do in one line") {
  const Record record = fly_short_period(stirred(9, 50));
  const TrajectoryModel<ShortPeriod> model(ShortPeriod(), record);
  FitOptions options = by_filter_error();
  options.loss = sepcal::Loss::huber;
  CHECK_THROWS_WITH_AS(sepcal::fit(model, record, options),
                       doctest::Contains("filter error takes squares alone"), sepcal::Error);
}

}  // namespace filter_error_test
