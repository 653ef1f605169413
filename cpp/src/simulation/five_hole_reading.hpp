// SPDX-License-Identifier: BSD-3-Clause
// What a simulated five-hole probe reports in the air that it meets: the readings whose correction,
// hidden effects and all, gives that air.
#pragma once

#include <Eigen/Core>

#include "simulation/hidden_effects.hpp"
#include "simulation/small_aircraft.hpp"

namespace sepcal::simulation {

/// Where effects enter a five-hole probe's flight.
const HiddenCatalogue& five_hole_effects();

struct FiveHoleReading {
  double total;           // pt [Pa]
  double fixed;           // ps [Pa]
  double alpha_pressure;  // dpa [Pa]
  double beta_pressure;   // dpb [Pa]
  double alpha;           // as read, dpa / (K_alpha (pt - ps)) [rad]
  double beta;            // as read [rad]
};

class FiveHoleReader {
 public:
  /// Both must outlive the reader.
  FiveHoleReader(const FiveHoleTruth& truth, const HiddenEffects& hidden)
      : truth_(truth), hidden_(hidden) {}

  /// `now` has the aircraft's sources, then room for alpha and beta, which don't matter. Throws
  /// Error where there is nothing to read, and where no reading corrects to the air met.
  FiveHoleReading read(const AircraftState& state, const Moment& now) const;

 private:
  double parameter(const char* name) const { return truth_.parameters.at(name); }

  /// Airspeed, alpha and beta of the air, probe axes [m/s, rad, rad].
  Eigen::Vector3d meet_air(const AircraftState& state) const;

  /// The same from what is read: sqrt(2 (pt - ps)/rho), alpha, beta.
  Eigen::Vector3d correct(const Eigen::Vector3d& read, const AircraftState& state,
                          Moment& now) const;

  /// What is read, (3), so that correct() gives `met`, from a reading near by.
  Eigen::Vector3d solve(const Eigen::Vector3d& near, const Eigen::Vector3d& met,
                        const AircraftState& state, Moment now) const;

  const FiveHoleTruth& truth_;
  const HiddenEffects& hidden_;
};

/// sqrt(1.4 ps/rho) M over sqrt(2 impact/rho), less 1: how much faster the air is than it would be
/// if it could not be compressed. `speed` is sqrt(2 impact/rho) [m/s].
double compressible_excess(double speed, const Air& air);

}  // namespace sepcal::simulation
