// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/check_model.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "estimation/model_trial.hpp"
#include "estimation/sampling.hpp"
#include "model/measurements.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace estimation;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t places_tried = 4;  // spread over the record, which may begin at rest
constexpr std::size_t samples_a_place = 4;
constexpr int points_tried = 3;
constexpr double derivative_tolerance = 1e-4;   // relative to the largest entry of the column's row
constexpr double linear_tolerance = 1e-6;       // relative to the largest entry of the column
constexpr double accumulated_rounding = 1e-13;  // of values, relative: a trajectory's, step by step
constexpr double difference_step = 1e-5;        // times half the bounds' width, else size or 1

/// Points of xi2: the start or the nominal one, and draws where the bounds are finite.
MatrixXd points_to_try(const Tables& tables, const std::map<std::string, double>& start) {
  FitOptions options;
  options.start = start;
  options.samples = points_tried - 1;
  const VectorXd nominal = nominal_point(tables.nonlinear, options);
  MatrixXd points = nominal.replicate(1, points_tried);
  const bool bounded = std::ranges::all_of(tables.nonlinear, [](const Variable& parameter) {
    return std::isfinite(parameter.lower) && std::isfinite(parameter.upper);
  });
  if (bounded) points.rightCols(points_tried - 1) = draw_samples(tables.nonlinear, options);
  return points;
}

/// The first samples of blocks that lie evenly over the record; of segments, for a model that
/// carries a state from their start on.
std::vector<model::Measurements::Range> ranges_to_try(const BlockModel& model,
                                                      const model::Measurements& measurements) {
  std::vector<model::Measurements::Range> all;
  for (const auto& chunk : measurements.chunks()) all.insert(all.end(), chunk.begin(), chunk.end());
  if (model.new_carry() != nullptr) {
    std::erase_if(all, [](const auto& range) { return !range.starts_segment; });
  }
  std::vector<model::Measurements::Range> tried;
  const std::size_t places = std::min(places_tried, all.size());
  for (std::size_t i = 0; i < places; ++i) {
    tried.push_back(all[places == 1 ? 0 : i * (all.size() - 1) / (places - 1)]);
    tried.back().rows = std::min(tried.back().rows, samples_a_place);
  }
  if (places == 1) tried.front().rows = std::min(all.front().rows, places_tried * samples_a_place);
  return tried;
}

std::string entry_name(const Tables& tables, Index output, Index column) {
  const std::string of = " (output '" + tables.outputs[static_cast<std::size_t>(output)].name + "'";
  if (column == tables.n_1()) return "b[" + std::to_string(output) + "]" + of + ")";
  return "A(" + std::to_string(output) + ", " + std::to_string(column) + ")" + of +
         ", parameter '" + tables.linear[static_cast<std::size_t>(column)].name + "')";
}

class Trial {
 public:
  Trial(const BlockModel& model, const Block& block) : model_(model), block_(block) {}

  MatrixXd values(const VectorXd& xi2) const { return evaluate(xi2, nullptr); }
  MatrixXd tangent(const VectorXd& xi2, const VectorXd& xi1) const { return evaluate(xi2, &xi1); }

 private:
  MatrixXd evaluate(const VectorXd& xi2, const VectorXd* xi1) const {
    const Tables& tables = model_.tables();
    const int columns = tables.n_1() + (xi1 == nullptr ? 0 : tables.n_2()) + 1;
    MatrixXd rows = MatrixXd::Constant(tables.n_z() * static_cast<Index>(block_.rows), columns,
                                       std::numeric_limits<double>::quiet_NaN());
    const auto carry = model_.new_carry();
    model_.evaluate(block_, xi2.data(), xi1 == nullptr ? nullptr : values_of(*xi1), carry.get(),
                    rows);
    return rows;
  }

  const BlockModel& model_;
  const Block& block_;
};

/// [A | b] at one place and point.
struct Seen {
  MatrixXd values;
  Index rows = 0;
  Index first = 0;  // the row from which on the model has done all that it does
};

void check_entries_set(const Tables& tables, const std::vector<Seen>& seen, bool carries,
                       bool started) {
  for (Index column = 0; column <= tables.n_1(); ++column) {
    for (Index j = 0; j < tables.n_z(); ++j) {
      const bool ever = std::ranges::any_of(seen, [&](const Seen& at) {
        const auto entries = at.values.col(column).segment(j * at.rows, at.rows);
        return entries.tail(at.rows - at.first).array().isFinite().any();
      });
      if (ever) continue;
      throw Error(
          "the model's " + entry_name(tables, j, column) +
          " is not a finite number at any sample tried; set every entry of A and b in at()" +
          (carries ? ", and every state's rate" : "") + (started ? ", or start elsewhere" : ""));
    }
  }
}

void check_same(const Tables& tables, const MatrixXd& once, const MatrixXd& again, Index rows) {
  for (Index column = 0; column < once.cols(); ++column) {
    for (Index row = 0; row < once.rows(); ++row) {
      const auto bits = std::bit_cast<std::uint64_t>(once(row, column));
      if (bits == std::bit_cast<std::uint64_t>(again(row, column))) continue;
      throw Error(
          "the model's " + entry_name(tables, row / rows, column) +
          " differs between two evaluations of the same sample; at() must be a pure function");
    }
  }
}

/// A and b don't depend on xi1, as they do where a trajectory isn't linear in a parameter that its
/// model calls linear.
void check_linear(const Trial& trial, const Tables& tables, const VectorXd& xi2,
                  const MatrixXd& values, Index rows) {
  const Index n_1 = tables.n_1();
  MatrixXd again = trial.tangent(xi2, VectorXd::Ones(n_1));
  again.col(n_1) = again.rightCols<1>().eval();
  if (!values.allFinite() || !again.allFinite()) return;
  for (Index column = 0; column <= n_1; ++column) {
    const VectorXd difference = (again.col(column) - values.col(column)).cwiseAbs();
    Index row = 0;
    const double largest = difference.maxCoeff(&row);
    const double size =
        column < n_1 ? values.col(column).cwiseAbs().maxCoeff() : values.cwiseAbs().maxCoeff();
    if (largest <= linear_tolerance * size) continue;
    throw Error("the model's " + entry_name(tables, row / rows, column) +
                " changes with the linear parameters; what multiplies them, and what is added, "
                "must not depend on them (a table linear_dynamic, even an empty one, says that the "
                "rates of a model are linear in its states)");
  }
}

/// Lengths over which the differences of a parameter are taken. How small an unbounded one is meant
/// to be only its start tells: its size is tried where 1 is too far. Near a kink, as of a speed
/// over the ground that is the wind's, only the short ones are exact.
std::vector<double> steps_to_try(const Variable& parameter, double value) {
  const double width = 0.5 * (parameter.upper - parameter.lower);
  const double size = std::abs(value);
  const double step = difference_step * (std::isfinite(width) ? width : std::max(1.0, size));
  std::vector<double> steps{step, step / 32.0, step / 1024.0};
  if (!std::isfinite(width) && size > 0.0 && size < 1.0) steps.push_back(difference_step * size);
  return steps;
}

/// Central differences of the outputs at xi1 = 1 with respect to xi2[k].
VectorXd differentiate(const Trial& trial, const VectorXd& xi2, Index k, double step) {
  VectorXd above = xi2;
  VectorXd below = xi2;
  above[k] += step;
  below[k] -= step;
  return (trial.values(above) - trial.values(below)).rowwise().sum() / (above[k] - below[k]);
}

void check_derivatives(const Trial& trial, const Tables& tables, const VectorXd& xi2, Index rows) {
  const Index n_1 = tables.n_1();
  const VectorXd xi1 = VectorXd::Ones(n_1);
  const MatrixXd tangent = trial.tangent(xi2, xi1);
  if (!tangent.allFinite()) return;
  const double size = trial.values(xi2).cwiseAbs().maxCoeff();
  const double smallest_scale = 1e-6 * size;
  for (Index k = 0; k < tables.n_2(); ++k) {
    const Variable& parameter = tables.nonlinear[static_cast<std::size_t>(k)];
    const VectorXd given = tangent.col(n_1 + k);
    VectorXd numeric;
    Index row = 0;
    const auto steps = steps_to_try(parameter, xi2[k]);
    const bool agree = std::ranges::any_of(steps, [&](double step) {
      numeric = differentiate(trial, xi2, k, step);
      const double scale =
          std::max({numeric.cwiseAbs().maxCoeff(), given.cwiseAbs().maxCoeff(), smallest_scale});
      const double difference = (numeric - given).cwiseAbs().maxCoeff(&row);
      const double rounding = accumulated_rounding * size / step;
      return !numeric.allFinite() || difference <= derivative_tolerance * scale + rounding;
    });
    if (agree) continue;
    throw Error("the model's derivative of output '" +
                tables.outputs[static_cast<std::size_t>(row / rows)].name + "' with respect to '" +
                parameter.name + "' is not that of its values (at() gives " +
                std::to_string(given[row]) + ", central differences " +
                std::to_string(numeric[row]) + "); compute in the type of xi2 throughout");
  }
}

}  // namespace

void check_model(const BlockModel& model, const Record& record,
                 const std::map<std::string, double>& start) {
  std::map<std::string, double> begun = start;
  begun.merge(model.starting_values(record));
  try_model(model, model::Measurements(model, record), begun);
}

void estimation::try_model(const BlockModel& model, const model::Measurements& measurements,
                           const std::map<std::string, double>& start) {
  if (measurements.chunks().empty()) {
    throw Error("the record has no rows; a model can't be tried on it");
  }
  const Tables& tables = model.tables();
  const MatrixXd points = points_to_try(tables, start);
  const bool carries = model.new_carry() != nullptr;
  std::vector<Seen> seen;
  for (const model::Measurements::Range& range : ranges_to_try(model, measurements)) {
    std::vector<const double*> pointers;
    const Block block = measurements.block(range, pointers);
    const auto rows = static_cast<Index>(range.rows);
    const Trial trial(model, block);
    for (Index i = 0; i < points.cols(); ++i) {
      // The first row of a trajectory is no step yet.
      seen.push_back({trial.values(points.col(i)), rows, carries && rows > 1 ? 1 : 0});
      check_same(tables, seen.back().values, trial.values(points.col(i)), rows);
      check_linear(trial, tables, points.col(i), seen.back().values, rows);
      check_derivatives(trial, tables, points.col(i), rows);
    }
  }
  check_entries_set(tables, seen, carries, !start.empty());
}

}  // namespace sepcal
