// SPDX-License-Identifier: BSD-3-Clause
// When did the model cease to hold, and which parameter moved? The generalised likelihood ratio of
// a filter's innovations (A. S. Willsky & H. L. Jones, A generalized likelihood ratio approach to
// the detection and estimation of jumps in linear systems, IEEE Trans. Automatic Control 21, 1976),
// for jumps of the parameters that a joint filter estimates. Bounded memory, no heap.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sepcal/detail/states/product.hpp"
#include "sepcal/detail/states/triangle.hpp"
#include "sepcal/states/filter.hpp"

namespace sepcal {

/// Times are in rows. The window is Onsets * rows_between.
struct ChangeTestOptions {
  int rows_between = 25;  // from an onset that is tried to the next
  int confirm = 100;    // from an alarm to its verdict: an outlier's evidence fades, a jump's grows
  int patience = 175;   // the same where several parameters jump, or another explains it as well
  double alarm = 30.0;  // (score / its deviation)^2 of one parameter at one onset
  double join = 12.0;   // what a further parameter has to explain of the same
  double share = 0.05;  // and at least so much of what the others do: a linearisation errs as well
  double clip = 4.0;    // deviations of a whitened innovation that count for an alarm, at most
  double nonlinear = 0.25;  // of a jump's size: what its linearisation may be off
};

enum class ChangeStatus {
  holds,      // nothing speaks against the parameters
  suspected,  // an alarm that is not confirmed yet
  changed     // confirmed: jump() has it
};

/// A jump of some of s's last K entries.
template <int N, int K, class Scalar = double>
struct Jump {
  using Parameters = Eigen::Vector<Scalar, K>;

  int rows = 0;          // since the onset that explains most
  Scalar statistic = 0;  // what the jump explains: chi squared of `count` degrees without one
  int count = 0;         // parameters that jumped
  Parameters size = states::zeros<Parameters>();       // 0: did not
  Parameters deviation = states::zeros<Parameters>();  // of size
  /// 1 in row j, column k where a jump of k in place of j explains the innovations nearly as well.
  Eigen::Matrix<Scalar, K, K> rivals = states::zeros<Eigen::Matrix<Scalar, K, K>>();
  Eigen::Vector<Scalar, N> moved = states::zeros<Eigen::Vector<Scalar, N>>();  // s, by `size`
  /// For a filter that can go back to the onset: by what the parameters move there, rivals among
  /// them, and how far each may be off that, 0 where it didn't jump.
  Parameters opened = states::zeros<Parameters>();
  Parameters reach = states::zeros<Parameters>();
  /// What a filter that follows takes, with the rivals open too: s moves by shift, and its
  /// covariance grows by spread'spread.
  Eigen::Vector<Scalar, N> shift = states::zeros<Eigen::Vector<Scalar, N>>();
  Eigen::Matrix<Scalar, K, N> spread = states::zeros<Eigen::Matrix<Scalar, K, N>>();

  bool is_ambiguous() const { return !rivals.isZero(0); }
};

/// N: entries of s, of which the last K are the parameters that may jump. A filter's predictions
/// and updates are told row by row; every `rows_between` rows begins a hypothesis "from here on".
///
/// A jump d at an onset moves the mean of s - s_hat by E d: E = [0; I] there, Phi E in a
/// prediction, (I - K H) E in an update, and the mean of the whitened innovation by G d,
/// G = S^-T H E. Score G'w and information G'G gather; the square of a parameter's score by its
/// information is chi squared of one degree where nothing changed and the noise is the model's.
/// Where it isn't, as in gusts, every such square is divided by what they have been in windows of
/// the flight before, of the parameter where they were largest.
template <int N, int K, class Scalar = double, int Onsets = 20>
class ChangeTest {
 public:
  using State = Eigen::Vector<Scalar, N>;
  using Matrix = Eigen::Matrix<Scalar, N, N>;
  using Parameters = Eigen::Vector<Scalar, K>;
  using Information = Eigen::Matrix<Scalar, K, K>;

  explicit ChangeTest(const ChangeTestOptions& options = {}, Eigen::Index n = N, Eigen::Index k = K)
      : options_(options), n_(n), k_(k), sum_(Parameters::Zero(k)) {}

  /// Beside Filter::predict() by this Phi (N x N).
  void predict(const Matrix& Phi) {
    for (int i = 0; i < count_; ++i) at(i).E = states::product(Phi, at(i).E);
  }

  /// The states begin anew, independent of the past, as in JointFilter::restart().
  void restart() {
    for (int i = 0; i < count_; ++i) at(i).E.topRows(n_ - k_).setZero();
  }

  /// Beside Filter::update(): its P before the update, the outputs' derivative H (n_z x N), y (NaN
  /// where missing), the innovation that it gave. What was refused there counts for nothing.
  template <int NZ>
  ChangeStatus update(const Matrix& P, const Eigen::Matrix<Scalar, NZ, N>& H,
                      const Eigen::Vector<Scalar, NZ>& y,
                      const Innovation<NZ, Scalar>& innovation) {
    if (innovation.status != FilterStatus::refused) absorb(P, H, y, innovation);
    ++rows_;
    if (rows_ % options_.rows_between == 0) begin();
    if (alarm_ < 0) {
      if (rows_ >= quiet_until_ && strongest(rows_) > static_cast<Scalar>(options_.alarm))
        alarm_ = rows_;
    } else if (rows_ - alarm_ >= options_.confirm) {
      if (strongest(alarm_) <= static_cast<Scalar>(options_.alarm)) {
        alarm_ = -1;
      } else if (is_told()) {
        return ChangeStatus::changed;
      }
    }
    return alarm_ < 0 ? ChangeStatus::holds : ChangeStatus::suspected;
  }

  /// Where `changed`: the onset, of those before the alarm, and the fewest parameters that explain
  /// the innovations: those that add `join` each, the best first, and without those that the later
  /// ones make idle.
  Jump<N, K, Scalar> jump() const {
    const Onset* best = nullptr;
    Parameters jumped = Parameters::Zero(k_);
    Scalar most = 0;
    for (int i = 0; i < count_ && at(i).row <= alarm_; ++i) {
      const Parameters chosen = choose(at(i));
      const Scalar worth =
          explained(at(i), chosen) - static_cast<Scalar>(options_.join) * chosen.sum();
      if (best != nullptr && worth <= most) continue;
      most = worth;
      best = &at(i);
      jumped = chosen;
    }
    return best == nullptr ? Jump<N, K, Scalar>{} : jump_of(*best, jumped);
  }

  /// Behind a jump that was followed: its evidence is used. Parameters seldom jump: after a second
  /// one within a window what follows is taken for the noise's, a window long.
  void forget() {
    const int window = Onsets * options_.rows_between;
    if (rows_ < seldom_until_) quiet_until_ = rows_ + window;
    seldom_until_ = rows_ + window;
    count_ = 0;
    alarm_ = -1;
  }

  /// How much more than white noise of the assumed size the scores scatter, at least 1.
  Scalar inflation() const {
    return std::max(Scalar(1), (sum_.maxCoeff() + beforehand) / (windows_ + beforehand));
  }

 private:
  struct Onset {
    int row = 0;
    Eigen::Matrix<Scalar, N, K> E = states::zeros<Eigen::Matrix<Scalar, N, K>>();
    Parameters score = states::zeros<Parameters>();
    Parameters clipped = states::zeros<Parameters>();  // the same without what outliers add
    Information information = states::zeros<Information>();
  };

  static constexpr Scalar beforehand = 4;  // windows of white noise that are taken as seen

  Onset& at(int i) { return ring_[static_cast<std::size_t>((first_ + i) % Onsets)]; }
  const Onset& at(int i) const { return ring_[static_cast<std::size_t>((first_ + i) % Onsets)]; }

  /// The oldest makes room, unless it is what an alarm is about.
  void begin() {
    if (count_ == Onsets) {
      if (alarm_ < 0) {
        const Onset& old = at(0);
        for (Eigen::Index j = 0; j < k_; ++j) sum_[j] += square(old, j) / Scalar(Onsets);
        windows_ += Scalar(1) / Scalar(Onsets);
      }
      first_ = (first_ + 1) % Onsets;
      --count_;
    }
    Onset& onset = at(count_++);
    onset.row = rows_;
    onset.E.setZero(n_, k_);
    onset.E.bottomRows(k_).setIdentity();
    onset.score.setZero(k_);
    onset.clipped.setZero(k_);
    onset.information.setZero(k_, k_);
  }

  template <int NZ>
  void absorb(const Matrix& P, const Eigen::Matrix<Scalar, NZ, N>& H,
              const Eigen::Vector<Scalar, NZ>& y, const Innovation<NZ, Scalar>& innovation) {
    Eigen::Matrix<Scalar, NZ, N> seen = H;
    for (Eigen::Index j = 0; j < y.size(); ++j) {
      if (std::isnan(y[j])) seen.row(j).setZero();
    }
    const Eigen::Matrix<Scalar, NZ, N> whitened = states::solve_transposed(innovation.S, seen);
    const Eigen::Matrix<Scalar, N, NZ> gain = states::product(P, whitened.transpose());
    const auto most = static_cast<Scalar>(options_.clip);
    const Eigen::Vector<Scalar, NZ> clipped = innovation.w.cwiseMax(-most).cwiseMin(most);
    for (int i = 0; i < count_; ++i) {
      Onset& onset = at(i);
      const Eigen::Matrix<Scalar, NZ, K> G = states::product(whitened, onset.E);
      onset.E -= states::product(gain, G);
      onset.score += states::product(G.transpose(), innovation.w);
      onset.clipped += states::product(G.transpose(), clipped);
      onset.information += states::product(G.transpose(), G);
    }
  }

  static Scalar square(const Onset& onset, Eigen::Index j) {
    const Scalar information = onset.information(j, j);
    return information > 0 ? onset.clipped[j] * onset.clipped[j] / information : Scalar(0);
  }

  /// Of onsets until this row.
  Scalar strongest(int until) const {
    Scalar most = 0;
    for (int i = 0; i < count_ && at(i).row <= until; ++i) {
      for (Eigen::Index j = 0; j < k_; ++j) most = std::max(most, square(at(i), j));
    }
    return most / inflation();
  }

  /// Whether no other parameter explains the change as well, or there is no more time to see;
  /// looked at five times from an onset to the next.
  bool is_told() const {
    const int since = rows_ - alarm_;
    if (since >= options_.patience) return true;
    if (since % std::max(1, options_.rows_between / 5) != 0) return false;
    const Jump<N, K, Scalar> now = jump();
    return now.count == 1 && !now.is_ambiguous();
  }

  /// Score and information of those that are chosen; of the others the identity, which tells
  /// nothing. `prior`: information that is there before.
  struct Told {
    Parameters score;
    Information root;

    Told(const Onset& onset, const Parameters& chosen, const Parameters& prior)
        : score(onset.score.cwiseProduct(chosen)) {
      Information information = onset.information;
      information.diagonal() += prior;
      for (Eigen::Index j = 0; j < chosen.size(); ++j) {
        if (chosen[j] != Scalar(0)) continue;
        information.row(j).setZero();
        information.col(j).setZero();
        information(j, j) = 1;
      }
      root = states::upper_root(information);
    }

    Parameters size() const {
      return states::solve_upper(root, states::solve_transposed(root, score));
    }

    /// U'U the covariance of those chosen, `by` times, and what their linearisation may be off.
    Information covariance_root(const Parameters& chosen, Scalar by, const Parameters& off) const {
      const Eigen::Index k = chosen.size();
      Information rows = states::solve_transposed(root, Information(Information::Identity(k, k))) *
                         (std::sqrt(by) * chosen).asDiagonal();
      Information U = off.asDiagonal();
      states::absorb_rows(U, rows);
      return U;
    }
  };

  Parameters none() const { return Parameters::Zero(k_); }

  Scalar explained(const Onset& onset, const Parameters& chosen) const {
    const Told told(onset, chosen, none());
    if (!states::is_regular(told.root)) return 0;
    return states::solve_transposed(told.root, told.score).squaredNorm() / inflation();
  }

  /// What makes a parameter a part of the change, beside others that explain so much.
  Scalar worth_having(Scalar explained) const {
    return static_cast<Scalar>(
        std::max(options_.join, options_.share * static_cast<double>(explained)));
  }

  /// 1 of those that jumped, 0 of the others.
  Parameters choose(const Onset& onset) const {
    Parameters chosen = Parameters::Zero(k_);
    Scalar reached = 0;
    for (Eigen::Index step = 0; step < k_; ++step) {
      Eigen::Index best = -1;
      Scalar most = reached + worth_having(reached);
      for (Eigen::Index j = 0; j < k_; ++j) {
        if (chosen[j] != Scalar(0)) continue;
        chosen[j] = 1;
        const Scalar with = explained(onset, chosen);
        chosen[j] = 0;
        if (with <= most) continue;
        most = with;
        best = j;
      }
      if (best < 0) break;
      chosen[best] = 1;
      reached = most;
      for (Eigen::Index j = 0; j < k_; ++j) {
        if (chosen[j] == Scalar(0) || j == best) continue;
        chosen[j] = 0;
        const Scalar without = explained(onset, chosen);
        if (reached - without < worth_having(without)) {
          reached = without;
        } else {
          chosen[j] = 1;
        }
      }
    }
    return chosen;
  }

  Jump<N, K, Scalar> jump_of(const Onset& onset, const Parameters& chosen) const {
    const Scalar by = inflation();
    const auto nonlinear = static_cast<Scalar>(options_.nonlinear);
    const Told told(onset, chosen, none());
    Jump<N, K, Scalar> jump;
    jump.rows = rows_ - onset.row;
    jump.statistic = explained(onset, chosen);
    jump.count = static_cast<int>(chosen.sum());
    jump.size = told.size();
    jump.moved = states::product(onset.E, jump.size);
    Information U = told.covariance_root(chosen, by, nonlinear * jump.size);
    jump.deviation = U.colwise().norm();
    jump.shift = jump.moved;
    jump.opened = jump.size;
    jump.reach = jump.size.cwiseAbs();
    jump.rivals.setZero(k_, k_);
    for (Eigen::Index j = 0; j < k_; ++j) {
      for (Eigen::Index k = 0; k < k_; ++k) {
        if (chosen[j] == Scalar(0) || chosen[k] != Scalar(0)) continue;
        Parameters other = chosen;
        other[j] = 0;
        other[k] = 1;
        if (jump.statistic - explained(onset, other) >= static_cast<Scalar>(options_.join))
          continue;
        jump.rivals(j, k) = 1;
        const Scalar alone = std::abs(Told(onset, other, none()).size()[k]);
        jump.reach[k] = std::max(jump.reach[k], alone);
      }
    }
    if (jump.is_ambiguous()) {  // all that may have jumped, each by no more than would do alone
      const Parameters open = (jump.reach.array() > Scalar(0)).template cast<Scalar>();
      Parameters prior = none();
      for (Eigen::Index k = 0; k < k_; ++k) {
        if (open[k] != Scalar(0)) prior[k] = by / (jump.reach[k] * jump.reach[k]);
      }
      const Told together(onset, open, prior);
      jump.opened = together.size();
      jump.shift = states::product(onset.E, jump.opened);
      U = together.covariance_root(open, by, nonlinear * jump.opened);
    }
    jump.spread = states::product(U, onset.E.transpose());
    return jump;
  }

  ChangeTestOptions options_;
  Eigen::Index n_;
  Eigen::Index k_;
  std::array<Onset, Onsets> ring_ = {};
  int first_ = 0;
  int count_ = 0;
  int rows_ = 0;
  int alarm_ = -1;        // the row of the alarm; -1: none
  int seldom_until_ = 0;  // another jump until then is the second within a window
  int quiet_until_ = 0;   // no alarm until then
  Parameters sum_;        // of squares at the ends of windows, in windows
  Scalar windows_ = 0;
};

/// Lets a jump into a filter: s moves by it, and its covariance opens by what is not known of it,
/// as by a step of time that brings so much noise: in every form, also where P has no digits left.
template <int N, class Form, int K>
FilterStatus follow(Filter<N, Form>& filter,
                    const Jump<N, K, typename Form::Matrix::Scalar>& jump) {
  using Scalar = Form::Matrix::Scalar;
  const Eigen::Index n = filter.x().size();
  const Eigen::Index k = jump.spread.rows();
  return filter.predict(Transition<N, K, Scalar>{
      filter.x() + jump.shift, Form::Matrix::Identity(n, n), jump.spread.transpose(),
      Eigen::Matrix<Scalar, K, K>::Identity(k, k)});
}

}  // namespace sepcal
