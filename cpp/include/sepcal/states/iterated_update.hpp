// SPDX-License-Identifier: BSD-3-Clause
// The iterated extended Kalman filter's update, S 3.15 to 3.18: Gauss-Newton on J of S 2.5, so that
// its fixed point is the state of highest probability given y.
#pragma once

#include <utility>

#include "sepcal/detail/states/triangle.hpp"
#include "sepcal/states/filter.hpp"

namespace sepcal {

struct IterationOptions {
  int iterations = 20;      // at most
  double tolerance = 1e-8;  // |eta_l - eta_(l-1)| <= tolerance, in standard deviations of eta_l
};

/// Updates `filter` by y (n_z, NaN where missing) with `outputs(eta)`, a Linearisation<NZ, NX> at
/// any state eta, and R. The innovation is the last iteration's; `not_converged` where the cap
/// ended it.
///
/// S 3.16 divides by |eta|, which fails at zero and adds metres to radians. Here a step's length is
/// its length in the metric of P(k+1|k+1) = U'U, |U^-T (eta_l - eta_(l-1))|: in that of P(k+1|k)
/// every step is short where little was known before. What rounds in eta is not asked for.
/// P(k+1|k) does not depend on eta, other than S 3.18 prints.
template <int NX, class Form, int NZ, class Outputs>
Innovation<NZ, typename Form::Matrix::Scalar> iterated_update(
    Filter<NX, Form>& filter, const Eigen::Vector<typename Form::Matrix::Scalar, NZ>& y,
    const Outputs& outputs, const Eigen::Matrix<typename Form::Matrix::Scalar, NZ, NZ>& R,
    const IterationOptions& options = {}) {
  using Scalar = Form::Matrix::Scalar;
  using Vector = Eigen::Vector<Scalar, NX>;
  constexpr Scalar digits_lost = 8;
  Filter<NX, Form> latest = filter;
  Innovation<NZ, Scalar> innovation;
  for (int l = 0; l < options.iterations; ++l) {
    // S 3.15 is S 2.9 with the linearisation about eta carried to x(k+1|k).
    const Vector eta = latest.x();
    Linearisation<NZ, NX, Scalar> carried = outputs(eta);
    carried.value += states::product(carried.jacobian, filter.x() - eta);
    latest = filter;
    innovation = latest.update(y, carried, R);
    if (innovation.status != FilterStatus::ok) return innovation;
    const auto U = latest.form().root();
    const Scalar step = states::solve_transposed(U, latest.x() - eta).norm();
    const Scalar size = states::solve_transposed(U, eta).norm();
    if (step <=
        static_cast<Scalar>(options.tolerance) + digits_lost * states::rounding<Scalar> * size) {
      filter = std::move(latest);
      return innovation;
    }
  }
  filter = std::move(latest);
  innovation.status = FilterStatus::not_converged;
  return innovation;
}

}  // namespace sepcal
