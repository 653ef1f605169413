// SPDX-License-Identifier: BSD-3-Clause
// Every filter, smoother and recursion, in sizes at which Eigen's own products would allocate. It
// is compiled as flight software is, and its object must not refer to an allocator or to
// exceptions.
#include "sepcal/detail/states/joseph_form.hpp"
#include "sepcal/states/extended_filter.hpp"
#include "sepcal/states/filter.hpp"
#include "sepcal/states/information_form.hpp"
#include "sepcal/states/iterated_update.hpp"
#include "sepcal/states/least_squares.hpp"
#include "sepcal/states/recursive_least_squares.hpp"
#include "sepcal/states/smoother.hpp"

namespace {

constexpr int n = 15;  // states, as of flight path reconstruction with biases
constexpr int m = 7;   // outputs
constexpr int n_w = 6;
using State = Eigen::Vector<double, n>;
using Output = Eigen::Vector<double, m>;
using Stage = sepcal::Stage<n>;
using Smoothed = sepcal::Smoothed<n>;

struct System {
  State rate(const State& x, double t) const { return -t * x.array().sin().matrix(); }
  Eigen::Matrix<double, n, n> rate_jacobian(const State& x, double t) const {
    return (-t * x.array().cos()).matrix().asDiagonal();
  }
  Eigen::Matrix<double, n, n_w> noise_input(const State& /*x*/, double /*t*/) const {
    return Eigen::Matrix<double, n, n_w>::Identity();
  }
};

struct Outputs {
  sepcal::Linearisation<m, n> operator()(const State& x) const {
    sepcal::Linearisation<m, n> h{x.head<m>().array().square().matrix(),
                                  Eigen::Matrix<double, m, n>::Zero()};
    h.jacobian.leftCols<m>() = (2.0 * x.head<m>()).asDiagonal();
    return h;
  }
};

template <class Form>
double run(const Output* y, int count, std::span<Stage> pass, std::span<Smoothed> smoothed) {
  using Q = Eigen::Matrix<double, n_w, n_w>;
  using R = Eigen::Matrix<double, m, m>;
  sepcal::Filter<n, Form> filter(State::Ones(), Eigen::Matrix<double, n, n>::Identity());
  double cost = 0.0;
  for (int k = 0; k < count; ++k) {
    Stage& stage = pass[static_cast<std::size_t>(k)];
    filter.update(y[k], Outputs{}(filter.x()), R::Identity().eval());
    cost += sepcal::iterated_update(filter, y[k], Outputs{}, R::Identity().eval()).cost();
    stage.filtered = filter.estimate();
    stage.next = sepcal::propagate(System{}, filter.x(), Q::Identity().eval(), k, k + 1.0, 0.1);
    filter.predict(stage.next);
    cost += sepcal::smooth_by_residual(stage, y[k], Outputs{}(filter.x()), R::Identity().eval())
                .w.norm();
  }
  sepcal::smooth(pass, smoothed);
  return cost + filter.covariance().trace();
}

struct Line {
  const Output* y;
  sepcal::LeastSquaresRows<m, n> operator()(int k, const State& p) const {
    const sepcal::Linearisation<m, n> f = Outputs{}(p);
    return {y[k] - f.value, f.jacobian, Eigen::Matrix<double, m, m>::Identity()};
  }
};

}  // namespace

double run_all(const Output* y, int count, std::span<Stage> pass, std::span<Smoothed> smoothed);

double run_all(const Output* y, int count, std::span<Stage> pass, std::span<Smoothed> smoothed) {
  double sum = run<sepcal::SquareRootForm<n>>(y, count, pass, smoothed) +
               run<sepcal::JosephForm<n>>(y, count, pass, smoothed) +
               run<sepcal::InformationForm<n>>(y, count, pass, smoothed);
  using Matrix = Eigen::Matrix<double, n, n>;
  const sepcal::LeastSquaresRows<m, n> rows = Line{y}(0, State::Ones());
  sepcal::InformationRecursion<n> information(State::Zero(), Matrix::Identity());
  sepcal::CovarianceRecursion<n> covariance(State::Zero(), Matrix::Identity());
  information.absorb(rows.H, rows.z, rows.W);
  covariance.absorb(rows.H, rows.z, rows.W);
  sum += information.covariance().trace() + covariance.covariance().trace();
  const auto inputs =
      sepcal::discretise_inputs<n, n_w>(Matrix::Ones(), Eigen::Matrix<double, n, n_w>::Ones(), 0.1);
  const auto fit = sepcal::iterate_least_squares(Line{y}, count, State::Ones().eval());
  return sum + inputs.end.sum() + fit.p.sum() + fit.rows.covariance().trace();
}
