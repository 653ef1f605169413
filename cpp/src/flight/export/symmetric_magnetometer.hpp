// SPDX-License-Identifier: BSD-3-Clause
// m = C h + n with a symmetric C: what autopilots hold of a magnetometer, whose correction is then
// symmetric too. Linear in its nine parameters.
#pragma once

#include <array>
#include <memory>

#include "sepcal/detail/model.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal::exporting {

struct SymmetricMagnetometer {
  static constexpr std::array inputs{Quantity{"hx", "uT"}, Quantity{"hy", "uT"},
                                     Quantity{"hz", "uT"}};  // the true field in body axes
  static constexpr std::array outputs{Quantity{"mx", "uT"}, Quantity{"my", "uT"},
                                      Quantity{"mz", "uT"}};
  static constexpr std::array linear{
      Quantity{"c_xx", "1"}, Quantity{"c_yy", "1"}, Quantity{"c_zz", "1"},
      Quantity{"c_xy", "1"}, Quantity{"c_xz", "1"}, Quantity{"c_yz", "1"},
      Quantity{"n_x", "uT"}, Quantity{"n_y", "uT"}, Quantity{"n_z", "uT"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  static constexpr bool dual_inputs = true;

  template <class U, class X>
  Affine<X, 3, 9> at(const Vec<U, 3>& h, const Vec<X, 0>& /*xi2*/) const {
    const Vec<X, 3> columns = h.template cast<X>();
    const auto& x = columns[0];
    const auto& y = columns[1];
    const auto& z = columns[2];
    const X zero(0.0);
    Affine<X, 3, 9> m;
    m.A.template leftCols<6>() << x, zero, zero, y, z, zero,  //
        zero, y, zero, x, zero, z,                            //
        zero, zero, z, zero, x, y;
    m.A.template rightCols<3>() = Eigen::Matrix<X, 3, 3>::Identity();
    m.b.setZero();
    return m;
  }

  /// C of the parameters.
  static Eigen::Matrix3d matrix(const Eigen::VectorXd& values);
};

/// The probe that reads a flight as `one`, a magnetometer in a known field, and fits this model.
std::shared_ptr<const Probe> symmetric_magnetometer(std::shared_ptr<const Probe> one);

}  // namespace sepcal::exporting
