// SPDX-License-Identifier: BSD-3-Clause
// State models of a user's own, and a trajectory model's rows on a whole record, in blocks of any
// length.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "block_inputs.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/record.hpp"
#include "sepcal/states/trajectory_model.hpp"

namespace sepcal::test {

/// x' = v, v' = -w^2 x - 2 d w v + g u; reads (1 + s) x + b, and v.
struct Oscillator {
  static constexpr std::array inputs{Quantity{"u", "1"}};
  static constexpr std::array states{Quantity{"x", "m"}, Quantity{"v", "m/s"}};
  static constexpr std::array outputs{Quantity{"x_m", "m"}, Quantity{"v_m", "m/s"}};
  static constexpr std::array linear{Quantity{"s", "1"}, Quantity{"b", "m"}};
  static constexpr std::array nonlinear{Quantity{"w", "rad/s", 0.5, 6}, Quantity{"d", "1", 0, 0.9},
                                        Quantity{"g", "m/s^2", -10, 10}};
  static constexpr std::array<Quantity, 0> noise{};
  static constexpr bool is_scale(int parameter) { return parameter == 0; }
  static constexpr bool acts_on(int /*parameter*/, int output) { return output == 0; }

  template <class U, class X>
  Rate<X, 2> rate(const Vec<X, 2>& x, const Vec<U, 1>& u, const Vec<X, 3>& p) const {
    Rate<X, 2> dx;
    dx[0] = x[1];
    dx[1] = -p[0] * p[0] * x[0] - 2.0 * p[1] * p[0] * x[1] + p[2] * u[0];
    return dx;
  }

  template <class U, class X>
  Affine<X, 2, 2> at(const Vec<X, 2>& x, const Vec<U, 1>& /*u*/, const Vec<X, 3>& /*p*/) const {
    Affine<X, 2, 2> z;
    z.A << x[0], X(1.0), X(0.0), X(0.0);
    z.b = x;
    return z;
  }

  Vec<double, 2> start(const Vec<double, 1>& /*u*/, const Vec<double, 2>& z) const { return z; }
};

/// The same, linear in the state and without the scale, which multiplies it.
struct LinearOscillator : Oscillator {
  static constexpr std::array linear{Quantity{"b", "m"}};
  static constexpr std::array<std::string_view, 1> linear_dynamic{"g"};
  static constexpr bool is_scale(int /*parameter*/) { return false; }

  template <class U, class X>
  Affine<X, 2, 1> at(const Vec<X, 2>& x, const Vec<U, 1>& /*u*/, const Vec<X, 3>& /*p*/) const {
    Affine<X, 2, 1> z;
    z.A << X(1.0), X(0.0);
    z.b = x;
    return z;
  }
};

/// [A | D | b], or [A | b] without xi1, of the record's segments one after another, output by
/// output: (n_z N) x columns. One carry, blocks of at most `block_rows`.
inline Eigen::MatrixXd rows_of(const BlockModel& model, const Record& record,
                               const Eigen::VectorXd& xi2, const Eigen::VectorXd* xi1,
                               std::size_t block_rows = 100000) {
  const Tables& tables = model.tables();
  const auto N = static_cast<Eigen::Index>(record.rows());
  Eigen::MatrixXd all(tables.n_z() * N, tables.n_1() + (xi1 == nullptr ? 0 : tables.n_2()) + 1);
  const auto carry = model.new_carry();
  Eigen::Index done = 0;
  for (const Segment& segment : record.segments()) {
    for (std::size_t first = segment.first; first < segment.last; first += block_rows) {
      const std::size_t count = std::min(block_rows, segment.last - first);
      const BlockInputs inputs = block_inputs(model, record, first);
      const auto n = static_cast<Eigen::Index>(count);
      Eigen::MatrixXd rows(tables.n_z() * n, all.cols());
      model.evaluate({inputs.pointers, count, first, first == segment.first}, values_of(xi2),
                     xi1 == nullptr ? nullptr : values_of(*xi1), carry.get(), rows);
      for (int j = 0; j < tables.n_z(); ++j) {
        all.middleRows(j * N + done, n) = rows.middleRows(j * n, n);
      }
      done += n;
    }
  }
  return all;
}

/// A xi1 + b.
inline Eigen::VectorXd outputs_of(const BlockModel& model, const Record& record,
                                  const Eigen::VectorXd& xi2, const Eigen::VectorXd& xi1) {
  const Eigen::MatrixXd rows = rows_of(model, record, xi2, nullptr);
  return rows.leftCols(xi1.size()) * xi1 + rows.rightCols<1>();
}

/// The largest error of D against central differences of A xi1 + b, relative to its column's
/// largest entry.
inline double error_of_tangent(const BlockModel& model, const Record& record,
                               const Eigen::VectorXd& xi2, const Eigen::VectorXd& xi1) {
  const Eigen::MatrixXd rows = rows_of(model, record, xi2, &xi1);
  double worst = 0.0;
  for (Eigen::Index k = 0; k < xi2.size(); ++k) {
    const double h = 2e-4 * std::max(0.1, std::abs(xi2[k]));
    const auto difference = [&](double step) -> Eigen::VectorXd {
      Eigen::VectorXd above = xi2;
      Eigen::VectorXd below = xi2;
      above[k] += step;
      below[k] -= step;
      return (outputs_of(model, record, above, xi1) - outputs_of(model, record, below, xi1)) /
             (above[k] - below[k]);
    };
    const Eigen::VectorXd numeric = (4.0 * difference(h) - difference(2.0 * h)) / 3.0;
    const Eigen::VectorXd given = rows.col(xi1.size() + k);
    worst = std::max(worst, (numeric - given).cwiseAbs().maxCoeff() / given.cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace sepcal::test
