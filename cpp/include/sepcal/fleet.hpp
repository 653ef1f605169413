// SPDX-License-Identifier: BSD-3-Clause
// Many flights of many vehicles, and what they say together: an effect too small for any one of
// them, a vehicle that has one, how parameters spread over vehicles. A flight is reduced once, in
// units of its own noise, to the triangle T of [parameters | candidates | residual], T'T = rows'
// rows; all that follows is linear algebra on triangles, and the data never move.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/choices.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal {

/// A coefficient of a candidate effect, a column of a flight's triangle.
struct CandidateColumn {
  std::string effect;  // "bias[temp_degc]"
  std::string name;    // of the coefficient; the effect's where it has one alone
  std::string unit;
  bool stands_in = false;  // it follows a channel that can't be the cause at its port

  friend bool operator==(const CandidateColumn&, const CandidateColumn&) = default;
};

/// A flight at a point, in units of its own residual, its own parameters projected out. To first
/// order |T [theta - values; gamma; -1]|^2 is its misfit (-2 ln L, as white noise has it) with
/// parameters theta and candidates' coefficients gamma.
struct FlightFactor {
  std::vector<std::string> parameters = {};   // p, without those of the flight alone
  std::vector<std::string> units = {};        // p
  Eigen::VectorXd values = {};                // p, where it was linearised
  std::vector<CandidateColumn> columns = {};  // c
  Eigen::MatrixXd triangle = {};              // (p + c + 1)^2, upper
  /// p: by what variances exceed those of white noise, where the flight's noise has a memory;
  /// empty: by nothing.
  Eigen::VectorXd inflation = {};
  /// [parameters | residual] (p + 1)^2, each row less what those before it foretell of its noise;
  /// empty where that is not known.
  Eigen::MatrixXd whitened = {};
  double readings = 0.0;                       // behind it, less own parameters
  std::map<std::string, double> own = {};      // estimates of the flight's own, at `values`
  std::map<std::string, double> centres = {};  // of drivers that go about one: effect's, by name
  double rmse = not_a_number;  // over all outputs, at the point, in their unit where they have one
};

/// How a flight is reduced.
struct ReduceOptions {
  std::vector<std::string> own = {};         // parameters of the flight alone
  std::map<std::string, double> at = {};     // of others; what is not named stays as it was fitted
  std::vector<std::string> candidates = {};  // linear ones; what the flight can't make is left out
  std::map<std::string, double> centres = {};  // by effect, in place of the flight's mean
};

/// Throws Error for a fit whose parameters are not those of its model, an unknown name, and a
/// flight that is not finite at the point.
FlightFactor reduce(const DiagnosedFit& fitted, const ReduceOptions& options);

/// With one parameter more, the rate at which `parameter` grows with an attribute that is
/// `distance` from its mean in this flight, called "parameter[attribute]" and 0 where it was
/// linearised. Throws Error for an unknown parameter.
FlightFactor with_rate(const FlightFactor& factor, const std::string& parameter,
                       const std::string& attribute, double distance);

/// A flight of a fleet.
struct FleetFlight {
  std::string name;
  std::string vehicle;  // or whatever shares one set of parameters
  FlightFactor factor;
  std::map<std::string, double> attributes = {};  // "age_days"; a number each
};

/// A vehicle's parameters from all its flights.
struct VehicleFit {
  std::string vehicle;
  std::size_t flights = 0;
  Eigen::VectorXd values = {};      // p; NaN where its flights do not tell
  Eigen::VectorXd inflation = {};   // p: of variances, as its flights' noise models have it
  Eigen::MatrixXd covariance = {};  // p x p, (R'R)^-1 with that
  Eigen::MatrixXd jackknife = {};   // p x p, by leaving out a flight each; NaN for fewer than three
  double misfit = 0.0;              // -2 ln L, a chi-squared of `readings` less what was estimated
  double readings = 0.0;
};

/// Each vehicle by itself, in the order in which they come; `common` parameters have one value for
/// the fleet, with an error of all vehicles. Throws Error for flights whose parameters differ, for
/// a common one that is none of them, and where none is left to the vehicles.
std::vector<VehicleFit> fit_vehicles(const std::vector<FleetFlight>& flights,
                                     const std::vector<std::string>& common = {});

/// How parameters spread over vehicles: theta_v = mean + b_v, b_v ~ N(0, spread).
struct Population {
  std::vector<std::string> parameters = {};  // p
  Eigen::VectorXd mean = {};                 // p
  Eigen::MatrixXd mean_covariance = {};      // p x p
  Eigen::MatrixXd spread = {};               // p x p, diagonal where they are taken as independent
  Eigen::VectorXd inflation = {};  // p: by what noise models fall short, a factor of variances
  double log_likelihood = 0.0;     // restricted, up to a constant
  std::vector<std::string> vehicles = {};
  Eigen::MatrixXd shrunken = {};         // p x vehicles, best linear unbiased predictions
  Eigen::MatrixXd shrunken_errors = {};  // p x vehicles, their standard errors
  bool converged = false;
};

/// What a population is taken to be.
struct PopulationOptions {
  bool correlated = false;  // a full spread; else a diagonal one
  /// By what the noise models' variances are multiplied (p); empty: as leaving out flights has it,
  /// over all vehicles.
  Eigen::VectorXd inflation = {};
  std::vector<std::string> common = {};  // parameters that the fleet shares: their spread is none
};

/// By restricted maximum likelihood on the vehicles' triangles (Patterson & Thompson 1971;
/// Lindstrom & Bates 1988): with q_v = R_v theta_v + e, e ~ N(0, 1), q_v ~ N(R_v mean, 1 + R_v
/// spread R_v'). Throws Error for fewer than three vehicles.
Population fit_population(const std::vector<FleetFlight>& flights,
                          const PopulationOptions& options = {});

/// A vehicle's parameters from flight to flight, and where they change for good.
struct VehicleSeries {
  std::string vehicle = {};
  std::vector<std::string> flights = {};  // n, as they were given
  Eigen::MatrixXd values = {};            // p x n, of each flight alone; NaN where it does not tell
  Eigen::MatrixXd errors = {};            // p x n, as its noise model has it, times `inflation`
  double inflation = 1.0;                 // root of what flights scatter by, in those errors
  std::size_t change = 0;                 // the likeliest: so many flights are before it
  double log10_p = 0.0;        // of no change: F of the likeliest, times the places tried
  double p_adjusted = 1.0;     // for the number of vehicles too
  std::string parameter = {};  // that changes by most of its errors
  double before = not_a_number;
  double after = not_a_number;
  double standard_error = not_a_number;  // of the difference
};

/// Each vehicle's flights in their order. F compares what two sets of parameters take of the misfit
/// with how flights scatter within each (Page 1955; Quandt 1958). Fewer than four flights show no
/// change. `common` parameters are held at the fleet's value and not followed. Throws Error as
/// fit_vehicles() does.
std::vector<VehicleSeries> follow_vehicles(const std::vector<FleetFlight>& flights,
                                           const std::vector<std::string>& common = {});

/// Where a missing effect is.
enum class FleetCause {
  everywhere,  // one coefficient for the fleet
  grows,       // a parameter that changes with an attribute of flights, at one rate for the fleet
  one_vehicle,
  differs  // each vehicle has its own coefficient
};

template <>
struct ChoiceNames<FleetCause> {
  static constexpr std::array<std::string_view, 4> names{"everywhere", "grows", "one-vehicle",
                                                         "differs"};
};

/// What the fleet says about one candidate in one place. Undefined numbers are NaN.
struct FleetFinding {
  FleetCause cause = FleetCause::everywhere;
  std::string effect = {};                     // "bias[temp_degc]"; that grows: "s_va[age_days]"
  std::string vehicle = {};                    // of one
  std::vector<Coefficient> coefficients = {};  // that differ: their mean and its error
  std::vector<double> spread = {};             // that differ: standard deviation between vehicles
  double log10_p = 0.0;
  double p_adjusted = 1.0;  // after Bonferroni, for all that was asked of its cause
  double drop = 0.0;        // of the misfit (-2 ln L), as noise models have it
  double share = 0.0;  // of the misfit that this takes: of the fleet's, or of the one vehicle's
  bool found = false;
  bool stands_in = false;                 // for what can be the cause, by its channel
  std::vector<std::string> as_good = {};  // that of the fleet takes as much in its place: -2 ln L
                                          // within 9.2
};

/// What a fleet lacks, and what is left with it.
struct FleetDiagnosis {
  std::vector<FleetFinding> found = {};   // in the order in which they were added
  std::vector<FleetFinding> others = {};  // beside those: the surest of each candidate, best first
  std::size_t vehicles = 0;
  std::size_t flights = 0;
  std::size_t tests = 0;
  double misfit_before = 0.0;               // over all flights, per reading
  double misfit_after = 0.0;                // with all that was found
  std::vector<double> flights_before = {};  // per reading, in the order of the flights
  std::vector<double> flights_after = {};
  std::vector<std::string> notes = {};
};

/// How a fleet is diagnosed.
struct FleetDiagnosisOptions {
  double significance = 0.01;  // for the fleet, after correction, shared among the causes
  int most = 8;                // findings
  /// Parameters that the fleet shares. Whether one differs in a vehicle or between vehicles is
  /// asked as of candidates.
  std::vector<std::string> common = {};
};

/// Tests every candidate of the triangles and every parameter's growth with an attribute, each
/// vehicle having parameters of its own; adds the surest and asks again beside it. Errors are those
/// of the scatter between vehicles or flights, never less than the noise models': noise that
/// wanders in each flight makes nothing significant. Throws Error as fit_vehicles() does and for
/// fewer than three flights.
FleetDiagnosis diagnose(const std::vector<FleetFlight>& flights,
                        const FleetDiagnosisOptions& options = {});

}  // namespace sepcal
