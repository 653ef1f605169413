// SPDX-License-Identifier: BSD-3-Clause
// The short period of an aircraft, for small changes about a trimmed flight:
//   alpha' = Za alpha + q + Zd elevator,  q' = Ma alpha + Mq q + Md elevator,
//   alpha_m = alpha + b_alpha,  q_m = q + b_q,  az_m = V (Za alpha + Zd elevator) + b_az.
// Linear in the state: of its ten parameters three are nonlinear.
#pragma once

#include <array>
#include <string_view>

#include "sepcal/states/state_model.hpp"

namespace sepcal {

struct ShortPeriod {
  static constexpr std::array inputs{Quantity{"elevator", "rad"}, Quantity{"airspeed", "m/s"}};
  static constexpr std::array states{Quantity{"alpha", "rad"}, Quantity{"q", "rad/s"}};
  static constexpr std::array outputs{Quantity{"alpha_m", "rad"}, Quantity{"q_m", "rad/s"},
                                      Quantity{"az_m", "m/s^2"}};
  static constexpr std::array linear{Quantity{"b_alpha", "rad"}, Quantity{"b_q", "rad/s"},
                                     Quantity{"b_az", "m/s^2"}};
  static constexpr std::array nonlinear{
      Quantity{"Za", "1/s", -20, 0}, Quantity{"Ma", "1/s^2", -200, 20},
      Quantity{"Mq", "1/s", -20, 0}, Quantity{"Zd", "1/s"}, Quantity{"Md", "1/s^2"}};
  static constexpr std::array<std::string_view, 2> linear_dynamic{"Zd", "Md"};
  static constexpr std::array noise{Quantity{"alpha", "rad/sqrt(s)"},
                                    Quantity{"q", "rad/s/sqrt(s)"}};

  static constexpr bool acts_on(int parameter, int output) { return parameter == output; }

  template <class U, class X>
  Rate<X, 2> rate(const Vec<X, 2>& x, const Vec<U, 2>& u, const Vec<X, 5>& p) const {
    Rate<X, 2> dx;
    dx[0] = p[za] * x[0] + x[1] + p[zd] * u[0];
    dx[1] = p[ma] * x[0] + p[mq] * x[1] + p[md] * u[0];
    return dx;
  }

  template <class U, class X>
  Affine<X, 3, 3> at(const Vec<X, 2>& x, const Vec<U, 2>& u, const Vec<X, 5>& p) const {
    Affine<X, 3, 3> z;
    z.A.setIdentity();
    z.b << x[0], x[1], u[1] * (p[za] * x[0] + p[zd] * u[0]);
    return z;
  }

 private:
  enum Parameter { za, ma, mq, zd, md };  // of p
};

}  // namespace sepcal
