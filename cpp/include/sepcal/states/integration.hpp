// SPDX-License-Identifier: BSD-3-Clause
// One step of a state model, from a row of a record to the next: the classical Runge-Kutta method
// of fourth order, or next() of a model in discrete time.
#pragma once

#include <span>
#include <utility>

#include "sepcal/states/state_model.hpp"
#include "sepcal/states/trajectory_options.hpp"

namespace sepcal {

/// What a record says to a state model at one row.
template <StateModel M>
struct StateRow {
  double time = not_a_number;  // s
  Vec<double, StateSizes<M>::n_u> u;
  Vec<double, StateSizes<M>::n_x> measured;  // of the states that are measured, not integrated
};

/// Two rows that follow each other, and what is assumed of the time between them.
template <StateModel M>
class Between {
 public:
  static constexpr int n_u = StateSizes<M>::n_u;
  static constexpr int n_x = StateSizes<M>::n_x;

  /// `measured`: the places of the states that are measured. All of them must outlive this.
  Between(const StateRow<M>& from, const StateRow<M>& to, InputsBetweenRows inputs,
          std::span<const int> measured)
      : from_(from), to_(to), inputs_(inputs), measured_(measured) {}

  double duration() const { return to_.time - from_.time; }  // s

  /// u at a share of the duration, 0 to 1. Time itself goes on where the others are held.
  Vec<double, n_u> u(double share) const {
    constexpr int time = place_of("time", M::inputs);
    Vec<double, n_u> result = from_.u;
    if (inputs_ == InputsBetweenRows::linear) result += share * (to_.u - from_.u);
    if constexpr (time >= 0) result[time] = from_.time + share * duration();
    return result;
  }

  /// Puts the measured states, as they are at a share of the duration, in their places; their
  /// derivatives are zero.
  template <class T>
  void put_measured(Vec<T, n_x>& x, double share) const {
    if (inputs_ == InputsBetweenRows::hold) share = 0.0;
    for (const int i : measured_) {
      x[i] = T(from_.measured[i] + share * (to_.measured[i] - from_.measured[i]));
    }
  }

  /// The same at the later row itself.
  template <class T>
  void put_measured_at_end(Vec<T, n_x>& x) const {
    for (const int i : measured_) x[i] = T(to_.measured[i]);
  }

 private:
  const StateRow<M>& from_;
  const StateRow<M>& to_;
  InputsBetweenRows inputs_;
  std::span<const int> measured_;
};

namespace states {

/// Runge-Kutta steps from a row to the next by rate(x, share of the time between them).
template <class State, class Rate>
State integrate(const Rate& rate, State x, double duration, int substeps) {
  const double share = 1.0 / substeps;
  const double dt = share * duration;
  for (int i = 0; i < substeps; ++i) {
    const double s = i * share;
    const State k1 = rate(x, s);
    const State k2 = rate(x + (0.5 * dt) * k1, s + 0.5 * share);
    const State k3 = rate(x + (0.5 * dt) * k2, s + 0.5 * share);
    const State k4 = rate(x + dt * k3, s + share);
    x += (dt / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return x;
}

}  // namespace states

/// x at the later row. T is double, or a dual number: its derivatives are then those of this very
/// step. Not finite where the model isn't.
template <StateModel M, class T>
Vec<T, StateSizes<M>::n_x> step(const M& model, Vec<T, StateSizes<M>::n_x> x,
                                const Vec<T, StateSizes<M>::n_p>& p, const Between<M>& between,
                                int substeps) {
  using State = Vec<T, StateSizes<M>::n_x>;
  if constexpr (is_discrete<M>()) {
    x = State(model.next(x, between.u(0.0), p));
  } else {
    const auto rate = [&](State at, double s) -> State {
      between.put_measured(at, s);
      return model.rate(at, between.u(s), p);
    };
    x = states::integrate(rate, std::move(x), between.duration(), substeps);
  }
  between.put_measured_at_end(x);
  return x;
}

}  // namespace sepcal
