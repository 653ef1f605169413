// SPDX-License-Identifier: BSD-3-Clause
// What comes of models with a state: plain structs, here beside those of other fits; what computes
// them is in sepcal._states.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "results.hpp"
#include "sepcal/error.hpp"
#include "sepcal/states/filter.hpp"
#include "sepcal/states/smooth_record.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;

using Deviations = std::map<std::string, double>;
using Changes = py::typing::Tuple<Change, py::ellipsis>;
using Rows = Eigen::Vector<std::size_t, Eigen::Dynamic>;

void define_changes(py::module_& module) {
  BoundStruct<ParameterChange>(module, "ParameterChange", "A parameter that jumped on the way.")
      .field("name", &ParameterChange::name, "Name of the parameter.")
      .field("before", &ParameterChange::before, "Its estimate before the jump.")
      .field("after", &ParameterChange::after, "Behind it, as estimated when it was found.")
      .field("standard_deviation", &ParameterChange::standard_deviation,
             "Standard deviation of after - before.")
      .tuple("rivals", &ParameterChange::rivals,
             "Parameters whose jump in its place would explain the innovations nearly as well.")
      .finish();
  BoundStruct<Change>(module, "Change", "Parameters that jumped at one time.")
      .field("onset", &Change::onset, "The row after which they jumped, to half a second or so.")
      .field("found", &Change::found, "The row at which it was said.")
      .field("onset_time", &Change::onset_time, "[s]; NaN where the data have none.")
      .field("found_time", &Change::found_time, "[s].")
      .field("statistic", &Change::statistic,
             "The chi squared that it explains, of one degree a parameter where nothing jumped.")
      .tuple("parameters", &Change::parameters, "The ParameterChange of each that jumped.")
      .finish();
}

void define_track(py::module_& module) {
  BoundStruct<Tracked>(module, "Track", "Estimates against time, one a row.")
      .field(
          "names",
          [](const Tracked& self) -> py::typing::Tuple<std::string, py::ellipsis> {
            return py::tuple(py::cast(self.track.names));
          },
          [](Tracked& self, const py::typing::Tuple<std::string, py::ellipsis>& names) {
            self.track.names = py::cast<std::vector<std::string>>(names);
          },
          "Of the n states that are integrated, then of the parameters, linear ones first.")
      .tuple("outputs", &Tracked::outputs, "n_z.")
      .field(
          "rows",
          [](const Tracked& self) -> Rows {
            return Eigen::Map<const Rows>(self.track.rows.data(),
                                          static_cast<Eigen::Index>(self.track.rows.size()));
          },
          [](Tracked& self, const Rows& rows) { self.track.rows.assign(rows.begin(), rows.end()); },
          "(M,) of the data, one an estimate.")
      .array("time", &Tracked::track, &Track::time, "(M,) [s]; empty where the data have none.")
      .field("estimates", &Tracked::track, &Track::estimates, "(M, n).")
      .field("standard_deviations", &Tracked::track, &Track::standard_deviations,
             "(M, n); 0 for what is held.")
      .field("innovations", &Tracked::track, &Track::innovations,
             "(M, n_z), reading less what was expected of it; NaN where missing.")
      .field(
          "changes",
          [](const Tracked& self) -> Changes { return py::tuple(py::cast(self.track.changes)); },
          [](Tracked& self, const Changes& changes) {
            self.track.changes = py::cast<std::vector<Change>>(changes);
          },
          "The Change of every jump that was found, in their order.")
      .field("refused", &Tracked::track, &Track::refused, "Rows that were not finite, left out.")
      .field("not_converged", &Tracked::track, &Track::not_converged,
             "Rows at which the cap of iekf's iterations ended them.")
      .copied()
      .finish();
  py::class_<IterationOptions>(module, "IterationOptions")
      .def(py::init([](int iterations, double tolerance) {
             if (iterations < 1) throw Error("row_iterations needs a number above 0");
             if (!(tolerance > 0.0)) throw Error("tolerance needs a number above 0");
             return IterationOptions{iterations, tolerance};
           }),
           "iterations"_a, "tolerance"_a);
  py::class_<FlightTrackOptions>(module, "FlightTrackOptions")
      .def(py::init([](const std::string& method, const Deviations& noise,
                       const Deviations& process_noise, const Deviations& walk,
                       const std::string& changes, const Deviations& initial_states,
                       const IterationOptions& iterations, double forgetting, double memory,
                       int every, const std::array<double, 3>& band, bool differentiate,
                       std::size_t start_rows, const std::vector<std::string>& own,
                       const std::string& second) {
             return FlightTrackOptions{
                 .how = {.method = choice_of<TrackMethod>("method", method),
                         .noise = noise,
                         .process_noise = process_noise,
                         .walk = walk,
                         .changes = choice_of<TrackChanges>("changes", changes),
                         .initial_states = initial_states,
                         .iterations = iterations,
                         .forgetting = forgetting,
                         .memory = memory,
                         .every = every,
                         .band = {band[0], band[1], band[2]},
                         .differentiate = differentiate},
                 .start_rows = start_rows,
                 .own = own,
                 .second = choice_of<TrackMethod>("second", second)};
           }),
           py::kw_only(), "method"_a, "noise"_a, "process_noise"_a, "walk"_a, "changes"_a,
           "initial_states"_a, "iterations"_a, "forgetting"_a, "memory"_a, "every"_a, "band"_a,
           "differentiate"_a, "start_rows"_a, "own"_a, "second"_a);
}

/// Matrices one after another, (N, n, n).
py::array_t<double> stack_matrices(const std::vector<Eigen::MatrixXd>& matrices) {
  const py::ssize_t n = matrices.empty() ? 0 : matrices.front().rows();
  py::array_t<double> stacked({static_cast<py::ssize_t>(matrices.size()), n, n});
  auto entries = stacked.mutable_unchecked<3>();
  for (py::ssize_t k = 0; k < stacked.shape(0); ++k) {
    for (py::ssize_t i = 0; i < n; ++i) {
      for (py::ssize_t j = 0; j < n; ++j) {
        entries(k, i, j) = matrices[static_cast<std::size_t>(k)](i, j);
      }
    }
  }
  return stacked;
}

std::vector<Eigen::MatrixXd> unstack_matrices(const py::array_t<double>& stacked) {
  return py::cast<std::vector<Eigen::MatrixXd>>(py::list(stacked));
}

void define_smoothed(py::module_& module) {
  BoundStruct<SmoothedRecord>(module, "SmoothedRecord",
                              "States and process noise, given all samples; NaN outside segments.")
      .tuple("states", &SmoothedRecord::states, "That are integrated, n_x.")
      .tuple("noises", &SmoothedRecord::noises, "n_w.")
      .tuple("outputs", &SmoothedRecord::outputs, "n_z.")
      .field("x", &SmoothedRecord::x, "(N, n_x), x(k|N).")
      .field(
          "covariance", [](const SmoothedRecord& self) { return stack_matrices(self.P); },
          [](SmoothedRecord& self, const py::array_t<double>& P) { self.P = unstack_matrices(P); },
          "(N, n_x, n_x), P(k|N).")
      .field("w", &SmoothedRecord::w, "(N, n_w), w(k|N): its mean from row k to the next.")
      .field(
          "w_covariance", [](const SmoothedRecord& self) { return stack_matrices(self.Q); },
          [](SmoothedRecord& self, const py::array_t<double>& Q) { self.Q = unstack_matrices(Q); },
          "(N, n_w, n_w), Q(k|N).")
      .field("innovations", &SmoothedRecord::innovations,
             "(N, n_z), measured less predicted from the rows before; NaN where missing.")
      .field("innovation_sd", &SmoothedRecord::innovation_sd, "(N, n_z), expected of them.")
      .field("cost", &SmoothedRecord::cost, "Sum of (e' Lambda^-1 e + ln det Lambda) / 2.")
      .field("readings", &SmoothedRecord::readings, "Outputs that were there.")
      .copied()
      .finish();
}

void define_innovation(py::module_& module) {
  using Update = Innovation<Eigen::Dynamic>;
  BoundStruct<Update>(module, "Innovation",
                      "A measurement less its prediction, and its covariance.")
      .field("count", &Update::count, "Outputs that were there.")
      .field("e", &Update::e, "(n_z,), y - expected; 0 where missing.")
      .field("w", &Update::w, "(n_z,), e in standard deviations, uncorrelated.")
      .field("root", &Update::S, "(n_z, n_z), upper triangular root of its covariance.")
      .copied()
      .finish()
      .def_property_readonly("covariance", &Update::covariance,
                             "(n_z, n_z); the identity in rows of missing outputs.")
      .def_property_readonly("cost", &Update::cost, "(e' Lambda^-1 e + ln det Lambda) / 2.");
}

}  // namespace

void define_state_results(py::module_& module) {
  define_smoothed(module);
  define_changes(module);
  define_track(module);
  define_innovation(module);
}

}  // namespace sepcal::bindings
