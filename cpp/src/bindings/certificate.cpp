// SPDX-License-Identifier: BSD-3-Clause
// What is proven of a cost, of models on columns.
#include "sepcal/certificate.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fitted_columns.hpp"
#include "python_effect.hpp"
#include "released.hpp"
#include "results.hpp"
#include "sepcal/error.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

using Ends = std::map<std::string, std::pair<double, double>>;

Ends ends_of(const std::map<std::string, Interval>& intervals) {
  Ends ends;
  for (const auto& [name, range] : intervals) ends[name] = {range.lower, range.upper};
  return ends;
}

std::map<std::string, Interval> intervals_of(const Ends& ends) {
  std::map<std::string, Interval> intervals;
  for (const auto& [name, range] : ends) intervals[name] = {range.first, range.second};
  return intervals;
}

Certificate certify_columns(const Model& model, const py::dict& columns,
                            const std::vector<std::string>& labels, CalibrationOptions options,
                            const std::vector<PythonEffect>& own, const FittedModel& fitted,
                            double tolerance, std::size_t boxes) {
  Record record = record_of(columns, labels);
  options.own_effects = own_effects(own, model.kit());
  const Released released;
  const FittedColumns there =
      bring_to_fit(model, std::move(record), options, fitted.effects, fitted.fit);
  return certify(*there.model, there.record, fitted.fit, there.options,
                 {.tolerance = tolerance, .boxes = boxes, .threads = there.options.threads});
}

CostBound bound_columns(const Model& model, const py::dict& columns,
                        const std::vector<std::string>& labels,
                        const std::map<std::string, double>& point, const Ends& bounds,
                        const std::map<std::string, double>& noise) {
  const Record record = record_of(columns, labels);
  const std::vector<Variable>& nonlinear = model.block->tables().nonlinear;
  Eigen::VectorXd xi2p(static_cast<Eigen::Index>(nonlinear.size()));
  for (std::size_t j = 0; j < nonlinear.size(); ++j) {
    const auto value = point.find(nonlinear[j].name);
    if (value == point.end()) throw Error("xi2p: '" + nonlinear[j].name + "' has no value");
    xi2p[static_cast<Eigen::Index>(j)] = value->second;
  }
  const Released released;
  return bound_cost(*model.block, record, xi2p, {.bounds = intervals_of(bounds), .noise = noise});
}

}  // namespace

void define_certificate(py::module_& module) {
  BoundStruct<Certificate>(module, "Certificate", "A proof about a fit's cost in a box.")
      .field(
          "status", [](const Certificate& self) { return std::string(to_string(self.status)); },
          [](Certificate& self, const std::string& status) {
            for (const auto known :
                 {Certified::global, Certified::elsewhere, Certified::not_certified}) {
              if (status == to_string(known)) self.status = known;
            }
          },
          R"("global": no parameters within the bounds have a cost lower by more than the
tolerance; "elsewhere": a lower one was found; "not_certified": the boxes ran out.)")
      .field("cost", &Certificate::cost, "J at the fit, without ln|R|, rounded upwards.")
      .field("lower", &Certificate::lower, "Proven: nothing within the bounds has less.")
      .field(
          "region", [](const Certificate& self) { return ends_of(self.region); },
          [](Certificate& self, const Ends& ends) { self.region = intervals_of(ends); },
          "{name: (lower, upper)} of the nonlinear parameters, where the minimum may be.")
      .field("boxes", &Certificate::boxes, "How many were bounded.")
      .field("better", &Certificate::better, "{name: value} where the cost is lower; else empty.")
      .field("better_cost", &Certificate::better_cost, "J there, rounded upwards; NaN if nowhere.")
      .field("message", &Certificate::message, "One line.")
      .copied()
      .finish();

  BoundStruct<CostBound>(module, "CostBound", "How far the least cost in a box may be below one.")
      .field("cost", &CostBound::cost, "J(xi2p), least over xi1.")
      .field("paper_error", &CostBound::paper_error, "E of Eq. 13.")
      .field("paper_lower", &CostBound::paper_lower,
             "J(xi2p) - E, which Eq. 7 takes for a bound and which is none.")
      .field("l_1", &CostBound::l_1, "Bound of |xi1|.")
      .field("l_2", &CostBound::l_2, "Bound of |xi2 - xi2p|.")
      .field("l_a", &CostBound::l_a, "Lipschitz constant of a sample's A, over R^1/2.")
      .field("l_b", &CostBound::l_b, "The same constant for b.")
      .field("joint_error", &CostBound::joint_error, "E', of all samples at once. Proven.")
      .field("lower", &CostBound::lower,
             "max(0, sqrt J(xi2p) - sqrt E')^2. Proven: nothing in the box has less.")
      .copied()
      .finish();

  module.def("certify", &certify_columns);
  module.def("bound_cost", &bound_columns);
}

}  // namespace sepcal::bindings
