// SPDX-License-Identifier: BSD-3-Clause
// Flights reduced to triangles, and what fleets of them say, as Python sees it.
#include "sepcal/fleet.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <cmath>
#include <tuple>
#include <utility>

#include "bindings.hpp"
#include "fleet/spread.hpp"
#include "numerics/tails.hpp"
#include "released.hpp"
#include "sepcal/flight/flight_factor.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

/// Name, vehicle, factor, attributes.
using Given = std::tuple<std::string, std::string, FlightFactor, std::map<std::string, double>>;

std::vector<FleetFlight> flights_of(const std::vector<Given>& given) {
  std::vector<FleetFlight> flights;
  for (const auto& [name, vehicle, factor, attributes] : given) {
    flights.push_back({name, vehicle, factor, attributes});
  }
  return flights;
}

/// Effect, coefficient, unit of each, and whether it stands in for another.
using Columns = std::vector<std::tuple<std::string, std::string, std::string, bool>>;

Columns columns_of(const FlightFactor& factor) {
  Columns columns;
  for (const CandidateColumn& one : factor.columns) {
    columns.emplace_back(one.effect, one.name, one.unit, one.stands_in);
  }
  return columns;
}

void set_columns(FlightFactor& factor, const Columns& columns) {
  factor.columns.clear();
  for (const auto& [effect, name, unit, stands_in] : columns) {
    factor.columns.push_back({effect, name, unit, stands_in});
  }
}

/// {coefficient: (estimate, standard error, unit)}
using ByName = std::map<std::string, std::tuple<double, double, std::string>>;

ByName coefficients_of(const FleetFinding& finding) {
  ByName all;
  for (const Coefficient& one : finding.coefficients) {
    all[one.name] = {one.estimate, one.standard_error, one.unit};
  }
  return all;
}

void set_coefficients(FleetFinding& finding, const ByName& all) {
  finding.coefficients.clear();
  for (const auto& [name, told] : all) {
    const auto& [estimate, error, unit] = told;
    finding.coefficients.push_back({name, unit, estimate, error});
  }
}

void define_results_of_fleets(py::module_& module) {
  BoundStruct<FlightFactor>(
      module, "FlightFactor",
      "A flight at a point, in units of its own residual, its own parameters projected out.")
      .field("parameters", &FlightFactor::parameters, "p names.")
      .field("units", &FlightFactor::units, "")
      .field("values", &FlightFactor::values, "Where it was linearised (p).")
      .field("columns", &columns_of, &set_columns,
             "(effect, coefficient, unit, whether it stands in for another cause) of each, c.")
      .field("triangle", &FlightFactor::triangle,
             "[parameters | columns | residual], upper, (p + c + 1) square.")
      .field("inflation", &FlightFactor::inflation,
             "Of variances, where the flight's noise has a memory (p).")
      .field("whitened", &FlightFactor::whitened,
             "[parameters | residual], less what a noise with a memory foretells; or empty.")
      .field("readings", &FlightFactor::readings, "Behind it, less the flight's own parameters.")
      .field("own", &FlightFactor::own, "Estimates of the flight's own parameters.")
      .field("centres", &FlightFactor::centres, "By effect, of what its driver goes about.")
      .field("rmse", &FlightFactor::rmse, "Over all outputs, at the point.")
      .finish();
  BoundStruct<VehicleFit>(module, "VehicleFit", "A vehicle's parameters from all its flights.")
      .field("vehicle", &VehicleFit::vehicle, "")
      .field("flights", &VehicleFit::flights, "How many.")
      .field("values", &VehicleFit::values, "NaN where its flights do not tell.")
      .field("inflation", &VehicleFit::inflation,
             "Of variances, as its flights' noise models have it (p).")
      .field("covariance", &VehicleFit::covariance, "As the noise models have it.")
      .field("jackknife", &VehicleFit::jackknife,
             "By leaving out a flight each; NaN for fewer than three.")
      .field("misfit", &VehicleFit::misfit, "-2 ln L at the estimates.")
      .field("readings", &VehicleFit::readings, "")
      .finish();
  BoundStruct<Population>(module, "Population", "How parameters spread over vehicles.")
      .field("parameters", &Population::parameters, "p names.")
      .field("mean", &Population::mean, "")
      .field("mean_covariance", &Population::mean_covariance, "")
      .field("spread", &Population::spread, "Covariance between vehicles (p x p).")
      .field("inflation", &Population::inflation,
             "By what variances exceed those of the noise models (p).")
      .field("log_likelihood", &Population::log_likelihood, "Restricted, up to a constant.")
      .field("vehicles", &Population::vehicles, "")
      .field("shrunken", &Population::shrunken, "Predictions (p x vehicles).")
      .field("shrunken_errors", &Population::shrunken_errors, "Their standard errors.")
      .field("converged", &Population::converged, "")
      .finish();
  BoundStruct<VehicleSeries>(module, "VehicleSeries",
                             "A vehicle's parameters from flight to flight.")
      .field("vehicle", &VehicleSeries::vehicle, "")
      .field("flights", &VehicleSeries::flights, "n names, in their order.")
      .field("values", &VehicleSeries::values, "Of each flight alone (p x n).")
      .field("errors", &VehicleSeries::errors, "Their standard errors (p x n).")
      .field("inflation", &VehicleSeries::inflation,
             "By what flights scatter, in errors of the noise models.")
      .field("change", &VehicleSeries::change, "So many flights are before the likeliest change.")
      .field("log10_p", &VehicleSeries::log10_p, "Of no change, for the places tried.")
      .field("p_adjusted", &VehicleSeries::p_adjusted, "For the number of vehicles too.")
      .field("parameter", &VehicleSeries::parameter, "That changes by most of its errors.")
      .field("before", &VehicleSeries::before, "")
      .field("after", &VehicleSeries::after, "")
      .field("standard_error", &VehicleSeries::standard_error, "Of the difference.")
      .finish();
  BoundStruct<FleetFinding>(module, "FleetFinding", "What a fleet says of a candidate.")
      .field(
          "cause", [](const FleetFinding& self) { return std::string(to_string(self.cause)); },
          [](FleetFinding& self, const std::string& word) {
            self.cause = choice_of<FleetCause>("cause", word);
          },
          R"("everywhere", "grows", "one-vehicle" or "differs".)")
      .field("effect", &FleetFinding::effect, "")
      .field("vehicle", &FleetFinding::vehicle, "Of one; else empty.")
      .field("coefficients", &coefficients_of, &set_coefficients,
             "{coefficient: (estimate, standard error, unit)}; of what differs the mean.")
      .field("spread", &FleetFinding::spread, "Of what differs: standard deviations.")
      .field("log10_p", &FleetFinding::log10_p, "For itself.")
      .field("p_adjusted", &FleetFinding::p_adjusted, "For the number of tests.")
      .field("drop", &FleetFinding::drop, "Of the misfit (-2 ln L), as the noise models have it.")
      .field("share", &FleetFinding::share, "Of the fleet's misfit, or of its one vehicle's.")
      .field("found", &FleetFinding::found, "")
      .field("as_good", &FleetFinding::as_good, "Effects that explain as much in its place.")
      .field("stands_in", &FleetFinding::stands_in, "Its channel can't be the cause there.")
      .finish();
  BoundStruct<FleetDiagnosis>(module, "FleetDiagnosis", "What a fleet lacks.")
      .field("found", &FleetDiagnosis::found, "In the order in which they were added.")
      .field("others", &FleetDiagnosis::others, "Beside those, best first.")
      .field("vehicles", &FleetDiagnosis::vehicles, "")
      .field("flights", &FleetDiagnosis::flights, "")
      .field("tests", &FleetDiagnosis::tests, "")
      .field("misfit_before", &FleetDiagnosis::misfit_before, "Per reading, over all flights.")
      .field("misfit_after", &FleetDiagnosis::misfit_after, "With all that was found.")
      .field("flights_before", &FleetDiagnosis::flights_before, "Per reading, of each flight.")
      .field("flights_after", &FleetDiagnosis::flights_after, "")
      .field("notes", &FleetDiagnosis::notes, "")
      .copied()
      .finish();
}

/// A flight calibrated with the options of another calibration, but for where that began.
Calibration calibrate_like(const Calibration& base, const Flight& flight) {
  CalibrationOptions options = base.options;
  options.fit.start.clear();
  options.fit.threads = 1;
  const Released released;
  return calibrate(base.probe, flight, options);
}

}  // namespace

void define_fleet(py::module_& module) {
  define_results_of_fleets(module);
  module.def("calibrate_like", &calibrate_like);
  module.def("list_fleet_candidates", &list_fleet_candidates, WithoutGil());
  module.def(
      "reduce",
      [](const Calibration& calibration, const Flight& flight, std::vector<std::string> own,
         std::map<std::string, double> at, std::vector<std::string> candidates,
         std::map<std::string, double> centres) {
        return reduce(calibration, flight,
                      {std::move(own), std::move(at), std::move(candidates), std::move(centres)});
      },
      WithoutGil());
  module.def("with_rate", &with_rate, WithoutGil());
  module.def(
      "fit_vehicles",
      [](const std::vector<Given>& flights, const std::vector<std::string>& common) {
        return fit_vehicles(flights_of(flights), common);
      },
      py::arg("flights"), py::arg("common") = std::vector<std::string>{}, WithoutGil());
  module.def(
      "fit_population",
      [](const std::vector<Given>& flights, bool correlated, Eigen::VectorXd inflation,
         std::vector<std::string> common) {
        return fit_population(flights_of(flights),
                              {correlated, std::move(inflation), std::move(common)});
      },
      py::arg("flights"), py::arg("correlated"), py::arg("inflation"),
      py::arg("common") = std::vector<std::string>{}, WithoutGil());
  module.def("find_spread",
             [](const std::vector<double>& estimates, const std::vector<double>& variances) {
               const fleet::Spread spread = fleet::find_spread(estimates, variances);
               return std::tuple(spread.mean, spread.standard_error, spread.variance);
             });
  module.def("p_of_distance", [](double errors, double freedom) {
    return std::pow(10.0, numerics::log10_f_tail(errors * errors, 1.0, freedom));
  });
  module.def(
      "follow_vehicles",
      [](const std::vector<Given>& flights, const std::vector<std::string>& common) {
        return follow_vehicles(flights_of(flights), common);
      },
      py::arg("flights"), py::arg("common") = std::vector<std::string>{}, WithoutGil());
  module.def(
      "diagnose_fleet",
      [](const std::vector<Given>& flights, double significance, int most,
         std::vector<std::string> common) {
        return diagnose(flights_of(flights), {significance, most, std::move(common)});
      },
      py::arg("flights"), py::arg("significance"), py::arg("most"),
      py::arg("common") = std::vector<std::string>{}, WithoutGil());
}

}  // namespace sepcal::bindings
