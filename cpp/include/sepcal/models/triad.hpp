// SPDX-License-Identifier: BSD-3-Clause
// The canonical form of a sensor's errors (Sun & Gebre-Egziabher, Eqs. A1-A4). A triad sees
// f(u, xi') through scale errors D, matrices N_m that are not diagonal, and a bias:
//   z = N (I + D) f + n + v = [N diag(f) | I] [D(1,1) D(2,2) D(3,3) n]' + N f + v,  N = N_1 N_2 ...
// (A4 prints D(i,i) for what must be D(i,i) - 1: with D(i,i) itself b would be zero.)
#pragma once

#include <array>

#include "sepcal/detail/joined_tables.hpp"
#include "sepcal/detail/lanewise.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/detail/models/scale.hpp"

namespace sepcal {

/// C_eta = I + [eta x], small angles (rad) from the reference's axes to the sensor's (Eq. A2, whose
/// entry (3,2) prints eta_3 for eta_1).
struct Misalignment {
  static constexpr std::array nonlinear{Quantity{"eta_x", "rad", -0.5, 0.5},
                                        Quantity{"eta_y", "rad", -0.5, 0.5},
                                        Quantity{"eta_z", "rad", -0.5, 0.5}};
  template <class X>
  static Eigen::Matrix<X, 3, 3> matrix(const Vec<X, 3>& eta) {
    const X one(Real<X>(1));
    Eigen::Matrix<X, 3, 3> C;
    C << one, -eta[2], eta[1],  //
        eta[2], one, -eta[0],   //
        -eta[1], eta[0], one;
    return C;
  }
};

/// C_alpha, symmetric with a unit diagonal: soft iron, or axes that are not at right angles.
struct CrossCoupling {
  static constexpr std::array nonlinear{Quantity{"alpha_xy", "1", -0.5, 0.5},
                                        Quantity{"alpha_xz", "1", -0.5, 0.5},
                                        Quantity{"alpha_yz", "1", -0.5, 0.5}};
  template <class X>
  static Eigen::Matrix<X, 3, 3> matrix(const Vec<X, 3>& alpha) {
    const X one(Real<X>(1));
    Eigen::Matrix<X, 3, 3> C;
    C << one, alpha[0], alpha[1],  //
        alpha[0], one, alpha[2],   //
        alpha[1], alpha[2], one;
    return C;
  }
};

/// f of a magnetometer: the true field in body axes.
struct FieldInBody {
  static constexpr std::array inputs{Quantity{"hx", "uT"}, Quantity{"hy", "uT"},
                                     Quantity{"hz", "uT"}};
  static constexpr std::array outputs{Quantity{"mx", "uT"}, Quantity{"my", "uT"},
                                      Quantity{"mz", "uT"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  template <class U, class X>
  Vec<U, 3> at(const Vec<U, 3>& h, const Vec<X, 0>& /*xi*/) const {
    return h;
  }
};

/// f of an accelerometer: the true specific force in body axes (at rest, level: fz = -9.81).
struct SpecificForceInBody {
  static constexpr std::array inputs{Quantity{"fx", "m/s^2"}, Quantity{"fy", "m/s^2"},
                                     Quantity{"fz", "m/s^2"}};
  static constexpr std::array outputs{Quantity{"ax", "m/s^2"}, Quantity{"ay", "m/s^2"},
                                      Quantity{"az", "m/s^2"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  template <class U, class X>
  Vec<U, 3> at(const Vec<U, 3>& f, const Vec<X, 0>& /*xi*/) const {
    return f;
  }
};

/// A triad that sees `Reference` through `Factors`, the product of whose matrices is N, the one
/// next to the readings first.
///   Reference  tables inputs, outputs (three), nonlinear (xi', may be empty); at(u, xi') is f
///   Factor     table nonlinear; matrix(xi), 3 x 3
/// Linear parameters: lambda_x, lambda_y, lambda_z (D - I), n_x, n_y, n_z in the readings' unit.
/// Nonlinear: the reference's, then each factor's.
template <class Reference, class... Factors>
struct Triad {
  static_assert(Reference::outputs.size() == 3, "a triad has three outputs");

  static constexpr auto inputs = Reference::inputs;
  static constexpr auto outputs = Reference::outputs;
  static constexpr std::array linear{
      scale_error("lambda_x"),          scale_error("lambda_y"),
      scale_error("lambda_z"),          Quantity{"n_x", outputs[0].unit},
      Quantity{"n_y", outputs[1].unit}, Quantity{"n_z", outputs[2].unit}};
  static constexpr auto nonlinear =
      composing::join_all(Reference::nonlinear, Factors::nonlinear...);
  static constexpr bool dual_inputs = true;
  static constexpr bool nested_duals = true;

  Reference reference = {};

  template <class U, class X>
  Affine<X, 3, 6> at(const Vec<U, static_cast<int>(inputs.size())>& u,
                     const Vec<X, static_cast<int>(nonlinear.size())>& xi2) const {
    constexpr int own = static_cast<int>(Reference::nonlinear.size());
    const Vec<X, own> of_reference = xi2.template head<own>();
    const auto f = reference.at(u, of_reference);
    const Eigen::Matrix<X, 3, 3> N = product(xi2);
    Affine<X, 3, 6> z;
    for (int i = 0; i < 3; ++i) z.A.col(i) = N.col(i) * f[i];
    z.A.template rightCols<3>() = Eigen::Matrix<X, 3, 3>::Identity();
    z.b = N * f;
    return z;
  }

  /// N = N_1 N_2 ... (3 x 3).
  template <class X>
  static Eigen::Matrix<X, 3, 3> product(const Vec<X, static_cast<int>(nonlinear.size())>& xi2) {
    Eigen::Matrix<X, 3, 3> N = Eigen::Matrix<X, 3, 3>::Identity();
    int first = static_cast<int>(Reference::nonlinear.size());
    const auto multiply = [&]<class Factor>(const Factor&) {
      constexpr int size = static_cast<int>(Factor::nonlinear.size());
      N = (N * Factor::matrix(Vec<X, size>(xi2.template segment<size>(first)))).eval();
      first += size;
    };
    (multiply(Factors{}), ...);
    return N;
  }
};

/// Scale errors, biases and small misalignments of an accelerometer, Eq. A2.
using Accelerometer = Triad<SpecificForceInBody, Misalignment>;

}  // namespace sepcal
