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
// it is, P+ = L P L' + K R K' with L = I - K H, which does not change with K. What is an entry of a
// matrix to one parameter is a column over all of them: sums of columns in place of small products.
#pragma once

#include <algorithm>
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
      : filter_(x, P), n_(n), n_w_(n_w), n_z_(n_z), n_theta_(moves.size()) {
    const Eigen::Index n_x = x.size();
    dx_.setZero(n_theta_, n_x);
    if (P.isZero(0.0)) dx_.middleRows(n, n_x).setIdentity();
    movers_.resize(moves.count());
    Eigen::Index r = 0;
    for (Eigen::Index i = 0; i < n_theta_; ++i) {
      if (moves[i]) movers_[r++] = i;
    }
    dP_.setZero(movers_.size(), n_x * n_x);
  }

  Eigen::Index parameters() const { return n_; }
  Eigen::Index noises() const { return n_w_; }
  Eigen::Index outputs() const { return n_z_; }
  const State& x() const { return filter_.x(); }
  Covariance covariance() const { return filter_.covariance(); }
  /// dx/dtheta, n_x x n_theta.
  auto slopes() const { return dx_.transpose(); }

  /// By y (n_z, NaN where missing), what was expected of it, and the outputs' deviations r (n_z).
  /// `rows` are this sample's; zero for what is missing, and where the status is not ok.
  Innovation<NZ> update(const Outputs& y, const SecondOrderReading<NX, NZ, N>& expected,
                        const Outputs& r, Rows& rows) {
    rows.setZero(n_z_ + n_z_ * (n_z_ + 1) / 2, n_theta_ + 1);
    const Covariance P = filter_.covariance();
    const Eigen::Matrix<double, NZ, NZ> R = r.cwiseAbs2().asDiagonal();
    const Innovation<NZ> innovation = filter_.template update<NZ>(y, {expected.z, expected.H}, R);
    if (innovation.status != FilterStatus::ok) return innovation;
    Sample at{y, innovation, expected.H, {}, {}};
    for (Eigen::Index j = 0; j < n_z_; ++j) {
      if (std::isnan(y[j])) at.H.row(j).setZero();
    }
    at.whitened_H = states::solve_transposed(innovation.S, at.H);
    at.Kbar = states::product(P, at.whitened_H.transpose());

    const Gathered begin = gather();
    Over<NZ> dw(n_theta_, n_z_);  // S^-T dz/dtheta, x as theta moves it
    for (Eigen::Index k = 0; k < n_z_; ++k) {
      auto slope = dw.col(k);
      slope.setZero();
      if (states::is_nil(innovation.S, k)) continue;
      for (Eigen::Index a = 0; a < dx_.cols(); ++a) {
        states::add_times(at.H(k, a), dx_.col(a), slope);
      }
      if (!std::isnan(y[k])) slope.head(n_) += expected.J.row(k).transpose();
      for (Eigen::Index i = 0; i < k; ++i) {
        states::add_times(-innovation.S(i, k), dw.col(i), slope);
      }
      slope /= innovation.S(k, k);
    }
    for (Eigen::Index k = 0; k < n_z_; ++k) {
      rows.row(k).head(n_theta_) = dw.col(k).transpose();
      for (Eigen::Index a = 0; a < dx_.cols(); ++a) {
        states::add_times(-at.Kbar(a, k), dw.col(k), dx_.col(a));
      }
    }
    if (movers_.size() > 0) differentiate_gains(at, P, expected.H_slopes, begin, r, rows);
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
    if (movers_.size() > 0) differentiate_prediction(step, P, variance);
    const SlopesOfState before = dx_;
    for (Eigen::Index a = 0; a < dx_.cols(); ++a) {
      auto slope = dx_.col(a);
      slope.setZero();
      for (Eigen::Index b = 0; b < dx_.cols(); ++b) {
        states::add_times(step.Phi(a, b), before.col(b), slope);
      }
      slope.head(n_) += step.Pi.row(a).transpose();
    }
    return status;
  }

  /// x where theta moves by `shift` (n_theta), to first order.
  void move(const Eigen::Vector<double, NT>& shift) {
    filter_ = Filter<NX>(filter_.x() + states::product(dx_.transpose(), shift), filter_.form());
  }

 private:
  /// Columns over theta, and over those of theta that move gains.
  template <int COLUMNS>
  using Over = Eigen::Matrix<double, NT, COLUMNS>;
  template <int COLUMNS>
  using OverMovers = Eigen::Matrix<double, Eigen::Dynamic, COLUMNS, Eigen::ColMajor, NT, COLUMNS>;
  using SlopesOfState = Over<NX>;
  using Gathered = OverMovers<NX>;
  using OfCovariance = OverMovers<states::times(NX, NX)>;  // entries column by column

  /// What a sample's derivatives have in common.
  struct Sample {
    const Outputs& y;
    const Innovation<NZ>& innovation;
    Eigen::Matrix<double, NZ, NX> H;           // zero in rows of missing outputs
    Eigen::Matrix<double, NZ, NX> whitened_H;  // S^-T H
    Eigen::Matrix<double, NX, NZ> Kbar;        // P H' S^-1: the gain is K = Kbar S^-T
  };

  Eigen::Index n_x() const { return dx_.cols(); }

  /// dx/dtheta of those that move gains.
  Gathered gather() const {
    Gathered gathered(movers_.size(), n_x());
    for (Eigen::Index a = 0; a < n_x(); ++a) {
      for (Eigen::Index r = 0; r < movers_.size(); ++r) gathered(r, a) = dx_(movers_[r], a);
    }
    return gathered;
  }

  /// What theta does to an entry whose slopes by x and the parameters are a column of `slopes`.
  /// Returns whether it does anything.
  template <class Slopes, class Column>
  bool follow(const Slopes& slopes, Eigen::Index entry, const Gathered& dx, Column&& column) const {
    column.setZero();
    const auto of_entry = slopes.col(entry);
    if (of_entry.isZero(0.0)) return false;
    for (Eigen::Index a = 0; a < n_x(); ++a) states::add_times(of_entry[a], dx.col(a), column);
    for (Eigen::Index r = 0; r < movers_.size() && movers_[r] < n_; ++r) {
      column[r] += of_entry[n_x() + movers_[r]];
    }
    return true;
  }

  /// The place among those that move gains; -1 where theta_i doesn't.
  Eigen::Index mover(Eigen::Index i) const {
    const auto* const end = movers_.data() + movers_.size();
    const auto* const at = std::lower_bound(movers_.data(), end, i);
    return at != end && *at == i ? at - movers_.data() : -1;
  }

  /// dP <- A dP A' + turned + turned'.
  void turn(const Covariance& A, const OfCovariance& turned) {
    const Eigen::Index n = n_x();
    OfCovariance half = OfCovariance::Zero(dP_.rows(), n * n);
    states::add_times_slopes(A, dP_, half);
    for (Eigen::Index d = 0; d < n; ++d) {
      for (Eigen::Index a = 0; a <= d; ++a) {
        auto entry = dP_.col(a + n * d);
        entry = turned.col(a + n * d) + turned.col(d + n * a);
        for (Eigen::Index c = 0; c < n; ++c) states::add_times(A(d, c), half.col(a + n * c), entry);
        if (a < d) dP_.col(d + n * a) = entry;
      }
    }
  }

  /// dP, the rows of Lambda, and what the gain's change does to x.
  template <class Slopes>
  void differentiate_gains(const Sample& at, const Covariance& P, const Slopes& H_slopes,
                           const Gathered& begin, const Outputs& r, Rows& rows) {
    const Eigen::Matrix<double, NZ, NZ>& S = at.innovation.S;
    const Outputs& w = at.innovation.w;
    const Eigen::Index n = n_x();
    const Eigen::Index m = movers_.size();
    // S^-T dH.
    OverMovers<states::times(NZ, NX)> dH(m, n_z_ * n);
    Eigen::Array<bool, NZ, NX> there(n_z_, n);
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index k = 0; k < n_z_; ++k) {
        auto slope = dH.col(k + n_z_ * a);
        const bool seen = !std::isnan(at.y[k]) && !states::is_nil(S, k);
        if (!seen) slope.setZero();
        there(k, a) = seen && follow(H_slopes, k + n_z_ * a, begin, slope);
        for (Eigen::Index i = 0; seen && i < k; ++i) {
          if (!there(i, a) || S(i, k) == 0.0) continue;
          slope -= S(i, k) * dH.col(i + n_z_ * a);
          there(k, a) = true;
        }
        if (there(k, a)) slope /= S(k, k);
      }
    }
    // M = S^-T dLambda S^-1.
    OverMovers<states::times(NX, NZ)> spread = OverMovers<states::times(NX, NZ)>::Zero(m, n * n_z_);
    states::add_slopes_times(dP_, at.whitened_H.transpose(), spread);
    OverMovers<states::times(NZ, NZ)> M = OverMovers<states::times(NZ, NZ)>::Zero(m, n_z_ * n_z_);
    const auto halves = [&](Eigen::Index j, Eigen::Index k) { return M.col(j + n_z_ * k); };
    for (Eigen::Index k = 0; k < n_z_; ++k) {
      for (Eigen::Index j = 0; j <= k; ++j) {
        for (Eigen::Index a = 0; a < n; ++a) {
          states::add_times(at.whitened_H(j, a), spread.col(a + n * k), halves(j, k));
          if (there(j, a)) states::add_times(at.Kbar(a, k), dH.col(j + n_z_ * a), halves(j, k));
          if (there(k, a)) states::add_times(at.Kbar(a, j), dH.col(k + n_z_ * a), halves(j, k));
        }
      }
    }
    const Eigen::Matrix<double, NX, NZ> K = states::solve_upper(S, at.Kbar.transpose()).transpose();
    Eigen::Matrix<double, NZ, NZ> whitening =  // S^-T
        states::solve_transposed(S, Eigen::Matrix<double, NZ, NZ>::Identity(n_z_, n_z_));
    for (Eigen::Index j = 0; j < n_z_; ++j) {
      const Eigen::Index own = mover(n_theta_ - n_z_ + j);
      if (own < 0 || std::isnan(at.y[j])) continue;
      const double dR = 2.0 * r[j] * r[j];
      for (Eigen::Index k = 0; k < n_z_; ++k) {
        for (Eigen::Index i = 0; i <= k; ++i) {
          halves(i, k)[own] += dR * whitening(i, j) * whitening(k, j);
        }
      }
    }
    OverMovers<NZ> Mw = OverMovers<NZ>::Zero(m, n_z_);
    Eigen::Index row = n_z_;
    for (Eigen::Index k = 0; k < n_z_; ++k) {
      for (Eigen::Index j = 0; j <= k; ++j, ++row) {
        states::add_times(w[k], halves(j, k), Mw.col(j));
        if (j < k) states::add_times(w[j], halves(j, k), Mw.col(k));
        const double unit = j < k ? 1.0 : 1.0 / std::numbers::sqrt2;
        for (Eigen::Index each = 0; each < m; ++each) {
          rows(row, movers_[each]) = unit * M(each, j + n_z_ * k);
        }
      }
    }

    // dK e = dP H' S^-1 w + P dH' S^-1 w - Kbar M w.
    Gathered moved = Gathered::Zero(m, n);
    const State pulled = states::product(at.whitened_H.transpose(), w);
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index b = 0; b < n; ++b) {
        states::add_times(pulled[b], dP_.col(a + n * b), moved.col(a));
        for (Eigen::Index k = 0; k < n_z_; ++k) {
          if (there(k, b)) states::add_times(P(a, b) * w[k], dH.col(k + n_z_ * b), moved.col(a));
        }
      }
      for (Eigen::Index k = 0; k < n_z_; ++k) {
        states::add_times(-at.Kbar(a, k), Mw.col(k), moved.col(a));
      }
      for (Eigen::Index each = 0; each < m; ++each) dx_(movers_[each], a) += moved(each, a);
    }

    // dP+ = L dP L' - T - T' + K dR K', T = L P dH' K'.
    OfCovariance turned = OfCovariance::Zero(m, n * n);
    if (there.any()) {
      OfCovariance across = OfCovariance::Zero(m, n * n);
      for (Eigen::Index b = 0; b < n; ++b) {
        for (Eigen::Index k = 0; k < n_z_; ++k) {
          if (!there(k, b)) continue;
          for (Eigen::Index c = 0; c < n; ++c) {
            states::add_times(-at.Kbar(c, k), dH.col(k + n_z_ * b), across.col(b + n * c));
          }
        }
      }
      states::add_times_slopes(filter_.covariance(), across, turned);  // L P = P+
    }
    Covariance L = -states::product(K, at.H);
    L.diagonal().array() += 1.0;
    turn(L, turned);
    for (Eigen::Index j = 0; j < n_z_; ++j) {
      const Eigen::Index own = mover(n_theta_ - n_z_ + j);
      if (own < 0 || std::isnan(at.y[j])) continue;
      add_square(own, 2.0 * r[j] * r[j], K.col(j));
    }
  }

  /// dP += factor v v' of one of those that move gains.
  template <class Vector>
  void add_square(Eigen::Index own, double factor, const Vector& v) {
    for (Eigen::Index b = 0; b < n_x(); ++b) {
      for (Eigen::Index a = 0; a < n_x(); ++a) dP_(own, a + n_x() * b) += factor * v[a] * v[b];
    }
  }

  void differentiate_prediction(const SecondOrderStep<NX, NV, N>& step, const Covariance& P,
                                const Parts& variance) {
    const Eigen::Index n = n_x();
    const Eigen::Index m = movers_.size();
    const Gathered dx = gather();
    const Covariance Phi_P = states::product(step.Phi, P);
    OfCovariance turned = OfCovariance::Zero(m, n * n);
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, NT, 1> change(m);
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index c = 0; c < n; ++c) {
        if (!follow(step.Phi_slopes, a + n * c, dx, change)) continue;
        for (Eigen::Index d = 0; d < n; ++d) {
          states::add_times(Phi_P(d, c), change, turned.col(a + n * d));
        }
      }
      for (Eigen::Index k = 0; k < variance.size(); ++k) {
        if (variance[k] == 0.0 || !follow(step.Gamma_slopes, a + n * k, dx, change)) continue;
        for (Eigen::Index d = 0; d < n; ++d) {
          states::add_times(variance[k] * step.Gamma(d, k), change, turned.col(a + n * d));
        }
      }
    }
    turn(step.Phi, turned);
    for (Eigen::Index k = 0; k < variance.size(); ++k) {
      const Eigen::Index own = mover(n_ + n + k % n_w_);
      if (own >= 0) add_square(own, 2.0 * variance[k], step.Gamma.col(k));
    }
  }

  void fill_residuals(const Sample& at, Rows& rows) const {
    const Outputs& w = at.innovation.w;
    rows.col(n_theta_).head(n_z_) = w;
    Eigen::Index row = n_z_;
    for (Eigen::Index k = 0; k < n_z_; ++k) {
      const bool missing = std::isnan(at.y[k]);
      for (Eigen::Index j = 0; j < k; ++j) {
        rows(row++, n_theta_) = missing || std::isnan(at.y[j]) ? 0.0 : w[j] * w[k];
      }
      rows(row++, n_theta_) = missing ? 0.0 : (w[k] * w[k] - 1.0) / std::numbers::sqrt2;
    }
  }

  Filter<NX> filter_;
  Eigen::Index n_;
  Eigen::Index n_w_;
  Eigen::Index n_z_;
  Eigen::Index n_theta_;
  Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1, Eigen::ColMajor, NT, 1> movers_;
  SlopesOfState dx_;  // dx/dtheta, n_theta x n_x
  OfCovariance dP_;
};

}  // namespace sepcal
