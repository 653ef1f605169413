// SPDX-License-Identifier: BSD-3-Clause
// The noise of a residual: its model, fitted, whitened by and drawn from.
#include "sepcal/noise_model.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <limits>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "released.hpp"
#include "sepcal/error.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The whole of e where none are given.
std::vector<Segment> segments_in(const std::optional<std::vector<SegmentRows>>& rows,
                                 const VectorXd& e) {
  if (!rows) return {Segment{.label = "", .first = 0, .last = static_cast<std::size_t>(e.size())}};
  return segments_of(*rows, values_in(e));
}

NoiseFit fit_residual(const VectorXd& e, const std::optional<std::vector<SegmentRows>>& segments,
                      std::optional<int> order, int max_order,
                      const std::optional<NoiseModel>& start) {
  const Released released;
  return fit_noise(values_in(e), segments_in(segments, e),
                   {.order = order, .max_order = max_order, .start = start});
}

/// W e at the rows of the segments, NaN elsewhere.
VectorXd whiten_residual(const NoiseModel& model, const VectorXd& e,
                         const std::optional<std::vector<SegmentRows>>& rows) {
  const Released released;
  const std::vector<Segment> segments = segments_in(rows, e);
  MatrixXd gathered = gather_rows(values_in(e), segments);
  Whitener(model, segments).apply(gathered);
  VectorXd white = VectorXd::Constant(e.size(), std::numeric_limits<double>::quiet_NaN());
  Index next = 0;
  for (const Segment& segment : segments) {
    const auto length = static_cast<Index>(segment.rows());
    white.segment(static_cast<Index>(segment.first), length) =
        gathered.col(0).segment(next, length);
    next += length;
  }
  return white;
}

MatrixXd draw_noise(const NoiseModel& model, const std::vector<std::size_t>& lengths, Index draws,
                    std::uint64_t seed) {
  const Released released;
  std::vector<Segment> segments;
  std::size_t first = 0;
  for (const std::size_t length : lengths) {
    segments.push_back({"", first, first + length});
    first += length;
  }
  std::mt19937_64 generator(seed);
  return simulate_noise(model, segments, draws, generator);
}

}  // namespace

void define_noise(py::module_& module) {
  BoundStruct<NoiseModel>(module, "NoiseModel",
                          "The noise of one output: phi(B) (1 - B)^d e = sigma w, w white.")
      .field("d", &NoiseModel::d, "In [0, 1): 0 white, 0.5 pink, near 1 a slow drift.")
      .field("phi", &NoiseModel::phi, "(p,), of a stationary autoregression.")
      .field("sigma", &NoiseModel::sigma, "Standard deviation of w, in the unit of e.")
      .field("free_level", &NoiseModel::free_level,
             "Whether nothing is assumed of the mean of a segment.")
      .finish()
      .def(py::init([](double d, const VectorXd& phi, double sigma, bool free_level) {
             return NoiseModel{.d = d, .phi = phi, .sigma = sigma, .free_level = free_level};
           }),
           py::kw_only(), "d"_a = 0.0, "phi"_a = VectorXd(), "sigma"_a = 1.0,
           "free_level"_a = false);
  BoundStruct<NoiseFit>(module, "NoiseFit", "A noise model of most likelihood.")
      .field("model", &NoiseFit::model, "The NoiseModel.")
      .field("minus_two_log_likelihood", &NoiseFit::minus_two_log_likelihood,
             "Comparable between fits of equal free_level and rows; -infinity of zeros.")
      .field("informative_rows", &NoiseFit::informative_rows,
             "Rows, less one for each segment where the level is free.")
      .field("evaluations", &NoiseFit::evaluations, "Evaluations of the likelihood.")
      .field("converged", &NoiseFit::converged, "Whether another step would gain next to nothing.")
      .finish();
  module.def("fit_noise", &fit_residual);
  module.def("whiten", &whiten_residual);
  module.def("simulate_noise", &draw_noise);
}

}  // namespace sepcal::bindings
