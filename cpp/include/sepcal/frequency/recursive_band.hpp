// SPDX-License-Identifier: BSD-3-Clause
// Equation error over a band, row by row: the recursive Fourier transform (E. A. Morelli, Real-time
// parameter estimation in the frequency domain, J. Guid. Control Dyn. 23, 2000). z = A xi holds for
// the transforms of its columns as it does row by row; these grow by a term a row, and what is
// forgotten fades in them. Bounded memory, no heap. fit_in_band() is the batch's.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "sepcal/detail/states/product.hpp"
#include "sepcal/detail/states/triangle.hpp"

namespace sepcal {

struct RecursiveBandOptions {
  /// What a row counts for after the next, above 0, at most 1: a memory of 1 / (1 - forgetting)
  /// rows.
  double forgetting = 1.0;
  /// Rows hold z of z' = A xi: its transform is multiplied by j w, and no row is differentiated.
  bool differentiate = false;
};

/// An output's rows over the band.
template <int K, class Scalar = double>
struct BandFactor {
  static constexpr int size = states::together(K, 1);

  /// [R q; 0 s]: what is minimised is |R xi - q|^2 + s^2, of parts as noisy as white rows are.
  Eigen::Matrix<Scalar, size, size> T = states::zeros<Eigen::Matrix<Scalar, size, size>>();
  Scalar parts = 0;  // independent real numbers in it, but for those that are spent on its ends
};

template <int K, class Scalar = double>
struct BandEstimate {
  using Vector = Eigen::Vector<Scalar, K>;

  Vector xi = states::zeros<Vector>();  // 0 for what isn't told
  /// Where the residual's spectrum is level over the band. NaN: xi isn't told yet, or by nothing.
  Vector deviation = states::zeros<Vector>();
  Scalar noise = std::numeric_limits<Scalar>::quiet_NaN();  // of rows, as if it were white
};

/// The least squares of a factor.
template <int K, class Scalar>
BandEstimate<K, Scalar> solve_band(const BandFactor<K, Scalar>& factor) {
  using Square = Eigen::Matrix<Scalar, K, K>;
  const Eigen::Index k = factor.T.cols() - 1;
  const Square R = factor.T.topLeftCorner(k, k);
  Scalar left = factor.parts;
  for (Eigen::Index j = 0; j < k; ++j) left -= states::is_nil(R, j) ? Scalar(0) : Scalar(1);
  BandEstimate<K, Scalar> found;
  found.xi = states::solve_upper(R, Eigen::Vector<Scalar, K>(factor.T.col(k).head(k)));
  if (left >= Scalar(1)) found.noise = std::abs(factor.T(k, k)) / std::sqrt(left);
  found.deviation =
      found.noise * states::solve_upper(R, Square(Square::Identity(k, k))).rowwise().norm();
  for (Eigen::Index j = 0; j < k; ++j) {
    if (states::is_nil(R, j)) found.deviation[j] = std::numeric_limits<Scalar>::quiet_NaN();
  }
  return found;
}

/// Of K regressors at F frequencies. A regressor that doesn't vary is a constant: the means of the
/// rows tell it, and the band nothing.
template <int K, int F, class Scalar = double>
class RecursiveBand {
 public:
  using Regressors = Eigen::Vector<Scalar, K>;

  /// Frequencies [Hz], at least two, rising and evenly spaced.
  explicit RecursiveBand(const Eigen::Vector<Scalar, F>& frequencies,
                         const RecursiveBandOptions& options = {}, Eigen::Index k = K)
      : options_(options),
        fade_(static_cast<Scalar>(std::sqrt(options.forgetting))),
        omega_(Scalar(2) * std::numbers::pi_v<Scalar> * frequencies),
        spacing_(frequencies[1] - frequencies[0]),
        X_(Spectra::Zero(frequencies.size(), k + 3)),
        first_(Row::Zero(k + 1)),
        last_(Row::Zero(k + 1)),
        sums_(Row::Zero(k + 1)),
        varies_(Row::Zero(k + 1)) {}

  /// A row at a time [s]. False, and nothing changed, where a number is not finite or time doesn't
  /// rise.
  bool absorb(Scalar time, const Regressors& regressors, Scalar z) {
    const Eigen::Index k = regressors.size();
    Row row(k + 1);
    row << regressors, z;
    if (!row.allFinite() || !std::isfinite(time)) return false;
    if (rows_ == 0) {
      first_ = row;
      begin_ = time;
    } else if (time <= begin_ + since_) {
      return false;
    }
    absorb_mean(row, time - begin_ - since_);
    since_ = time - begin_;
    Columns columns(k + 3);  // without the first row, whose size would leave its rounding
    columns << row - first_, Scalar(1), since_;
    varies_ = varies_.cwiseMax((row - first_).cwiseAbs());
    for (Eigen::Index i = 0; i < omega_.size(); ++i) {
      X_.row(i) =
          fade_ * X_.row(i) + std::polar(Scalar(1), -omega_[i] * since_) * columns.transpose();
    }
    last_ = row;
    const Scalar squared = fade_ * fade_;
    squares_ = squared * squares_ + Scalar(1);
    fourths_ = squared * squared * fourths_ + Scalar(1);
    first_weight_ = rows_ == 0 ? Scalar(1) : fade_ * first_weight_;
    ++rows_;
    return true;
  }

  /// All rows so far.
  BandFactor<K, Scalar> factor() const {
    const Eigen::Index k = first_.size() - 1;
    BandFactor<K, Scalar> factor;
    factor.T.setZero(k + 1, k + 1);
    if (rows_ < 3) return factor;
    const Scalar step = since_ / static_cast<Scalar>(rows_ - 1);
    const Scalar seconds = squares_ * squares_ / fourths_ * step;  // of as many rows of one weight
    const Scalar shared = std::max(Scalar(1), Scalar(1) / (spacing_ * seconds));
    Parts rows = parts(std::sqrt(Scalar(2) / (squares_ * shared)), step);
    const bool has_constant = (varies_.head(k).array() == Scalar(0)).any();
    const Scalar spent = options_.differentiate ? Scalar(4) : Scalar(2);
    factor.parts =
        Scalar(2 * omega_.size()) / shared - spent + (has_constant ? Scalar(1) : Scalar(0));

    // Where frequencies are multiples of one over the rows' length, nothing is left of the
    // constant.
    if (X_.col(k + 1).norm() <= Scalar(1e4) * states::rounding<Scalar> * squares_)
      rows.col(0).setZero();
    if (has_constant) rows.bottomRightCorner(1, k + 1) = sums_.transpose() / std::sqrt(squares_);
    constexpr int size = states::together(K, 1 + ends);
    Eigen::Matrix<Scalar, size, size> T =
        Eigen::Matrix<Scalar, size, size>::Zero(k + 1 + ends, k + 1 + ends);
    states::absorb_rows(T, rows, Scalar(1e3) * states::rounding<Scalar>);
    factor.T = T.bottomRightCorner(k + 1, k + 1);
    return factor;
  }

  BandEstimate<K, Scalar> estimate() const { return solve_band(factor()); }

 private:
  static constexpr int ends = 4;
  using Complex = std::complex<Scalar>;
  using Row = Eigen::Vector<Scalar, states::together(K, 1)>;
  using Columns = Eigen::Vector<Scalar, states::together(K, 3)>;
  using Spectra = Eigen::Matrix<Complex, F, states::together(K, 3)>;
  using Parts = Eigen::Matrix<Scalar, F == Eigen::Dynamic ? Eigen::Dynamic : 2 * F + 1,
                              states::together(K, 1 + ends)>;

  /// Of rows, or of what is between two of them where z is differentiated.
  void absorb_mean(const Row& row, Scalar seconds) {
    const Eigen::Index k = row.size() - 1;
    sums_ *= fade_;
    if (!options_.differentiate) {
      sums_ += row;
    } else if (rows_ > 0) {
      sums_.head(k) += Scalar(0.5) * (row + last_).head(k);
      sums_[k] += (row[k] - last_[k]) / seconds;
    }
  }

  /// Real and imaginary parts of [1 t, e^-jwT, first weight | A | z], and a row for the means.
  /// Behind j w what z is at the ends is left: two real numbers.
  Parts parts(Scalar scale, Scalar step) const {
    const Eigen::Index k = first_.size() - 1;
    const Eigen::Index f = omega_.size();
    const Scalar decay = -std::log(fade_) / step;
    Parts parts = Parts::Zero(2 * f + 1, k + 1 + ends);
    for (Eigen::Index i = 0; i < f; ++i) {
      Eigen::Matrix<Complex, 1, states::together(K, 1 + ends)> row(k + 1 + ends);
      row << X_(i, k + 1), X_(i, k + 2), Complex(0), Complex(0), X_.row(i).head(k + 1);
      if (options_.differentiate) {
        row[2] = std::polar(Scalar(1), -omega_[i] * since_) / step;
        row[3] = first_weight_ / step;
        row[k + ends] *= Complex(-decay, omega_[i]);
      }
      parts.row(i) = scale * row.real();
      parts.row(f + i) = scale * row.imag();
    }
    return parts;
  }

  RecursiveBandOptions options_;
  Scalar fade_;  // of transforms, a row: the root of `forgetting`, which is of squares
  Eigen::Vector<Scalar, F> omega_;  // rad/s
  Scalar spacing_;                  // Hz
  Spectra X_;                       // of [A z 1 t], times since the first row
  Row first_;
  Row last_;
  Row sums_;            // of [A z], for their means
  Row varies_;          // how far each went from the first
  Scalar begin_ = 0;    // s
  Scalar since_ = 0;    // s, of the last row since the first
  Scalar squares_ = 0;  // of the rows' weights, summed
  Scalar fourths_ = 0;  // of their fourth powers
  Scalar first_weight_ = 0;
  int rows_ = 0;
};

}  // namespace sepcal
