// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/covariance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "model/loss.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/symmetric.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

MatrixXd nothing(Index k) { return MatrixXd::Constant(k, k, undefined); }

/// The free parameters whose estimate has a distribution: those not held by a bound.
std::vector<Index> find_inside(const std::vector<bool>& at_bound) {
  std::vector<Index> indices;
  for (std::size_t k = 0; k < at_bound.size(); ++k) {
    if (!at_bound[k]) indices.push_back(static_cast<Index>(k));
  }
  return indices;
}

/// Rows over `noise`, those of the prior among them, or the share of it that is one of `shares`:
/// n x n.
MatrixXd whiten(const Problem& problem, const StageTwo& two, const VectorXd& noise,
                double shares = 1.0) {
  TriangularFactor factor = combine(two.factors, noise.cwiseInverse());
  for (Prior& prior : problem.prior()) {
    prior.weight /= std::sqrt(shares);
    prior.join(factor, two.x);
  }
  return factor.matrix().topLeftCorner(two.x.size(), two.x.size());
}

/// The estimate with the factors of the sampled rows alone.
StageTwo on_sampled_rows(const Problem& problem, const SampledRows& sampled, StageTwo two) {
  const VectorXd xi1 = two.x.head(sampled.sweep.tables().n_1());
  const VectorXd xi2 = two.x.tail(sampled.sweep.tables().n_2());
  const FitOptions& options = problem.options();
  if (options.loss == Loss::squares) {
    two.factors = sampled.sweep.tangent_factors(xi1, xi2);
  } else {
    two.factors = sampled.sweep.forgiving_factors(
        xi1, xi2, model::RobustLoss(options.loss, options.loss_width), two.noise.cwiseInverse());
  }
  return two;
}

/// Parameters that the measurements had to pay for: all of them, less the share of each that its
/// prior paid.
double count_spent(const Problem& problem, const StageTwo& two, const std::vector<Index>& inside) {
  auto spent = static_cast<double>(two.x.size());
  for (const Prior& prior : problem.prior()) {
    const MatrixXd R = select_columns(whiten(problem, two, two.noise), inside);
    spent -= prior_share(inverse_of_square(R), prior.weight(inside));
  }
  return spent;
}

/// The noise that residuals are judged to have, by output: two.noise where it was given, else with
/// M / (M - p), and less where it stands at its floor above the residual. There, at 1e-12 of the
/// output, a thousandth of it is the rounding of the measurements.
VectorXd judge_noise(const Problem& problem, const StageTwo& two, double rows, double ratio) {
  constexpr double rounding = 1e-6;  // of the floor's variance
  if (problem.noise().size() > 0) return two.noise;
  VectorXd judged = two.noise * std::sqrt(ratio);
  if (problem.options().loss != Loss::squares) return judged;
  for (Index j = 0; j < judged.size(); ++j) {
    const MatrixXd& T = two.factors[static_cast<std::size_t>(j)].matrix();
    const double share = T.rightCols<1>().squaredNorm() / (rows * two.noise[j] * two.noise[j]);
    judged[j] *= std::sqrt(std::clamp(share, rounding, 1.0));
  }
  return judged;
}

/// The sandwich, H^-1, and what blocks show of the noise in its middle.
struct Slices {
  MatrixXd covariance;
  MatrixXd inverse_hessian;
  BlockEvidence evidence;
};

/// Whether blocks speak against a noise model and for that of the residual by itself: they show
/// clearly less than the first says, and are far likelier under the second.
bool refutes(const BlockEvidence& restricted, const BlockEvidence& by_itself) {
  constexpr double far_likelier = 30.0;  // in -2 ln L
  return restricted.minus_two_log_likelihood - by_itself.minus_two_log_likelihood > far_likelier;
}

/// Whether they show so little that it is worth asking.
bool doubts(const BlockEvidence& evidence) {
  constexpr double little = 0.7;
  return evidence.mean() < little;
}

/// The sandwich, between factors that nearly are its bread: with Q = J R^-1, all is near to one.
class Sandwich {
  static constexpr Index most_blocks = 20;
  static constexpr Index fewest_rows = 100;

 public:
  /// `judged` (n_z): the noise behind R (k x k) of all rows and K of the sampled ones. `ratio`:
  /// M / (M - p).
  Sandwich(const Problem& problem, const SampledRows& sampled, const StageTwo& two, MatrixXd R,
           MatrixXd K, VectorXd judged, double ratio)
      : problem_(problem),
        sweep_(sampled.sweep),
        shares_(sampled.rows),
        two_(two),
        R_(std::move(R)),
        K_(std::move(K)),
        judged_(std::move(judged)),
        ratio_(ratio),
        residuals_(sweep_.residuals(xi1(), xi2())),
        blocks_(residuals_.rows() >= fewest_rows ? most_blocks : 1) {
    const FitOptions& options = problem.options();
    if (options.loss != Loss::squares) loss_.emplace(options.loss, options.loss_width);
    if (loss_) {
      for (Index j = 0; j < residuals_.cols(); ++j) {
        for (double& r : residuals_.col(j)) {
          r = two_.noise[j] * loss_->influence(r / two_.noise[j]);
        }
      }
    }
  }

  bool is_finite() const { return residuals_.allFinite() && R_.allFinite() && K_.allFinite(); }

  /// Gives each output's residual its noise model; whether any is coloured.
  bool find_colours(const std::vector<Index>& inside) {
    // An estimated R above its own residual stands at its floor: what is left is rounding.
    const bool may_be_rounding = !loss_ && problem_.noise().size() == 0;
    colours_ = find_output_noise(sweep_.tangent_rows(xi1(), xi2()), inside, residuals_,
                                 sweep_.measurements().runs(),
                                 (may_be_rounding ? 0.99 : 0.0) * two_.noise, sweep_.pool());
    return std::ranges::any_of(colours_, [](const std::optional<OutputNoise>& colour) {
      return colour && !is_white(*colour);
    });
  }

  /// Gives each coloured output the noise of its residual by itself.
  void leave_columns_out(const std::vector<Index>& inside) {
    const std::vector<MatrixXd> tangents = sweep_.tangent_rows(xi1(), xi2());
    for (std::size_t j = 0; j < colours_.size(); ++j) {
      const std::optional<OutputNoise>& colour = colours_[j];
      if (!colour.has_value()) continue;
      if (is_white(*colour)) continue;
      colours_[j] =
          find_noise_by_itself(residuals_.col(static_cast<Index>(j)),
                               tangents[j](Eigen::all, inside), sweep_.measurements().runs());
    }
  }

  const std::vector<std::optional<OutputNoise>>& noise() const { return colours_; }

  /// The covariance (k x k); with a loss, of white residuals before find_colours() was asked.
  Slices covariance(const std::vector<Index>& inside) const {
    const Index k = R_.cols();
    MatrixXd bread = MatrixXd::Identity(k, k);
    MatrixXd middle = MatrixXd::Zero(k, k);
    MatrixXd known = MatrixXd::Zero(k, k);  // the prior's information
    for (const Prior& prior : problem_.prior()) {
      MatrixXd W = (prior.weight(inside) / std::sqrt(shares_)).asDiagonal();
      K_.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(W);
      known += W.transpose() * W;
    }
    std::vector<MatrixXd> tangents = sweep_.tangent_rows(xi1(), xi2());
    BlockEvidence evidence;
    if (loss_) {
      weigh_each_row(std::move(tangents), inside, bread, middle);
      bread += known;
    } else {
      const BlockScores scores = find_scores(std::move(tangents), inside);
      middle = scores.score_covariance();
      if (blocks_ > 1) evidence = scores.weigh(known, K_);
    }
    middle += known;
    const MatrixXd inverse = R_.triangularView<Eigen::Upper>().solve(MatrixXd(bread.inverse()));
    const MatrixXd outer =
        R_.triangularView<Eigen::Upper>().solve(MatrixXd(MatrixXd::Identity(k, k)));
    return {numerics::symmetric_part(inverse * middle * inverse.transpose()),
            numerics::symmetric_part(inverse * outer.transpose()), std::move(evidence)};
  }

 private:
  VectorXd xi1() const { return two_.x.head(sweep_.tables().n_1()); }
  VectorXd xi2() const { return two_.x.tail(sweep_.tables().n_2()); }

  /// The scores of blocks, in the coordinates of K.
  BlockScores find_scores(std::vector<MatrixXd> tangents, const std::vector<Index>& inside) const {
    const Index k = K_.cols();
    std::vector<BlockScores> parts(tangents.size(), BlockScores(blocks_, k));
    sweep_.pool().for_each(tangents.size(), [&](std::size_t j) {
      const double deviation = judged_[static_cast<Index>(j)];
      MatrixXd Q = tangents[j](Eigen::all, inside) / deviation;
      tangents[j].resize(0, 0);
      K_.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(Q);
      std::optional<OutputNoise> colour;
      if (!colours_.empty()) colour = colours_[j];
      parts[j].add(Q, residuals_.col(static_cast<Index>(j)) / deviation, colour, deviation,
                   sweep_.measurements().runs());
    });
    BlockScores sum(blocks_, k);
    for (const BlockScores& part : parts) sum.add(part);
    return sum;
  }

  /// With a loss each row has its own slope of psi, and white rows their own square.
  void weigh_each_row(std::vector<MatrixXd> tangents, const std::vector<Index>& inside,
                      MatrixXd& bread, MatrixXd& middle) const {
    std::vector<MatrixXd> breads(tangents.size());
    std::vector<MatrixXd> middles(tangents.size());
    sweep_.pool().for_each(tangents.size(), [&](std::size_t j) {
      const double noise = two_.noise[static_cast<Index>(j)];
      const double judged = judged_[static_cast<Index>(j)];
      MatrixXd Q = tangents[j](Eigen::all, inside) / judged;
      K_.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(Q);
      const VectorXd slopes =
          tangents[j].rightCols<1>().unaryExpr([&](double r) { return loss_->slope(r / noise); });
      breads[j] = Q.transpose() * slopes.asDiagonal() * Q;
      std::optional<OutputNoise> colour;
      if (!colours_.empty()) colour = colours_[j];
      if (colour && !is_white(*colour)) {
        middles[j] = covariance_product(*colour, judged, sweep_.measurements().runs(), Q);
      } else {
        const VectorXd s = residuals_.col(static_cast<Index>(j)) / judged;
        middles[j] = ratio_ * Q.transpose() * s.cwiseAbs2().asDiagonal() * Q;
      }
    });
    bread.setZero();
    for (std::size_t j = 0; j < breads.size(); ++j) {
      bread += breads[j];
      middle += middles[j];
    }
  }

  const Problem& problem_;
  const model::Sweep& sweep_;
  double shares_;  // of the prior, one of which is the sampled rows'
  const StageTwo& two_;
  MatrixXd R_;
  MatrixXd K_;
  VectorXd judged_;
  double ratio_;
  MatrixXd residuals_;  // rows x n_z; with a loss, noise_j psi(r / noise_j)
  Index blocks_;        // that the noise is held against; 1 of a record too short for them
  std::optional<model::RobustLoss> loss_;
  std::vector<std::optional<OutputNoise>> colours_;
};

}  // namespace

MatrixXd inverse_of_square(const MatrixXd& R) {
  const Index n = R.cols();
  if ((R.diagonal().array().abs() <= 1e-14 * R.colwise().norm().transpose().array()).any()) {
    return nothing(n);
  }
  const MatrixXd inverse = R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(n, n));
  return inverse * inverse.transpose();
}

MatrixXd select_columns(const MatrixXd& R, const std::vector<Index>& columns) {
  TriangularFactor factor(static_cast<int>(columns.size()));
  MatrixXd rows = R(Eigen::all, columns);
  factor.absorb(rows);
  return factor.matrix();
}

Covariances find_covariances(const Problem& problem, const model::Sweep& sweep,
                             const SampledRows& sampled, const StageTwo& two) {
  const bool noise_given = problem.noise().size() > 0;
  const FitOptions& options = problem.options();
  Covariances result;
  result.inside = find_inside(two.at_bound);
  const auto k = static_cast<Index>(result.inside.size());
  const auto rows = static_cast<double>(sweep.measurements().rows());
  const double count = rows * sweep.tables().n_z();
  const double freedom = count - count_spent(problem, two, result.inside);
  const double ratio = freedom > 0.0 ? count / freedom : undefined;
  result.freedom = freedom;

  const VectorXd judged = judge_noise(problem, two, rows, freedom > 0.0 ? ratio : 1.0);
  result.tangent = whiten(problem, two, judged);
  result.judged = judged;
  const MatrixXd R = select_columns(result.tangent, result.inside);
  result.white = noise_given || freedom > 0.0 ? inverse_of_square(R) : nothing(k);
  result.noise_model = result.inverse_hessian = result.white;
  const bool forgiving = options.loss != Loss::squares;
  if (k == 0 || std::isnan(ratio) || !result.white.allFinite()) return result;
  if (!forgiving && !options.coloured_errors) return result;

  MatrixXd K = R;
  if (sampled.rows > 1.0) {
    const StageTwo part = on_sampled_rows(problem, sampled, two);
    K = select_columns(whiten(problem, part, judged, sampled.rows), result.inside);
    result.sample_falls_short = !inverse_of_square(K).allFinite();
    if (result.sample_falls_short) return result;
  }
  Sandwich sandwich(problem, sampled, two, R, std::move(K), judged, ratio);
  if (!sandwich.is_finite()) return result;
  if (forgiving) {
    const Slices slices = sandwich.covariance(result.inside);
    result.noise_model = result.white = slices.covariance;
    result.inverse_hessian = slices.inverse_hessian;
  }
  if (!options.coloured_errors) return result;
  const bool coloured_noise = sandwich.find_colours(result.inside);
  result.noise = sandwich.noise();
  if (!coloured_noise && !noise_given) return result;
  Slices slices = sandwich.covariance(result.inside);
  if (coloured_noise && doubts(slices.evidence)) {
    sandwich.leave_columns_out(result.inside);
    Slices others = sandwich.covariance(result.inside);
    if (refutes(slices.evidence, others.evidence)) {
      slices = std::move(others);
      result.noise = sandwich.noise();
    }
  }
  if (coloured_noise) result.evidence = std::move(slices.evidence);
  if (slices.covariance.allFinite()) result.noise_model = std::move(slices.covariance);
  return result;
}

double prior_share(const MatrixXd& covariance, const VectorXd& weights) {
  const double share = covariance.diagonal().cwiseProduct(weights.cwiseAbs2()).sum();
  return std::isfinite(share) ? share : 0.0;
}

MatrixXd spread(const MatrixXd& covariance, const std::vector<Index>& places, Index n) {
  MatrixXd all = nothing(n);
  all(places, places) = covariance;
  return all;
}

MatrixXd correlation_of(const MatrixXd& covariance) {
  const VectorXd errors = covariance.diagonal().cwiseSqrt();
  MatrixXd correlation = covariance.cwiseQuotient(errors * errors.transpose());
  for (Index k = 0; k < errors.size(); ++k) {
    if (!std::isnan(errors[k])) correlation(k, k) = 1.0;
  }
  return correlation;
}

}  // namespace sepcal::estimation
