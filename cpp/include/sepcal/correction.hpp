// SPDX-License-Identifier: BSD-3-Clause
// A calibration at work on board, sample by sample: readings in, corrected readings out, with every
// effect that was composed to the model (static_composition.hpp). The same corrections as apply()
// makes of a log: what acts on the reference alone, the wind or the attitude, is none of them.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <string_view>

#include "sepcal/dual.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/states/triangle.hpp"
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
  refused,        // a reading or a driver is not a number, or a pressure is below zero
  not_converged,  // the field was not found, or the sensor's matrix is singular
};

/// NaN where the status is not ok; `not_converged` has the last step's.
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

/// The model without its input corrections: xi2 begins with its parameters.
template <class M>
const auto& without_corrections(const M& model) {
  if constexpr (composing::is_corrected<M>) {
    return without_corrections(model.model);
  } else {
    return model;
  }
}

/// xi1 without what is the wind's: its components, and what effects add to it.
template <class M, class Scalar>
Vec<Scalar, Sizes<M>::n_1> without_wind(Vec<Scalar, Sizes<M>::n_1> xi1) {
  for (int k = 0; k < Sizes<M>::n_1; ++k) {
    const std::string_view name = M::linear[static_cast<std::size_t>(k)].name;
    if (name.starts_with("w_") || name.starts_with("wind[")) xi1[k] = Scalar(0);
  }
  return xi1;
}

}  // namespace correcting

/// A magnetometer's: h of m = C h + n + effects, from what it reads, m (uT), and the drivers in u,
/// of which the field's own places are not read.
template <class M, class Scalar>
  requires correcting::Of<M, Magnetometer>
CorrectedField<Scalar> correct(const Calibrated<M, Scalar>& calibrated, const Vec<Scalar, 3>& m,
                               const Vec<Scalar, Sizes<M>::n_u>& u,
                               const FieldIteration& options = {}) {
  using Number = Dual<Scalar, 3>;
  const auto& model = correcting::without_corrections(calibrated.model);
  using Inner = std::remove_cvref_t<decltype(model)>;
  constexpr Scalar digits_lost = 8;
  constexpr std::array field{place_of("hx", M::inputs), place_of("hy", M::inputs),
                             place_of("hz", M::inputs)};
  const Vec<Number, Sizes<Inner>::n_2> xi2 =
      calibrated.xi2.template head<Sizes<Inner>::n_2>().template cast<Number>();
  Vec<Scalar, 3> h = Vec<Scalar, 3>::Zero();
  CorrectedField<Scalar> result;
  for (result.iterations = 1; result.iterations <= options.iterations; ++result.iterations) {
    Vec<Number, Sizes<M>::n_u> at = u.template cast<Number>();
    for (int i = 0; i < 3; ++i) at[field[static_cast<std::size_t>(i)]] = Number(h[i], i);
    const auto [A, b] = model.at(composing::select<M, Inner>(at), xi2);
    Vec<Scalar, 3> missing = m;
    Eigen::Matrix<Scalar, 3, 3> slope;
    for (int i = 0; i < 3; ++i) {
      Number z = b[i];
      for (int k = 0; k < Sizes<Inner>::n_1; ++k) z += A(i, k) * calibrated.xi1[k];
      missing[i] -= z.value();
      slope.row(i) = z.slopes().transpose();
    }
    if (!missing.allFinite() || !slope.allFinite()) return result;
    const Vec<Scalar, 3> step = states::solve_square(slope, missing);
    result.status = CorrectionStatus::not_converged;
    if (!step.allFinite()) return result;
    h += step;
    result.h = h;
    const Scalar least = static_cast<Scalar>(options.tolerance) +
                         digits_lost * states::rounding<Scalar> * h.cwiseAbs().maxCoeff();
    if (step.cwiseAbs().maxCoeff() <= least) {
      result.status = CorrectionStatus::ok;
      return result;
    }
  }
  --result.iterations;
  return result;
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

/// A five-hole probe's, from the pressures and drivers in u; attitude and rates in u are not read.
template <class M, class Scalar>
  requires correcting::Of<M, FiveHoleProbe>
CorrectedAir<Scalar> correct(const Calibrated<M, Scalar>& calibrated,
                             const Vec<Scalar, Sizes<M>::n_u>& u) {
  return composing::behind_corrections(
      calibrated.model, u, calibrated.xi2, [&](const auto& model, auto inner, const auto& xi2) {
        using Inner = std::remove_cvref_t<decltype(model)>;
        using std::asin;
        using std::atan2;
        // In still air and level, at rest: what is left is the air, in body axes.
        for (const char* name : {"roll", "pitch", "yaw", "p", "q", "r"})
          inner[place_of(name, Inner::inputs)] = Scalar(0);
        const auto [A, b] = model.at(inner, xi2);
        const Vec<Scalar, 3> air =
            b + states::product(A, correcting::without_wind<Inner, Scalar>(calibrated.xi1));
        CorrectedAir<Scalar> result;
        if (!air.allFinite()) return result;
        result.airspeed = air.norm();
        result.alpha = atan2(air[2], air[0]);
        result.beta = result.airspeed > 0 ? asin(air[1] / result.airspeed) : Scalar(0);
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
  return composing::behind_corrections(
      calibrated.model, u, calibrated.xi2, [&](const auto& model, const auto& inner, const auto&) {
        using Inner = std::remove_cvref_t<decltype(model)>;
        using std::isfinite;
        using std::sqrt;
        const Scalar met = (z - calibrated.xi1[1]) / calibrated.xi1[0];
        const Scalar offset = 2 * inner[place_of("pressure_offset", Inner::inputs)] /
                              inner[place_of("rho", Inner::inputs)];
        const Scalar undisturbed = offset == Scalar(0) ? met : sqrt(met * met + offset);
        const Scalar airspeed =
            undisturbed * (1 + inner[place_of("airspeed_scale", Inner::inputs)]) +
            inner[place_of("airspeed_bias", Inner::inputs)];
        if (!isfinite(airspeed)) return CorrectedAirspeed<Scalar>{};
        return CorrectedAirspeed<Scalar>{CorrectionStatus::ok, airspeed};
      });
}

}  // namespace sepcal
