// SPDX-License-Identifier: BSD-3-Clause
// The profile cost by dense linear least squares, and its gradient by differences: what searches of
// it are held against; and a problem whose minima are many.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "dense_reference.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/options.hpp"
#include "simulated_records.hpp"

namespace sepcal::test {

/// Stage one by NLopt.
inline FitOptions global(int evaluations = 500) {
  FitOptions options;
  options.search = Search::global;
  options.samples = evaluations;
  return options;
}

/// Tr[R] at one xi2: mean squared residual after dense linear least squares with R = I, summed
/// over outputs.
inline double dense_trace(const Simulated& simulated, const Eigen::VectorXd& xi2) {
  const Eigen::MatrixXd values = dense_values(*simulated.model, simulated.record, xi2);
  const Eigen::Index n_1 = values.cols() - 1;
  const Eigen::VectorXd y = dense_outputs(*simulated.model, simulated.record) - values.col(n_1);
  const Eigen::MatrixXd A = values.leftCols(n_1);
  const Eigen::VectorXd r = y - A * A.colPivHouseholderQr().solve(y);
  return r.squaredNorm() / static_cast<double>(simulated.record.rows());
}

/// d Tr[R] / d xi2 by Richardson's extrapolation of central differences over `step`.
inline Eigen::VectorXd dense_gradient(const Simulated& simulated, const Eigen::VectorXd& xi2,
                                      double step = 1e-3) {
  Eigen::VectorXd gradient(xi2.size());
  for (Eigen::Index k = 0; k < xi2.size(); ++k) {
    const auto slope = [&](double by) {
      Eigen::VectorXd above = xi2;
      Eigen::VectorXd below = xi2;
      above[k] += by;
      below[k] -= by;
      return (dense_trace(simulated, above) - dense_trace(simulated, below)) / (2.0 * by);
    };
    gradient[k] = (4.0 * slope(0.5 * step) - slope(step)) / 3.0;
  }
  return gradient;
}

/// z = c cos(w t) + s sin(w t): the frequency of a tone, whose side lobes are minima.
struct Tone {
  static constexpr std::array inputs{Quantity{"t", "s"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array linear{Quantity{"c", "1"}, Quantity{"s", "1"}};
  static constexpr std::array nonlinear{Quantity{"w", "rad/s", 0.5, 3.0}};
  template <class U, class X>
  Affine<X, 1, 2> at(const Vec<U, 1>& u, const Vec<X, 1>& xi2) const {
    using std::cos;
    using std::sin;
    const X phase = xi2[0] * u[0];
    Affine<X, 1, 2> z;
    z.A << cos(phase), sin(phase);
    z.b << X(0.0);
    return z;
  }
};

/// 30 s of a tone of 1.7 rad/s, amplitude 1.1, noise 0.3.
inline Simulated simulate_tone(std::uint64_t seed) {
  Simulated tone{"tone",
                 block_model(Tone{}),
                 Eigen::Vector2d(1.0, 0.5),
                 Eigen::VectorXd::Constant(1, 1.7),
                 {}};
  std::vector<double> t(300);
  for (std::size_t k = 0; k < t.size(); ++k) t[k] = 0.1 * static_cast<double>(k);
  tone.record.add("t", t);
  Draws draws(seed);
  add_outputs(tone.record, *tone.model, tone.xi1, tone.xi2, Eigen::VectorXd::Constant(1, 0.3),
              draws);
  return tone;
}

}  // namespace sepcal::test
