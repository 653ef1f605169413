// SPDX-License-Identifier: BSD-3-Clause
// One step of a state model, from a row of a record to the next: the classical Runge-Kutta method
// of fourth order, or next() of a model in discrete time.
#pragma once

#include <limits>
#include <span>
#include <utility>

#include "sepcal/detail/states/inputs_between_rows.hpp"
#include "sepcal/states/state_model.hpp"

namespace sepcal {

/// What a record says to a state model at one row.
template <StateModel M, class Scalar = double>
struct StateRow {
  Scalar time = std::numeric_limits<Scalar>::quiet_NaN();  // s
  Vec<Scalar, StateSizes<M>::n_u> u;
  Vec<Scalar, StateSizes<M>::n_x> measured;  // of the states that are measured, not integrated
};

/// Two rows that follow each other, and what is assumed of the time between them.
template <StateModel M, class Scalar = double>
class Between {
 public:
  static constexpr int n_u = StateSizes<M>::n_u;
  static constexpr int n_x = StateSizes<M>::n_x;

  /// `measured`: the places of the states that are measured. All of them must outlive this.
  Between(const StateRow<M, Scalar>& from, const StateRow<M, Scalar>& to, InputsBetweenRows inputs,
          std::span<const int> measured)
      : from_(from), to_(to), inputs_(inputs), measured_(measured) {}

  Scalar duration() const { return to_.time - from_.time; }  // s

  /// u at a share of the duration, 0 to 1. Time itself goes on where the others are held.
  Vec<Scalar, n_u> u(Scalar share) const {
    constexpr int time = place_of("time", M::inputs);
    Vec<Scalar, n_u> result = from_.u;
    if (inputs_ == InputsBetweenRows::linear) result += share * (to_.u - from_.u);
    if constexpr (time >= 0) result[time] = from_.time + share * duration();
    return result;
  }

  /// Puts the measured states, as they are at a share of the duration, in their places; their
  /// derivatives are zero.
  template <class T>
  void put_measured(Vec<T, n_x>& x, Scalar share) const {
    if (inputs_ == InputsBetweenRows::hold) share = 0;
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
  const StateRow<M, Scalar>& from_;
  const StateRow<M, Scalar>& to_;
  InputsBetweenRows inputs_;
  std::span<const int> measured_;
};

namespace states {

/// Runge-Kutta steps from a row to the next by rate(x, share of the time between them).
template <class State, class Scalar, class Rate>
State integrate(const Rate& rate, State x, Scalar duration, int substeps) {
  const Scalar share = Scalar(1) / static_cast<Scalar>(substeps);
  const Scalar dt = share * duration;
  const Scalar half = Scalar(0.5) * dt;
  for (int i = 0; i < substeps; ++i) {
    const Scalar s = static_cast<Scalar>(i) * share;
    const State k1 = rate(x, s);
    const State k2 = rate(x + half * k1, s + Scalar(0.5) * share);
    const State k3 = rate(x + half * k2, s + Scalar(0.5) * share);
    const State k4 = rate(x + dt * k3, s + share);
    x += (dt / 6) * (k1 + Scalar(2) * k2 + Scalar(2) * k3 + k4);
  }
  return x;
}

}  // namespace states

/// x at the later row. T is double, or a dual number: its derivatives are then those of this very
/// step. Not finite where the model isn't.
template <StateModel M, class T, class Scalar>
Vec<T, StateSizes<M>::n_x> step(const M& model, Vec<T, StateSizes<M>::n_x> x,
                                const Vec<T, StateSizes<M>::n_p>& p,
                                const Between<M, Scalar>& between, int substeps) {
  using State = Vec<T, StateSizes<M>::n_x>;
  if constexpr (is_discrete<M>()) {
    x = State(model.next(x, between.u(Scalar(0)), p));
  } else {
    const auto rate = [&](State at, Scalar s) -> State {
      between.put_measured(at, s);
      return model.rate(at, between.u(s), p);
    };
    x = states::integrate<State>(rate, std::move(x), between.duration(), substeps);
  }
  between.put_measured_at_end(x);
  return x;
}

}  // namespace sepcal
