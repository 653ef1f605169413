// SPDX-License-Identifier: BSD-3-Clause
#include "many/joint_covariance.hpp"

#include <cmath>

#include "estimation/covariance.hpp"
#include "numerics/symmetric.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool is_singular(const MatrixXd& R) {
  return !R.allFinite() ||
         (R.diagonal().array().abs() <= 1e-14 * R.colwise().norm().transpose().array()).any();
}

MatrixXd undefined(Index n) { return MatrixXd::Constant(n, n, not_a_number); }

/// rows K^-1. Without rows or columns there is nothing to solve, and Eigen is not to be asked.
MatrixXd divide(MatrixXd rows, const MatrixXd& K) {
  if (rows.size() > 0) K.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(rows);
  return rows;
}

/// R^-1 M R^-T, symmetric to the last bit.
MatrixXd sandwich(const MatrixXd& R, const MatrixXd& M) {
  if (R.size() == 0) return M;
  const auto upper = R.triangularView<Eigen::Upper>();
  const MatrixXd half = upper.solve(M);
  const MatrixXd whole = upper.solve(half.transpose());
  return numerics::symmetric_part(whole);
}

JudgedFlight judge_flight(const Layout& layout, const std::vector<bool>& at_bound,
                          const TriangularFactor& block, Index flight) {
  JudgedFlight judged{{}, {{}, {}, {}, TriangularFactor(1)}, {}};
  Index own = 0;
  for (Index k = 0; k < layout.own + layout.shared; ++k) {
    if (at_bound[static_cast<std::size_t>(layout.place(flight, k))]) continue;
    judged.columns.push_back(k);
    own += k < layout.own ? 1 : 0;
  }
  std::vector<Index> columns = judged.columns;
  columns.push_back(block.columns() - 1);
  judged.share = eliminate_own(block.matrix()(Eigen::all, columns), own);
  return judged;
}

/// Rows of the prior in the coordinates of K.
MatrixXd known_rows(const VectorXd& weights, const MatrixXd& K) {
  return divide(weights.asDiagonal(), K);
}

/// Of [own | shared], the own ones alone.
VectorXd own_weights(const JudgedFlight& judged, const ManyObjective& objective) {
  VectorXd weights = objective.prior_weights()(judged.columns);
  weights.tail(weights.size() - judged.share.own.cols()).setZero();
  return weights;
}

void ask_for_middles(JointCovariance& result, const JointProblem& joint, const JointStage& stage,
                     const ManyObjective& objective, FlightSource& source) {
  VectorXd rounding = VectorXd::Zero(stage.noise.size());
  for (Index j = 0; j < rounding.size() && !joint.noise_given(); ++j) {
    rounding[j] = 2.0 * joint.noise_floor(j);
  }
  std::vector<ScoreQuestion> questions;
  std::vector<std::size_t> asked;
  for (Index i = 0; i < joint.layout.flights; ++i) {
    const JudgedFlight& judged = result.flights[static_cast<std::size_t>(i)];
    if (is_singular(judged.share.own)) continue;
    asked.push_back(static_cast<std::size_t>(i));
    questions.push_back({objective.flight(i), joint.layout.point(stage.x, i),
                         std::sqrt(result.ratio) * stage.noise, rounding, judged.columns,
                         beside_others(judged.share, result.joint)});
  }
  const std::vector<MatrixXd> middles = source.score_covariances(questions);
  for (std::size_t q = 0; q < asked.size(); ++q) {
    JudgedFlight& judged = result.flights[asked[q]];
    judged.middle = middles[q];
    if (judged.middle.size() == 0) continue;
    const MatrixXd known = known_rows(own_weights(judged, objective), questions[q].K);
    judged.middle += known.transpose() * known;
  }
}

/// The factors of the problem whitened by `noise`.
JointCovariance factorise(const JointProblem& joint, const JointStage& stage,
                          const ManyObjective& objective, const VectorXd& noise) {
  return factorise(objective.flight_blocks(noise.cwiseInverse()), stage.at_bound, joint.layout,
                   objective.shared_prior().matrix());
}

/// Parameters that the measurements had to pay for: all of them, less the share of each that its
/// prior paid.
double count_spent(const JointProblem& joint, const JointStage& stage,
                   const ManyObjective& objective) {
  auto spent = static_cast<double>(joint.layout.size());
  const VectorXd& weights = objective.prior_weights();
  if (weights.isZero(0.0)) return spent;
  const JointCovariance all = factorise(joint, stage, objective, stage.noise);
  spent -=
      estimation::prior_share(all.shared_white(), weights.tail(joint.layout.shared)(all.shared));
  for (Index i = 0; i < joint.layout.flights; ++i) {
    const JudgedFlight& judged = all.flights[static_cast<std::size_t>(i)];
    spent -= estimation::prior_share(all.own_white(i),
                                     own_weights(judged, objective).head(judged.share.own.cols()));
  }
  return spent;
}

/// M / (M - n), the square of what R-hat has to be multiplied by; 1 where R was given, NaN where
/// nothing is left to estimate it from.
double judge_ratio(const JointProblem& joint, const JointStage& stage,
                   const ManyObjective& objective) {
  if (joint.noise_given()) return 1.0;
  const double measurements = joint.rows * static_cast<double>(stage.noise.size());
  const double freedom = measurements - count_spent(joint, stage, objective);
  return freedom > 0 ? measurements / freedom : not_a_number;
}

}  // namespace

JointCovariance factorise(const std::vector<TriangularFactor>& blocks,
                          const std::vector<bool>& at_bound, const Layout& layout,
                          const MatrixXd& shared_prior) {
  JointCovariance result;
  std::vector<Share> shares;
  for (Index i = 0; i < layout.flights; ++i) {
    result.flights.push_back(
        judge_flight(layout, at_bound, blocks[static_cast<std::size_t>(i)], i));
    shares.push_back(result.flights.back().share);
  }
  for (const Index column : result.flights.front().columns) {
    if (column >= layout.own) result.shared.push_back(column - layout.own);
  }
  // Own parameters at their bounds differ from flight to flight, the shared ones don't.
  std::vector<Index> columns = result.shared;
  columns.push_back(layout.shared);
  result.joint = shared_factor(shares, shared_prior(Eigen::all, columns));
  result.singular = is_singular(result.joint);
  return result;
}

void JointCovariance::add_middles(const VectorXd& prior_weights) {
  const MatrixXd known = known_rows(prior_weights(shared), joint);
  middle_sum = known.transpose() * known;
  for (Index i = 0; i < static_cast<Index>(flights.size()); ++i) middle_sum += shared_middle(i);
}

MatrixXd JointCovariance::contribution(Index flight) const {
  const Index k = joint.cols();
  const TriangularFactor& factor = flights[static_cast<std::size_t>(flight)].share.shared;
  return divide(factor.matrix().topLeftCorner(k, k), joint);
}

MatrixXd JointCovariance::shared_middle(Index flight) const {
  const MatrixXd& middle = flights[static_cast<std::size_t>(flight)].middle;
  if (middle.size() > 0) return middle.bottomRightCorner(joint.cols(), joint.cols());
  const MatrixXd B = contribution(flight);
  return B.transpose() * B;
}

MatrixXd JointCovariance::shared_white() const {
  if (!is_defined()) return undefined(joint.cols());
  return sandwich(joint, MatrixXd::Identity(joint.cols(), joint.cols()));
}

MatrixXd JointCovariance::shared_coloured() const {
  return is_defined() ? sandwich(joint, middle_sum) : undefined(joint.cols());
}

MatrixXd JointCovariance::own_white(Index flight) const {
  const Share& share = flights[static_cast<std::size_t>(flight)].share;
  const Index n_own = share.own.cols();
  if (!is_defined() || is_singular(share.own)) return undefined(n_own);
  const MatrixXd through = divide(share.cross, joint);  // what the shared parameters' error adds
  return sandwich(share.own, MatrixXd::Identity(n_own, n_own) + through * through.transpose());
}

MatrixXd JointCovariance::own_coloured(Index flight) const {
  const JudgedFlight& judged = flights[static_cast<std::size_t>(flight)];
  const Share& share = judged.share;
  const Index n_own = share.own.cols();
  if (!is_defined() || is_singular(share.own)) return undefined(n_own);
  const MatrixXd through = divide(share.cross, joint);
  MatrixXd own = MatrixXd::Identity(n_own, n_own);
  MatrixXd mixed = MatrixXd::Zero(n_own, joint.cols());
  if (judged.middle.size() > 0) {
    own = judged.middle.topLeftCorner(n_own, n_own);
    mixed = judged.middle.topRightCorner(n_own, joint.cols());
  }
  const MatrixXd crossed = mixed * through.transpose();
  return sandwich(share.own,
                  own + through * middle_sum * through.transpose() - crossed - crossed.transpose());
}

JointCovariance find_joint_covariance(const JointProblem& joint, const JointStage& stage,
                                      const ManyObjective& objective, FlightSource& source) {
  const double ratio = judge_ratio(joint, stage, objective);
  const double known_ratio = std::isnan(ratio) ? 1.0 : ratio;
  JointCovariance result = factorise(joint, stage, objective, std::sqrt(known_ratio) * stage.noise);
  result.ratio = ratio;
  if (!result.is_defined()) return result;
  if (joint.problem.options().coloured_errors) {
    ask_for_middles(result, joint, stage, objective, source);
  }
  result.add_middles(objective.prior_weights().tail(joint.layout.shared));
  return result;
}

}  // namespace sepcal::many
