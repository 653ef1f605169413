// SPDX-License-Identifier: BSD-3-Clause
// A three-axis magnetometer against a known field (Sun & Gebre-Egziabher, Eqs. B1-B3):
// m = C_alpha C_eta C_lambda h + n, with C_lambda = I + diag(lambda), C_eta = I + [eta x] (Eq. A2,
// entry (3,2) read as eta_1) and C_alpha symmetric with a unit diagonal: nine entries of C, nine
// parameters, so that none is hidden behind another.
#pragma once

#include <array>

#include "sepcal/detail/model.hpp"
#include "sepcal/detail/models/scale.hpp"
#include "sepcal/models/triad.hpp"

namespace sepcal {

struct Magnetometer {
  static constexpr std::array inputs{Quantity{"hx", "uT"}, Quantity{"hy", "uT"},
                                     Quantity{"hz", "uT"}};  // the true field in body axes
  static constexpr std::array outputs{Quantity{"mx", "uT"}, Quantity{"my", "uT"},
                                      Quantity{"mz", "uT"}};
  static constexpr std::array linear{scale_error("lambda_x"), scale_error("lambda_y"),
                                     scale_error("lambda_z"), Quantity{"n_x", "uT"},
                                     Quantity{"n_y", "uT"},   Quantity{"n_z", "uT"}};
  static constexpr std::array nonlinear{
      Quantity{"eta_x", "rad", -0.5, 0.5},  Quantity{"eta_y", "rad", -0.5, 0.5},
      Quantity{"eta_z", "rad", -0.5, 0.5},  Quantity{"alpha_xy", "1", -0.5, 0.5},
      Quantity{"alpha_xz", "1", -0.5, 0.5}, Quantity{"alpha_yz", "1", -0.5, 0.5}};
  static constexpr bool dual_inputs = true;
  static constexpr bool nested_duals = true;
  static constexpr bool enclosed = true;
  using LanesOf = Magnetometer;

  template <class U>
  static Vec<U, 3> prepare(const Vec<U, 3>& h) {
    return h;
  }

  /// What depends on xi2 alone.
  template <class X>
  static Eigen::Matrix<X, 3, 3> settle(const Vec<X, 6>& xi2) {
    return soft_iron_and_misalignment(xi2);
  }

  template <class U, class X>
  static Affine<X, 3, 6> combine(const Vec<U, 3>& h, const Eigen::Matrix<X, 3, 3>& CC) {
    Affine<X, 3, 6> z;
    for (int i = 0; i < 3; ++i) z.A.col(i) = CC.col(i) * h[i];
    z.A.template rightCols<3>() = Eigen::Matrix<X, 3, 3>::Identity();
    z.b = CC * h;
    return z;
  }

  template <class U, class X>
  Affine<X, 3, 6> at(const Vec<U, 3>& h, const Vec<X, 6>& xi2) const {
    return combine<U, X>(h, settle<X>(xi2));
  }

  /// xi2 of the linear fit m = C h + n, a column: within wide bounds, or from few rows, descents
  /// from samples end elsewhere. None where C can't be split.
  static Eigen::MatrixXd guess(const Eigen::MatrixXd& u, const Eigen::MatrixXd& z);

  /// C_alpha C_eta (3 x 3).
  template <class X>
  static Eigen::Matrix<X, 3, 3> soft_iron_and_misalignment(const Vec<X, 6>& xi2) {
    const Eigen::Matrix<X, 3, 3> C_eta = Misalignment::matrix(Vec<X, 3>(xi2.template head<3>()));
    const Eigen::Matrix<X, 3, 3> C_alpha = CrossCoupling::matrix(Vec<X, 3>(xi2.template tail<3>()));
    return C_alpha * C_eta;
  }
};

}  // namespace sepcal
