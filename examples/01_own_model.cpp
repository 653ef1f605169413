// SPDX-License-Identifier: BSD-3-Clause
// Airspeed scale, heading error and wind from a wind box: V = k v [cos, sin](psi + delta) + W.
#include <cstdio>
#include <sepcal/sepcal.hpp>
using namespace sepcal;
struct WindBox {
  static constexpr std::array inputs{Quantity{"v", "m/s"}, Quantity{"psi", "rad"}};
  static constexpr std::array outputs{Quantity{"vn", "m/s"}, Quantity{"ve", "m/s"}};
  static constexpr std::array<Quantity, 3> linear{{{"k", "1"}, {"w_n", "m/s"}, {"w_e", "m/s"}}};
  static constexpr std::array nonlinear{Quantity{"delta", "rad", -0.5, 0.5}};
  template <class U, class X>
  Affine<X, 2, 3> at(const Vec<U, 2>& u, const Vec<X, 1>& xi2) const {
    Affine<X, 2, 3> z{.b = Vec<X, 2>::Zero()};
    z.A << u[0] * cos(u[1] + xi2[0]), X(1.0), X(0.0), u[0] * sin(u[1] + xi2[0]), X(0.0), X(1.0);
    return z;
  }
};
int main() {
  Record box;  // six legs: airspeed as read, heading, and the ground velocity that GPS saw
  box.add("v", {21, 20.4, 19.7, 20.2, 20.9, 19.5}).add("vn", {18.2, 4.9, -15.4, -24.9, -13.4, 6.8});
  box.add("psi", {0, 1.1, 2.1, 3.1, 4.2, 5.2}).add("ve", {3.9, 22.1, 19.6, 2.1, -17.2, -15.1});
  const Fit fit = sepcal::fit(WindBox{}, box);
  for (const Parameter& p : fit.parameters)
    std::printf("%-5s %7.4f +- %.4f\n", p.name.c_str(), p.value, p.standard_error);
}
