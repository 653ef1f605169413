// SPDX-License-Identifier: BSD-3-Clause
// Flight software's use of sepcal::core: a filter, a stream of least squares and an iterated fit,
// each of a problem whose answer can be written down. Returns how many came out wrong.
#include <cmath>
#include <cstdio>
#include <sepcal/core.hpp>
#include <sepcal/detail/states/information_root.hpp>
#include <sepcal/states/filter.hpp>
#include <sepcal/states/least_squares.hpp>

namespace {

using Scalar = Eigen::Vector<double, 1>;
using Square = Eigen::Matrix<double, 1, 1>;

/// 1 where a number is not what it should be, to 1e-12 of it.
int wrong(const char* what, double value, double expected) {
  const bool right = std::abs(value - expected) <= 1e-12 * std::abs(expected);
  std::printf("%-28s %.15g%s\n", what, value, right ? "" : ", which is wrong");
  return right ? 0 : 1;
}

/// A constant with the prior N(10, 4), measured as 11, 13 and 12 with variance 2: the posterior's
/// 1/P = 1/4 + 3/2, x = P (10/4 + 36/2).
int filter_a_constant() {
  sepcal::Filter<1> filter(Scalar(10.0), Square(4.0));
  for (const double y : {11.0, 13.0, 12.0}) {
    const sepcal::Linearisation<1, 1> expected{filter.x(), Square(1.0)};
    if (filter.update(Scalar(y), expected, Square(2.0)).status != sepcal::FilterStatus::ok) {
      return 1;
    }
  }
  return wrong("filtered x", filter.x()[0], 20.5 / 1.75) +
         wrong("its variance", filter.covariance()(0, 0), 1.0 / 1.75);
}

/// A line through z(t) = 1, 3, 2, 6 at t = 0 ... 3 of variance 1: with t's mean 1.5, z's 3 and
/// S_tt = 5, S_tz = 7 its slope is 7/5 and its offset 3 - 1.5 * 7/5; the slope's variance 1/5.
int lay_a_line() {
  const double z[] = {1.0, 3.0, 2.0, 6.0};
  sepcal::InformationRoot<2> line;
  for (int t = 0; t < 4; ++t) {
    if (!line.absorb<1>(Eigen::RowVector2d(1.0, t), Scalar(z[t]), Square(1.0))) return 1;
  }
  return wrong("offset of the line", line.solution()[0], 0.9) +
         wrong("slope of the line", line.solution()[1], 1.4) +
         wrong("the slope's variance", line.covariance()(1, 1), 0.2);
}

/// z = exp(-a t) with a = 0.75, without noise, from a = 0.2.
int fit_a_decay() {
  const auto sample = [](int k, const Scalar& a) {
    const double t = 0.5 * k;
    const double f = std::exp(-a[0] * t);
    return sepcal::LeastSquaresRows<1, 1>{Scalar(std::exp(-0.75 * t) - f), Square(-t * f),
                                          Square(1.0)};
  };
  const auto fit = sepcal::iterate_least_squares<1>(sample, 10, Scalar(0.2));
  return (fit.status == sepcal::LeastSquaresStatus::converged ? 0 : 1) +
         wrong("rate of the decay", fit.p[0], 0.75);
}

}  // namespace

int main() { return filter_a_constant() + lay_a_line() + fit_a_decay(); }
