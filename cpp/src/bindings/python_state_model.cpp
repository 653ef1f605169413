// SPDX-License-Identifier: BSD-3-Clause
#include "python_state_model.hpp"

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace sepcal::bindings {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::ssize_t length(std::size_t count) { return static_cast<py::ssize_t>(count); }

/// The column of a record at a row; what stands for it where the record has none.
double value_at(const Record& record, const Variable& variable, std::size_t row) {
  return record.has(variable.name) ? record.column(variable.name)[row] : variable.absent;
}

}  // namespace

/// A pass: where it has come to in Python, and the trajectory that is running (-1: none yet).
struct PythonStateModel::Path final : Carry {
  explicit Path(py::object where)
      : python(new py::object(std::move(where)), [](const py::object* released) {
          const py::gil_scoped_acquire gil;
          delete released;
        }) {}

  std::shared_ptr<const py::object> python;
  int trajectory = -1;
};

/// What Walk.walk() gave, and each row's trajectory.
struct PythonStateModel::Answer {
  Numbers A;       // (n_z, n_1, rows, P) of the model's own tables
  Numbers b;       // (n_z, rows, P)
  Numbers slopes;  // (n_z, rows, P, w)
  std::vector<int> trajectories;
  std::vector<int> seeds;  // places in p of the last of the w
};

PythonStateModel::PythonStateModel(TrajectoryPlan plan, std::shared_ptr<const py::object> walk)
    : StateBlockModel(plan.tables()), plan_(std::move(plan)), walk_(std::move(walk)) {}

std::unique_ptr<Carry> PythonStateModel::new_carry() const {
  const py::gil_scoped_acquire gil;
  return std::make_unique<Path>(walk_->attr("new_path")());
}

/// What the model's start(u, z) says of a row; None where it has none.
py::object PythonStateModel::start_at(const Record& record, std::size_t row) const {
  std::vector<double> u;
  std::vector<double> z;
  for (const Variable& input : plan_.model().inputs) u.push_back(value_at(record, input, row));
  for (const Variable& output : plan_.model().outputs) z.push_back(value_at(record, output, row));
  return walk_->attr("start")(Numbers(length(u.size()), u.data()),
                              Numbers(length(z.size()), z.data()));
}

std::map<std::string, double> PythonStateModel::starting_values(const Record& record) const {
  std::map<std::string, double> values;
  if (plan_.separable()) return values;
  const std::vector<std::size_t> rows = plan_.starts_in(record);
  const py::gil_scoped_acquire gil;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    const py::object answer = start_at(record, rows[t]);
    for (const int i : plan_.integrated()) {
      const Variable& state = plan_.model().states[static_cast<std::size_t>(i)];
      const bool sampled = std::isfinite(state.lower) && std::isfinite(state.upper);
      if (answer.is_none() && sampled) continue;
      values[plan_.start_name(state.name, static_cast<int>(t))] =
          answer.is_none() ? 0.0 : answer.cast<Numbers>().at(i);
    }
  }
  return values;
}

/// What Walk calls known of the rows: u, time, measured states.
MatrixXd PythonStateModel::known_of(const Block& block) const {
  std::vector<int> places;
  for (int i = 0; i < static_cast<int>(plan_.model().inputs.size()); ++i) places.push_back(i);
  places.push_back(plan_.time_input());
  for (std::size_t i = 0; i < plan_.measured().size(); ++i) {
    places.push_back(plan_.measured_input(i));
  }
  const auto rows = static_cast<Index>(block.rows);
  MatrixXd known(rows, static_cast<Index>(places.size()));
  for (Index i = 0; i < known.cols(); ++i) {
    const auto input = static_cast<std::size_t>(places[static_cast<std::size_t>(i)]);
    known.col(i) = Eigen::Map<const VectorXd>(block.inputs[input], rows);
  }
  return known;
}

/// Rows of all parameters at several points, chosen by their columns; zero where that is -1.
MatrixXd PythonStateModel::rows_at(const MatrixXd& points, const std::vector<int>& columns) {
  MatrixXd chosen = MatrixXd::Zero(static_cast<Index>(columns.size()), points.cols());
  for (Index i = 0; i < chosen.rows(); ++i) {
    const int column = columns[static_cast<std::size_t>(i)];
    if (column >= 0) chosen.row(i) = points.row(column);
  }
  return chosen;
}

/// p (n_p x points).
MatrixXd PythonStateModel::p_at(const MatrixXd& points) const {
  std::vector<int> columns;
  for (int i = 0; i < static_cast<int>(plan_.model().nonlinear.size()); ++i) {
    columns.push_back(plan_.column_of_parameter(i));
  }
  return rows_at(points, columns);
}

/// The model's own linear parameters (n_1 x points), zero where one isn't in use.
MatrixXd PythonStateModel::linear_at(const MatrixXd& points) const {
  std::vector<int> columns(plan_.model().linear.size(), -1);
  for (std::size_t k = 0; k < plan_.linear().size(); ++k) {
    columns[static_cast<std::size_t>(plan_.linear()[k])] = static_cast<int>(k);
  }
  return rows_at(points, columns);
}

/// The states at a trajectory's start (n_x x points); zero where measured.
MatrixXd PythonStateModel::starts_at(const MatrixXd& points, int trajectory) const {
  std::vector<int> columns;
  for (int i = 0; i < static_cast<int>(plan_.model().states.size()); ++i) {
    columns.push_back(plan_.column_of_start(i, trajectory));
  }
  return rows_at(points, columns);
}

PythonStateModel::Answer PythonStateModel::walk(const Block& block, const MatrixXd& points,
                                                bool tangent, Path& path) const {
  Answer answer;
  py::list begins;
  py::list starts;
  for (std::size_t row = 0; row < block.rows; ++row) {
    const int at = plan_.trajectory_at(block.first + row, row == 0 && block.starts_segment);
    if (at >= 0) {
      path.trajectory = at;
      begins.append(row);
      starts.append(starts_at(points, at));
    }
    answer.trajectories.push_back(path.trajectory);
  }
  const MatrixXd p = p_at(points);
  if (tangent) {
    answer.seeds.resize(static_cast<std::size_t>(p.rows()));
    std::iota(answer.seeds.begin(), answer.seeds.end(), 0);
  } else if (plan_.separable()) {
    answer.seeds = plan_.model().linear_dynamic;
  }
  const bool slopes = tangent || plan_.separable();
  const py::object seeds = slopes ? py::cast(answer.seeds) : py::none();
  const py::tuple arrays = walk_->attr("walk")(*path.python, known_of(block), begins, starts, p,
                                               seeds, linear_at(points));
  answer.A = arrays[0].cast<Numbers>();
  answer.b = arrays[1].cast<Numbers>();
  answer.slopes = arrays[2].cast<Numbers>();
  return answer;
}

/// Rows of one point, all of whose parameters are xi; nonlinear ones have columns where there is
/// room for them.
void PythonStateModel::place(const Block& block, const Answer& answer, Index point,
                             const VectorXd& xi, Rows rows) const {
  const auto A = answer.A.unchecked<4>();
  const auto b = answer.b.unchecked<3>();
  const auto slopes = answer.slopes.unchecked<4>();
  const auto n = static_cast<Index>(block.rows);
  const int n_1 = tables().n_1();
  rows.setZero();
  for (std::size_t j = 0; j < plan_.outputs().size(); ++j) {
    const int output = plan_.outputs()[j];
    for (Index row = 0; row < n; ++row) {
      auto out = rows.row(static_cast<Index>(j) * n + row);
      const int trajectory = answer.trajectories[static_cast<std::size_t>(row)];
      if (trajectory < 0) {
        out.setConstant(not_a_number);
        continue;
      }
      for (const int k : plan_.acting(j)) {
        out[k] = A(output, plan_.linear()[static_cast<std::size_t>(k)], row, point);
      }
      double rest = b(output, row, point);
      for (py::ssize_t i = 0; i < slopes.shape(3); ++i) {
        const auto seed = static_cast<std::size_t>(i);
        const int to =
            seed < plan_.integrated().size()
                ? plan_.column_of_start(plan_.integrated()[seed], trajectory)
                : plan_.column_of_parameter(answer.seeds[seed - plan_.integrated().size()]);
        out[to] = slopes(output, row, point, i);
        if (to < n_1) rest -= out[to] * xi[to];
      }
      out[out.size() - 1] = rest;
    }
  }
}

void PythonStateModel::evaluate(const Block& block, const double* xi2, const double* xi1,
                                Carry* carry, Rows rows) const {
  const py::gil_scoped_acquire gil;
  VectorXd xi = VectorXd::Zero(tables().n_1() + tables().n_2());
  if (xi1 != nullptr) xi.head(tables().n_1()) = Eigen::Map<const VectorXd>(xi1, tables().n_1());
  xi.tail(tables().n_2()) = Eigen::Map<const VectorXd>(xi2, tables().n_2());
  const Answer answer = walk(block, xi, xi1 != nullptr, static_cast<Path&>(*carry));
  place(block, answer, 0, xi, rows);
}

void PythonStateModel::evaluate_points(const Block& block, const MatrixXd& points,
                                       std::span<const std::unique_ptr<Carry>> carries,
                                       MatrixXd& scratch, const VisitRows& visit) const {
  const py::gil_scoped_acquire gil;
  MatrixXd xi = MatrixXd::Zero(tables().n_1() + tables().n_2(), points.cols());
  xi.bottomRows(tables().n_2()) = points;
  // One path for all of them: the first one's.
  const Answer answer = walk(block, xi, false, static_cast<Path&>(*carries.front()));
  scratch.resize(static_cast<Index>(block.rows) * tables().n_z(), tables().n_1() + 1);
  for (Index s = 0; s < points.cols(); ++s) {
    place(block, answer, s, xi.col(s), scratch);
    visit(s, scratch);
  }
}

/// A filter's way along the record, a call of Python a step.
class PythonStateModel::Steps final : public StateSteps {
 public:
  Steps(const PythonStateModel& model, const Record& record, const VectorXd& xi)
      : model_(model), plan_(model.plan()), record_(record) {
    Steps::set_parameters(xi);
    for (int i = 0; i < static_cast<int>(plan_.model().nonlinear.size()); ++i) seeds_.push_back(i);
  }

  void set_parameters(const VectorXd& xi) override {
    p_ = model_.p_at(xi);
    xi1_ = model_.linear_at(xi);
  }

  Step advance(std::size_t row, const VectorXd& x) const override { return step(row, x, {}); }

  /// From a step so short that it is linear in its duration.
  MatrixXd rate_slopes(std::size_t row, const VectorXd& x) const override {
    if (plan_.discrete()) return MatrixXd::Zero(n_x(), n_x());
    constexpr double share = 0x1p-10;
    const std::span<const double> time = record_.column("time");
    const double moment = share * (time[row + 1] - time[row]);
    MatrixXd known = known_at(row, 1).replicate(2, 1);
    known(1, static_cast<Index>(plan_.model().inputs.size())) += moment;
    const py::gil_scoped_acquire gil;
    const py::tuple arrays = model_.walk_->attr("step")(known, x, p_, std::vector<int>{});
    return (arrays[1].cast<MatrixXd>() - MatrixXd::Identity(n_x(), n_x())) / moment;
  }

  Reading read(std::size_t row, const VectorXd& x) const override {
    const py::gil_scoped_acquire gil;
    const py::tuple arrays = ask(row, x, {});
    return {arrays[0].cast<VectorXd>()(plan_.outputs()),
            arrays[1].cast<MatrixXd>()(plan_.outputs(), Eigen::all)};
  }

  JointStep advance_jointly(std::size_t row, const VectorXd& x,
                            const VectorXd& density) const override {
    const Step taken = step(row, x, seeds_);
    const VectorXd variances = plan_.noise_variances(density, duration(row));
    return {taken.x, in_columns(taken.Phi),
            taken.Gamma * variances.asDiagonal() * taken.Gamma.transpose()};
  }

  Reading read_jointly(std::size_t row, const VectorXd& x) const override {
    const py::gil_scoped_acquire gil;
    const py::tuple arrays = ask(row, x, seeds_);
    const auto A = arrays[2].cast<MatrixXd>();
    MatrixXd H = in_columns(arrays[1].cast<MatrixXd>()(plan_.outputs(), Eigen::all));
    for (std::size_t j = 0; j < plan_.outputs().size(); ++j) {
      for (const int k : plan_.acting(j)) {
        H(static_cast<Index>(j), n_x() + k) +=
            A(plan_.outputs()[j], plan_.linear()[static_cast<std::size_t>(k)]);
      }
    }
    return {arrays[0].cast<VectorXd>()(plan_.outputs()), std::move(H)};
  }

  SecondOrderStep advance_to_second_order(std::size_t row, const VectorXd& x) const override {
    SecondOrderStep step;
    SecondOrderNoise noise;
    {
      const py::gil_scoped_acquire gil;
      const py::tuple arrays =
          model_.walk_->attr("second_order_step")(known_at(row, 2), x, p_, seeds_);
      const MatrixXd slopes = in_columns(arrays[1].cast<MatrixXd>());
      step.x = arrays[0].cast<VectorXd>();
      step.Phi = slopes.leftCols(n_x());
      step.Pi = acting(slopes).rightCols(acting_count());
      step.Phi_slopes = acting(in_columns(flatten(arrays[3].cast<Numbers>()))).transpose();
      noise.G = arrays[2].cast<MatrixXd>();
      noise.constant = false;
      noise.slopes = acting(in_columns(flatten(arrays[4].cast<Numbers>()))).transpose();
    }
    add_noise(step, noise, duration(row), plan_.discrete());
    return step;
  }

  SecondOrderReading read_to_second_order(std::size_t row, const VectorXd& x) const override {
    const py::gil_scoped_acquire gil;
    const py::tuple arrays =
        model_.walk_->attr("second_order_reading")(known_at(row, 1), x, p_, xi1_, seeds_);
    const std::vector<int>& outputs = plan_.outputs();
    const auto n_z = static_cast<Index>(outputs.size());
    const auto A = arrays[2].cast<MatrixXd>();
    const auto A_slopes = arrays[4].cast<Numbers>();
    MatrixXd slopes = in_columns(arrays[1].cast<MatrixXd>()(outputs, Eigen::all));
    MatrixXd curvatures = in_columns(flatten(arrays[3].cast<Numbers>(), outputs));
    for (std::size_t j = 0; j < outputs.size(); ++j) {
      for (const int k : plan_.acting(j)) {
        const int linear = plan_.linear()[static_cast<std::size_t>(k)];
        slopes(static_cast<Index>(j), n_x() + k) += A(outputs[j], linear);
        for (Index i = 0; i < n_x(); ++i) {
          curvatures(i * n_z + static_cast<Index>(j), n_x() + k) +=
              A_slopes.at(outputs[j], linear, i);
        }
      }
    }
    SecondOrderReading reading;
    reading.z = arrays[0].cast<VectorXd>()(outputs);
    reading.H = slopes.leftCols(n_x());
    reading.J = acting(slopes).rightCols(acting_count());
    reading.H_slopes = acting(curvatures).transpose();
    return reading;
  }

  VectorXd start(std::size_t row) const override {
    const py::gil_scoped_acquire gil;
    const py::object answer = model_.start_at(record_, row);
    if (answer.is_none()) return VectorXd::Zero(n_x());
    return answer.cast<VectorXd>()(plan_.integrated());
  }

 private:
  Index n_x() const { return static_cast<Index>(plan_.integrated().size()); }

  Step step(std::size_t row, const VectorXd& x, const std::vector<int>& seeds) const {
    const py::gil_scoped_acquire gil;
    const py::tuple arrays = model_.walk_->attr("step")(known_at(row, 2), x, p_, seeds);
    auto Phi = arrays[1].cast<MatrixXd>();
    auto G = arrays[2].cast<MatrixXd>();
    if (plan_.discrete()) return {arrays[0].cast<VectorXd>(), std::move(Phi), std::move(G)};
    const NoiseResponse<Eigen::Dynamic> response(Phi.leftCols(n_x()), duration(row));
    MatrixXd Gamma(n_x(), 2 * G.cols());
    Gamma << response.mean() * G, response.slope() * G;
    return {arrays[0].cast<VectorXd>(), std::move(Phi), std::move(Gamma)};
  }

  /// To the next row, s.
  double duration(std::size_t row) const {
    const std::span<const double> time = record_.column("time");
    return time[row + 1] - time[row];
  }

  py::tuple ask(std::size_t row, const VectorXd& x, const std::vector<int>& seeds) const {
    return model_.walk_->attr("read")(known_at(row, 1), x, p_, xi1_, seeds);
  }

  /// Derivatives by x and p as those by x and all parameters.
  MatrixXd in_columns(const MatrixXd& derivative) const {
    const Index n = n_x();
    MatrixXd result =
        MatrixXd::Zero(derivative.rows(), n + plan_.tables().n_1() + plan_.tables().n_2());
    result.leftCols(n) = derivative.leftCols(n);
    for (std::size_t i = 0; i < seeds_.size(); ++i) {
      const int column = plan_.column_of_parameter(seeds_[i]);
      if (column >= 0) result.col(n + column) = derivative.col(n + static_cast<Index>(i));
    }
    return result;
  }

  Index acting_count() const { return static_cast<Index>(plan_.acting_columns().size()); }

  /// Of columns by x and all parameters those by x and the parameters that act.
  MatrixXd acting(const MatrixXd& all) const {
    MatrixXd result(all.rows(), n_x() + acting_count());
    result.leftCols(n_x()) = all.leftCols(n_x());
    result.rightCols(acting_count()) =
        all.rightCols(all.cols() - n_x())(Eigen::all, plan_.acting_columns());
    return result;
  }

  /// (rows, columns, w), of some of the rows, to (columns * rows, w), column by column.
  static MatrixXd flatten(const Numbers& array, const std::vector<int>& rows) {
    const auto values = array.unchecked<3>();
    const auto count = static_cast<Index>(rows.size());
    MatrixXd flat(values.shape(1) * count, values.shape(2));
    for (py::ssize_t column = 0; column < values.shape(1); ++column) {
      for (Index row = 0; row < count; ++row) {
        for (py::ssize_t w = 0; w < values.shape(2); ++w) {
          flat(column * count + row, w) = values(rows[static_cast<std::size_t>(row)], column, w);
        }
      }
    }
    return flat;
  }
  static MatrixXd flatten(const Numbers& array) {
    std::vector<int> all(static_cast<std::size_t>(array.shape(0)));
    std::iota(all.begin(), all.end(), 0);
    return flatten(array, all);
  }

  MatrixXd known_at(std::size_t row, std::size_t rows) const {
    std::vector<const double*> inputs;
    for (const Variable& input : model_.tables().inputs) {
      inputs.push_back(record_.column(input.name).data() + row);
    }
    return model_.known_of({.inputs = inputs, .rows = rows, .first = row});
  }

  const PythonStateModel& model_;
  const TrajectoryPlan& plan_;
  const Record& record_;
  std::vector<int> seeds_;  // places in p
  VectorXd p_;
  VectorXd xi1_;
};

std::unique_ptr<StateSteps> PythonStateModel::steps(const Record& record,
                                                    const VectorXd& xi) const {
  return std::make_unique<Steps>(*this, record, xi);
}

}  // namespace sepcal::bindings
