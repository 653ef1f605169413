// SPDX-License-Identifier: BSD-3-Clause
// The Kalman filter, S 2.3 to 2.13, and with linearisations of a nonlinear system the extended one,
// S 3.12 and 3.13. Samples may come at any times and outputs may be missing. No memory is asked
// for, nothing is thrown: what can't be used is refused by a status and leaves the filter as it
// was.
#pragma once

#include <utility>

#include "sepcal/detail/states/estimate.hpp"
#include "sepcal/detail/states/linearisation.hpp"
#include "sepcal/detail/states/measured.hpp"
#include "sepcal/detail/states/product.hpp"
#include "sepcal/detail/states/square_root_form.hpp"

namespace sepcal {

enum class FilterStatus {
  ok,
  refused,        // not finite, or a covariance that is not positive: nothing was changed
  not_converged,  // iterations ended by their cap; the last one's estimate is kept
};

/// What a measurement brought that was not expected, S 5.3. Zeros, or of a size that is known at
/// run time empty, until a sample was used.
template <int NZ, class Scalar = double>
struct Innovation {
  FilterStatus status = FilterStatus::refused;
  int count = 0;  // outputs that were there
  using Vector = Eigen::Vector<Scalar, NZ>;
  using Matrix = Eigen::Matrix<Scalar, NZ, NZ>;
  Vector e = states::zeros<Vector>();               // y - h; 0 where missing
  Vector w = states::zeros<Vector>();               // S^-T e: unit covariance
  Matrix S = Matrix::Identity(e.size(), e.size());  // Lambda = S'S

  /// Lambda(k+1|k) = C P C' + R, n_z x n_z; the identity in rows of missing outputs.
  Matrix covariance() const { return states::product(S.transpose(), S); }

  /// This sample's term of V_m, S 5.7: (e' Lambda^-1 e + ln det Lambda) / 2. With count ln(2 pi) /
  /// 2 added it is -ln p(e), S 5.4.
  Scalar cost() const {
    return Scalar(0.5) * w.squaredNorm() + S.diagonal().array().abs().log().sum();
  }
};

/// Of n_x states. Form is how their covariance is kept: SquareRootForm, JosephForm or
/// InformationForm.
template <int NX, class Form = SquareRootForm<NX>>
class Filter {
 public:
  using Scalar = Form::Matrix::Scalar;
  using Vector = Eigen::Vector<Scalar, NX>;
  using Matrix = Eigen::Matrix<Scalar, NX, NX>;

  /// x(0|-1) or x(0|0), and its covariance P (positive semidefinite; else every step is refused).
  Filter(Vector x, const Matrix& P) : x_(std::move(x)), form_(P) {}
  /// The same with P as the form has it.
  Filter(Vector x, Form form) : x_(std::move(x)), form_(std::move(form)) {}

  const Vector& x() const { return x_; }
  Matrix covariance() const { return form_.covariance(); }
  Estimate<NX, Scalar> estimate() const { return {x_, form_.root()}; }
  const Form& form() const { return form_; }

  /// x(k+1|k) and P(k+1|k), S 2.7 and 2.8; called again without an update, S 2.12 and 2.13: the
  /// state i samples ahead. (S says that P then grows with i; it falls where Phi damps more than
  /// Q_d brings.)
  template <int NW>
  FilterStatus predict(const Transition<NX, NW, Scalar>& to) {
    Form next = form_;
    next.predict(to.Phi, to.Gamma, to.Q_d);
    if (!to.x.allFinite() || !next.covariance().allFinite()) return FilterStatus::refused;
    x_ = to.x;
    form_ = std::move(next);
    return FilterStatus::ok;
  }

  /// x(k|k) and P(k|k), S 2.9 to 2.11 and 3.12 to 3.14, from y (n_z, NaN where missing), what was
  /// expected of it at x(k|k-1), and R (n_z x n_z, positive semidefinite).
  template <int NZ>
  Innovation<NZ, Scalar> update(const Eigen::Vector<Scalar, NZ>& y,
                                const Linearisation<NZ, NX, Scalar>& expected,
                                const Eigen::Matrix<Scalar, NZ, NZ>& R) {
    const states::Measured<NZ, NX, Scalar> seen(y, expected.value, expected.jacobian, R);
    Form next = form_;
    const Gain<NX, NZ, Scalar> gain = next.update(seen.H, seen.R);
    Innovation<NZ, Scalar> innovation;
    if (!(gain.S.diagonal().array() > 0).all()) return innovation;
    const Eigen::Vector<Scalar, NZ> w = states::solve_transposed(gain.S, seen.e);
    const Vector x = x_ + states::product(gain.Kbar, w);
    if (!x.allFinite() || !next.covariance().allFinite()) return innovation;
    x_ = x;
    form_ = std::move(next);
    return {FilterStatus::ok, seen.count, seen.e, w, gain.S};
  }

 private:
  Vector x_;
  Form form_;
};

}  // namespace sepcal
