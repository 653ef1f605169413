// SPDX-License-Identifier: BSD-3-Clause
// Many flights: what a worker answers of one, as plain arrays that travel, and the joint fit that
// asks functions in Python for all flights' answers.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <optional>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "flight/verbs/held_options.hpp"
#include "model/measurements.hpp"
#include "released.hpp"
#include "results.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit_many.hpp"
#include "sepcal/flight/calibration.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Factors travel as one matrix, (m (n + 1)) x (n + 1) of m, one below the other.
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

/// Status, message, x, noise, factors, output_squares, rows, floor; or None and why a flight can't
/// be used.
using Start = std::tuple<std::optional<FitStatus>, std::string, VectorXd, VectorXd, MatrixXd,
                         VectorXd, std::size_t, VectorXd>;
/// x, noise, rounding, columns, K.
using Question = std::tuple<VectorXd, VectorXd, VectorXd, std::vector<Eigen::Index>, MatrixXd>;

/// Factor, V_m, readings, row.
using Score = std::tuple<MatrixXd, double, std::size_t, std::size_t>;
/// Squares, counts, readings, memory.
using Innovations = std::tuple<VectorXd, VectorXd, VectorXd, double>;

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
  } else if (!options.free.empty() && model.held.empty()) {
    throw Error("free is for sepcal's own probes: this model holds no parameter by default");
  } else {
    options = verbs::hold(model.held, model.block->tables(), options);
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
  ProbeRecord prepared =
      model.probe->prepare(probes::read_for(*model.probe, flight, options.log).flight, options.log);
  return {model.block,
          std::make_unique<FlightProblem>(*model.block, std::move(prepared.record), many)};
}

PreparedFlight prepare_columns(const Model& model, const py::dict& columns,
                               const std::vector<std::string>& labels,
                               const CalibrationOptions& options,
                               const std::vector<std::string>& own) {
  Record record = record_of(columns, labels);
  const Released released;
  const ManyOptions many = many_options(model, options, own, false);
  record = model::with_constant_outputs(model.block->tables(), std::move(record));
  return {model.block, std::make_unique<FlightProblem>(*model.block, std::move(record), many)};
}

Start start(const PreparedFlight& flight) {
  const FlightStart start = flight.problem->start();
  return {start.status,         start.message,        start.x,    start.noise,
          stack(start.factors), start.output_squares, start.rows, start.floor};
}

MatrixXd linearise(const PreparedFlight& flight, const VectorXd& x) {
  return stack(flight.problem->linearise(x));
}

MatrixXd score_covariance(const PreparedFlight& flight, const Question& question) {
  const auto& [x, noise, rounding, columns, K] = question;
  return flight.problem->score_covariance({0, x, noise, rounding, columns, K});
}

Score score(const PreparedFlight& flight, const VectorXd& x) {
  const FlightScore score = flight.problem->score(x);
  return {score.factor.matrix(), score.cost, score.readings, score.row};
}

Innovations innovations(const PreparedFlight& flight, const VectorXd& x) {
  const FlightInnovations sums = flight.problem->innovations(x);
  return {sums.squares, sums.counts, sums.readings, sums.memory};
}

MatrixXd score_blocks(const PreparedFlight& flight, const std::tuple<VectorXd, int>& question) {
  const auto& [x, blocks] = question;
  return stack(flight.problem->score_blocks(x, blocks));
}

/// Asks `visit(kind, [(flight, argument), ...])`, which answers with a list in that order.
class MappedFlights final : public FlightSource {
 public:
  MappedFlights(std::vector<std::string> names, py::function visit)
      : names_(std::move(names)), visit_(std::move(visit)) {}

  std::vector<std::string> names() const override { return names_; }

  std::vector<FlightStart> start() override {
    const py::gil_scoped_acquire acquire;
    py::list questions;
    for (std::size_t i = 0; i < names_.size(); ++i) questions.append(py::make_tuple(i, py::none()));
    std::vector<FlightStart> starts;
    for (const py::handle answer : visit_("start", questions)) {
      auto [status, message, x, noise, factors, squares, rows, floor] = answer.cast<Start>();
      if (!status) {
        starts.push_back({.error = message});
        continue;
      }
      starts.push_back({.error = {},
                        .status = *status,
                        .message = message,
                        .x = x,
                        .noise = noise,
                        .factors = unstack(factors),
                        .output_squares = squares,
                        .rows = rows,
                        .floor = floor});
    }
    return starts;
  }

  std::vector<std::vector<TriangularFactor>> linearise(
      const std::vector<FlightPoint>& points) override {
    const py::gil_scoped_acquire acquire;
    std::vector<std::vector<TriangularFactor>> factors;
    for (const py::handle answer : visit_("linearise", questions_at(points))) {
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

  std::vector<FlightScore> scores(const std::vector<FlightPoint>& points) override {
    const py::gil_scoped_acquire acquire;
    std::vector<FlightScore> scores;
    for (const py::handle answer : visit_("score", questions_at(points))) {
      const auto [factor, cost, readings, row] = answer.cast<Score>();
      scores.push_back({unstack(factor).front(), cost, readings, row});
    }
    return scores;
  }

  std::vector<FlightInnovations> innovations(const std::vector<FlightPoint>& points) override {
    const py::gil_scoped_acquire acquire;
    std::vector<FlightInnovations> innovations;
    for (const py::handle answer : visit_("innovations", questions_at(points))) {
      const auto [squares, counts, readings, memory] = answer.cast<Innovations>();
      innovations.push_back({squares, counts, readings, memory});
    }
    return innovations;
  }

  std::vector<std::vector<TriangularFactor>> score_blocks(const std::vector<FlightPoint>& points,
                                                          const std::vector<int>& blocks) override {
    const py::gil_scoped_acquire acquire;
    py::list questions;
    for (std::size_t i = 0; i < points.size(); ++i) {
      questions.append(py::make_tuple(points[i].flight, py::make_tuple(points[i].x, blocks[i])));
    }
    std::vector<std::vector<TriangularFactor>> factors;
    for (const py::handle answer : visit_("score_blocks", questions)) {
      factors.push_back(unstack(answer.cast<MatrixXd>()));
    }
    return factors;
  }

 private:
  static py::list questions_at(const std::vector<FlightPoint>& points) {
    py::list questions;
    for (const FlightPoint& point : points) {
      questions.append(py::make_tuple(point.flight, point.x));
    }
    return questions;
  }

  std::vector<std::string> names_;
  py::function visit_;
};

/// A number of each shared parameter, by its name.
template <Eigen::VectorXd Departure::* member>
std::vector<OutputValue> by_name(const Departure& departure) {
  std::vector<OutputValue> values;
  for (std::size_t k = 0; k < departure.names.size(); ++k) {
    values.push_back({departure.names[k], (departure.*member)[static_cast<Eigen::Index>(k)]});
  }
  return values;
}

template <Eigen::VectorXd Departure::* member>
void set_by_name(Departure& departure, const std::vector<OutputValue>& values) {
  departure.names.clear();
  (departure.*member).resize(static_cast<Eigen::Index>(values.size()));
  for (const OutputValue& one : values) {
    (departure.*member)[static_cast<Eigen::Index>(departure.names.size())] = one.value;
    departure.names.push_back(one.name);
  }
}

std::string largest(const Departure& departure) {
  const Eigen::ArrayXd sizes =
      (departure.standard_error.array() > 0)
          .select(departure.difference.array().abs() / departure.standard_error.array(), -1.0);
  Eigen::Index place = 0;
  if (sizes.size() == 0 || !(sizes.maxCoeff(&place) >= 0.0)) return "";
  return departure.names[static_cast<std::size_t>(place)];
}

ManyFit fit_mapped(const Model& model, const std::vector<std::string>& names,
                   const CalibrationOptions& options, const std::vector<std::string>& own,
                   bool leave_out, const py::function& visit) {
  MappedFlights source(names, visit);
  const ManyOptions many = many_options(model, options, own, leave_out);
  const Released released;
  return fit_many(*model.block, source, many);
}

void define_results_of_many(py::module_& module) {
  BoundStruct<Departure>(
      module, "Departure",
      "Does a flight's own estimate of the shared parameters agree with that of all the others?\n\n"
      "Both to first order at the joint solution, along the combinations that both determine.")
      .field("combinations", &Departure::combinations, "k of them; 0: nothing can be tested.")
      .field("statistic", &Departure::statistic,
             "d' V^-1 d, d the difference, V as the flights' noise models have it.")
      .field("p", &Departure::p,
             "Probability of a larger one where nothing departs: F(k, rows x outputs - n).")
      .field("p_holm", &Departure::p_holm, "The same, by Holm for the number of flights.")
      .field("p_white", &Departure::p_white,
             "With white residuals of the common R, off the drop in cost.")
      .field("p_white_holm", &Departure::p_white_holm, "")
      .field("difference", &by_name<&Departure::difference>, &set_by_name<&Departure::difference>,
             "Own estimate less the others', by shared parameter; of a noise of its logarithm.")
      .field("standard_error", &by_name<&Departure::standard_error>,
             &set_by_name<&Departure::standard_error>, "Standard error of the difference.")
      .comparable()
      .finish()
      .def_property_readonly("largest", &largest,
                             "The shared parameter that differs by most of its standard errors; "
                             R"("" where none does.)");

  BoundStruct<FlightFit>(module, "FlightFit", "One flight of a joint fit.")
      .field("name", &FlightFit::name, "")
      .field("own", &FlightFit::own, "In the model's order.")
      .field("rmse", &FlightFit::rmse, "By output, in its unit.")
      .field("rows", &FlightFit::rows, "")
      .field("alone", &FlightFit::alone,
             "Status of the flight's fit by itself, where the joint one began.")
      .field("message", &FlightFit::message, "Message of that fit.")
      .field("departure", &FlightFit::departure, "")
      .comparable()
      .finish()
      .def("__getitem__", [](const FlightFit& self, const std::string& name) {
        return find_named(self.own, name, "own parameter", "the flight has");
      });

  BoundStruct<ManyFit>(module, "ManyFit", "A joint fit of many flights.")
      .field("status", &ManyFit::status, R"("converged", "not_converged" or "not_identifiable".)")
      .field("message", &ManyFit::message, "One line; empty where there is nothing to say.")
      .field("shared", &ManyFit::shared, "In the model's order, fixed ones among them.")
      .field("covariance", &ManyFit::covariance,
             "Covariance of the shared parameters, in that order; NaN without a standard error.")
      .field("correlation", &ManyFit::correlation, "")
      .field("covariance_white", &ManyFit::covariance_white, "As white residuals would have it.")
      .field("flights", &ManyFit::flights, "In the order given.")
      .field("left_out", &ManyFit::left_out, "Flights that can't be used, and why.")
      .field("noise", &ManyFit::noise,
             "By output, common to all flights: given, or from R-hat = SSE / N.")
      .field("rmse", &ManyFit::rmse, "Over all flights.")
      .field("cost", &ManyFit::cost, "J of Eq. 6 over all rows; by filter error V_m.")
      .field("method", &ManyFit::method, R"("output-error" or "filter-error".)")
      .field("noise_sizes", &ManyFit::noise_sizes,
             "By filter error: process noises, then outputs, common to all flights.")
      .field("log_likelihood", &ManyFit::log_likelihood, "By filter error.")
      .field("unobservable", &ManyFit::identifiability, &Identifiability::unobservable,
             "Unobservable combinations of the shared parameters.")
      .field("weak", &ManyFit::identifiability, &Identifiability::weak, "")
      .field("iterations", &ManyFit::iterations, "")
      .field("noise_iterations", &ManyFit::noise_iterations, "")
      .field("passes", &ManyFit::passes, "Over the data, beside each flight's own fit.")
      .field("rows", &ManyFit::rows, "Rows of all flights.")
      .copied()
      .finish()
      .def("__getitem__", [](const ManyFit& self, const std::string& name) {
        return find_named(self.shared, name, "shared parameter", "the fit has");
      });
}

}  // namespace

void define_many(py::module_& module) {
  define_results_of_many(module);
  py::class_<PreparedFlight>(module, "PreparedFlight")
      .def("start", &start, WithoutGil())
      .def("linearise", &linearise, WithoutGil())
      .def("score_covariance", &score_covariance, WithoutGil())
      .def("score", &score, WithoutGil())
      .def("innovations", &innovations, WithoutGil())
      .def("score_blocks", &score_blocks, WithoutGil());
  module.def("prepare_flight", &prepare_flight, WithoutGil());
  module.def("prepare_columns", &prepare_columns);
  module.def("fit_many", &fit_mapped);
}

}  // namespace sepcal::bindings
