// SPDX-License-Identifier: BSD-3-Clause
// What process noise makes of a fit that integrates without it. The state is off by e, of
// covariance P, and the score s = sum J_k' R^-1 H_k e_k by what has come of it so far: with B_k =
// J_k' R^-1 H_k and C = cov(e, s), at every row
//   cov(s) <- cov(s) + B P B' + B C + C'B',   C <- C + P B',
// and from a row to the next P <- Phi P Phi' + Gamma Q_d Gamma', C <- Phi C. One pass, nothing
// kept.
#include "base/stop.hpp"
#include "model/measurements.hpp"
#include "sepcal/detail/states/state_steps.hpp"
#include "states/start_deviations.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class ScoreNoise {
 public:
  ScoreNoise(const StateBlockModel& model, const Record& record, const VectorXd& xi,
             const VectorXd& noise, const VectorXd& density)
      : model_(model),
        plan_(model.plan()),
        xi_(xi),
        weights_(noise.cwiseAbs2().cwiseInverse()),
        density_(density.cwiseAbs2()),
        steps_(model.steps(record, xi)),
        measurements_(model, record),
        time_(record.column("time")),
        score_(MatrixXd::Zero(xi.size(), xi.size())) {}

  void run() {
    const std::unique_ptr<Carry> carry = model_.new_carry();
    std::vector<const double*> inputs;
    MatrixXd tangent;
    for (const std::vector<Range>& chunk : measurements_.chunks()) {
      for (const Range& range : chunk) {
        base::heed_stop();
        fill(measurements_.block(range, inputs), *carry, tangent);
        follow(range, tangent);
      }
    }
  }

  const MatrixXd& covariance() const { return score_; }

 private:
  using Range = model::Measurements::Range;

  /// [A | D | b] of a block, (n_z * rows) x (n + 1).
  void fill(const Block& block, Carry& carry, MatrixXd& tangent) const {
    tangent.resize(static_cast<Index>(block.rows) * weights_.size(), xi_.size() + 1);
    const int n_1 = model_.tables().n_1();
    const VectorXd linear = xi_.head(n_1);
    const VectorXd nonlinear = xi_.tail(xi_.size() - n_1);
    model_.evaluate(block, values_of(nonlinear), values_of(linear), &carry, tangent);
  }

  void follow(const Range& range, const MatrixXd& tangent) {
    for (std::size_t k = 0; k < range.rows; ++k) {
      const std::size_t row = range.first + k;
      const int trajectory = plan_.trajectory_at(row, k == 0 && range.starts_segment);
      if (trajectory >= 0) {
        begin(trajectory);
      } else {
        advance(row - 1);
      }
      add(row, k, tangent);
    }
  }

  void begin(int trajectory) {
    x_ = states::start_of(plan_, trajectory, xi_);
    P_ = MatrixXd::Zero(x_.size(), x_.size());
    C_ = MatrixXd::Zero(x_.size(), xi_.size());
  }

  void add(std::size_t row, std::size_t within, const MatrixXd& tangent) {
    const auto first = static_cast<Index>(within);
    const Index stride = tangent.rows() / weights_.size();
    const auto J = tangent(Eigen::seqN(first, weights_.size(), stride),
                           Eigen::seqN(0, xi_.size()));  // n_z x n
    const MatrixXd B = J.transpose() * weights_.asDiagonal() * steps_->read(row, x_).H;
    const MatrixXd BC = B * C_;
    score_ += B * P_ * B.transpose() + BC + BC.transpose();
    C_ += P_ * B.transpose();
  }

  void advance(std::size_t row) {
    const StateSteps::Step step = steps_->advance(row, x_);
    const double held = plan_.discrete() ? 1.0 : time_[row + 1] - time_[row];
    x_ = step.x;
    P_ = step.Phi * P_ * step.Phi.transpose() +
         step.Gamma * plan_.noise_variances(density_, held).asDiagonal() * step.Gamma.transpose();
    C_ = step.Phi * C_;
  }

  const StateBlockModel& model_;
  const TrajectoryPlan& plan_;
  const VectorXd& xi_;
  VectorXd weights_;  // n_z, R^-1
  VectorXd density_;  // n_w
  std::unique_ptr<StateSteps> steps_;
  model::Measurements measurements_;
  std::span<const double> time_;
  VectorXd x_;
  MatrixXd P_;      // n_x x n_x
  MatrixXd C_;      // n_x x n
  MatrixXd score_;  // n x n
};

}  // namespace

MatrixXd StateBlockModel::score_noise(const Record& record, const VectorXd& xi,
                                      const VectorXd& noise, const VectorXd& density) const {
  ScoreNoise score(*this, record, xi, noise, density);
  score.run();
  return score.covariance();
}

}  // namespace sepcal
