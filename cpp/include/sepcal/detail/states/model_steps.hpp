// SPDX-License-Identifier: BSD-3-Clause
// StateSteps of a state model in C++: the very steps that a trajectory takes, in dual numbers.
#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <type_traits>
#include <vector>

#include "sepcal/detail/states/integration.hpp"
#include "sepcal/detail/states/noise_response.hpp"
#include "sepcal/detail/states/second_order_step.hpp"
#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/detail/states/step_noise.hpp"
#include "sepcal/states/state_model.hpp"

namespace sepcal {

/// Whether a model has start(u, z).
template <StateModel M>
constexpr bool has_start() {
  return requires(const M& model, const Vec<double, StateSizes<M>::n_u>& u,
                  const Vec<double, StateSizes<M>::n_z>& z) { model.start(u, z); };
}

/// x by the model's start(u, z) at a row of the record, z NaN for outputs that the record doesn't
/// have; zero where the model has no start().
template <StateModel M>
Vec<double, StateSizes<M>::n_x> start_of_model(const M& model, const Record& record,
                                               std::size_t row) {
  if constexpr (has_start<M>()) {
    const auto read = [&](const auto& table, auto& values) {
      for (std::size_t i = 0; i < table.size(); ++i) {
        const bool there = record.has(table[i].name);
        values[static_cast<Eigen::Index>(i)] =
            there ? record.column(table[i].name)[row] : table[i].absent;
      }
    };
    Vec<double, StateSizes<M>::n_u> u;
    Vec<double, StateSizes<M>::n_z> z;
    read(M::inputs, u);
    read(M::outputs, z);
    return model.start(u, z);
  } else {
    return Vec<double, StateSizes<M>::n_x>::Zero();
  }
}

template <StateModel M>
class ModelSteps final : public StateSteps {
 public:
  /// At xi, in the order of the plan's tables. Model, plan and record must outlive this.
  ModelSteps(const M& model, const TrajectoryPlan& plan, const Record& record,
             const Eigen::VectorXd& xi)
      : model_(model), plan_(plan), record_(record) {
    ModelSteps::set_parameters(xi);
    for (const Variable& input : plan.tables().inputs) {
      const bool absent = !record.has(input.name) && std::isfinite(input.absent);
      constants_.push_back(input.absent);
      columns_.push_back(absent ? std::span<const double>() : record.column(input.name));
    }
    find_parameters();
  }

  void set_parameters(const Eigen::VectorXd& xi) override {
    for (int i = 0; i < n_p; ++i) {
      const int column = plan_.column_of_parameter(i);
      p_[i] = column < 0 ? 0.0 : xi[column];
    }
    for (std::size_t k = 0; k < plan_.linear().size(); ++k) {
      xi1_[plan_.linear()[k]] = xi[static_cast<Eigen::Index>(k)];
    }
  }

  Step advance(std::size_t row, const Eigen::VectorXd& x) const override {
    using Number = ceres::Jet<double, n_x>;
    const StateRow<M> from = row_at(row);
    const StateRow<M> to = row_at(row + 1);
    const Between<M> between(from, to, plan_.options().inputs, plan_.measured());
    const Vec<double, n_x> begin = whole<double>(from, x);
    const Vec<Number, n_x> end =
        step<M, Number>(model_, whole<Number>(from, x), p_.template cast<Number>(), between,
                        plan_.options().substeps);
    const std::vector<int>& free = plan_.integrated();
    const auto n = static_cast<Eigen::Index>(free.size());
    Vec<double, n_x> next;
    for (int i = 0; i < n_x; ++i) next[i] = end[i].a;
    Step step{next(free), Eigen::MatrixXd(n, n), Eigen::MatrixXd(n, n_v)};
    for (Eigen::Index i = 0; i < n; ++i) {
      step.Phi.row(i) = end[free[static_cast<std::size_t>(i)]].v(free).transpose();
    }
    Eigen::Matrix<double, n_x, n_w> G = noise_input<M, double>(model_, begin, between.u(0.0), p_);
    if constexpr (is_discrete<M>()) {
      step.Gamma = pick(G, free, noises_);
    } else {
      if constexpr (has_noise_input<M>()) {
        G = (0.5 * (G + noise_input<M, double>(model_, next, between.u(1.0), p_))).eval();
      }
      const Eigen::MatrixXd own = pick(G, free, noises_);
      const NoiseResponse<Eigen::Dynamic> response(step.Phi, between.duration());
      step.Gamma << response.mean() * own, response.slope() * own;
    }
    return step;
  }

  Eigen::MatrixXd rate_slopes(std::size_t row, const Eigen::VectorXd& x) const override {
    const std::vector<int>& free = plan_.integrated();
    const auto n = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd F = Eigen::MatrixXd::Zero(n, n);
    if constexpr (!is_discrete<M>()) {
      using Number = ceres::Jet<double, n_x>;  // as advance() has it
      const StateRow<M> here = row_at(row);
      const Vec<Number, n_p> p = p_.template cast<Number>();
      const Vec<Number, n_x> rate = model_.rate(whole<Number>(here, x), here.u, p);
      for (Eigen::Index i = 0; i < n; ++i) {
        F.row(i) = rate[free[static_cast<std::size_t>(i)]].v(free).transpose();
      }
    }
    return F;
  }

  Reading read(std::size_t row, const Eigen::VectorXd& x) const override {
    using Number = ceres::Jet<double, n_x>;  // as advance() has it
    const auto expected = affine<Number>(row, x, p_.template cast<Number>());
    const std::vector<int>& free = plan_.integrated();
    Reading reading = empty_reading(static_cast<Eigen::Index>(free.size()));
    for (std::size_t j = 0; j < plan_.outputs().size(); ++j) {
      const Number z = sum(expected, j);
      const auto at = static_cast<Eigen::Index>(j);
      reading.z[at] = z.a;
      reading.H.row(at) = z.v(free).transpose();
    }
    return reading;
  }

  Eigen::VectorXd next(std::size_t row, const Eigen::VectorXd& x) const override {
    const StateRow<M> from = row_at(row);
    const StateRow<M> to = row_at(row + 1);
    const Between<M> between(from, to, plan_.options().inputs, plan_.measured());
    return step<M, double>(model_, whole<double>(from, x), p_, between,
                           plan_.options().substeps)(plan_.integrated());
  }

  Eigen::VectorXd expect(std::size_t row, const Eigen::VectorXd& x) const override {
    const auto expected = affine<double>(row, x, p_);
    Eigen::VectorXd z(static_cast<Eigen::Index>(plan_.outputs().size()));
    for (std::size_t j = 0; j < plan_.outputs().size(); ++j) {
      z[static_cast<Eigen::Index>(j)] = sum(expected, j);
    }
    return z;
  }

  JointStep advance_jointly(std::size_t row, const Eigen::VectorXd& x,
                            const Eigen::VectorXd& density) const override {
    const StateRow<M> from = row_at(row);
    const StateRow<M> to = row_at(row + 1);
    const Between<M> between(from, to, plan_.options().inputs, plan_.measured());
    const Vec<Joint, n_x> begin = whole<Joint>(from, x);
    const Vec<Joint, n_x> end =
        step<M, Joint>(model_, begin, seeded_parameters(), between, plan_.options().substeps);
    Vec<double, n_x> half_way;
    for (int i = 0; i < n_x; ++i) half_way[i] = 0.5 * (begin[i].a + end[i].a);
    Eigen::Matrix<double, n_x, n_x> Q_d = Eigen::Matrix<double, n_x, n_x>::Zero();
    if (!density.isZero(0.0)) {
      const Eigen::Matrix<double, n_w, n_w> Q = density.asDiagonal();
      Q_d = noise_of_step<M>(model_, between, half_way, p_, Q);
    }
    const std::vector<int>& free = plan_.integrated();
    const auto n = static_cast<Eigen::Index>(free.size());
    JointStep joint{Eigen::VectorXd(n), Eigen::MatrixXd(n, columns()), Q_d(free, free)};
    for (Eigen::Index i = 0; i < n; ++i) {
      const Joint& state = end[free[static_cast<std::size_t>(i)]];
      joint.x[i] = state.a;
      joint.Phi.row(i) = slopes_of(state);
    }
    return joint;
  }

  Reading read_jointly(std::size_t row, const Eigen::VectorXd& x) const override {
    const auto expected = affine<Joint>(row, x, seeded_parameters());
    const auto n = static_cast<Eigen::Index>(plan_.integrated().size());
    Reading reading = empty_reading(columns());
    for (std::size_t j = 0; j < plan_.outputs().size(); ++j) {
      const Joint z = sum(expected, j);
      const auto at = static_cast<Eigen::Index>(j);
      reading.z[at] = z.a;
      reading.H.row(at) = slopes_of(z);
      for (const int k : plan_.acting(j)) {
        reading.H(at, n + k) +=
            expected.A(plan_.outputs()[j], plan_.linear()[static_cast<std::size_t>(k)]).a;
      }
    }
    return reading;
  }

  SecondOrderStep advance_to_second_order(std::size_t row,
                                          const Eigen::VectorXd& x) const override {
    const StateRow<M> from = row_at(row);
    const StateRow<M> to = row_at(row + 1);
    const Between<M> between(from, to, plan_.options().inputs, plan_.measured());
    const Vec<double, n_x> begin = whole<double>(from, x);
    SecondOrderStep step;
    const Vec<double, n_x> end = second_order_step<M>(
        model_, begin, p_, between, plan_.options().substeps, second_order_places(), step);
    SecondOrderNoise noise;
    second_order_noise<M>(model_, begin, p_, between, second_order_places(), end, step, noise);
    add_noise(step, noise, between.duration(), plan_.discrete());
    return step;
  }

  SecondOrderReading read_to_second_order(std::size_t row,
                                          const Eigen::VectorXd& x) const override {
    const StateRow<M> here = row_at(row);
    SecondOrderReading reading;
    second_order_reading<M>(model_, whole<double>(here, x), here.u, xi1_, p_, second_order_places(),
                            reading);
    return reading;
  }

  Eigen::VectorXd start(std::size_t row) const override {
    return start_of_model(model_, record_, row)(plan_.integrated());
  }

 private:
  static constexpr int n_u = StateSizes<M>::n_u;
  static constexpr int n_x = StateSizes<M>::n_x;
  static constexpr int n_z = StateSizes<M>::n_z;
  static constexpr int n_1 = StateSizes<M>::n_1;
  static constexpr int n_p = StateSizes<M>::n_p;
  static constexpr int n_w = StateSizes<M>::n_w;
  static constexpr int n_v = noise_parts<M>();
  using Joint = ceres::Jet<double, n_x + n_p>;

  double input(int place, std::size_t row) const {
    const std::span<const double> column = columns_[static_cast<std::size_t>(place)];
    return column.empty() ? constants_[static_cast<std::size_t>(place)] : column[row];
  }

  StateRow<M> row_at(std::size_t row) const {
    StateRow<M> result;
    for (int i = 0; i < n_u; ++i) {
      result.u[i] = plan_.input(i) < 0 ? 0.0 : input(plan_.input(i), row);
    }
    result.time = input(plan_.time_input(), row);
    for (std::size_t i = 0; i < plan_.measured().size(); ++i) {
      result.measured[plan_.measured()[i]] = input(plan_.measured_input(i), row);
    }
    return result;
  }

  /// All states, of which x are those that are integrated and differentiated by.
  template <class Number>
  Vec<Number, n_x> whole(const StateRow<M>& row, const Eigen::VectorXd& x) const {
    Vec<Number, n_x> all;
    for (const int i : plan_.measured()) all[i] = Number(row.measured[i]);
    for (std::size_t i = 0; i < plan_.integrated().size(); ++i) {
      const int state = plan_.integrated()[i];
      const double value = x[static_cast<Eigen::Index>(i)];
      if constexpr (std::is_same_v<Number, double>) {
        all[state] = value;
      } else {
        all[state] = Number(value, state);
      }
    }
    return all;
  }

  /// The parameters that act, by their places among the model's n_1 + n_p.
  void find_parameters() {
    const std::vector<int>& acting = plan_.acting_columns();
    const auto place = [&acting](int column) {
      return static_cast<std::size_t>(std::ranges::find(acting, column) - acting.begin());
    };
    parameters_.resize(acting.size());
    for (std::size_t k = 0; k < plan_.linear().size(); ++k) {
      parameters_[place(static_cast<int>(k))] = plan_.linear()[k];
    }
    for (int i = 0; i < n_p; ++i) {
      if (plan_.column_of_parameter(i) < 0) continue;
      parameters_[place(plan_.column_of_parameter(i))] = n_1 + i;
    }
    noises_.resize(n_w);
    std::iota(noises_.begin(), noises_.end(), 0);
  }

  /// A step that is linear in the state curves by no state.
  SecondOrderPlaces second_order_places() const {
    return {.states = plan_.integrated(),
            .parameters = parameters_,
            .outputs = plan_.outputs(),
            .curves = !has_linear_dynamics<M>()};
  }

  /// Rows and columns of a matrix of fixed size, which Eigen's own indexing can't take in every
  /// case.
  template <class Matrix>
  static Eigen::MatrixXd pick(const Matrix& all, const std::vector<int>& rows,
                              const std::vector<int>& columns) {
    Eigen::MatrixXd part(rows.size(), columns.size());
    for (Eigen::Index k = 0; k < part.cols(); ++k) {
      for (Eigen::Index i = 0; i < part.rows(); ++i) {
        part(i, k) = all(rows[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(k)]);
      }
    }
    return part;
  }

  /// p, differentiated by.
  Vec<Joint, n_p> seeded_parameters() const {
    Vec<Joint, n_p> p;
    for (int i = 0; i < n_p; ++i) p[i] = Joint(p_[i], n_x + i);
    return p;
  }

  template <class Number>
  Affine<Number, n_z, n_1> affine(std::size_t row, const Eigen::VectorXd& x,
                                  const Vec<Number, n_p>& p) const {
    const StateRow<M> here = row_at(row);
    return model_.at(whole<Number>(here, x), here.u, p);
  }

  /// A xi1 + b of an output that is kept.
  template <class Number>
  Number sum(const Affine<Number, n_z, n_1>& expected, std::size_t output) const {
    const int j = plan_.outputs()[output];
    Number z = expected.b[j];
    for (const int k : plan_.acting(output)) {
      const int column = plan_.linear()[static_cast<std::size_t>(k)];
      z += expected.A(j, column) * xi1_[column];
    }
    return z;
  }

  Reading empty_reading(Eigen::Index columns) const {
    const auto n = static_cast<Eigen::Index>(plan_.outputs().size());
    return {Eigen::VectorXd(n), Eigen::MatrixXd(n, columns)};
  }

  /// n_x + n.
  Eigen::Index columns() const {
    return static_cast<Eigen::Index>(plan_.integrated().size()) + plan_.tables().n_1() +
           plan_.tables().n_2();
  }

  /// By the states that are integrated, and by the parameters in use.
  Eigen::RowVectorXd slopes_of(const Joint& number) const {
    const auto n = static_cast<Eigen::Index>(plan_.integrated().size());
    Eigen::RowVectorXd slopes = Eigen::RowVectorXd::Zero(columns());
    slopes.head(n) = number.v(plan_.integrated()).transpose();
    for (int i = 0; i < n_p; ++i) {
      const int column = plan_.column_of_parameter(i);
      if (column >= 0) slopes[n + column] = number.v[n_x + i];
    }
    return slopes;
  }

  const M& model_;
  const TrajectoryPlan& plan_;
  const Record& record_;
  Vec<double, n_p> p_;
  Vec<double, n_1> xi1_ = Vec<double, n_1>::Zero();
  std::vector<std::span<const double>> columns_;
  std::vector<double> constants_;  // of inputs that the record doesn't have
  std::vector<int> parameters_;    // of the acting columns: places among the model's n_1 + n_p
  std::vector<int> noises_;        // 0 to n_w - 1
};

}  // namespace sepcal
