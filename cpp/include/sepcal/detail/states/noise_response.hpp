// SPDX-License-Identifier: BSD-3-Clause
// What process noise does to the state from a row to the next, of a step whose derivative Phi is
// known, however it was taken. Between two rows a noise is given by its first two polynomials of
// Legendre, w(s) = mean + sqrt(3) (2 s - 1) slope at a share s of the time: of white noise both
// have the density over the time for their variance, and are independent, so that Gamma Q_d Gamma'
// is Van Loan's integral to the fourth order in the time, and smoothed noise has a mean to show.
#pragma once

#include <cmath>
#include <numbers>

#include "sepcal/detail/states/product.hpp"
#include "sepcal/states/state_model.hpp"

namespace sepcal {

/// How many columns Gamma has: n_w means, then, in continuous time, n_w slopes.
template <class M>
constexpr int noise_parts() {
  return (is_discrete<M>() ? 1 : 2) * StateSizes<M>::n_w;
}

/// Responses of the state to a mean and to a slope that enter its rate, from E = Phi - I with Phi =
/// exp(A): dt (exp(A) - 1) / A and dt times the integral of sqrt(3) (1 - 2 s) exp(A s), as powers
/// of E, whose first left out is 3/160 of E^5: a millionth where the fastest rate times dt is 0.15.
template <int NX>
class NoiseResponse {
 public:
  using Matrix = Eigen::Matrix<double, NX, NX>;

  NoiseResponse(const Matrix& Phi, double duration)
      : E_(Phi - Matrix::Identity(Phi.rows(), Phi.cols())),
        square_(states::product(E_, E_)),
        cube_(states::product(square_, E_)),
        duration_(duration) {}

  Matrix mean() const {
    Matrix sum = E_ / 2.0 - square_ / 12.0 + cube_ / 24.0 -
                 (19.0 / 720.0) * states::product(square_, square_);
    sum.diagonal().array() += 1.0;
    return duration_ * sum;
  }

  Matrix slope() const {
    return -std::numbers::sqrt3 * duration_ *
           (E_ / 6.0 - cube_ / 360.0 + states::product(square_, square_) / 360.0);
  }

  /// Their slopes by many variables from those of Phi, as add_slopes_times() has them.
  template <class Slopes>
  struct Change {
    Slopes mean;
    Slopes slope;
  };
  template <class Slopes>
  Change<Slopes> change(const Slopes& dPhi) const {
    const auto sum = [&](const Slopes& left, const Matrix& b, const Matrix& a,
                         const Slopes& right) {
      Slopes result = Slopes::Zero(dPhi.rows(), dPhi.cols());
      states::add_slopes_times(left, b, result);
      states::add_times_slopes(a, right, result);
      return result;
    };
    const Slopes d2 = sum(dPhi, E_, E_, dPhi);
    const Slopes d3 = sum(d2, E_, square_, dPhi);
    const Slopes d4 = sum(d2, square_, square_, d2);
    return {duration_ * (dPhi / 2.0 - d2 / 12.0 + d3 / 24.0 - (19.0 / 720.0) * d4),
            -std::numbers::sqrt3 * duration_ * (dPhi / 6.0 - d3 / 360.0 + d4 / 360.0)};
  }

 private:
  Matrix E_;
  Matrix square_;
  Matrix cube_;
  double duration_;
};

}  // namespace sepcal
