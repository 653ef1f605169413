// SPDX-License-Identifier: BSD-3-Clause
// What a fit says: estimates with their uncertainty, the noise, and what stage one saw.
#include "results.hpp"

#include <pybind11/eigen.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "sepcal/collinearity.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

/// "at its lower bound": what a table says of a parameter that is not simply estimated.
std::string_view remark(const Parameter& parameter) {
  if (parameter.fixed) return "fixed";
  if (!parameter.at_bound) return "";
  const bool lower = parameter.value - parameter.lower <= parameter.upper - parameter.value;
  return lower ? "at its lower bound" : "at its upper bound";
}

void define_parameters(py::module_& module) {
  BoundStruct<Parameter>(module, "Parameter", "One estimate, in `unit`.")
      .told()
      .comparable()
      .finish()
      .def_property_readonly("remark", &remark,
                             "Fixed, at its lower or at its upper bound; else nothing.");

  BoundStruct<NoiseSize>(module, "NoiseSize",
                         "A noise's size that filter error estimated, or was given.")
      .told()
      .comparable()
      .finish();

  BoundStruct<Combination>(
      module, "Combination",
      "A linear combination of parameters that the record leaves open or determines poorly.")
      .field("text", &Combination::text,
             R"("0.8 w_n - 0.6 lambda_va", coefficients of unit length.)")
      .tuple("parameters", &Combination::parameters, "Those that take part, largest share first.")
      .field("standard_error", &Combination::standard_error,
             "Standard error of the combination; infinite where it is singular.")
      .comparable()
      .finish();

  BoundStruct<EffectSetting>(
      module, "EffectSetting",
      "An effect of a fit, with what it took from the record; None or empty where it takes none.")
      .field("name", &EffectSetting::name, R"(Whole, aliases resolved: "wind[altitude_m]".)")
      .field("centre", &EffectSetting::centre, "Centre of a power's driver, in the driver's unit.")
      .field("mean", &EffectSetting::mean,
             "Mean of the power over the fitted rows, where it is taken away.")
      .tuple("knots", &EffectSetting::knots, "Knots of a spline.")
      .tuple("means", &EffectSetting::means,
             "Means of its functions over the fitted rows, where they are taken away.")
      .tuple("labels", &EffectSetting::labels,
             "Labels of the driver `maneuver`; the first has no coefficient.")
      .field("span", &EffectSetting::span, "The record's first and last time [s].")
      .field("t0", &EffectSetting::t0, "t0 of a step [s].")
      .comparable()
      .finish();
}

void define_stage_one(py::module_& module) {
  BoundStruct<NamedMinimum>(module, "LocalMinimum", "A local minimum of Tr[R] within the bounds.")
      .field("xi2", &NamedMinimum::xi2, "")
      .field("trace_r", &NamedMinimum::trace_r,
             "Sum over outputs of the mean squared residual, in the outputs' units.")
      .finish();

  BoundStruct<ScreenResults>(
      module, "ScreenResults",
      "Eqs. 17 and 18 at every sample, each (S,); norms are Frobenius', over the whole record.")
      .field("ratio_a", &ScreenResults::ratio_a, "|dA/dxi2| l_2 / |A|.")
      .field("ratio_b", &ScreenResults::ratio_b,
             "|db/dxi2| l_2 / |b|; zero where b does not depend on xi2.")
      .field("curvature_a", &ScreenResults::curvature_a,
             "Smallest eigenvalue of the sum of A's second derivatives.")
      .field("curvature_b", &ScreenResults::curvature_b, "The same of b.")
      .field("accepted", &ScreenResults::accepted, "False: the sample was not used.")
      .finish();

  BoundStruct<NamedStageOne>(
      module, "StageOne",
      "Samples of xi2 and Tr[R] at each (Eqs. 16, 19, Steps 2-4); of a global search, all it "
      "tried.\n\nFixed parameters have no part in it. The samples are not kept in a calibration's "
      "JSON.")
      .field("samples", &NamedStageOne::samples, "(S, n_2), in the model's order.")
      .field("trace_r", &NamedStageOne::rest, &StageOne::trace_r,
             "(S,); infinite where the model is not finite.")
      .field("best", &NamedStageOne::best, "The sample with the least Tr[R].")
      .field("best_trace_r", &NamedStageOne::rest, &StageOne::best_trace_r, "")
      .field("minima", &NamedStageOne::minima, "Distinct ones, lowest first.")
      .field("unique_minimum", &NamedStageOne::rest, &StageOne::unique_minimum,
             "One minimum and no flat direction.")
      .field("flat_directions", &NamedStageOne::rest, &StageOne::flat_directions,
             "In words: a valley of Tr[R] and no point (Fig. 6).")
      .field("screens", &NamedStageOne::rest, &StageOne::screens, "Where fit() was asked for them.")
      .finish();
}

}  // namespace

void define_results(py::module_& module) {
  define_parameters(module);
  define_stage_one(module);
  BoundStruct<CorrelatedPair>(module, "CorrelatedPair", "Two estimates that go together.")
      .field("first", &CorrelatedPair::first, "")
      .field("second", &CorrelatedPair::second, "")
      .field("correlation", &CorrelatedPair::correlation, "")
      .comparable()
      .finish();

  BoundStruct<Collinearity>(module, "Collinearity",
                            "Which estimates a record hardly tells apart (Belsley, Kuh & Welsch).")
      .field("names", &Collinearity::names, "The k estimates that have a standard error.")
      .field("pairs", &Collinearity::pairs, "|correlation| above 0.9, strongest first.")
      .field("condition_indices", &Collinearity::condition_indices,
             "(k,), from 1 up; above 30 columns hardly differ.")
      .field("variance_proportions", &Collinearity::variance_proportions,
             "(k, k): the share of an estimate's variance (a column each) by the direction of each "
             "condition index (a row each).")
      .finish();

  BoundStruct<FittedModel>(module, "Fit", "The two-stage batch estimate.")
      .field("status", &FittedModel::fit, &Fit::status,
             R"("converged", "not_converged" or "not_identifiable".)")
      .field("message", &FittedModel::fit, &Fit::message,
             "One line; empty where there is nothing to say.")
      .field("parameters", &FittedModel::fit, &Fit::parameters,
             "Linear, then nonlinear, in the model's order.")
      .field("n_1", &FittedModel::fit, &Fit::n_1, "How many of them are linear.")
      .field("covariance", &FittedModel::fit, &Fit::covariance,
             "(n, n), in that order; NaN where there is no standard error.")
      .field("correlation", &FittedModel::fit, &Fit::correlation, "(n, n).")
      .field("covariance_white", &FittedModel::fit, &Fit::covariance_white,
             "(n, n), of white residuals; of a loaded one only its diagonal.")
      .field("covariance_noise_model", &FittedModel::fit, &Fit::covariance_noise_model,
             "(n, n), as each output's noise model has it; of a loaded one only its diagonal.")
      .field("covariance_blocks", &FittedModel::fit, &Fit::covariance_blocks,
             "(n, n), as it is among blocks of the record; of a loaded one only its diagonal.")
      .field("noise", &FittedModel::fit, &Fit::noise,
             "By output: standard deviation, given or from R-hat = SSE / N.")
      .field("rmse", &FittedModel::fit, &Fit::rmse, "By output, unwhitened, in its unit.")
      .field("cost", &FittedModel::fit, &Fit::cost, "J of Eq. 6; by filter error V_m, S 5.7.")
      .field("method", &FittedModel::fit, &Fit::method, R"("output-error" or "filter-error".)")
      .field("noise_sizes", &FittedModel::fit, &Fit::noise_sizes,
             "By filter error, by name: process noises, then outputs; else empty.")
      .field("log_likelihood", &FittedModel::fit, &Fit::log_likelihood,
             "By filter error; else NaN.")
      .field("log_likelihood_without", &FittedModel::fit, &Fit::log_likelihood_without,
             "Output error's, from which filter error began; else NaN.")
      .field("rows", &FittedModel::fit, &Fit::rows, "That stage two used.")
      .field(
          "unobservable",
          [](const FittedModel& self) { return self.fit.identifiability.unobservable; },
          [](FittedModel& self, std::vector<Combination> found) {
            self.fit.identifiability.unobservable = std::move(found);
          },
          "Singular, or uncertain beyond half the width of their bounds.")
      .field(
          "weak", [](const FittedModel& self) { return self.fit.identifiability.weak; },
          [](FittedModel& self, std::vector<Combination> found) {
            self.fit.identifiability.weak = std::move(found);
          },
          "Singular value below a fiftieth of the largest.")
      .field("stage_one", &FittedModel::stage_one, "")
      .field("second_stage", &FittedModel::fit, &Fit::second_stage,
             R"("joint" or "projected": what stage two used in the end.)")
      .field("iterations", &FittedModel::fit, &Fit::iterations,
             "Iterations of stage two's minimisations.")
      .field("noise_iterations", &FittedModel::fit, &Fit::noise_iterations,
             "Alternations of R with the parameters.")
      .field("effects", &FittedModel::effects, "That joined the model, in order.")
      .field("text", &FittedModel::page, &Page::text, "The app's page, as print() shows it.")
      .field("explained", &FittedModel::page, &Page::explained,
             "The same with the whole message, as by the apps' --explain.")
      .copied()
      .finish()
      .def_property_readonly(
          "collinearity", [](const FittedModel& self) { return find_collinearity(self.fit); },
          "Which estimates the record hardly tells apart.")
      .def("__getitem__", [](const FittedModel& self, const std::string& name) {
        return find_named(self.fit.parameters, name, "parameter", "the fit has");
      });
  module.def("confidence_ellipse", [](const FittedModel& self, const std::string& first,
                                      const std::string& second, double level, int points) {
    return confidence_ellipse(self.fit, first, second, level, points);
  });
}

}  // namespace sepcal::bindings
