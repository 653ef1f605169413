// SPDX-License-Identifier: BSD-3-Clause
// From a state model to the waist: x is integrated along each segment, and its sensitivities
// S = dx/d(p, x(0)) with it: S <- Phi S + Pi, Phi = dx+/dx and Pi = dx+/dp from one step in dual
// numbers. Then D = H_x S + H_p. Where the dynamics are linear, the columns of S that belong to
// linear parameters and initial states are, by superposition, columns of A.
#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/states/integration.hpp"
#include "sepcal/detail/states/model_steps.hpp"
#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/detail/states/trajectory_plan.hpp"
#include "sepcal/states/state_model.hpp"

namespace sepcal {

/// A state model's tables at run time. A model may say `static constexpr bool acts_on(int linear,
/// int output)`, by default true, and `static constexpr bool is_scale(int linear)`, by default
/// false. Where inputs and parameters are chosen at run time, `void name_tables(StateTables&)
/// const` names those that are in use; the others, without names, are zero and in no table.
template <StateModel M>
StateTables state_tables_of(const M& model) {
  const auto variables = [](const auto& table) {
    return std::vector<Variable>(table.begin(), table.end());
  };
  StateTables tables{variables(M::inputs), variables(M::states), variables(M::outputs),
                     variables(M::linear), variables(M::nonlinear)};
  constexpr auto places = linear_dynamic_places<M>();
  tables.linear_dynamic.assign(places.begin(), places.end());
  tables.linear_in_state = has_linear_dynamics<M>();
  tables.noise = variables(M::noise);
  tables.discrete = is_discrete<M>();
  for (int k = 0; k < StateSizes<M>::n_1; ++k) {
    std::vector<bool> acts(M::outputs.size(), true);
    if constexpr (requires { M::acts_on(0, 0); }) {
      for (int j = 0; j < StateSizes<M>::n_z; ++j) {
        acts[static_cast<std::size_t>(j)] = M::acts_on(k, j);
      }
    }
    tables.acts_on.push_back(std::move(acts));
    bool scale = false;
    if constexpr (requires { M::is_scale(0); }) scale = M::is_scale(k);
    tables.scales.push_back(scale);
  }
  if constexpr (requires { model.name_tables(tables); }) model.name_tables(tables);
  return tables;
}

/// The linear parameters are the model's own, then, where the dynamics are linear and nothing else
/// is asked for, those of `linear_dynamic` and the initial states. The others are nonlinear, the
/// initial states last: `alpha_0`, or `alpha_0[label]` or `alpha_0[2]` of each segment where there
/// are several. Inputs are the model's, measured states, and `time`, s.
template <StateModel M>
class TrajectoryModel final : public StateBlockModel {
 public:
  /// For the segments of this record, whose rows it must be fitted to; the record isn't kept. A
  /// model may have `static void check(const Record&, const TrajectoryOptions&)`, which throws
  /// Error for a record that is none of its own. Throws Error as TrajectoryPlan does.
  TrajectoryModel(const M& model, const Record& record, const TrajectoryOptions& options = {})
      : TrajectoryModel(model, TrajectoryPlan(state_tables_of(model), &record, options)) {
    if constexpr (requires { M::check(record, options); }) M::check(record, options);
  }

  /// For any record: all of its segments begin at one initial state. So are many flights fitted,
  /// each a segment with an initial state of its own.
  explicit TrajectoryModel(const M& model, const TrajectoryOptions& options = {})
      : TrajectoryModel(model, TrajectoryPlan(state_tables_of(model), nullptr, options)) {}

  const M& state_model() const { return model_; }
  const TrajectoryPlan& plan() const override { return plan_; }

  std::unique_ptr<StateSteps> steps(const Record& record,
                                    const Eigen::VectorXd& xi) const override {
    return std::make_unique<ModelSteps<M>>(model_, plan_, record, xi);
  }

  /// The initial states by name, from the model's start(u, z) at the first rows, z NaN for outputs
  /// that the record doesn't have; zero where the model has no start().
  std::map<std::string, double> initial_states(const Record& record) const {
    const std::vector<std::size_t> rows = plan_.starts_in(record);
    std::map<std::string, double> result;
    for (int t = 0; t < plan_.trajectories(); ++t) {
      const Vec<double, n_x> x = start_of_model(model_, record, rows[static_cast<std::size_t>(t)]);
      for (int i = 0; i < n_x; ++i) {
        if (plan_.column_of_start(i, t) < 0) continue;
        result[plan_.start_name(std::string(state(i).name), t)] = x[i];
      }
    }
    return result;
  }

  /// Of the initial states that are nonlinear. Without start() none that has bounds to sample.
  std::map<std::string, double> starting_values(const Record& record) const override {
    std::map<std::string, double> values = initial_states(record);
    const std::vector<Variable>& nonlinear = plan_.tables().nonlinear;
    std::erase_if(values, [&](const auto& each) {
      const auto at = std::ranges::find(nonlinear, each.first, &Variable::name);
      return at == nonlinear.end() ||
             (!has_start<M>() && std::isfinite(at->lower) && std::isfinite(at->upper));
    });
    return values;
  }

  /// x at every row of the record, (rows x n_x), by the parameters' values; NaN outside segments.
  /// Throws std::out_of_range for a parameter without a value.
  Eigen::MatrixXd states(const Record& record, const std::map<std::string, double>& values) const {
    const std::vector<Variable> parameters = plan_.tables().parameters();
    Eigen::VectorXd xi(static_cast<Eigen::Index>(parameters.size()));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      xi[static_cast<Eigen::Index>(i)] = values.at(parameters[i].name);
    }
    const int n_1_all = plan_.tables().n_1();
    const Point point{xi.data() + n_1_all, xi.data(), n_1_all};
    Eigen::MatrixXd x =
        Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(record.length()), n_x, not_a_number);
    for (const Segment& segment : record.segments()) follow(record, segment, point, x);
    return x;
  }

  std::unique_ptr<Carry> new_carry() const override { return std::make_unique<Path>(); }

  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                Eigen::Ref<Eigen::MatrixXd> rows) const override {
    auto& path = static_cast<Path&>(*carry);
    const Point point{xi2, xi1, plan_.tables().n_1()};
    if (xi1 != nullptr) return walk<AllSeeds>(block, point, path, rows);
    if constexpr (has_linear_dynamics<M>()) {
      if (plan_.separable()) return walk<LinearSeeds>(block, point, path, rows);
    }
    walk<NoSeeds>(block, point, path, rows);
  }

 private:
  static constexpr int n_u = StateSizes<M>::n_u;
  static constexpr int n_x = StateSizes<M>::n_x;
  static constexpr int n_z = StateSizes<M>::n_z;
  static constexpr int n_1 = StateSizes<M>::n_1;
  static constexpr int n_p = StateSizes<M>::n_p;
  static constexpr int n_linear = linear_dynamic_count<M>();

  /// Which of p are differentiated beside the states, and by which number.
  struct NoSeeds {
    static constexpr std::array<int, 0> places{};
    using Number = double;
  };
  struct LinearSeeds {
    static constexpr auto places = linear_dynamic_places<M>();
    using Number = ceres::Jet<double, n_x + n_linear>;
  };
  struct AllSeeds {
    static constexpr auto places = [] {
      std::array<int, static_cast<std::size_t>(n_p)> all{};
      for (int i = 0; i < n_p; ++i) all[static_cast<std::size_t>(i)] = i;
      return all;
    }();
    using Number = ceres::Jet<double, n_x + n_p>;
  };
  template <class Seeds>
  static constexpr int seeds = static_cast<int>(Seeds::places.size());
  template <class Seeds>
  static constexpr bool has_slopes = !std::is_same_v<typename Seeds::Number, double>;

  /// xi, asked for by column of [A | D]. Without xi1 the linear parameters are zero.
  struct Point {
    const double* xi2;
    const double* xi1;
    int n_1;

    double operator[](int column) const {
      if (column < 0) return 0.0;  // a parameter that isn't in use
      if (column >= n_1) return xi2[column - n_1];
      return xi1 == nullptr ? 0.0 : xi1[column];
    }
  };

  /// d/d(x(0), p), the seeded ones of p.
  template <class Seeds>
  static constexpr int width = n_x + seeds<Seeds>;
  template <class Seeds>
  using Slopes = Eigen::Matrix<double, 1, width<Seeds>>;

  struct Path final : Carry {
    StateRow<M> row;  // the last one
    Vec<double, n_x> x = Vec<double, n_x>::Constant(not_a_number);
    Eigen::Matrix<double, n_x, n_x + n_p> S;  // as many columns as a pass asks for
    int trajectory = -1;                      // none has begun
    /// What the columns of scales are less: their values at the start, and the slopes of
    /// sum A xi1 over them.
    Eigen::Matrix<double, n_z, n_1> start = Eigen::Matrix<double, n_z, n_1>::Zero();
    Eigen::Matrix<double, n_z, n_x + n_p> start_slopes =
        Eigen::Matrix<double, n_z, n_x + n_p>::Zero();
    bool begins = false;
  };

  TrajectoryModel(M model, TrajectoryPlan plan)
      : StateBlockModel(plan.tables()), model_(std::move(model)), plan_(std::move(plan)) {}

  static const Quantity& state(int i) { return M::states[static_cast<std::size_t>(i)]; }

  static double value(double number) { return number; }
  template <class Dual>
  static double value(const Dual& number) {
    return number.a;
  }

  StateRow<M> read_row(const Block& block, std::size_t row) const {
    StateRow<M> result;
    const auto read = [&](int i) { return block.inputs[static_cast<std::size_t>(i)][row]; };
    for (int i = 0; i < n_u; ++i) result.u[i] = plan_.input(i) < 0 ? 0.0 : read(plan_.input(i));
    result.time = read(plan_.time_input());
    for (std::size_t i = 0; i < plan_.measured().size(); ++i) {
      result.measured[plan_.measured()[i]] = read(plan_.measured_input(i));
    }
    return result;
  }

  template <class Seeds>
  Vec<typename Seeds::Number, n_p> dual_parameters(const Point& point) const {
    using Number = Seeds::Number;
    Vec<Number, n_p> p;
    for (int i = 0; i < n_p; ++i) p[i] = Number(point[plan_.column_of_parameter(i)]);
    if constexpr (has_slopes<Seeds>) {
      for (int k = 0; k < seeds<Seeds>; ++k) {
        p[Seeds::places[static_cast<std::size_t>(k)]].v[n_x + k] = 1.0;
      }
    }
    return p;
  }

  /// x along one segment, into its rows of `x`.
  void follow(const Record& record, const Segment& segment, const Point& point,
              Eigen::MatrixXd& x) const {
    std::vector<std::vector<double>> constants;
    std::vector<const double*> inputs;
    for (const Variable& input : plan_.tables().inputs) {
      if (record.has(input.name) || !std::isfinite(input.absent)) {
        inputs.push_back(record.column(input.name).data() + segment.first);
      } else {
        inputs.push_back(constants.emplace_back(segment.rows(), input.absent).data());
      }
    }
    const Vec<double, n_p> p = dual_parameters<NoSeeds>(point);
    Path path;
    const Block block{inputs, segment.rows(), segment.first, true};
    for (std::size_t row = 0; row < block.rows; ++row) {
      go<NoSeeds>(read_row(block, row), block.first + row, row == 0, p, point, path);
      x.row(static_cast<Eigen::Index>(block.first + row)) = path.x.transpose();
    }
  }

  /// To the next row: its trajectory begins there, or goes on.
  template <class Seeds>
  void go(StateRow<M> next, std::size_t row, bool starts_segment,
          const Vec<typename Seeds::Number, n_p>& p, const Point& point, Path& path) const {
    const int trajectory = plan_.trajectory_at(row, starts_segment);
    if (trajectory >= 0) {
      begin<Seeds>(next, point, trajectory, path);
    } else if (path.x.allFinite()) {
      advance<Seeds>(next, p, path);
    }
    path.row = std::move(next);
  }

  template <class Seeds>
  void walk(const Block& block, const Point& point, Path& path,
            Eigen::Ref<Eigen::MatrixXd> rows) const {
    const Vec<typename Seeds::Number, n_p> p = dual_parameters<Seeds>(point);
    // Zeros for initial states of other segments; no numbers before a trajectory begins.
    const bool begins = plan_.trajectory_at(block.first, block.starts_segment) >= 0;
    rows.setConstant(begins || path.trajectory >= 0 ? 0.0 : not_a_number);
    for (std::size_t row = 0; row < block.rows; ++row) {
      const bool first = row == 0 && block.starts_segment;
      go<Seeds>(read_row(block, row), block.first + row, first, p, point, path);
      if (path.trajectory < 0) continue;
      emit<Seeds>(p, point, path, static_cast<Eigen::Index>(row),
                  static_cast<Eigen::Index>(block.rows), rows);
    }
  }

  template <class Seeds>
  void begin(const StateRow<M>& row, const Point& point, int trajectory, Path& path) const {
    path.trajectory = trajectory;
    path.begins = true;
    path.S.setZero();
    for (int i = 0; i < n_x; ++i) {
      const int column = plan_.column_of_start(i, trajectory);
      path.x[i] = column < 0 ? row.measured[i] : point[column];
      if (column >= 0) path.S(i, i) = 1.0;
    }
  }

  /// x with its derivatives; a measured one has none.
  template <class Seeds>
  Vec<typename Seeds::Number, n_x> dual_state(const Path& path) const {
    using Number = Seeds::Number;
    Vec<Number, n_x> x;
    for (int i = 0; i < n_x; ++i) {
      x[i] = Number(path.x[i]);
      if constexpr (has_slopes<Seeds>) {
        if (plan_.column_of_start(i, 0) >= 0) x[i].v[i] = 1.0;
      }
    }
    return x;
  }

  template <class Seeds>
  void advance(const StateRow<M>& next, const Vec<typename Seeds::Number, n_p>& p,
               Path& path) const {
    using Number = Seeds::Number;
    const Between<M> between(path.row, next, plan_.options().inputs, plan_.measured());
    const Vec<Number, n_x> x =
        step<M, Number>(model_, dual_state<Seeds>(path), p, between, plan_.options().substeps);
    if constexpr (has_slopes<Seeds>) {
      Eigen::Matrix<double, n_x, n_x> transition;  // Phi
      for (int i = 0; i < n_x; ++i) transition.row(i) = x[i].v.template head<n_x>().transpose();
      auto S = path.S.template leftCols<width<Seeds>>();
      S = (transition * S).eval();
      for (int i = 0; i < n_x; ++i) {  // Pi
        S.row(i).template tail<seeds<Seeds>>() += x[i].v.template tail<seeds<Seeds>>().transpose();
      }
    }
    for (int i = 0; i < n_x; ++i) path.x[i] = value(x[i]);
    if (ran_away<Seeds>(path)) path.x.setConstant(not_a_number);  // until the next start
  }

  /// The state left the finite numbers; or, where trajectories are added up, a rounding error at
  /// the start has grown so much that their sum has no digits left.
  template <class Seeds>
  bool ran_away(const Path& path) const {
    if (!path.x.allFinite()) return true;
    constexpr double no_digits_left = 1e10;
    if constexpr (has_linear_dynamics<M>() && has_slopes<Seeds>) {
      const auto growth = path.S.template leftCols<n_x>().cwiseAbs().maxCoeff();
      return plan_.separable() && !(growth < no_digits_left);
    }
    return false;
  }

  /// One sample's rows of [A | D | b], output by output.
  template <class Seeds>
  void emit(const Vec<typename Seeds::Number, n_p>& p, const Point& point, Path& path,
            Eigen::Index row, Eigen::Index block_rows, Eigen::Ref<Eigen::MatrixXd> rows) const {
    const auto z = model_.at(dual_state<Seeds>(path), path.row.u, p);
    for (std::size_t place = 0; place < plan_.outputs().size(); ++place) {
      const int j = plan_.outputs()[place];
      if (path.begins) keep_start<Seeds>(z, j, point, path);
      auto out = rows.row(static_cast<Eigen::Index>(place) * block_rows + row);
      for (const int k : plan_.acting(place)) {
        const int column = plan_.linear()[static_cast<std::size_t>(k)];
        out[k] = value(z.A(j, column)) - path.start(j, column);
      }
      double b = path.x.allFinite() ? value(z.b[j]) : not_a_number;
      if constexpr (has_slopes<Seeds>) {
        typename Seeds::Number sum = z.b[j];
        for (const int k : plan_.acting(place)) {
          sum += point[k] * z.A(j, plan_.linear()[static_cast<std::size_t>(k)]);
        }
        Slopes<Seeds> slopes = slopes_of<Seeds>(sum, path);
        slopes -= path.start_slopes.row(j).template head<width<Seeds>>();
        b -= place_slopes<Seeds>(slopes, point, path.trajectory, out);
      }
      out[out.size() - 1] = b;
    }
    path.begins = false;
  }

  /// What the scales' columns of output j are at the start, where they are counted from it.
  template <class Seeds>
  void keep_start(const Affine<typename Seeds::Number, n_z, n_1>& z, int j, const Point& point,
                  Path& path) const {
    using Number = Seeds::Number;
    Number sum(0.0);
    for (const int k : plan_.scales()) {
      const int column = plan_.linear()[static_cast<std::size_t>(k)];
      path.start(j, column) = value(z.A(j, column));
      sum += point[k] * z.A(j, column);
    }
    if constexpr (has_slopes<Seeds>) {
      path.start_slopes.row(j).template head<width<Seeds>>() = slopes_of<Seeds>(sum, path);
    }
  }

  /// H_x S + H_p of a number that depends on x and on p.
  template <class Seeds>
  static Slopes<Seeds> slopes_of(const Seeds::Number& number, const Path& path) {
    Slopes<Seeds> slopes =
        number.v.template head<n_x>().transpose() * path.S.template leftCols<width<Seeds>>();
    slopes.template tail<seeds<Seeds>>() += number.v.template tail<seeds<Seeds>>().transpose();
    return slopes;
  }

  /// Puts them into their columns. Returns the share of those that are linear in sum A xi1: b is
  /// what the output has beside it.
  template <class Seeds, class Row>
  double place_slopes(const Slopes<Seeds>& slopes, const Point& point, int trajectory,
                      Row& out) const {
    double linear = 0.0;
    const auto place = [&](int column, double slope) {
      if (column < 0) return;
      out[column] = slope;
      if (column < point.n_1) linear += slope * point[column];
    };
    for (int i = 0; i < n_x; ++i) place(plan_.column_of_start(i, trajectory), slopes[i]);
    for (int k = 0; k < seeds<Seeds>; ++k) {
      place(plan_.column_of_parameter(Seeds::places[static_cast<std::size_t>(k)]), slopes[n_x + k]);
    }
    return linear;
  }

  M model_;
  TrajectoryPlan plan_;
};

}  // namespace sepcal
