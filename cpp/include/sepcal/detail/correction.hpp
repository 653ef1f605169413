// SPDX-License-Identifier: BSD-3-Clause
// A calibration at work on board, sample by sample: readings in, corrected readings out, with every
// effect that was composed to the model (static_composition.hpp). The same corrections as apply()
// makes of a log: what acts on the reference alone, the wind or the attitude, is none of them.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <string_view>

#include "sepcal/detail/dual.hpp"
#include "sepcal/detail/states/triangle.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/static_composition.hpp"

namespace sepcal {

/// A model, with its effects, and its parameters, in the order of its tables: NaN until they are
/// set.
template <SeparableModel M, class Scalar = double>
struct Calibrated {
  static constexpr Scalar unknown = std::numeric_limits<Scalar>::quiet_NaN();

  M model;
  Vec<Scalar, Sizes<M>::n_1> xi1 = Vec<Scalar, Sizes<M>::n_1>::Constant(unknown);
  Vec<Scalar, Sizes<M>::n_2> xi2 = Vec<Scalar, Sizes<M>::n_2>::Constant(unknown);

  /// Sets a parameter by its name. False where the model has none of that name.
  bool set(std::string_view name, Scalar value) {
    const int linear = place_of(name, M::linear);
    const int nonlinear = place_of(name, M::nonlinear);
    if (linear >= 0) xi1[linear] = value;
    if (nonlinear >= 0) xi2[nonlinear] = value;
    return linear >= 0 || nonlinear >= 0;
  }
};

enum class CorrectionStatus {
  ok,
  refused,        // a number is missing that it takes, or a pressure is not above zero
  not_converged,  // the field was not found, or the sensor's matrix is singular
};

/// NaN where the status is not ok.
template <class Scalar>
struct CorrectedField {
  CorrectionStatus status = CorrectionStatus::refused;
  Vec<Scalar, 3> h = Vec<Scalar, 3>::Constant(std::numeric_limits<Scalar>::quiet_NaN());  // uT
  int iterations = 0;
};

template <class Scalar>
struct CorrectedAir {
  CorrectionStatus status = CorrectionStatus::refused;
  Scalar airspeed = std::numeric_limits<Scalar>::quiet_NaN();  // true, m/s
  Scalar alpha = std::numeric_limits<Scalar>::quiet_NaN();     // rad, body axes, at the probe
  Scalar beta = std::numeric_limits<Scalar>::quiet_NaN();      // rad
};

template <class Scalar>
struct CorrectedAirspeed {
  CorrectionStatus status = CorrectionStatus::refused;
  Scalar airspeed = std::numeric_limits<Scalar>::quiet_NaN();  // true, m/s
};

/// Of Newton's steps for a field: the first is exact where every effect is linear in it.
struct FieldIteration {
  int iterations = 20;      // at most
  double tolerance = 1e-9;  // a step's largest component <= tolerance, uT, or what rounds in h
};

namespace correcting {

template <class M, class Base>
concept Of = std::same_as<typename composing::BaseOf<M>::Type, Base>;

/// xi1 without what is not the probe's: the wind and what follows it, an arm.
template <class M, class Scalar>
Vec<Scalar, Sizes<M>::n_1> of_probe(Vec<Scalar, Sizes<M>::n_1> xi1) {
  constexpr auto others = [] {
    std::array<bool, M::linear.size()> found{};
    for (std::size_t k = 0; k < found.size(); ++k) {
      const std::string_view name = M::linear[k].name;
      found[k] =
          name.starts_with("w_") || name.starts_with("wind[") || name.starts_with("lever_arm.");
    }
    return found;
  }();
  for (int k = 0; k < Sizes<M>::n_1; ++k) {
    if (others[static_cast<std::size_t>(k)]) xi1[k] = Scalar(0);
  }
  return xi1;
}

/// A and b of a five-hole probe that is level and doesn't turn, so that its velocity is the air's
/// in body axes; drivers, an angle or a rate among them, are as they are.
template <class Scalar>
Affine<Scalar, 3, 5> level(const FiveHoleProbe& probe, Vec<Scalar, 14> u,
                           const Vec<Scalar, 5>& xi2) {
  u.template head<6>().setZero();
  return probe.at(u, xi2);
}
template <class Scalar, class M, class E>
auto level(const Composed<M, E>& model, const Vec<Scalar, Sizes<Composed<M, E>>::n_u>& u,
           const Vec<Scalar, Sizes<Composed<M, E>>::n_2>& xi2) {
  constexpr int own = Sizes<M>::n_2;
  const Vec<Scalar, own> of_model = xi2.template head<own>();
  const Vec<Scalar, Sizes<Composed<M, E>>::n_2 - own> of_effect =
      xi2.template tail<Sizes<Composed<M, E>>::n_2 - own>();
  return model.template join<Scalar, Scalar>(
      level<Scalar>(model.model, composing::select<Composed<M, E>, M>(u), of_model), u, of_effect);
}

}  // namespace correcting

/// A magnetometer's: h of m = C h + n + effects, from what it reads, m (uT), and the drivers in u,
/// of which the field's own places are not read.
template <class M, class Scalar>
  requires correcting::Of<M, Magnetometer>
CorrectedField<Scalar> correct(const Calibrated<M, Scalar>& calibrated, const Vec<Scalar, 3>& m,
                               const Vec<Scalar, Sizes<M>::n_u>& u,
                               const FieldIteration& options = {}) {
  const auto solve = [&](const auto& model, const auto& drivers, const auto& of_model) {
    using Inner = std::remove_cvref_t<decltype(model)>;
    using Number = Dual<Scalar, 3>;
    constexpr Scalar digits_lost = 8;
    constexpr std::array field{place_of("hx", Inner::inputs), place_of("hy", Inner::inputs),
                               place_of("hz", Inner::inputs)};
    const Vec<Number, Sizes<Inner>::n_2> xi2 = of_model.template cast<Number>();
    Vec<Number, Sizes<Inner>::n_u> at = drivers.template cast<Number>();
    Vec<Scalar, 3> h = Vec<Scalar, 3>::Zero();
    CorrectedField<Scalar> result;
    while (result.iterations < options.iterations) {
      ++result.iterations;
      for (int i = 0; i < 3; ++i) at[field[static_cast<std::size_t>(i)]] = Number(h[i], i);
      const auto [A, b] = model.at(at, xi2);
      Vec<Scalar, 3> missing = m;
      Eigen::Matrix<Scalar, 3, 3> slope;
      for (int i = 0; i < 3; ++i) {
        Number z = b[i];
        for (int k = 0; k < Sizes<Inner>::n_1; ++k) z += A(i, k) * calibrated.xi1[k];
        missing[i] -= z.value();
        slope.row(i) = z.slopes().transpose();
      }
      if (!missing.allFinite() || !slope.allFinite()) return CorrectedField<Scalar>{};
      const Vec<Scalar, 3> step = states::solve_square(slope, missing);
      result.status = CorrectionStatus::not_converged;
      if (!step.allFinite()) return result;
      h += step;
      const Scalar least = static_cast<Scalar>(options.tolerance) +
                           digits_lost * states::rounding<Scalar> * h.cwiseAbs().maxCoeff();
      if (step.cwiseAbs().maxCoeff() <= least) {
        result.status = CorrectionStatus::ok;
        result.h = h;
        return result;
      }
    }
    return result;
  };
  return composing::behind_corrections(calibrated.model, u, calibrated.xi2, solve);
}

/// A magnetometer's that was calibrated by the field's strength alone: h but for a rotation, from
/// what it reads and the drivers, all in u.
template <class M, class Scalar>
  requires correcting::Of<M, AttitudeIndependentMagnetometer>
CorrectedField<Scalar> correct(const Calibrated<M, Scalar>& calibrated,
                               const Vec<Scalar, Sizes<M>::n_u>& u) {
  return composing::behind_corrections(
      calibrated.model, u, calibrated.xi2,
      [](const auto& model, const auto& inner, const auto& xi2) {
        const auto row = std::remove_cvref_t<decltype(model)>::prepare(inner);
        Eigen::Matrix<Scalar, 3, 3> C =
            AttitudeIndependentMagnetometer::soft_iron_and_scale<Scalar>(xi2);
        C.diagonal() += row.scale;
        const Vec<Scalar, 3> r = row.m - xi2.template tail<3>();
        CorrectedField<Scalar> result;
        if (!r.allFinite() || !C.allFinite()) return result;
        result.h = states::solve_square(C, r);
        result.iterations = 1;
        result.status =
            result.h.allFinite() ? CorrectionStatus::ok : CorrectionStatus::not_converged;
        return result;
      });
}

/// A five-hole probe's, from the pressures and drivers in u; attitude and rates in u are read only
/// where they drive an effect.
template <class M, class Scalar>
  requires correcting::Of<M, FiveHoleProbe>
CorrectedAir<Scalar> correct(const Calibrated<M, Scalar>& calibrated,
                             const Vec<Scalar, Sizes<M>::n_u>& u) {
  return composing::behind_corrections(
      calibrated.model, u, calibrated.xi2,
      [&](const auto& model, const auto& seen, const auto& xi2) {
        using Inner = std::remove_cvref_t<decltype(model)>;
        using std::asin;
        using std::atan2;
        CorrectedAir<Scalar> result;
        constexpr int pt = place_of("pt", Inner::inputs);
        constexpr int ps = place_of("ps", Inner::inputs);
        constexpr int density = place_of("rho", Inner::inputs);
        const Scalar pressure = seen[pt] - seen[ps];
        const Scalar rho = seen[density];
        if (!(pressure > 0) || !(rho > 0) || !std::isfinite(rho)) return result;
        const auto [A, b] = correcting::level<Scalar>(model, seen, xi2);
        const Vec<Scalar, 3> air =
            b + states::product(A, correcting::of_probe<Inner, Scalar>(calibrated.xi1));
        if (!air.allFinite()) return result;
        // The column of b_va is where the air comes from; a bias may make the speed negative.
        const Scalar sign = air.dot(A.col(1)) < 0 ? Scalar(-1) : Scalar(1);
        result.airspeed = sign * air.norm();
        result.alpha = atan2(sign * air[2], sign * air[0]);
        result.beta = result.airspeed == Scalar(0) ? Scalar(0) : asin(air[1] / result.airspeed);
        result.status = CorrectionStatus::ok;
        return result;
      });
}

/// A Pitot-static tube's, from the airspeed z that it reads (m/s) and the drivers in u, of which
/// the velocities are not read.
template <class M, class Scalar>
  requires correcting::Of<M, PitotStatic>
CorrectedAirspeed<Scalar> correct(const Calibrated<M, Scalar>& calibrated, const Scalar& z,
                                  const Vec<Scalar, Sizes<M>::n_u>& u) {
  static_assert(Sizes<M>::n_1 == Sizes<PitotStatic>::n_1,
                "a term on a tube is not undone; let its ports follow a driver");
  return composing::behind_corrections(
      calibrated.model, u, calibrated.xi2, [&](const auto& model, const auto& inner, const auto&) {
        using Inner = std::remove_cvref_t<decltype(model)>;
        using std::isfinite;
        using std::sqrt;
        constexpr int scale = place_of("airspeed_scale", Inner::inputs);
        constexpr int bias = place_of("airspeed_bias", Inner::inputs);
        constexpr int pressure = place_of("pressure_offset", Inner::inputs);
        constexpr int rho = place_of("rho", Inner::inputs);
        const Scalar met = (z - calibrated.xi1[1]) / calibrated.xi1[0];
        const Scalar offset =
            inner[pressure] == Scalar(0) ? Scalar(0) : 2 * inner[pressure] / inner[rho];
        const Scalar undisturbed = offset == Scalar(0) ? met : sqrt(met * met + offset);
        const Scalar airspeed = undisturbed * (1 + inner[scale]) + inner[bias];
        if (!isfinite(airspeed)) return CorrectedAirspeed<Scalar>{};
        return CorrectedAirspeed<Scalar>{CorrectionStatus::ok, airspeed};
      });
}

}  // namespace sepcal
