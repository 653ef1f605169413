// SPDX-License-Identifier: BSD-3-Clause
// Many flights: what a worker answers of one, as plain arrays that travel, and the joint fit that
// asks functions in Python for all flights' answers.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "flight/verbs/held_options.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit_many.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using WithoutGil = py::call_guard<py::gil_scoped_release>;

constexpr std::array statuses{FitStatus::converged, FitStatus::not_converged,
                              FitStatus::not_identifiable};

FitStatus to_status(const std::string& name) {
  for (const FitStatus status : statuses) {
    if (to_string(status) == name) return status;
  }
  throw Error("'" + name + "' is no status of a fit");
}

/// n_z factors travel as one matrix, (n_z (n + 1)) x (n + 1), one below the other.
MatrixXd stack(const std::vector<TriangularFactor>& factors) {
  const Eigen::Index columns = factors.front().columns();
  MatrixXd stacked(columns * static_cast<Eigen::Index>(factors.size()), columns);
  for (std::size_t j = 0; j < factors.size(); ++j) {
    stacked.middleRows(static_cast<Eigen::Index>(j) * columns, columns) = factors[j].matrix();
  }
  return stacked;
}

std::vector<TriangularFactor> unstack(const MatrixXd& stacked) {
  std::vector<TriangularFactor> factors;
  for (Eigen::Index row = 0; row < stacked.rows(); row += stacked.cols()) {
    MatrixXd rows = stacked.middleRows(row, stacked.cols());
    factors.emplace_back(static_cast<int>(stacked.cols())).absorb(rows);
  }
  return factors;
}

/// Status, message, x, noise, factors, output_squares, rows; or None and why a flight can't be
/// used.
using Start = std::tuple<std::optional<std::string>, std::string, VectorXd, VectorXd, MatrixXd,
                         VectorXd, std::size_t>;
/// x, noise, rounding, columns, K.
using Question = std::tuple<VectorXd, VectorXd, VectorXd, std::vector<Eigen::Index>, MatrixXd>;

/// A flight as a joint fit takes it, with the model that it refers to.
struct PreparedFlight {
  std::shared_ptr<const BlockModel> model;
  std::unique_ptr<const FlightProblem> problem;
};

/// The options with what the model's probe holds. Throws Error for what many flights can't have.
ManyOptions many_options(const Model& model, const CalibrationOptions& given,
                         const std::vector<std::string>& own, bool leave_out) {
  if (!given.effects.empty()) {
    throw Error(
        "fit_many() takes no effects, which each flight would centre on itself; write them"
        " into a model of your own, or fit each flight by itself");
  }
  CalibrationOptions options = given;
  if (model.probe != nullptr) {
    if (model.probe->with_noise(1.0) != nullptr) {
      throw Error(
          "a model of the field's strength alone depends on its own noise, which"
          " fit_many() does not follow; fit each flight by itself");
    }
    options = verbs::hold(*model.probe, options);
  } else if (!options.free.empty()) {
    throw Error("free is for sepcal's own probes: this model holds no parameter by default");
  }
  return {.own = own, .fit = options.fit, .leave_out = leave_out};
}

PreparedFlight prepare_flight(const Model& model, const Flight& flight,
                              const CalibrationOptions& options,
                              const std::vector<std::string>& own) {
  if (model.probe == nullptr) {
    throw Error("this model takes no flight; give its inputs and outputs as {name: array}");
  }
  const ManyOptions many = many_options(model, options, own, false);
  ProbeRecord prepared = model.probe->prepare(flight, options.drop_invalid);
  return {model.block,
          std::make_unique<FlightProblem>(*model.block, std::move(prepared.record), many)};
}

PreparedFlight prepare_columns(const Model& model, const py::dict& columns,
                               const std::vector<std::string>& labels,
                               const CalibrationOptions& options,
                               const std::vector<std::string>& own) {
  Record record = record_of(columns, labels);
  const py::gil_scoped_release release;
  const ManyOptions many = many_options(model, options, own, false);
  for (const Variable& output : model.block->tables().outputs) {
    if (record.has(output.name) || !std::isfinite(output.absent)) continue;
    record.add(output.name, std::vector<double>(record.length(), output.absent));
  }
  return {model.block, std::make_unique<FlightProblem>(*model.block, std::move(record), many)};
}

Start start(const PreparedFlight& flight) {
  const FlightStart start = flight.problem->start();
  return {std::string(to_string(start.status)),
          start.message,
          start.x,
          start.noise,
          stack(start.factors),
          start.output_squares,
          start.rows};
}

MatrixXd linearise(const PreparedFlight& flight, const VectorXd& x) {
  return stack(flight.problem->linearise(x));
}

MatrixXd score_covariance(const PreparedFlight& flight, const Question& question) {
  const auto& [x, noise, rounding, columns, K] = question;
  return flight.problem->score_covariance({0, x, noise, rounding, columns, K});
}

/// Asks `visit(kind, [(flight, argument), ...])`, which answers with a list in that order.
class MappedFleet final : public Fleet {
 public:
  MappedFleet(std::vector<std::string> names, py::function visit)
      : names_(std::move(names)), visit_(std::move(visit)) {}

  std::vector<std::string> names() const override { return names_; }

  std::vector<FlightStart> start() override {
    const py::gil_scoped_acquire acquire;
    py::list questions;
    for (std::size_t i = 0; i < names_.size(); ++i) questions.append(py::make_tuple(i, py::none()));
    std::vector<FlightStart> starts;
    for (const py::handle answer : visit_("start", questions)) {
      auto [status, message, x, noise, factors, squares, rows] = answer.cast<Start>();
      if (!status) {
        starts.push_back({.error = message});
        continue;
      }
      starts.push_back({.error = {},
                        .status = to_status(*status),
                        .message = message,
                        .x = x,
                        .noise = noise,
                        .factors = unstack(factors),
                        .output_squares = squares,
                        .rows = rows});
    }
    return starts;
  }

  std::vector<std::vector<TriangularFactor>> linearise(
      const std::vector<FlightPoint>& points) override {
    const py::gil_scoped_acquire acquire;
    py::list questions;
    for (const FlightPoint& point : points) {
      questions.append(py::make_tuple(point.flight, point.x));
    }
    std::vector<std::vector<TriangularFactor>> factors;
    for (const py::handle answer : visit_("linearise", questions)) {
      factors.push_back(unstack(answer.cast<MatrixXd>()));
    }
    return factors;
  }

  std::vector<MatrixXd> score_covariances(const std::vector<ScoreQuestion>& asked) override {
    const py::gil_scoped_acquire acquire;
    py::list questions;
    for (const ScoreQuestion& one : asked) {
      questions.append(
          py::make_tuple(one.flight, Question{one.x, one.noise, one.rounding, one.columns, one.K}));
    }
    std::vector<MatrixXd> covariances;
    for (const py::handle answer : visit_("score_covariance", questions)) {
      covariances.push_back(answer.cast<MatrixXd>());
    }
    return covariances;
  }

 private:
  std::vector<std::string> names_;
  py::function visit_;
};

py::dict describe(const Departure& departure, const std::vector<Parameter>& shared) {
  py::dict difference;
  py::dict error;
  for (std::size_t k = 0; k < shared.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    difference[py::str(shared[k].name)] = departure.difference[at];
    error[py::str(shared[k].name)] = departure.standard_error[at];
  }
  return py::dict("combinations"_a = departure.combinations, "statistic"_a = departure.statistic,
                  "p"_a = departure.p, "p_holm"_a = departure.p_holm,
                  "p_white"_a = departure.p_white, "p_white_holm"_a = departure.p_white_holm,
                  "difference"_a = difference, "standard_error"_a = error);
}

/// Keys as the fields of sepcal.ManyFit.
py::dict describe(const ManyFit& fit) {
  py::list flights;
  for (const FlightFit& flight : fit.flights) {
    flights.append(py::dict("name"_a = flight.name, "own"_a = bindings::describe(flight.own),
                            "rmse"_a = bindings::describe(flight.rmse), "rows"_a = flight.rows,
                            "alone"_a = to_string(flight.alone), "message"_a = flight.message,
                            "departure"_a = describe(flight.departure, fit.shared)));
  }
  py::dict left_out;
  for (const LeftOut& flight : fit.left_out) left_out[py::str(flight.name)] = flight.reason;
  const Identifiability& found = fit.identifiability;
  return py::dict(
      "status"_a = to_string(fit.status), "message"_a = fit.message,
      "shared"_a = bindings::describe(fit.shared), "covariance"_a = fit.covariance,
      "correlation"_a = fit.correlation, "covariance_white"_a = fit.covariance_white,
      "flights"_a = flights, "left_out"_a = left_out, "noise"_a = bindings::describe(fit.noise),
      "rmse"_a = bindings::describe(fit.rmse), "cost"_a = fit.cost,
      "unobservable"_a = bindings::describe(found.unobservable),
      "weak"_a = bindings::describe(found.weak), "iterations"_a = fit.iterations,
      "noise_iterations"_a = fit.noise_iterations, "passes"_a = fit.passes, "rows"_a = fit.rows);
}

py::dict fit_mapped(const Model& model, const std::vector<std::string>& names,
                    const CalibrationOptions& options, const std::vector<std::string>& own,
                    bool leave_out, const py::function& visit) {
  MappedFleet fleet(names, visit);
  const auto run = [&] {
    const ManyOptions many = many_options(model, options, own, leave_out);
    const py::gil_scoped_release release;
    return fit_many(*model.block, fleet, many);
  };
  return describe(run());
}

}  // namespace

void define_many(py::module_& module) {
  py::class_<PreparedFlight>(module, "PreparedFlight")
      .def("start", &start, WithoutGil())
      .def("linearise", &linearise, WithoutGil())
      .def("score_covariance", &score_covariance, WithoutGil());
  module.def("prepare_flight", &prepare_flight, WithoutGil());
  module.def("prepare_columns", &prepare_columns);
  module.def("fit_many", &fit_mapped);
}

}  // namespace sepcal::bindings
