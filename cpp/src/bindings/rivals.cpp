// SPDX-License-Identifier: BSD-3-Clause
// Estimators that the two-stage one is measured against, on columns.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "model/differences.hpp"
#include "released.hpp"
#include "sepcal/detail/rivals/alonso_shuster.hpp"
#include "sepcal/detail/rivals/haupt_kasdin.hpp"
#include "sepcal/detail/rivals/single_stage.hpp"
#include "sepcal/detail/rivals/two_step_problems.hpp"
#include "sepcal/error.hpp"
#include "structs.hpp"

namespace pybind11::detail {

template <>
struct type_caster<sepcal::rivals::Solver>
    : WordCaster<sepcal::rivals::Solver, sepcal::rivals::Solver::levenberg_marquardt,
                 sepcal::rivals::Solver::slsqp> {};
template <>
struct type_caster<sepcal::rivals::CostScale>
    : WordCaster<sepcal::rivals::CostScale, sepcal::rivals::CostScale::mean,
                 sepcal::rivals::CostScale::sum> {};

}  // namespace pybind11::detail

namespace sepcal::bindings {
namespace {

using namespace py::literals;
using namespace rivals;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Values = std::map<std::string, double>;
using Ends = std::map<std::string, Interval>;

/// f of a problem in Python, its slopes by differences of fourth order.
class PythonChange final : public ChangeOfVariables {
 public:
  using Row = std::tuple<std::string, std::string, double, double>;  // name, unit, lower, upper

  PythonChange(const std::vector<Row>& rows, py::object at) : at_(share(std::move(at))) {
    for (const auto& [name, unit, lower, upper] : rows) {
      parameters_.emplace_back(name, unit, lower, upper);
    }
  }

  const std::vector<Variable>& parameters() const override { return parameters_; }

  VectorXd at(const VectorXd& xi) const override {
    const py::gil_scoped_acquire gil;
    const py::object answer = (*at_)(xi);
    using Contiguous = py::array_t<double, py::array::c_style | py::array::forcecast>;
    const auto states = Contiguous::ensure(answer);
    if (!states || states.ndim() != 1 || states.size() == 0) {
      throw Error("at(xi) of a two-step problem must give its states, an array (p,)");
    }
    return Eigen::Map<const VectorXd>(states.data(), states.size());
  }

  MatrixXd slopes(const VectorXd& xi) const override {
    MatrixXd slopes;
    for (Index k = 0; k < xi.size(); ++k) {
      const Variable& parameter = parameters_[static_cast<std::size_t>(k)];
      const double scale =
          std::min(0.5 * (parameter.upper - parameter.lower), std::max(1.0, std::abs(xi[k])));
      const auto along = [&](double step) {
        VectorXd moved = xi;
        moved[k] += step;
        return at(moved);
      };
      const VectorXd slope =
          model::differentiate(along, scale, parameter.lower - xi[k], parameter.upper - xi[k]);
      if (slopes.size() == 0) slopes.resize(slope.size(), xi.size());
      slopes.col(k) = slope;
    }
    return slopes;
  }

 private:
  std::shared_ptr<const py::object> at_;
  std::vector<Variable> parameters_;
};

/// Both steps.
struct Problem {
  Model first;
  std::shared_ptr<const ChangeOfVariables> change;
};

template <class P>
Problem problem_of(P problem) {
  return {Model(std::make_shared<const StaticModel<FirstStepModel<P>>>(FirstStepModel<P>{problem})),
          std::make_shared<const StaticChange<P>>(problem)};
}

SingleStageFit fit_all_at_once(const Model& model, const py::dict& columns,
                               const std::vector<std::string>& labels, const Values& start,
                               Ends bounds, Values fix, Values noise, std::string segments,
                               Solver solver, CostScale cost, double noise_tolerance,
                               int noise_iterations, int evaluations, int threads) {
  const Record record = record_of(columns, labels);
  SingleStageOptions options;
  options.bounds = std::move(bounds);
  options.fix = std::move(fix);
  options.noise = std::move(noise);
  options.segments = std::move(segments);
  options.solver = solver;
  options.cost = cost;
  options.noise_tolerance = noise_tolerance;
  options.noise_iterations = noise_iterations;
  options.evaluations = evaluations;
  options.threads = threads;
  const Released released;
  return fit_single_stage(*model.block, record, start, options);
}

HauptKasdinFit fit_in_two_steps(const Problem& problem, const py::dict& columns,
                                const std::vector<std::string>& labels, const Values& start,
                                Ends bounds, Values noise, std::string segments, Solver solver,
                                int evaluations, int threads) {
  const Record record = record_of(columns, labels);
  HauptKasdinOptions options;
  options.bounds = std::move(bounds);
  options.noise = std::move(noise);
  options.segments = std::move(segments);
  options.solver = solver;
  options.evaluations = evaluations;
  options.threads = threads;
  const Released released;
  return fit_haupt_kasdin(*problem.first.block, record, *problem.change, start, options);
}

AlonsoShusterFit fit_twostep(const py::dict& columns, const std::vector<std::string>& labels,
                             double field_strength, double noise, bool bias_alone, int reweightings,
                             bool mean_as_printed, int iterations, std::string segments) {
  const Record record = record_of(columns, labels);
  const Released released;
  return fit_alonso_shuster(record, field_strength,
                            {.noise = noise,
                             .bias_alone = bias_alone,
                             .reweightings = reweightings,
                             .mean_as_printed = mean_as_printed,
                             .iterations = iterations,
                             .segments = std::move(segments)});
}

void define_fits(py::module_& module) {
  BoundStruct<SingleStageFit>(module, "SingleStageFit",
                              "All parameters at once by one nonlinear programme.")
      .field("converged", &SingleStageFit::converged, "As the solver says.")
      .tuple("names", &SingleStageFit::names, "n, linear, then nonlinear, fixed ones among them.")
      .field("estimates", &SingleStageFit::estimates, "(n,)")
      .field("noise", &SingleStageFit::noise, "{output: standard deviation}")
      .field("cost", &SingleStageFit::cost, "J of Eq. 6, as a Fit has it.")
      .field("evaluations", &SingleStageFit::evaluations,
             "Evaluations of the cost; of Levenberg-Marquardt iterations.")
      .field("noise_iterations", &SingleStageFit::noise_iterations,
             "Alternations of R with the parameters.")
      .copied()
      .finish();
  BoundStruct<FirstStep>(module, "FirstStep", "The states of a two-step fit, found linearly.")
      .tuple("names", &FirstStep::names, "p")
      .field("states", &FirstStep::states, "(p,), of least norm where H is singular.")
      .field("information", &FirstStep::information, "(p, p), H' R^-1 H.")
      .field("rank", &FirstStep::rank, "Rank of H.")
      .field("condition", &FirstStep::condition, "Condition of H, its columns of unit length.")
      .field("noise", &FirstStep::noise, "{output: standard deviation}")
      .finish();
  BoundStruct<HauptKasdinFit>(module, "HauptKasdinFit", "A two-step fit by a change of variables.")
      .field("first", &HauptKasdinFit::first, "The first step.")
      .field("converged", &HauptKasdinFit::converged, "As the second step's solver says.")
      .tuple("names", &HauptKasdinFit::names, "n")
      .field("estimates", &HauptKasdinFit::estimates, "(n,)")
      .field("standard_errors", &HauptKasdinFit::standard_errors, "(n,), NaN where undefined.")
      .field("covariance", &HauptKasdinFit::covariance, "(n, n)")
      .field("cost", &HauptKasdinFit::cost, "Cost of Eq. 32.")
      .field("evaluations", &HauptKasdinFit::evaluations, "Evaluations of the second step.")
      .copied()
      .finish();
  BoundStruct<AlonsoShusterFit>(module, "AlonsoShusterFit", "TWOSTEP's magnetometer.")
      .field("converged", &AlonsoShusterFit::converged, "Whether the second step did.")
      .field("message", &AlonsoShusterFit::message, "One line; empty: nothing to say.")
      .tuple("names", &AlonsoShusterFit::names, "n: lambda, alpha and n, or n alone.")
      .field("estimates", &AlonsoShusterFit::estimates, "(n,), NaN where there are none.")
      .field("standard_errors", &AlonsoShusterFit::standard_errors, "(n,)")
      .field("covariance", &AlonsoShusterFit::covariance, "(n, n)")
      .field("bias", &AlonsoShusterFit::bias, "n of B = C h + n [uT], (3,).")
      .field("shape", &AlonsoShusterFit::shape, "C C', (3, 3).")
      .field("theta", &AlonsoShusterFit::theta, "(c, E), (9,), or b, (3,).")
      .field("centred", &AlonsoShusterFit::centred, "The same of the first step.")
      .field("cost", &AlonsoShusterFit::cost, "Half the weighted squares of the second step.")
      .field("iterations", &AlonsoShusterFit::iterations, "Iterations of the second step.")
      .copied()
      .finish();
}

}  // namespace

void define_rivals(py::module_& module) {
  define_fits(module);
  py::class_<Problem>(module, "TwoStepProblem", "Both steps of a Haupt/Kasdin fit.")
      .def(py::init(
          [](const Model& first, const std::vector<PythonChange::Row>& parameters, py::object at) {
            return Problem{first, std::make_shared<const PythonChange>(parameters, std::move(at))};
          }))
      .def_property_readonly("first", [](const Problem& self) { return self.first; })
      .def("at", [](const Problem& self, const VectorXd& xi) { return self.change->at(xi); });
  module.def("example_in_five_states", [] { return problem_of(ExampleInFiveStates{}); });
  module.def("example_in_three_states", [] { return problem_of(ExampleInThreeStates{}); });
  module.def("magnetometer_in_nine_states", [](double field_strength) {
    return problem_of(MagnetometerInNineStates{field_strength});
  });
  const SingleStageOptions single;
  module.def("fit_single_stage", &fit_all_at_once, "model"_a, "columns"_a, "labels"_a, "start"_a,
             py::kw_only(), "bounds"_a, "fix"_a, "noise"_a, "segments"_a,
             "solver"_a = single.solver, "cost"_a = single.cost,
             "noise_tolerance"_a = single.noise_tolerance,
             "noise_iterations"_a = single.noise_iterations, "evaluations"_a = single.evaluations,
             "threads"_a = single.threads);
  module.def("fit_haupt_kasdin", &fit_in_two_steps, "problem"_a, "columns"_a, "labels"_a, "start"_a,
             py::kw_only(), "bounds"_a, "noise"_a, "segments"_a, "solver"_a, "evaluations"_a,
             "threads"_a);
  module.def("fit_alonso_shuster", &fit_twostep, "columns"_a, "labels"_a, "field_strength"_a,
             py::kw_only(), "noise"_a, "bias_alone"_a, "reweightings"_a, "mean_as_printed"_a,
             "iterations"_a, "segments"_a);
}

}  // namespace sepcal::bindings
