// SPDX-License-Identifier: BSD-3-Clause
// Where a fit fails on a flight, as Python sees it.
#include "sepcal/flight/comparison.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "results.hpp"
#include "structs.hpp"

namespace sepcal::bindings {

void define_comparison(py::module_& module) {
  BoundStruct<Misfit>(module, "Misfit",
                      "One output over one stretch of a flight; NaN where there are too few rows.")
      .told()
      .comparable()
      .finish()
      .def_property_readonly("verdict", &verdict_on_noise,
                             "In words whether the residuals are noise.")
      .def_property_readonly(
          "is_white", &is_white,
          "Whether lag_one is within 3 / sqrt(rows), as noise alone is 369 times "
          "in 370.");

  BoundStruct<ChannelMisfit>(module, "ChannelMisfit",
                             "One output's residual against one channel of the flight.")
      .told()
      .comparable()
      .finish();

  BoundStruct<Window>(module, "Window", "A stretch of about a twentieth of the rows.")
      .told()
      .comparable()
      .finish();

  BoundStruct<Disturbance>(module, "Disturbance",
                           "By filter error: a noise that drives a state, in its own standard "
                           "deviations along the flight.\n\nStandard normal where the model is "
                           "right: beyond 3 in 0.27 % of the rows.")
      .field("noise", &Disturbance::noise, "Its size, of the fit.")
      .field("share_beyond", &Disturbance::share_beyond,
             "Share of the rows beyond 3; NaN of a noise that is none or at its floor.")
      .field("rows", &Disturbance::rows,
             "Length of the longest run beyond 3 sigma, in rows; 0 if none.")
      .field("first_s", &Disturbance::first_s, "")
      .field("last_s", &Disturbance::last_s, "")
      .field("peak", &Disturbance::peak, "The largest in it, with its sign.")
      .comparable()
      .finish();

  BoundStruct<OutputValidation>(module, "OutputValidation",
                                "How well a model follows an output over all rows.")
      .told()
      .comparable()
      .finish();

  BoundStruct<ReferenceMisfit>(
      module, "ReferenceMisfit",
      "A calibrated quantity against an independent sensor's column of the same log.")
      .told()
      .field("time", &ReferenceMisfit::time,
             "(N,) [s] of the rows in which both are there; row numbers where there is no time.")
      .field("difference", &ReferenceMisfit::difference, "(N,) calibrated - reference.")
      .field("against", &ReferenceMisfit::against, "(N,) the reference's values.")
      .finish();

  BoundStruct<Compared>(module, "Comparison", "A calibration against a flight.")
      .field("model", &Compared::comparison, &Comparison::model, "")
      .field(
          "file", [](const Compared& self) { return self.comparison.flight.file; },
          [](Compared& self, std::string file) { self.comparison.flight.file = std::move(file); },
          "File of the flight.")
      .field("status", &Compared::comparison, &Comparison::status,
             "Status of the calibration, repeated.")
      .field("message", &Compared::comparison, &Comparison::message, "")
      .field("overall", &Compared::comparison, &Comparison::overall, "One an output.")
      .field("where", &Compared::comparison, &Comparison::where,
             "Maneuver by maneuver, outputs within, in the flight's order.")
      .field("channels", &Compared::comparison, &Comparison::channels,
             "By share_smooth, largest first.")
      .field("windows", &Compared::comparison, &Comparison::windows,
             "The five worst in units of the fit's noise, worst first.")
      .array("time", &Compared::comparison, &Comparison::time, "(N,) [s], of every row used.")
      .field("residuals", &Compared::comparison, &Comparison::residuals,
             "(N, n_z), z - model; of a fit by filter error innovations.")
      .field("modelled", &Compared::comparison, &Comparison::modelled, "(N, n_z), z less them.")
      .field("method", &Compared::comparison, &Comparison::method,
             R"("output-error" or "filter-error".)")
      .field("sigma", &Compared::comparison, &Comparison::sigma,
             "By filter error and output: rms of innovations in the filter's standard deviations.")
      .field("disturbances", &Compared::comparison, &Comparison::disturbances,
             "By filter error, one a process noise.")
      .field("validation", &Compared::comparison, &Comparison::validation, "One an output.")
      .field("references", &Compared::comparison, &Comparison::references,
             "One a column that was given as `reference`.")
      .field("notes", &Compared::comparison, &Comparison::notes, "One line each, for people.")
      .field("json", &Compared::json, "")
      .field("text", &Compared::page, &Page::text, "The app's page, as print() shows it.")
      .field("explained", &Compared::page, &Page::explained,
             "The same with the whole message, as by the apps' --explain.")
      .copied()
      .finish();
}

}  // namespace sepcal::bindings
