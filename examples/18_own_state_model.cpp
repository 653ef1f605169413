// SPDX-License-Identifier: BSD-3-Clause
// Roll damping and aileron effectiveness from a few reversals: p' = Lp p + La aileron.
#include <cstdio>
#include <sepcal/sepcal.hpp>
using namespace sepcal;
struct RollMode {
  static constexpr std::array inputs{Quantity{"aileron", "rad"}};
  static constexpr std::array states{Quantity{"p", "rad/s"}};
  static constexpr std::array outputs{Quantity{"p_m", "rad/s"}};
  static constexpr std::array linear{Quantity{"b_p", "rad/s"}};
  static constexpr std::array nonlinear{Quantity{"Lp", "1/s", -20, 0}, Quantity{"La", "1/s^2"}};
  static constexpr std::array<std::string_view, 1> linear_dynamic{"La"};  // linear in p and La
  static constexpr std::array<Quantity, 0> noise{};
  template <class U, class X>
  Rate<X, 1> rate(const Vec<X, 1>& x, const Vec<U, 1>& u, const Vec<X, 2>& p) const {
    Rate<X, 1> dx;
    dx[0] = p[0] * x[0] + p[1] * u[0];
    return dx;
  }
  template <class U, class X>
  Affine<X, 1, 1> at(const Vec<X, 1>& x, const Vec<U, 1>& /*u*/, const Vec<X, 2>& /*p*/) const {
    Affine<X, 1, 1> z;
    z.A << X(1.0);
    z.b << x[0];
    return z;
  }
};
int main() {
  Record roll;  // two seconds at 10 Hz
  roll.add("time", {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0,
                    1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2.0});
  roll.add("aileron", {0.0,  0.1,  0.1,  0.1,  0.1,  0.1,  0.1,  0.1,  0.1,  -0.1, -0.1,
                       -0.1, -0.1, -0.1, -0.1, -0.1, 0.05, 0.05, 0.05, 0.05, 0.05});
  roll.add("p_m",
           {0.051, 0.1,    0.188,  0.254,  0.312,  0.353,  0.384,  0.412,  0.431, 0.336, 0.159,
            0.023, -0.086, -0.168, -0.233, -0.281, -0.239, -0.129, -0.044, 0.024, 0.076});
  const TrajectoryModel model(RollMode{}, roll);
  const Fit fit = sepcal::fit(model, roll);
  for (const Parameter& p : fit.parameters)
    std::printf("%-4s %8.4f +- %.4f\n", p.name.c_str(), p.value, p.standard_error);
}
