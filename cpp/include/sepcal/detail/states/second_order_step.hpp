// SPDX-License-Identifier: BSD-3-Clause
// A step of a state model and what it expects of its outputs, with the derivatives that a
// likelihood's score asks for: those of Phi, Gamma and H too, by the states and the parameters,
// which are second derivatives of the model, exact. Nested dual numbers give those of the rate at a
// stage of the step, where parameters enter few of the operations; from stage to stage they are
// products. Asks for no memory where sizes are fixed.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "sepcal/detail/dual.hpp"
#include "sepcal/detail/nested_dual.hpp"
#include "sepcal/detail/states/integration.hpp"
#include "sepcal/detail/states/noise_response.hpp"
#include "sepcal/detail/states/product.hpp"
#include "sepcal/states/state_model.hpp"

namespace sepcal {

/// What is asked for: the states that Phi and H are of and by, the parameters by their places among
/// a model's linear ones and then its others, the outputs. `curves`: whether a step bends by the
/// states, as one that is linear in them doesn't.
struct SecondOrderPlaces {
  std::span<const int> states;
  std::span<const int> parameters;
  std::span<const int> outputs;
  bool curves = true;
};

namespace states {

/// How many of n_x states a dual number is differentiated by at a time: two registers of two, as
/// often no more than half of an aircraft's are integrated.
constexpr int states_at_a_time(int n_x) { return n_x > 4 ? 4 : n_x; }

/// How many directions beside `inner` states, of `all` that there are: fewer where a matrix of so
/// many numbers would be more than the stack takes.
constexpr int directions_at_a_time(int inner, int all, int numbers) {
  constexpr int most = 16;
  constexpr int room = 15000;  // doubles
  int count = all < 1 ? 1 : all < most ? all : most;
  while (count > 1 && (2 + inner + count * (1 + inner)) * numbers > room) --count;
  return count;
}

/// visit(first, one behind the last) of some of `count` at a time; once without any too.
template <class Visit>
void for_each_group(int count, int most, const Visit& visit) {
  for (int first = 0; first == 0 || first < count; first += most) {
    visit(first, std::min(first + most, count));
  }
}

/// A function's values, n of them, with first and second derivatives, by f states and m parameters.
/// Entries of the Jacobian by the states stand column by column in the columns of `curvatures`.
template <int N, int F, int P>
struct SecondOrderValues {
  static constexpr int D = F + P + 1;  // more than one, as Eigen asks of such matrices
  template <int ROWS, int COLUMNS>
  using Most =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, ROWS, COLUMNS>;

  Vec<double, N> value;
  Most<D, N> slopes;  // f + m by n
  Most<D, N * F>
      curvatures;  // f + m by n f: of the Jacobian's entries, by the states, then the rest
};

/// Which states a function is differentiated by as it is asked, [first, behind), and whether it was
/// not asked by them before.
struct InnerStates {
  int first;
  int behind;
  bool anew;
};

/// Of `function`, a template of x, p and InnerStates that returns numbers of which `rows` are
/// wanted, at x and p, by `states` of x and `parameters` of p.
template <int NX, int NP, int INNER, int OUTER, int N, int F, int P, class Function>
void differentiate_twice(const Function& function, const Vec<double, NX>& x,
                         const Vec<double, NP>& p, std::span<const int> rows,
                         std::span<const int> states, std::span<const int> parameters, bool curves,
                         SecondOrderValues<N, F, P>& result) {
  using Number = NestedDual<INNER, OUTER>;
  const auto f = static_cast<int>(states.size());
  const auto m = static_cast<int>(parameters.size());
  const auto n = static_cast<Eigen::Index>(rows.size());
  result.slopes.setZero(f + m, n);
  result.curvatures.setZero(f + m, n * f);
  const auto at = [](std::span<const int> places, int i) {
    return places[static_cast<std::size_t>(i)];
  };
  for_each_group(f, INNER, [&](int inner, int behind_inner) {
    bool anew = true;
    /// By those of one kind, from `outer` on, which stand from `first` on among all.
    const auto ask = [&](std::span<const int> kind, bool are_states, int first, int outer,
                         int behind) {
      Vec<Number, NX> variables;
      Vec<Number, NP> others;
      for (int i = 0; i < NX; ++i) variables[i] = Number(x[i]);
      for (int i = 0; i < NP; ++i) others[i] = Number(p[i]);
      for (int i = inner; i < behind_inner; ++i) {
        const int place = at(states, i);
        const bool too = are_states && i >= outer && i < behind;
        variables[place] = Number(x[place], i - inner, too ? i - outer : -1);
      }
      for (int i = outer; i < behind; ++i) {
        const int place = at(kind, i);
        if (!are_states) {
          others[place] = Number(p[place], -1, i - outer);
        } else if (i < inner || i >= behind_inner) {
          variables[place] = Number(x[place], -1, i - outer);
        }
      }
      const auto found = function(variables, others, InnerStates{inner, behind_inner, anew});
      anew = false;
      for (Eigen::Index row = 0; row < n; ++row) {
        const Number& number = found[at(rows, static_cast<int>(row))];
        result.value[row] = number.value();
        for (int i = inner; i < behind_inner; ++i) result.slopes(i, row) = number.slope(i - inner);
        for (int d = outer; d < behind; ++d) {
          if (!are_states) result.slopes(first + d, row) = number.outer_slope(d - outer);
          for (int i = inner; i < behind_inner; ++i) {
            result.curvatures(first + d, row + n * i) =
                number.second_derivative(d - outer, i - inner);
          }
        }
      }
    };
    for_each_group(curves ? f : 0, OUTER,
                   [&](int outer, int behind) { ask(states, true, 0, outer, behind); });
    if (m == 0) return;
    for_each_group(m, OUTER,
                   [&](int outer, int behind) { ask(parameters, false, f, outer, behind); });
  });
}

}  // namespace states

/// From a row to the next, of n_x states, n_v parts of noises (noise_parts()) and n parameters. Of
/// the slopes a row is a state's, then a parameter's, and a column an entry of Phi or Gamma, column
/// by column.
template <int NX, int NV, int N>
struct SecondOrderStep {
  Eigen::Vector<double, NX> x;          // at the next row
  Eigen::Matrix<double, NX, NX> Phi;    // dx+/dx
  Eigen::Matrix<double, NX, N> Pi;      // dx+/d parameters
  Eigen::Matrix<double, NX, NV> Gamma;  // dx+/dw, by the noises' parts
  Eigen::Matrix<double, states::together(NX, N), states::times(NX, NX)> Phi_slopes;
  Eigen::Matrix<double, states::together(NX, N), states::times(NX, NV)> Gamma_slopes;
};

/// What is expected of n_z outputs, A xi1 + b.
template <int NX, int NZ, int N>
struct SecondOrderReading {
  Eigen::Vector<double, NZ> z;
  Eigen::Matrix<double, NZ, NX> H;  // dz/dx
  Eigen::Matrix<double, NZ, N> J;   // dz/d parameters, x as it is
  Eigen::Matrix<double, states::together(NX, N), states::times(NZ, NX)> H_slopes;
};

/// G and its slopes, as SecondOrderStep has those of Gamma. Constant where the slopes are empty.
template <int NX, int NW, int N>
struct SecondOrderNoise {
  Eigen::Matrix<double, NX, NW> G;
  Eigen::Matrix<double, states::together(NX, N), states::times(NX, NW)> slopes;
  bool constant = true;
};

/// Gamma of a step whose Phi is there, from G. `discrete`: of a model in discrete time, whose Gamma
/// is G.
template <int NX, int NV, int N, int NW>
void add_noise(SecondOrderStep<NX, NV, N>& step, const SecondOrderNoise<NX, NW, N>& noise,
               double duration, bool discrete) {
  const Eigen::Index n_x = step.Phi.rows();
  const Eigen::Index n_w = noise.G.cols();
  const Eigen::Index parts = discrete ? 1 : 2;
  step.Gamma.resize(n_x, parts * n_w);
  step.Gamma_slopes.setZero(step.Phi_slopes.rows(), parts * n_x * n_w);
  if (discrete) {
    step.Gamma.leftCols(n_w) = noise.G;
    if (!noise.constant) step.Gamma_slopes.leftCols(n_x * n_w) = noise.slopes;
    return;
  }
  const NoiseResponse<NX> response(step.Phi, duration);
  const Eigen::Matrix<double, NX, NX> mean = response.mean();
  const Eigen::Matrix<double, NX, NX> slope = response.slope();
  step.Gamma.leftCols(n_w) = states::product(mean, noise.G);
  step.Gamma.rightCols(n_w) = states::product(slope, noise.G);
  const auto change = response.change(step.Phi_slopes);
  auto of_mean = step.Gamma_slopes.leftCols(n_x * n_w);
  auto of_slope = step.Gamma_slopes.rightCols(n_x * n_w);
  states::add_slopes_times(change.mean, noise.G, of_mean);
  states::add_slopes_times(change.slope, noise.G, of_slope);
  if (noise.constant) return;
  states::add_times_slopes(mean, noise.slopes, of_mean);
  states::add_times_slopes(slope, noise.slopes, of_slope);
}

/// Of the rate at a stage whose states have the derivatives a and b, those by all directions.
template <class Values, class Slopes, class Curvatures>
void compose_stage(const Values& rate, const Slopes& a, const Curvatures& b, Slopes& first,
                   Curvatures& second) {
  const Eigen::Index directions = a.rows();
  const Eigen::Index f = a.cols();
  first.setZero(directions, f);
  second.setZero(directions, f * f);
  Curvatures W = Curvatures::Zero(directions, f * f);
  first.bottomRows(directions - f) = rate.slopes.bottomRows(directions - f);
  W.bottomRows(directions - f) = rate.curvatures.bottomRows(directions - f);
  for (Eigen::Index i = 0; i < f; ++i) {
    for (Eigen::Index k = 0; k < f; ++k)
      states::add_times(rate.slopes(k, i), a.col(k), first.col(i));
  }
  for (Eigen::Index entry = 0; entry < f * f; ++entry) {
    for (Eigen::Index k = 0; k < f; ++k) {
      states::add_times(rate.curvatures(k, entry), a.col(k), W.col(entry));
    }
  }
  for (Eigen::Index j = 0; j < f; ++j) {
    for (Eigen::Index i = 0; i < f; ++i) {
      for (Eigen::Index k = 0; k < f; ++k) {
        states::add_times(rate.slopes(k, i), b.col(k + f * j), second.col(i + f * j));
        states::add_times(a(j, k), W.col(i + f * k), second.col(i + f * j));
      }
    }
  }
}

/// Puts a step's end and its derivatives a and b where `step` has them; `columns`: of the places'
/// parameters those that have directions.
template <class Step, class State, class Slopes, class Curvatures>
void put_end(const SecondOrderPlaces& places, std::span<const Eigen::Index> columns,
             const State& end, const Slopes& a, const Curvatures& b, Step& step) {
  const auto f = static_cast<Eigen::Index>(places.states.size());
  const auto n = static_cast<Eigen::Index>(places.parameters.size());
  step.x.resize(f);
  for (Eigen::Index i = 0; i < f; ++i) {
    step.x[i] = end[places.states[static_cast<std::size_t>(i)]];
  }
  step.Phi = a.topRows(f).transpose();
  step.Pi.setZero(f, n);
  step.Phi_slopes.setZero(f + n, f * f);
  step.Phi_slopes.topRows(f) = b.topRows(f);
  Eigen::Index row = f;
  for (const Eigen::Index column : columns) {
    step.Pi.col(column) = a.row(row).transpose();
    step.Phi_slopes.row(f + column) = b.row(row);
    ++row;
  }
}

/// Fills all of `step` but Gamma, which add_noise() does, and returns the model's whole state at
/// the next row, measured ones too.
template <StateModel M, class Step>
Vec<double, StateSizes<M>::n_x> second_order_step(const M& model,
                                                  const Vec<double, StateSizes<M>::n_x>& x,
                                                  const Vec<double, StateSizes<M>::n_p>& p,
                                                  const Between<M>& between, int substeps,
                                                  const SecondOrderPlaces& places, Step& step) {
  constexpr int n_x = StateSizes<M>::n_x;
  constexpr int n_1 = StateSizes<M>::n_1;
  constexpr int n_p = StateSizes<M>::n_p;
  constexpr int inner = states::states_at_a_time(n_x);
  constexpr int outer = states::directions_at_a_time(inner, n_x > n_p ? n_x : n_p, 4 * n_x);
  using Values = states::SecondOrderValues<n_x, n_x, n_p>;
  using Slopes = Values::template Most<Values::D, n_x>;
  using Curvatures = Values::template Most<Values::D, n_x * n_x>;
  const auto f = static_cast<Eigen::Index>(places.states.size());
  // Of the parameters only those that are no linear ones act on a step.
  std::array<int, static_cast<std::size_t>(n_p) + 1> seeded{};
  std::array<Eigen::Index, static_cast<std::size_t>(n_p) + 1> columns{};
  std::size_t m = 0;
  for (std::size_t i = 0; i < places.parameters.size(); ++i) {
    if (places.parameters[i] < n_1) continue;
    seeded[m] = places.parameters[i] - n_1;
    columns[m++] = static_cast<Eigen::Index>(i);
  }
  const std::span<const int> parameters(seeded.data(), m);
  const auto directions = f + static_cast<Eigen::Index>(m);

  Vec<double, n_x> begin = x;
  Slopes A = Slopes::Zero(directions, f);  // of the states where a step begins
  A.topRows(f).setIdentity();
  Curvatures B = Curvatures::Zero(directions, f * f);
  Values rate;  // at a stage
  const auto differentiate = [&](const auto& function, const Vec<double, n_x>& at) {
    states::differentiate_twice<n_x, n_p, inner, outer>(
        function, at, p, places.states, places.states, parameters, places.curves, rate);
  };
  if constexpr (is_discrete<M>()) {
    const Vec<double, n_x> end = model.next(x, between.u(0.0), p);
    differentiate(
        [&]<class T>(const Vec<T, n_x>& at, const Vec<T, n_p>& of,
                     const states::InnerStates& /*by*/) -> Vec<T, n_x> {
          return model.next(at, between.u(0.0), of);
        },
        x);
    Slopes first;
    Curvatures second;
    compose_stage(rate, A, B, first, second);
    put_end(places, {columns.data(), m}, end, first, second, step);
    Vec<double, n_x> whole = end;
    between.put_measured_at_end(whole);
    return whole;
  } else {
    const double share = 1.0 / static_cast<double>(substeps);
    const double dt = share * between.duration();
    constexpr std::array<double, 4> reach{0.0, 0.5, 0.5, 1.0};
    constexpr std::array<double, 4> weights{1.0, 2.0, 2.0, 1.0};
    Slopes first;
    Curvatures second;
    for (int substep = 0; substep < substeps; ++substep) {
      Vec<double, n_x> k = Vec<double, n_x>::Zero();
      Vec<double, n_x> sum = k;
      Slopes sum_first = Slopes::Zero(directions, f);
      Curvatures sum_second = Curvatures::Zero(directions, f * f);
      for (std::size_t stage = 0; stage < 4; ++stage) {
        const double s = (static_cast<double>(substep) + reach[stage]) * share;
        const double h = reach[stage] * dt;
        Vec<double, n_x> at = begin + h * k;
        between.put_measured(at, s);
        const Vec<double, StateSizes<M>::n_u> u = between.u(s);
        differentiate(
            [&]<class T>(const Vec<T, n_x>& state, const Vec<T, n_p>& of,
                         const states::InnerStates& /*by*/) -> Vec<T, n_x> {
              return model.rate(state, u, of);
            },
            at);
        for (Eigen::Index i = 0; i < f; ++i) {
          k[places.states[static_cast<std::size_t>(i)]] = rate.value[i];
        }
        if (stage == 0) {
          compose_stage(rate, A, B, first, second);
        } else {
          const Slopes a = A + h * first;
          const Curvatures b = B + h * second;
          compose_stage(rate, a, b, first, second);
        }
        sum += weights[stage] * k;
        sum_first += weights[stage] * first;
        sum_second += weights[stage] * second;
      }
      begin += dt / 6.0 * sum;
      A += dt / 6.0 * sum_first;
      B += dt / 6.0 * sum_second;
    }
    between.put_measured_at_end(begin);
    put_end(places, {columns.data(), m}, begin, A, B, step);
    return begin;
  }
}

/// The mean of G at both ends of a step, with what x and the parameters at its beginning do to it;
/// `end` is the model's whole state where it ends.
template <StateModel M, class Step, class Noise>
void second_order_noise(const M& model, const Vec<double, StateSizes<M>::n_x>& x,
                        const Vec<double, StateSizes<M>::n_p>& p, const Between<M>& between,
                        const SecondOrderPlaces& places, const Vec<double, StateSizes<M>::n_x>& end,
                        const Step& step, Noise& noise) {
  constexpr int n_x = StateSizes<M>::n_x;
  constexpr int n_1 = StateSizes<M>::n_1;
  constexpr int n_p = StateSizes<M>::n_p;
  constexpr int n_w = StateSizes<M>::n_w;
  const auto f = static_cast<Eigen::Index>(places.states.size());
  const auto n = static_cast<Eigen::Index>(places.parameters.size());
  const auto state = [&](Eigen::Index i) { return places.states[static_cast<std::size_t>(i)]; };
  noise.G.resize(f, n_w);
  noise.constant = !has_noise_input<M>();
  if constexpr (!has_noise_input<M>()) {
    const Eigen::Matrix<double, n_x, n_w> G = noise_input<M, double>(model, x, between.u(0.0), p);
    for (Eigen::Index i = 0; i < f; ++i) noise.G.row(i) = G.row(state(i));
  } else {
    using Number = Dual<double, n_x + n_p>;
    noise.slopes.setZero(f + n, f * n_w);
    /// Adds a share of G, with its slopes by x and p, of which x has those of `by_x` (f + n by f).
    const auto add = [&](double weight, const Vec<double, n_x>& at, double share,
                         const auto& by_x) {
      Vec<Number, n_x> variables;
      Vec<Number, n_p> parameters;
      for (int i = 0; i < n_x; ++i) variables[i] = Number(at[i], i);
      for (int i = 0; i < n_p; ++i) parameters[i] = Number(p[i], n_x + i);
      const Eigen::Matrix<Number, n_x, n_w> G =
          noise_input<M, Number>(model, variables, between.u(share), parameters);
      for (Eigen::Index k = 0; k < n_w; ++k) {
        for (Eigen::Index i = 0; i < f; ++i) {
          const Number& number = G(state(i), k);
          noise.G(i, k) += weight * number.value();
          auto slopes = noise.slopes.col(k * f + i);
          for (Eigen::Index j = 0; j < f; ++j) {
            states::add_times(weight * number.slope(state(j)), by_x.col(j), slopes);
          }
          for (Eigen::Index j = 0; j < n; ++j) {
            const int place = places.parameters[static_cast<std::size_t>(j)] - n_1;
            if (place >= 0) slopes[f + j] += weight * number.slope(n_x + place);
          }
        }
      }
    };
    noise.G.setZero();
    using ByState = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                  n_x + n_1 + n_p, n_x>;
    ByState by_x = ByState::Zero(f + n, f);
    by_x.topRows(f).setIdentity();
    if constexpr (is_discrete<M>()) {
      add(1.0, x, 0.0, by_x);
    } else {
      add(0.5, x, 0.0, by_x);
      by_x.topRows(f) = step.Phi.transpose();
      by_x.bottomRows(n) = step.Pi.transpose();
      add(0.5, end, 1.0, by_x);
    }
  }
}

/// The same of the outputs at inputs u (n_u) and linear parameters xi1 (n_1).
template <StateModel M, class Reading>
void second_order_reading(const M& model, const Vec<double, StateSizes<M>::n_x>& x,
                          const Vec<double, StateSizes<M>::n_u>& u,
                          const Vec<double, StateSizes<M>::n_1>& xi1,
                          const Vec<double, StateSizes<M>::n_p>& p, const SecondOrderPlaces& places,
                          Reading& reading) {
  constexpr int n_x = StateSizes<M>::n_x;
  constexpr int n_z = StateSizes<M>::n_z;
  constexpr int n_1 = StateSizes<M>::n_1;
  constexpr int n_p = StateSizes<M>::n_p;
  constexpr int inner = states::states_at_a_time(n_x);
  constexpr int outer = states::directions_at_a_time(inner, n_x > n_p ? n_x : n_p, n_z * (n_1 + 1));
  const auto f = static_cast<Eigen::Index>(places.states.size());
  const auto n = static_cast<Eigen::Index>(places.parameters.size());
  const auto outputs = static_cast<Eigen::Index>(places.outputs.size());
  std::array<int, static_cast<std::size_t>(n_p) + 1> seeded{};
  std::array<Eigen::Index, static_cast<std::size_t>(n_p) + 1> rows{};  // of theirs
  std::size_t m = 0;
  reading.J.setZero(outputs, n);
  reading.H_slopes.setZero(f + n, outputs * f);
  for (Eigen::Index i = 0; i < n; ++i) {
    const int place = places.parameters[static_cast<std::size_t>(i)];
    if (place < n_1) continue;
    seeded[m] = place - n_1;
    rows[m++] = i;
  }
  const auto function = [&]<class T>(const Vec<T, n_x>& at, const Vec<T, n_p>& of,
                                     const states::InnerStates& by) -> Vec<T, n_z> {
    const Affine<T, n_z, n_1> expected = model.at(at, u, of);
    Vec<T, n_z> z = expected.b;
    for (int k = 0; k < n_1; ++k) {
      if (xi1[k] == 0.0) continue;
      for (int j = 0; j < n_z; ++j) z[j] += expected.A(j, k) * xi1[k];
    }
    for (Eigen::Index k = 0; by.anew && k < n; ++k) {
      const int column = places.parameters[static_cast<std::size_t>(k)];
      if (column >= n_1) continue;
      for (Eigen::Index j = 0; j < outputs; ++j) {
        const T& entry = expected.A(places.outputs[static_cast<std::size_t>(j)], column);
        reading.J(j, k) = entry.value();
        for (int i = by.first; i < by.behind; ++i) {
          reading.H_slopes(f + k, j + outputs * i) = entry.slope(i - by.first);
        }
      }
    }
    return z;
  };
  states::SecondOrderValues<n_z, n_x, n_p> found;
  states::differentiate_twice<n_x, n_p, inner, outer>(function, x, p, places.outputs, places.states,
                                                      std::span<const int>(seeded.data(), m),
                                                      places.curves, found);
  reading.z = found.value.head(outputs);
  reading.H = found.slopes.topRows(f).transpose();
  reading.H_slopes.topRows(f) = found.curvatures.topRows(f);
  for (std::size_t k = 0; k < m; ++k) {
    const auto row = f + static_cast<Eigen::Index>(k);
    reading.J.col(rows[k]) = found.slopes.row(row).transpose();
    reading.H_slopes.row(f + rows[k]) = found.curvatures.row(row);
  }
}

}  // namespace sepcal
