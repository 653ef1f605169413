// SPDX-License-Identifier: BSD-3-Clause
// The likelihood of a state model along a record, sample by sample through the score filter. Each
// trajectory begins in its initial state, which is a parameter, and not in doubt: P(0) = 0.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "base/stop.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/detail/states/score_filter.hpp"
#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/error.hpp"
#include "states/known_inputs.hpp"
#include "states/start_deviations.hpp"

namespace sepcal {
namespace {

using Eigen::Dynamic;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Scores = ScoreFilter<Dynamic, Dynamic, Dynamic, Dynamic>;

class StateInnovations final : public InnovationModel {
 public:
  StateInnovations(const StateBlockModel& model, const Record& record)
      : model_(model),
        plan_(model.plan()),
        record_(record),
        acting_(plan_.acting_columns()),
        n_(model.tables().n_1() + model.tables().n_2()),
        n_x_(static_cast<Index>(plan_.integrated().size())),
        n_w_(static_cast<Index>(plan_.model().noise.size())),
        n_z_(static_cast<Index>(plan_.outputs().size())),
        time_(record.column("time")) {
    if (plan_.options().scales_about_start) {
      throw Error(
          "filter error takes a scale times its output as it is; fit without "
          "scales_about_start");
    }
    states::check_inputs(model.tables(), record);
    for (const Variable& output : plan_.tables().outputs) {
      outputs_.push_back(record.column(output.name));
    }
  }

  Index noises() const override { return n_w_; }
  Index outputs() const override { return n_z_; }
  Index size() const override { return n_ + n_w_ + n_z_; }

  Eigen::Array<bool, Dynamic, 1> moves() const override {
    Eigen::Array<bool, Dynamic, 1> moves = Eigen::Array<bool, Dynamic, 1>::Constant(size(), true);
    if (plan_.separable()) moves.head(model_.tables().n_1()) = false;
    return moves;
  }

  Value value(const VectorXd& theta) const override {
    return run(theta, [](std::size_t, const VectorXd&, const Innovation<Dynamic>&) {});
  }

  Value scores(const VectorXd& theta, const VisitScores& visit) const override {
    const Noise noise = noise_of(theta);
    const VectorXd xi = theta.head(n_);
    const auto steps = model_.steps(record_, xi);
    std::vector<Index> columns;
    Scores::Rows sample;
    MatrixXd rows;
    return walk(
        [&](int trajectory) {
          columns = columns_of(trajectory);
          return begin(trajectory, xi);
        },
        [&](Scores& filter, std::size_t row) {
          return filter.update(readings(row), steps->read_to_second_order(row, filter.x()), noise.r,
                               sample);
        },
        [&](const Place& at, const Innovation<Dynamic>& /*innovation*/) {
          const auto in_block = static_cast<Index>((at.row - at.first) % block_rows);
          if (in_block == 0) {
            rows.setZero(
                rows_a_sample() * static_cast<Index>(std::min(block_rows, at.last - at.row)),
                size() + 1);
          }
          rows.middleRows(in_block * rows_a_sample(), rows_a_sample())(Eigen::all, columns) =
              sample;
          if (at.row + 1 == at.last || in_block + 1 == static_cast<Index>(block_rows)) {
            visit(at.row - static_cast<std::size_t>(in_block), rows);
          }
        },
        [&](Scores& filter, std::size_t row) {
          return filter.predict(steps->advance_to_second_order(row, filter.x()), noise.q,
                                held(row));
        });
  }

  Value linear_scores(const VectorXd& theta, const VisitScores& visit) const override {
    const Noise noise = noise_of(theta);
    const VectorXd xi = theta.head(n_);
    const VectorXd none = VectorXd::Zero(n_w_);
    const auto steps = model_.steps(record_, xi);
    const Eigen::Array<bool, Dynamic, 1> moves = this->moves();
    std::vector<Index> linear;  // of theta
    for (Index i = 0; i < size(); ++i) {
      if (!moves[i]) linear.push_back(i);
    }
    linear.push_back(size());
    std::vector<Index> columns;
    Scores::Rows sample;
    MatrixXd all(n_z_, size() + 1);
    return walk(
        [&](int trajectory) {
          columns = columns_of(trajectory);
          return begin(trajectory, xi, false);
        },
        [&](Scores& filter, std::size_t row) {
          const StateSteps::Reading joint = steps->read_jointly(row, filter.x());
          StateSteps::SecondOrderReading reading;
          reading.z = joint.z;
          reading.H = joint.H.leftCols(n_x_);
          reading.J = acting(joint.H);
          return filter.update(readings(row), reading, noise.r, sample);
        },
        [&](const Place& at, const Innovation<Dynamic>& /*innovation*/) {
          all.setZero();
          all(Eigen::all, columns) = sample.topRows(n_z_);
          MatrixXd chosen = all(Eigen::all, linear);
          visit(at.row, chosen);
        },
        [&](Scores& filter, std::size_t row) {
          StateSteps::Step plain = steps->advance(row, filter.x());
          StateSteps::SecondOrderStep step;
          step.Pi = acting(steps->advance_jointly(row, filter.x(), none).Phi);
          step.x = std::move(plain.x);
          step.Phi = std::move(plain.Phi);
          step.Gamma = std::move(plain.Gamma);
          return filter.predict(step, noise.q, held(row));
        });
  }

  MatrixXd reach(const VectorXd& theta) const override {
    constexpr std::size_t window = 50;  // rows
    const VectorXd xi = theta.head(n_);
    const auto steps = model_.steps(record_, xi);
    MatrixXd squares = MatrixXd::Zero(n_z_, n_w_);
    double count = 0.0;
    for_each_trajectory([&](std::size_t first, std::size_t last, int trajectory) {
      VectorXd x = states::start_of(plan_, trajectory, xi);
      std::vector<MatrixXd> P(static_cast<std::size_t>(n_w_));
      for (std::size_t row = first; row < last; ++row) {
        if ((row - first) % window == 0) {
          for (MatrixXd& each : P) each.setZero(n_x_, n_x_);
        }
        const MatrixXd H = steps->read(row, x).H;
        if (!H.allFinite()) return false;
        for (Index k = 0; k < n_w_; ++k) {
          squares.col(k) += (H * P[static_cast<std::size_t>(k)] * H.transpose()).diagonal();
        }
        count += 1.0;
        if (row + 1 == last) break;
        const StateSteps::Step step = steps->advance(row, x);
        if (!step.x.allFinite()) return false;
        for (Index k = 0; k < n_w_; ++k) {
          MatrixXd& each = P[static_cast<std::size_t>(k)];
          const VectorXd variances = plan_.noise_variances(VectorXd::Unit(n_w_, k), held(row));
          each = step.Phi * each * step.Phi.transpose() +
                 step.Gamma * variances.asDiagonal() * step.Gamma.transpose();
        }
        x = step.x;
      }
      return true;
    });
    return (squares / std::max(count, 1.0)).cwiseSqrt();
  }

  Innovations innovations(const VectorXd& theta) const override {
    const auto rows = static_cast<Index>(record_.length());
    Innovations result{MatrixXd::Constant(rows, n_z_, not_a_number),
                       MatrixXd::Constant(rows, n_z_, not_a_number)};
    run(theta, [&](std::size_t row, const VectorXd& y, const Innovation<Dynamic>& innovation) {
      const MatrixXd Lambda = innovation.covariance();
      for (Index j = 0; j < n_z_; ++j) {
        if (std::isnan(y[j])) continue;
        result.e(static_cast<Index>(row), j) = innovation.e[j];
        result.sd(static_cast<Index>(row), j) = std::sqrt(Lambda(j, j));
      }
    });
    return result;
  }

  MatrixXd spread(const VectorXd& theta) const override {
    const Noise noise = noise_of(theta);
    const VectorXd xi = theta.head(n_);
    const auto steps = model_.steps(record_, xi);
    MatrixXd result = MatrixXd::Constant(static_cast<Index>(record_.length()), n_z_, not_a_number);
    for_each_trajectory([&](std::size_t first, std::size_t last, int trajectory) {
      VectorXd x = states::start_of(plan_, trajectory, xi);
      MatrixXd P = MatrixXd::Zero(n_x_, n_x_);
      for (std::size_t row = first; row < last; ++row) {
        const MatrixXd H = steps->read(row, x).H;
        result.row(static_cast<Index>(row)) = (H * P * H.transpose()).diagonal().cwiseSqrt();
        if (row + 1 == last) break;
        const StateSteps::Step step = steps->advance(row, x);
        const VectorXd variances = plan_.noise_variances(noise.q.cwiseAbs2(), held(row));
        P = step.Phi * P * step.Phi.transpose() +
            step.Gamma * variances.asDiagonal() * step.Gamma.transpose();
        x = step.x;
      }
      return true;
    });
    return result;
  }

  MatrixXd draw(const VectorXd& theta, const std::function<double()>& normal) const override {
    const Noise noise = noise_of(theta);
    const VectorXd xi = theta.head(n_);
    const auto steps = model_.steps(record_, xi);
    MatrixXd result = MatrixXd::Constant(static_cast<Index>(record_.length()), n_z_, not_a_number);
    const auto draw_of = [&](const VectorXd& sd) {
      return VectorXd(sd.unaryExpr([&](double each) { return each * normal(); }));
    };
    for_each_trajectory([&](std::size_t first, std::size_t last, int trajectory) {
      VectorXd x = states::start_of(plan_, trajectory, xi);
      for (std::size_t row = first; row < last; ++row) {
        result.row(static_cast<Index>(row)) =
            (steps->read(row, x).z + draw_of(noise.r)).transpose();
        if (row + 1 == last) break;
        const StateSteps::Step step = steps->advance(row, x);
        const VectorXd variances = plan_.noise_variances(noise.q.cwiseAbs2(), held(row));
        x = step.x + step.Gamma * draw_of(variances.cwiseSqrt());
      }
      return true;
    });
    return result;
  }

 private:
  static constexpr std::size_t block_rows = 64;

  struct Noise {
    VectorXd q;  // n_w
    VectorXd r;  // n_z
  };

  Noise noise_of(const VectorXd& theta) const {
    return {theta.segment(n_, n_w_).array().exp(), theta.tail(n_z_).array().exp()};
  }

  /// The filter without derivatives: visit(row, y, innovation) of each sample that it could use.
  template <class Visit>
  Value run(const VectorXd& theta, const Visit& visit) const {
    const Noise noise = noise_of(theta);
    const VectorXd xi = theta.head(n_);
    const auto steps = model_.steps(record_, xi);
    const MatrixXd R = noise.r.cwiseAbs2().asDiagonal();
    VectorXd y;
    return walk(
        [&](int trajectory) {
          return Filter<Dynamic>(states::start_of(plan_, trajectory, xi),
                                 MatrixXd::Zero(n_x_, n_x_));
        },
        [&](Filter<Dynamic>& filter, std::size_t row) {
          StateSteps::Reading expected = steps->read(row, filter.x());
          y = readings(row);
          return filter.update<Dynamic>(y, {std::move(expected.z), std::move(expected.H)}, R);
        },
        [&](const Place& at, const Innovation<Dynamic>& innovation) {
          visit(at.row, y, innovation);
        },
        [&](Filter<Dynamic>& filter, std::size_t row) {
          StateSteps::Step step = steps->advance(row, filter.x());
          const MatrixXd Q_d = plan_.noise_variances(noise.q.cwiseAbs2(), held(row)).asDiagonal();
          return filter.predict<Dynamic>(
              {std::move(step.x), std::move(step.Phi), std::move(step.Gamma), Q_d});
        });
  }

  /// A row of a trajectory [first, last).
  struct Place {
    std::size_t first;
    std::size_t last;
    std::size_t row;
  };

  /// A filter along each trajectory: begin(trajectory) makes it, update(filter, row) takes a sample
  /// to its innovation, see(place, innovation) follows where that went well, and predict(filter,
  /// row) leads to the next row. Ends where the filter can't go on.
  template <class Begin, class Update, class See, class Predict>
  Value walk(const Begin& begin, const Update& update, const See& see,
             const Predict& predict) const {
    Value value;
    for_each_trajectory([&](std::size_t first, std::size_t last, int trajectory) {
      auto filter = begin(trajectory);
      for (std::size_t row = first; row < last; ++row) {
        const Innovation<Dynamic> innovation = update(filter, row);
        if (!take(innovation, row, value)) return false;
        see(Place{first, last, row}, innovation);
        if (row + 1 == last) break;
        if (predict(filter, row) != FilterStatus::ok) {
          give_up(row, value);
          return false;
        }
      }
      return true;
    });
    return value;
  }

  /// go(first row, one behind the last, trajectory), until one of them returns false.
  template <class Go>
  void for_each_trajectory(const Go& go) const {
    for (const Segment& segment : record_.segments()) {
      std::size_t first = segment.first;
      int trajectory = plan_.trajectory_at(first, true);
      for (std::size_t row = first + 1; row <= segment.last; ++row) {
        const int next = row < segment.last ? plan_.trajectory_at(row, false) : 0;
        if (next < 0) continue;
        if (!go(first, row, trajectory)) return;
        first = row;
        trajectory = next;
      }
    }
  }

  /// Of columns by x and xi those of the parameters that act.
  MatrixXd acting(const MatrixXd& joint) const {
    return joint.rightCols(joint.cols() - n_x_)(Eigen::all, acting_);
  }

  /// `with_gains`: and their derivatives.
  Scores begin(int trajectory, const VectorXd& xi, bool with_gains = true) const {
    const auto n = static_cast<Index>(acting_.size());
    Scores::Moves moves = Scores::Moves::Constant(n + n_x_ + n_w_ + n_z_, false);
    const Eigen::Array<bool, Dynamic, 1> all = this->moves();
    const std::vector<Index> columns = columns_of(trajectory);
    for (Index i = 0; with_gains && i < moves.size(); ++i) {
      moves[i] = all[columns[static_cast<std::size_t>(i)]];
    }
    return {
        states::start_of(plan_, trajectory, xi), MatrixXd::Zero(n_x_, n_x_), n, n_w_, n_z_, moves};
  }

  /// Of the score filter's columns those of theta, and the residual's.
  std::vector<Index> columns_of(int trajectory) const {
    std::vector<Index> columns(acting_.begin(), acting_.end());
    for (const int i : plan_.integrated()) columns.push_back(plan_.column_of_start(i, trajectory));
    for (Index k = n_; k <= size(); ++k) columns.push_back(k);
    return columns;
  }

  VectorXd readings(std::size_t row) const {
    VectorXd y(n_z_);
    for (Index j = 0; j < n_z_; ++j) y[j] = outputs_[static_cast<std::size_t>(j)][row];
    return y;
  }

  double held(std::size_t row) const {
    return plan_.discrete() ? 1.0 : time_[row + 1] - time_[row];
  }

  /// Adds a sample to the likelihood. False where the filter can't go on.
  static bool take(const Innovation<Dynamic>& innovation, std::size_t row, Value& value) {
    if (row % block_rows == 0) base::heed_stop();
    if (innovation.status != FilterStatus::ok) {
      give_up(row, value);
      return false;
    }
    value.cost += innovation.cost();
    value.readings += static_cast<std::size_t>(innovation.count);
    return true;
  }

  static void give_up(std::size_t row, Value& value) {
    value.cost = std::numeric_limits<double>::infinity();
    value.row = row;
  }

  const StateBlockModel& model_;
  const TrajectoryPlan& plan_;
  const Record& record_;
  std::vector<int> acting_;
  Index n_;
  Index n_x_;
  Index n_w_;
  Index n_z_;
  std::span<const double> time_;
  std::vector<std::span<const double>> outputs_;
};

}  // namespace

std::unique_ptr<InnovationModel> StateBlockModel::innovations(const Record& record) const {
  return std::make_unique<StateInnovations>(*this, record);
}

}  // namespace sepcal
