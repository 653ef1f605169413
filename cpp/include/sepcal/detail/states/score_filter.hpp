// SPDX-License-Identifier: BSD-3-Clause
// The filter of a likelihood: beside x and P it carries their derivatives by theta, and gives of
// each sample its term of V_m (S 5.7) and the rows whose triangular factor [R q] holds Fisher's
// information and the gradient (S 5.10; S 5.11 with the trace that its product of vectors stands
// for, which is the same for one output only). With Lambda = S'S, w = S^-T e and, for parameter i,
//   d_i = S^-T de/dtheta_i,   M_i = S^-T (dLambda/dtheta_i) S^-1,
// a sample's rows are [-d_i | w], n_z of them, and for j <= k those of Lambda,
// [M_i,kk / sqrt 2 | (w_k^2 - 1) / sqrt 2] and [M_i,jk | w_j w_k]. Then R'R = sum d_i'd_j +
// tr(M_i M_j) / 2, and R'q is minus the gradient: theta + R^-1 q is a step of Fisher scoring.
// No derivative goes through a factorisation: P is propagated as a root, dP as
// it is, P+ = L P L' + K R K' with L = I - K H, which does not change with K.
#pragma once

#include <cmath>
#include <numbers>

#include "sepcal/detail/states/second_order_step.hpp"
#include "sepcal/states/filter.hpp"

namespace sepcal {

/// How theta stands: n parameters of the model, the state where the segment begins (n_x), ln of the
/// process noises' roots of density (n_w), ln of the outputs' standard deviations (n_z). Each noise
/// enters a step by n_v / n_w parts (noise_parts()). Sizes may be Eigen::Dynamic. Asks for no
/// memory where they are fixed, and throws nothing.
template <int NX, int NW, int NZ, int N, int NV = states::times(2, NW)>
class ScoreFilter {
 public:
  static constexpr int NT = states::together(states::together(N, NX), states::together(NW, NZ));
  static constexpr int NR = NZ == Eigen::Dynamic ? Eigen::Dynamic : NZ + NZ * (NZ + 1) / 2;
  using State = Eigen::Vector<double, NX>;
  using Covariance = Eigen::Matrix<double, NX, NX>;
  using Outputs = Eigen::Vector<double, NZ>;
  using Noise = Eigen::Vector<double, NW>;
  using Parts = Eigen::Vector<double, NV>;
  using Rows = Eigen::Matrix<double, NR, states::together(NT, 1)>;  // [score rows | residual]
  using Moves = Eigen::Array<bool, NT, 1>;

  /// At a segment's start x, which theta knows (P = 0), or which is what is known of it beside a
  /// covariance P, and no part of theta. `moves`: by which of theta gains change; where dynamics
  /// are linear in the state, xi1 and x(0) change none.
  ScoreFilter(const State& x, const Covariance& P, Eigen::Index n, Eigen::Index n_w,
              Eigen::Index n_z, const Moves& moves)
      : filter_(x, P), n_(n), n_w_(n_w), n_z_(n_z), moves_(moves) {
    const Eigen::Index n_x = x.size();
    dx_.setZero(n_x, moves.size());
    if (P.isZero(0.0)) dx_.middleCols(n, n_x).setIdentity();
    dP_.setZero(n_x, n_x * moves.size());
  }

  Eigen::Index parameters() const { return n_; }
  Eigen::Index noises() const { return n_w_; }
  Eigen::Index outputs() const { return n_z_; }
  const State& x() const { return filter_.x(); }
  Covariance covariance() const { return filter_.covariance(); }
  /// dx/dtheta, n_x x n_theta.
  const Eigen::Matrix<double, NX, NT>& slopes() const { return dx_; }

  /// By y (n_z, NaN where missing), what was expected of it, and the outputs' deviations r (n_z).
  /// `rows` are this sample's; zero for what is missing, and where the status is not ok.
  Innovation<NZ> update(const Outputs& y, const SecondOrderReading<NX, NZ, N>& expected,
                        const Outputs& r, Rows& rows) {
    rows.setZero(n_z_ + n_z_ * (n_z_ + 1) / 2, moves_.size() + 1);
    const Covariance P = filter_.covariance();
    const Eigen::Matrix<double, NZ, NZ> R = r.cwiseAbs2().asDiagonal();
    const Innovation<NZ> innovation = filter_.template update<NZ>(y, {expected.z, expected.H}, R);
    if (innovation.status != FilterStatus::ok) return innovation;
    Sample at{y, expected.H, innovation, P};
    for (Eigen::Index j = 0; j < n_z_; ++j) {
      if (std::isnan(y[j])) at.H.row(j).setZero();
    }
    at.PH = states::product(P, at.H.transpose());
    at.K = over_covariance(at.PH, innovation.S);
    at.L = -states::product(at.K, at.H);
    at.L.diagonal().array() += 1.0;
    for (Eigen::Index i = 0; i < moves_.size(); ++i) differentiate_update(at, expected, r, i, rows);
    fill_residuals(at, rows);
    return innovation;
  }

  /// To the next row; `held` is the time to it (s; 1 of a model in discrete time), `q` the roots of
  /// the noises' densities (n_w).
  FilterStatus predict(const SecondOrderStep<NX, NV, N>& step, const Noise& q, double held) {
    const Covariance P = filter_.covariance();
    Parts variance(step.Gamma.cols());
    for (Eigen::Index k = 0; k < variance.size(); ++k) {
      variance[k] = q[k % n_w_] * q[k % n_w_] / held;
    }
    const Eigen::Matrix<double, NV, NV> Q_d = variance.asDiagonal();
    const FilterStatus status = filter_.template predict<NV>({step.x, step.Phi, step.Gamma, Q_d});
    if (status != FilterStatus::ok) return status;
    const Covariance Phi_P = states::product(step.Phi, P);
    for (Eigen::Index i = 0; i < moves_.size(); ++i) {
      if (moves_[i]) differentiate_covariance(step, Phi_P, variance, i);
      State moved = states::product(step.Phi, dx_.col(i));
      if (i < n_) moved += step.Pi.col(i);
      dx_.col(i) = moved;
    }
    return status;
  }

  /// x where theta moves by `shift` (n_theta), to first order.
  void move(const Eigen::Vector<double, NT>& shift) {
    filter_ = Filter<NX>(filter_.x() + states::product(dx_, shift), filter_.form());
  }

 private:
  /// What a sample's derivatives have in common.
  struct Sample {
    const Outputs& y;
    Eigen::Matrix<double, NZ, NX> H;  // zero in rows of missing outputs
    const Innovation<NZ>& innovation;
    const Covariance& P;  // P(k|k-1)
    Eigen::Matrix<double, NX, NZ> PH = {};
    Eigen::Matrix<double, NX, NZ> K = {};
    Covariance L = {};  // I - K H
  };

  /// B Lambda^-1.
  static Eigen::Matrix<double, NX, NZ> over_covariance(const Eigen::Matrix<double, NX, NZ>& B,
                                                       const Eigen::Matrix<double, NZ, NZ>& S) {
    const Eigen::Matrix<double, NZ, NX> Kbar = states::solve_transposed(S, B.transpose());
    return states::solve_upper(S, Kbar).transpose();
  }

  auto slope_of_covariance(Eigen::Index i) { return dP_.middleCols(i * dx_.rows(), dx_.rows()); }

  /// Slopes by x and the parameters, times what theta_i does to these: a matrix column by column.
  template <int ROWS, int COLUMNS, class Slopes>
  Eigen::Matrix<double, ROWS, COLUMNS> along(const Slopes& slopes, Eigen::Index i,
                                             Eigen::Index rows, Eigen::Index columns) const {
    const Eigen::Index n_x = dx_.rows();
    Eigen::Vector<double, Slopes::RowsAtCompileTime> flat =
        states::product(slopes.leftCols(n_x), dx_.col(i));
    if (i < n_) flat += slopes.col(n_x + i);
    return Eigen::Map<const Eigen::Matrix<double, ROWS, COLUMNS>>(flat.data(), rows, columns);
  }

  void differentiate_update(const Sample& at, const SecondOrderReading<NX, NZ, N>& expected,
                            const Outputs& r, Eigen::Index i, Rows& rows) {
    const Eigen::Matrix<double, NZ, NZ>& S = at.innovation.S;
    Outputs dz = states::product(at.H, dx_.col(i));
    if (i < n_) dz += expected.J.col(i);
    for (Eigen::Index j = 0; j < n_z_; ++j) {
      if (std::isnan(at.y[j])) dz[j] = 0.0;
    }
    const Outputs d = states::solve_transposed(S, -dz);
    rows.col(i).head(n_z_) = -d;
    State moved = dx_.col(i) - states::product(at.K, dz);
    if (moves_[i]) moved += differentiate_gain(at, expected, r, i, rows);
    dx_.col(i) = moved;
  }

  /// Of theta_i that moves gains: dP, the rows of Lambda, and dK e, which it returns.
  State differentiate_gain(const Sample& at, const SecondOrderReading<NX, NZ, N>& expected,
                           const Outputs& r, Eigen::Index i, Rows& rows) {
    const Eigen::Matrix<double, NZ, NZ>& S = at.innovation.S;
    Eigen::Matrix<double, NZ, NX> dH = along<NZ, NX>(expected.H_slopes, i, n_z_, dx_.rows());
    Outputs dR = Outputs::Zero(n_z_);  // of a diagonal
    const Eigen::Index output = i - (moves_.size() - n_z_);
    if (output >= 0) dR[output] = 2.0 * r[output] * r[output];
    for (Eigen::Index j = 0; j < n_z_; ++j) {
      if (!std::isnan(at.y[j])) continue;
      dH.row(j).setZero();
      dR[j] = 0.0;
    }
    const Covariance dP = slope_of_covariance(i);
    const Eigen::Matrix<double, NX, NZ> P_dH = states::product(at.P, dH.transpose());
    const Eigen::Matrix<double, NX, NZ> moved = states::product(dP, at.H.transpose()) + P_dH;
    Eigen::Matrix<double, NZ, NZ> dLambda =
        states::product(at.H, moved) + states::product(dH, at.PH);
    dLambda.diagonal() += dR;

    const Eigen::Matrix<double, NZ, NZ> half = states::solve_transposed(S, dLambda);
    const Eigen::Matrix<double, NZ, NZ> M = states::solve_transposed(S, half.transpose());
    Eigen::Index row = n_z_;
    for (Eigen::Index k = 0; k < n_z_; ++k) {
      for (Eigen::Index j = 0; j < k; ++j) rows(row++, i) = M(j, k);
      rows(row++, i) = M(k, k) / std::numbers::sqrt2;
    }

    const Eigen::Matrix<double, NX, NZ> dK =
        over_covariance(moved - states::product(at.K, dLambda), S);
    const Covariance turned = states::product(states::product(at.L, P_dH), at.K.transpose());
    slope_of_covariance(i) = states::product(at.L, dP, at.L.transpose()) - turned -
                             turned.transpose() +
                             states::product(at.K, dR.asDiagonal() * at.K.transpose());
    return states::product(dK, at.innovation.e);
  }

  void differentiate_covariance(const SecondOrderStep<NX, NV, N>& step, const Covariance& Phi_P,
                                const Parts& variance, Eigen::Index i) {
    const Eigen::Index n_x = dx_.rows();
    const Covariance dPhi = along<NX, NX>(step.Phi_slopes, i, n_x, n_x);
    const Eigen::Matrix<double, NX, NV> dGamma =
        along<NX, NV>(step.Gamma_slopes, i, n_x, variance.size());
    const Covariance turned =
        states::product(dPhi, Phi_P.transpose()) +
        states::product(dGamma, variance.asDiagonal() * step.Gamma.transpose());
    const Covariance dP = slope_of_covariance(i);
    slope_of_covariance(i) =
        states::product(step.Phi, dP, step.Phi.transpose()) + turned + turned.transpose();
    const Eigen::Index noise = i - n_ - n_x;
    if (noise < 0 || noise >= n_w_) return;
    for (Eigen::Index k = noise; k < variance.size(); k += n_w_) {
      slope_of_covariance(i) +=
          2.0 * variance[k] * states::product(step.Gamma.col(k), step.Gamma.col(k).transpose());
    }
  }

  void fill_residuals(const Sample& at, Rows& rows) const {
    const Outputs& w = at.innovation.w;
    const Eigen::Index last = moves_.size();
    rows.col(last).head(n_z_) = w;
    Eigen::Index row = n_z_;
    for (Eigen::Index k = 0; k < n_z_; ++k) {
      const bool missing = std::isnan(at.y[k]);
      for (Eigen::Index j = 0; j < k; ++j) {
        rows(row++, last) = missing || std::isnan(at.y[j]) ? 0.0 : w[j] * w[k];
      }
      rows(row++, last) = missing ? 0.0 : (w[k] * w[k] - 1.0) / std::numbers::sqrt2;
    }
  }

  Filter<NX> filter_;
  Eigen::Index n_;
  Eigen::Index n_w_;
  Eigen::Index n_z_;
  Moves moves_;
  Eigen::Matrix<double, NX, NT> dx_;
  Eigen::Matrix<double, NX, states::times(NX, NT)> dP_;  // n_x x n_x, side by side
};

}  // namespace sepcal
