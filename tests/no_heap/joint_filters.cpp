// SPDX-License-Identifier: BSD-3-Clause
// Filters of states and parameters, over a model with a state and over one of samples, as flight
// software compiles them.
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/detail/states/joseph_form.hpp"
#include "sepcal/frequency/recursive_band.hpp"
#include "sepcal/states/information_form.hpp"
#include "sepcal/states/joint_filter.hpp"
#include "sepcal/states/recursive_likelihood.hpp"

namespace {

/// A turning body with biased gyros and everything else that a model may have.
struct Body {
  static constexpr std::array inputs{sepcal::Quantity{"torque", "1"}};
  static constexpr std::array states{sepcal::Quantity{"angle", "rad"},
                                     sepcal::Quantity{"rate", "rad/s"}};
  static constexpr std::array outputs{sepcal::Quantity{"rate_m", "rad/s"}};
  static constexpr std::array linear{sepcal::Quantity{"bias", "rad/s"}};
  static constexpr std::array nonlinear{sepcal::Quantity{"damping", "1/s"}};
  static constexpr std::array noise{sepcal::Quantity{"rate", "rad/s/sqrt(s)"}};
  template <class U, class X>
  sepcal::Rate<X, 2> rate(const sepcal::Vec<X, 2>& x, const sepcal::Vec<U, 1>& u,
                          const sepcal::Vec<X, 1>& p) const {
    using std::sin;
    sepcal::Rate<X, 2> dx;
    dx[0] = x[1];
    dx[1] = u[0] - p[0] * x[1] - sin(x[0]);
    return dx;
  }
  template <class U, class X>
  sepcal::Affine<X, 1, 1> at(const sepcal::Vec<X, 2>& x, const sepcal::Vec<U, 1>& /*u*/,
                             const sepcal::Vec<X, 1>& /*p*/) const {
    sepcal::Affine<X, 1, 1> z;
    z.A << X(1.0);
    z.b << x[1];
    return z;
  }
};

template <class Form>
double run_jointly(const double* y, int count) {
  using Filter = sepcal::JointFilter<Body, Form>;
  using One = Eigen::Matrix<double, 1, 1>;
  using Reading = Eigen::Vector<double, 1>;
  Filter filter({}, {Eigen::Vector4d::Zero(), Eigen::Matrix4d::Identity()});
  double cost = 0.0;
  sepcal::StateRow<Body> row;
  for (int k = 0; k < count; ++k) {
    const sepcal::StateRow<Body> last = row;
    row.time = 0.1 * k;
    row.u[0] = y[k];
    if (k > 0) filter.predict(last, row, One(0.01));
    cost += filter.update(row.u, Reading(y[k]), One(0.1)).cost();
    cost += filter.update_iterated(row.u, Reading(y[k]), One(0.1)).cost();
  }
  sepcal::ChangeTest<4, 2, double, 5> changes;
  for (int k = 1; k < count; ++k) {
    const sepcal::StateRow<Body> last = row;
    row.time += 0.1;
    filter.predict(last, row, One(0.01), {}, changes);
    const Reading z(y[k]);
    if (filter.update(row.u, z, One(0.1), changes) == sepcal::ChangeStatus::changed) {
      filter.follow_change(changes);
    }
  }
  changes.restart();
  filter.restart(filter.x(), Eigen::Matrix2d::Identity());
  sepcal::JointFilter<sepcal::ScalarExample2, Form> samples(
      {}, {Eigen::Vector4d::Zero(), Eigen::Matrix4d::Identity()});
  cost += samples.update(Reading(y[0]), Reading(y[1]), One(0.1)).cost();
  return cost + filter.filter().covariance().trace() + samples.filter().covariance().trace();
}

double run_likelihood(const double* y, int count) {
  using Likelihood = sepcal::RecursiveLikelihood<Body>;
  Likelihood::Theta theta = Likelihood::Theta::Zero();
  const Likelihood::Theta bound = Likelihood::Theta::Constant(1e3);
  Likelihood likelihood({}, theta, Likelihood::Root::Identity(), -bound, bound,
                        Likelihood::Free::Constant(true));
  sepcal::StateRow<Body> row;
  for (int k = 0; k < count; ++k) {
    const sepcal::StateRow<Body> last = row;
    row.time = 0.1 * k;
    row.u[0] = y[k];
    if (k > 0) likelihood.predict(last, row);
    likelihood.update(row.u, Eigen::Vector<double, 1>(y[k]), 0.999);
    likelihood.step();
  }
  return likelihood.theta().sum() + likelihood.recursion().cost();
}

double run_over_band(const double* y, int count) {
  sepcal::RecursiveBand<2, 5> band(Eigen::Vector<double, 5>::LinSpaced(5, 0.2, 1.0),
                                   {.forgetting = 0.99, .differentiate = true});
  for (int k = 0; k < count; ++k) band.absorb(0.1 * k, Eigen::Vector2d(y[k], 1.0), y[k]);
  return band.estimate().xi.sum();
}

}  // namespace

double run_all(const double* y, int count);

double run_all(const double* y, int count) {
  return run_jointly<sepcal::SquareRootForm<4>>(y, count) +
         run_jointly<sepcal::InformationForm<4>>(y, count) +
         run_jointly<sepcal::JosephForm<4>>(y, count) + run_likelihood(y, count) +
         run_over_band(y, count);
}
