// SPDX-License-Identifier: BSD-3-Clause
// A step of a state model and what it expects of its outputs, with the derivatives that a
// likelihood's score asks for: those of Phi, Gamma and H too, by the states and the parameters,
// which are second derivatives of the model, exact, by nested dual numbers through the very step.
// Asks for no memory where sizes are fixed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "sepcal/detail/dual.hpp"
#include "sepcal/detail/nested_dual.hpp"
#include "sepcal/detail/states/integration.hpp"
#include "sepcal/detail/states/noise_response.hpp"
#include "sepcal/detail/states/product.hpp"
#include "sepcal/states/state_model.hpp"

namespace sepcal {

namespace states {

/// a b entries; Eigen::Dynamic where either is.
constexpr int times(int a, int b) {
  return a == Eigen::Dynamic || b == Eigen::Dynamic ? Eigen::Dynamic : a * b;
}

/// Some of the numbers that derivatives are asked for by, a few at a time: as many as a dual number
/// has room for.
class Group {
 public:
  explicit Group(std::span<const int> members) : members_(members) {}

  /// Where a number stands in it; -1 where it doesn't.
  int place(int number) const {
    const auto at = std::ranges::find(members_, number);
    return at == members_.end() ? -1 : static_cast<int>(at - members_.begin());
  }

  /// visit(place in the group, number) for each.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t i = 0; i < members_.size(); ++i) visit(static_cast<int>(i), members_[i]);
  }

 private:
  std::span<const int> members_;
};

/// visit(group of at most `most`) for all of them; once without any too, for what is asked for
/// without.
template <class Visit>
void for_each_group(std::span<const int> numbers, std::size_t most, const Visit& visit) {
  for (std::size_t first = 0; first == 0 || first < numbers.size(); first += most) {
    visit(Group(numbers.subspan(first, std::min(most, numbers.size() - first))));
  }
}

/// How many of n_x states a dual number is differentiated by at a time: all of a few, half of many,
/// as often no more than half of an aircraft's are integrated.
constexpr int states_at_a_time(int n_x) { return n_x > 4 ? (n_x + 1) / 2 : n_x; }

/// How many directions beside `inner` states: four, or fewer where a matrix of so many numbers
/// would be more than the stack takes.
constexpr int directions_at_a_time(int inner, int numbers) {
  int count = 4;
  while (count > 1 && (1 + count) * (inner + 2) * numbers > 12000) --count;
  return count;
}

}  // namespace states

/// From a row to the next, of n_x states, n_v parts of noises (noise_parts()) and n parameters.
/// Entries of Phi and Gamma stand column by column in the rows of their slopes, whose columns are
/// the states, then the parameters.
template <int NX, int NV, int N>
struct SecondOrderStep {
  Eigen::Vector<double, NX> x;          // at the next row
  Eigen::Matrix<double, NX, NX> Phi;    // dx+/dx
  Eigen::Matrix<double, NX, N> Pi;      // dx+/d parameters
  Eigen::Matrix<double, NX, NV> Gamma;  // dx+/dw, by the noises' parts
  Eigen::Matrix<double, states::times(NX, NX), states::together(NX, N)> Phi_slopes;
  Eigen::Matrix<double, states::times(NX, NV), states::together(NX, N)> Gamma_slopes;
};

/// What is expected of n_z outputs, A xi1 + b.
template <int NX, int NZ, int N>
struct SecondOrderReading {
  Eigen::Vector<double, NZ> z;
  Eigen::Matrix<double, NZ, NX> H;  // dz/dx
  Eigen::Matrix<double, NZ, N> J;   // dz/d parameters, x as it is
  Eigen::Matrix<double, states::times(NZ, NX), states::together(NX, N)> H_slopes;
};

/// G and its slopes, as SecondOrderStep has those of Gamma. Constant where the slopes are empty.
template <int NX, int NW, int N>
struct SecondOrderNoise {
  Eigen::Matrix<double, NX, NW> G;
  Eigen::Matrix<double, states::times(NX, NW), states::together(NX, N)> slopes;
  bool constant = true;
};

/// Gamma of a step whose Phi is there, from G. `discrete`: of a model in discrete time, whose Gamma
/// is G.
template <int NX, int NV, int N, int NW>
void add_noise(SecondOrderStep<NX, NV, N>& step, const SecondOrderNoise<NX, NW, N>& noise,
               double duration, bool discrete) {
  const Eigen::Index n_x = step.Phi.rows();
  const Eigen::Index n_w = noise.G.cols();
  const Eigen::Index columns = step.Phi_slopes.cols();
  const Eigen::Index parts = discrete ? 1 : 2;
  step.Gamma.resize(n_x, parts * n_w);
  step.Gamma_slopes.setZero(parts * n_x * n_w, columns);
  if (discrete) {
    step.Gamma.leftCols(n_w) = noise.G;
    if (!noise.constant) step.Gamma_slopes.topRows(n_x * n_w) = noise.slopes;
    return;
  }
  const NoiseResponse<NX> response(step.Phi, duration);
  const Eigen::Matrix<double, NX, NX> mean = response.mean();
  const Eigen::Matrix<double, NX, NX> slope = response.slope();
  step.Gamma.leftCols(n_w) = states::product(mean, noise.G);
  step.Gamma.rightCols(n_w) = states::product(slope, noise.G);
  for (Eigen::Index k = 0; k < columns; ++k) {
    const auto put = [&](Eigen::Index first, const Eigen::Matrix<double, NX, NW>& change) {
      step.Gamma_slopes.col(k).segment(first, n_x * n_w) += change.reshaped();
    };
    const auto bent = step.Phi_slopes.col(k);
    if (!bent.isZero(0.0)) {
      const Eigen::Matrix<double, NX, NX> dPhi = bent.reshaped(n_x, n_x);
      const auto change = response.change(dPhi);
      put(0, states::product(change.mean, noise.G));
      put(n_x * n_w, states::product(change.slope, noise.G));
    }
    if (noise.constant) continue;
    const Eigen::Matrix<double, NX, NW> dG = noise.slopes.col(k).reshaped(n_x, n_w);
    put(0, states::product(mean, dG));
    put(n_x * n_w, states::product(slope, dG));
  }
}

/// Parameters are those of the model's tables, n_1 linear ones (which act on no step), then n_p.
/// `inner`: the states that Phi is asked for by. `directions`: which of x and p (n_x + place) the
/// derivatives are asked for by. All others are zero, and so is Gamma: add_noise() sets it.
template <StateModel M>
SecondOrderStep<StateSizes<M>::n_x, noise_parts<M>(), StateSizes<M>::n_1 + StateSizes<M>::n_p>
second_order_step(const M& model, const Vec<double, StateSizes<M>::n_x>& x,
                  const Vec<double, StateSizes<M>::n_p>& p, const Between<M>& between, int substeps,
                  std::span<const int> inner, std::span<const int> directions) {
  constexpr int n_x = StateSizes<M>::n_x;
  constexpr int n_1 = StateSizes<M>::n_1;
  constexpr int n_p = StateSizes<M>::n_p;
  constexpr int by_states = states::states_at_a_time(n_x);
  constexpr int by_directions = states::directions_at_a_time(by_states, n_x);
  using Number = NestedDual<by_states, by_directions>;
  SecondOrderStep<n_x, noise_parts<M>(), n_1 + n_p> result;
  result.Phi.setZero();
  result.Pi.setZero();
  result.Gamma.setZero();
  result.Phi_slopes.setZero();
  result.Gamma_slopes.setZero();
  states::for_each_group(inner, by_states, [&](const states::Group& by) {
    states::for_each_group(directions, by_directions, [&](const states::Group& group) {
      Vec<Number, n_x> begin;
      Vec<Number, n_p> parameters;
      for (int i = 0; i < n_x; ++i) begin[i] = Number(x[i], by.place(i), group.place(i));
      for (int i = 0; i < n_p; ++i) parameters[i] = Number(p[i], -1, group.place(n_x + i));
      const Vec<Number, n_x> end = step<M, Number>(model, begin, parameters, between, substeps);
      for (int i = 0; i < n_x; ++i) {
        result.x[i] = end[i].value();
        by.for_each([&](int k, int state) { result.Phi(i, state) = end[i].slope(k); });
        group.for_each([&](int d, int direction) {
          const int column = direction < n_x ? direction : direction + n_1;
          if (direction >= n_x) result.Pi(i, column - n_x) = end[i].outer_slope(d);
          by.for_each([&](int k, int state) {
            result.Phi_slopes(state * n_x + i, column) = end[i].second_derivative(d, k);
          });
        });
      }
    });
  });
  return result;
}

/// The mean of G at both ends of a step, with what x and the parameters at its beginning do to it.
template <StateModel M>
SecondOrderNoise<StateSizes<M>::n_x, StateSizes<M>::n_w, StateSizes<M>::n_1 + StateSizes<M>::n_p>
second_order_noise(const M& model, const Vec<double, StateSizes<M>::n_x>& x,
                   const Vec<double, StateSizes<M>::n_p>& p, const Between<M>& between,
                   const SecondOrderStep<StateSizes<M>::n_x, noise_parts<M>(),
                                         StateSizes<M>::n_1 + StateSizes<M>::n_p>& step) {
  constexpr int n_x = StateSizes<M>::n_x;
  constexpr int n_1 = StateSizes<M>::n_1;
  constexpr int n_p = StateSizes<M>::n_p;
  constexpr int n_w = StateSizes<M>::n_w;
  SecondOrderNoise<n_x, n_w, n_1 + n_p> noise;
  if constexpr (!has_noise_input<M>()) {
    noise.G = noise_input<M, double>(model, x, between.u(0.0), p);
  } else {
    using Number = Dual<double, n_x + n_p>;
    using Slopes = Eigen::Matrix<double, n_x * n_w, n_x + n_p>;
    const auto at = [&](const Vec<double, n_x>& state, double share, Slopes& slopes) {
      Vec<Number, n_x> begin;
      Vec<Number, n_p> parameters;
      for (int i = 0; i < n_x; ++i) begin[i] = Number(state[i], i);
      for (int i = 0; i < n_p; ++i) parameters[i] = Number(p[i], n_x + i);
      const Eigen::Matrix<Number, n_x, n_w> G =
          noise_input<M, Number>(model, begin, between.u(share), parameters);
      Eigen::Matrix<double, n_x, n_w> value;
      for (int k = 0; k < n_w; ++k) {
        for (int i = 0; i < n_x; ++i) {
          value(i, k) = G(i, k).value();
          slopes.row(k * n_x + i) = G(i, k).slopes().transpose();
        }
      }
      return value;
    };
    Slopes begin;
    Slopes end;
    noise.constant = false;
    noise.G = at(x, 0.0, begin);
    noise.slopes.setZero();
    noise.slopes.template leftCols<n_x>() = begin.template leftCols<n_x>();
    noise.slopes.template rightCols<n_p>() = begin.template rightCols<n_p>();
    if constexpr (!is_discrete<M>()) {
      noise.G = (0.5 * (noise.G + at(step.x, 1.0, end))).eval();
      noise.slopes.template leftCols<n_x>() +=
          states::product(end.template leftCols<n_x>(), step.Phi);
      noise.slopes.template rightCols<n_1 + n_p>() +=
          states::product(end.template leftCols<n_x>(), step.Pi);
      noise.slopes.template rightCols<n_p>() += end.template rightCols<n_p>();
      noise.slopes *= 0.5;
    }
  }
  return noise;
}

/// The same of the outputs at inputs u (n_u) and linear parameters xi1 (n_1).
template <StateModel M>
SecondOrderReading<StateSizes<M>::n_x, StateSizes<M>::n_z, StateSizes<M>::n_1 + StateSizes<M>::n_p>
second_order_reading(const M& model, const Vec<double, StateSizes<M>::n_x>& x,
                     const Vec<double, StateSizes<M>::n_u>& u,
                     const Vec<double, StateSizes<M>::n_1>& xi1,
                     const Vec<double, StateSizes<M>::n_p>& p, std::span<const int> inner,
                     std::span<const int> directions) {
  constexpr int n_x = StateSizes<M>::n_x;
  constexpr int n_z = StateSizes<M>::n_z;
  constexpr int n_1 = StateSizes<M>::n_1;
  constexpr int n_p = StateSizes<M>::n_p;
  constexpr int by_states = states::states_at_a_time(n_x);
  constexpr int by_directions = states::directions_at_a_time(by_states, n_z * (n_1 + 1));
  using Number = NestedDual<by_states, by_directions>;
  SecondOrderReading<n_x, n_z, n_1 + n_p> result;
  result.H.setZero();
  result.J.setZero();
  result.H_slopes.setZero();
  states::for_each_group(inner, by_states, [&](const states::Group& by) {
    states::for_each_group(directions, by_directions, [&](const states::Group& group) {
      Vec<Number, n_x> at;
      Vec<Number, n_p> parameters;
      for (int i = 0; i < n_x; ++i) at[i] = Number(x[i], by.place(i), group.place(i));
      for (int i = 0; i < n_p; ++i) parameters[i] = Number(p[i], -1, group.place(n_x + i));
      const auto expected = model.at(at, u, parameters);
      for (int j = 0; j < n_z; ++j) {
        Number z = expected.b[j];
        for (int k = 0; k < n_1; ++k) {
          if (xi1[k] != 0.0) z += expected.A(j, k) * xi1[k];
          result.J(j, k) = expected.A(j, k).value();
          by.for_each([&](int i, int state) {
            result.H_slopes(state * n_z + j, n_x + k) = expected.A(j, k).slope(i);
          });
        }
        result.z[j] = z.value();
        by.for_each([&](int i, int state) { result.H(j, state) = z.slope(i); });
        group.for_each([&](int d, int direction) {
          const int column = direction < n_x ? direction : direction + n_1;
          if (direction >= n_x) result.J(j, column - n_x) = z.outer_slope(d);
          by.for_each([&](int i, int state) {
            result.H_slopes(state * n_z + j, column) = z.second_derivative(d, i);
          });
        });
      }
    });
  });
  return result;
}

}  // namespace sepcal
