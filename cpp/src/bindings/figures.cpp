// SPDX-License-Identifier: BSD-3-Clause
// What the report's pictures are drawn from, and the curves in them.
#include "flight/verbs/figures.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <optional>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "flight/verbs/cost_landscape.hpp"
#include "numerics/residual_curves.hpp"
#include "python_effect.hpp"
#include "released.hpp"
#include "sepcal/error.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal::bindings {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<SegmentRows> describe(const std::vector<Segment>& segments) {
  std::vector<SegmentRows> rows;
  for (const auto& [label, first, last] : segments) rows.emplace_back(label, first, last);
  return rows;
}

std::optional<Array> array_or_none(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return adopt(values);
}

using Curve = std::tuple<Array, Array>;

Curve describe(numerics::Curve curve) {
  return {adopt(std::move(curve.x)), adopt(std::move(curve.y))};
}

/// Lags, correlations, limits.
std::tuple<Array, Array, Array> autocorrelation(const VectorXd& residual,
                                                const std::vector<SegmentRows>& runs) {
  auto found = numerics::find_autocorrelation(residual, segments_of(runs, values_in(residual)));
  return {adopt(std::move(found.lags)), adopt(std::move(found.values)),
          adopt(std::move(found.limits))};
}

Curve spectrum(const VectorXd& residual, const std::vector<SegmentRows>& runs, double interval) {
  return describe(
      numerics::find_spectrum(residual, segments_of(runs, values_in(residual)), interval));
}

void check_lengths(const VectorXd& x, const VectorXd& y) {
  if (x.size() != y.size()) throw Error("x and y differ in length; give as many of each");
}

Curve bin_means(const VectorXd& x, const VectorXd& y, int bins) {
  check_lengths(x, y);
  return describe(numerics::bin_means(x, y, bins));
}

/// (x, mean, half width), or None.
std::optional<std::tuple<VectorXd, VectorXd, VectorXd>> smooth(const VectorXd& x,
                                                               const VectorXd& y) {
  check_lengths(x, y);
  const auto fitted = numerics::fit_smooth(x, y);
  if (!fitted) return std::nullopt;
  return std::tuple(fitted->x, fitted->mean, fitted->half_width);
}

std::optional<VectorXd> channel(const FlightFigures& figures, const std::string& name) {
  if (!figures.channels.has(name)) return std::nullopt;
  return gather_rows(figures.channels.column(name), figures.channels.segments());
}

FlightFigures gather(const Calibration& calibration, const Flight& flight) {
  need_own_effects(calibration);
  return gather_figures(calibration, flight);
}

CostLandscape landscape(const Calibration& calibration, const Flight& flight) {
  need_own_effects(calibration);
  return find_cost_landscape(calibration, flight);
}

}  // namespace

void define_figures(py::module_& module) {
  using Figures = FlightFigures;
  py::class_<Figures>(module, "FlightFigures")
      .def_property_readonly("rows",
                             [](const Figures& self) {
                               return py::array_t<std::size_t>(
                                   static_cast<py::ssize_t>(self.rows.size()), self.rows.data());
                             })
      .def_property_readonly("segments",
                             [](const Figures& self) { return describe(self.segments); })
      .def_property_readonly("runs", [](const Figures& self) { return describe(self.runs); })
      .def_readonly("interval", &Figures::interval)
      .def_readonly("measured", &Figures::measured)
      .def_readonly("modelled", &Figures::modelled)
      .def_readonly("within_95", &Figures::within_95)
      .def_property_readonly("airspeed",
                             [](const Figures& self) { return array_or_none(self.airspeed); })
      .def_property_readonly("heading",
                             [](const Figures& self) { return array_or_none(self.heading); })
      .def_readonly("heading_is_track", &Figures::heading_is_track)
      .def("channel", &channel);
  module.def("gather_figures", &gather, WithoutGil());
  using Landscape = CostLandscape;
  py::class_<Landscape>(module, "CostLandscape")
      .def_property_readonly("names",
                             [](const Landscape& self) {
                               std::vector<std::string> names;
                               for (const auto& one : self.parameters) names.push_back(one.name);
                               return names;
                             })
      .def_property_readonly("units",
                             [](const Landscape& self) {
                               std::vector<std::string> units;
                               for (const auto& one : self.parameters) units.push_back(one.unit);
                               return units;
                             })
      .def_property_readonly(
          "points", [](const Landscape& self) { return MatrixXd(self.points.transpose()); })
      .def_readonly("trace_r", &Landscape::trace_r);
  module.def("cost_landscape", &landscape, WithoutGil());
  module.def("autocorrelation", &autocorrelation);
  module.def("spectrum", &spectrum);
  module.def("quantiles",
             [](const VectorXd& residual) { return describe(numerics::find_quantiles(residual)); });
  module.def("smooth", &smooth);
  module.def("bin_means", &bin_means);
}

}  // namespace sepcal::bindings
