// SPDX-License-Identifier: BSD-3-Clause
#include "certificate/box_bound.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "numerics/bounded_least_squares.hpp"

namespace sepcal::certificate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns in ranges, in plain numbers about the middle, and what each may be multiplied by.
struct Columns {
  std::vector<Ranges> ranges = {};
  Ranges factors = {};  // zero among them

  void add(Ranges column, const Enclosure& factor) {
    ranges.push_back(std::move(column));
    factors.push_back(factor);
  }

  MatrixXd plain(Index rows) const {
    MatrixXd K(rows, static_cast<Index>(ranges.size()));
    for (Index c = 0; c < K.cols(); ++c) {
      for (Index i = 0; i < rows; ++i) {
        K(i, c) = ranges[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)].middle();
      }
    }
    return K;
  }
};

Enclosure dot(const Ranges& x, const VectorXd& y) {
  Enclosure sum(0.0);
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[static_cast<Index>(i)];
  return sum;
}

/// |y - K v| minimised with v within its limits, about: what is left.
VectorXd leftover(const Columns& columns, const Ranges& ranges) {
  VectorXd y(static_cast<Index>(ranges.size()));
  for (Index i = 0; i < y.size(); ++i) y[i] = ranges[static_cast<std::size_t>(i)].middle();
  const MatrixXd K = columns.plain(y.size());
  if (K.size() == 0) return y;
  const Eigen::HouseholderQR<MatrixXd> qr(K);
  const Index p = std::min(K.rows(), K.cols());
  const MatrixXd R = qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
  const VectorXd q = (qr.householderQ().adjoint() * y).head(p);
  numerics::Box box{VectorXd(K.cols()), VectorXd(K.cols())};
  for (Index c = 0; c < K.cols(); ++c) {
    const Enclosure& factor = columns.factors[static_cast<std::size_t>(c)];
    box.lower[c] = factor.lower();
    box.upper[c] = factor.upper();
  }
  return y - K * numerics::solve_bounded(R, q, box).x;
}

/// Half of |y - K v|^2 is at least this for all v within the limits, whatever rho is.
double dual_bound(const Columns& columns, const Ranges& y, const VectorXd& rho) {
  Enclosure bound = dot(y, rho);
  Enclosure square_of_rho(0.0);
  for (const double value : rho) square_of_rho += square(Enclosure(value));
  bound = bound - square_of_rho * 0.5;
  for (std::size_t c = 0; c < columns.ranges.size(); ++c) {
    bound = bound - Enclosure((dot(columns.ranges[c], rho) * columns.factors[c]).upper());
  }
  return bound.lower();
}

/// About the pseudo-inverse of A (n_1 x rows).
MatrixXd pseudo_inverse_of(const MatrixXd& A) {
  if (A.size() == 0) return MatrixXd::Zero(A.cols(), A.rows());
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(A).pseudoInverse();
}

/// Rows whose every part is finite over the box: the cost is at least that of these.
std::vector<Index> finite_rows(const EnclosedProblem& problem, const EnclosedRows& over) {
  std::vector<Index> kept;
  const auto parts = static_cast<std::size_t>(over.columns) *
                     static_cast<std::size_t>(EnclosedRows::parts_of(over.n_2));
  for (Index i = 0; i < problem.rows(); ++i) {
    const std::span<const Enclosure> row(over.at(i, 0), parts);
    if (std::ranges::all_of(row, &Enclosure::is_finite)) kept.push_back(i);
  }
  return kept;
}

/// xi1 about the middle of a box: what is held is known, the rest is found.
class Linear {
 public:
  Linear(const EnclosedProblem& problem, const EnclosedRows& at, const std::vector<Index>& kept,
         const Ranges& limits)
      : problem_(problem), kept_(kept), xi1_(VectorXd::Zero(problem.n_1())) {
    for (Index l = 0; l < problem.n_1(); ++l) {
      const Enclosure& limit = limits[static_cast<std::size_t>(l)];
      if (limit.lower() < limit.upper()) {
        free_.push_back(l);
      } else {
        xi1_[l] = limit.lower();
      }
    }
    const auto rows = static_cast<Index>(kept.size());
    MatrixXd A(rows, static_cast<Index>(free_.size()));
    VectorXd y(rows);
    for (Index r = 0; r < rows; ++r) {
      const Index i = kept[static_cast<std::size_t>(r)];
      for (Index f = 0; f < A.cols(); ++f) {
        A(r, f) = problem.weight(i) * at.at(i, free_[static_cast<std::size_t>(f)])->middle();
      }
      y[r] = problem.weight(i) * without_held(at, i).middle();
    }
    P_ = pseudo_inverse_of(A);
    solve_within(A, y, limits);
  }

  /// Least squares in the middle, within the limits: a guess.
  const VectorXd& xi1() const { return xi1_; }

  /// How far xi1 is from that at most, for any xi2 of the box with J at most `most` (n_1). Infinite
  /// where that can't be proven. With P about the pseudo-inverse of A, all weighted,
  ///   xi1 = P (z - b) - P r + (I - P A) xi1,   |r| <= sqrt(2 J)
  VectorXd reach(const EnclosedRows& over, double most) const;

 private:
  /// The free part of xi1, the least within the limits.
  void solve_within(const MatrixXd& A, const VectorXd& y, const Ranges& limits) {
    const Index n = A.cols();
    numerics::Box box{VectorXd(n), VectorXd(n)};
    for (Index f = 0; f < n; ++f) {
      const auto l = static_cast<std::size_t>(free_[static_cast<std::size_t>(f)]);
      box.lower[f] = limits[l].lower();
      box.upper[f] = limits[l].upper();
    }
    const VectorXd unbounded = P_ * y;
    VectorXd x = box.clip(unbounded);
    if (x != unbounded) {
      x += numerics::solve_bounded(A, y - A * x, {box.lower - x, box.upper - x}).x;
      x = box.clip(x);
    }
    for (Index f = 0; f < n; ++f) xi1_[free_[static_cast<std::size_t>(f)]] = x[f];
  }

  /// z - b - A xi1 of what is held.
  Enclosure without_held(const EnclosedRows& rows, Index i) const {
    Enclosure left = Enclosure(problem_.z(i)) - *rows.at(i, problem_.n_1());
    for (Index l = 0; l < problem_.n_1(); ++l) {
      if (std::ranges::find(free_, l) == free_.end()) left = left - *rows.at(i, l) * xi1_[l];
    }
    return left;
  }

  const EnclosedProblem& problem_;
  const std::vector<Index>& kept_;
  VectorXd xi1_;
  std::vector<Index> free_ = {};
  MatrixXd P_ = {};
};

VectorXd Linear::reach(const EnclosedRows& over, double most) const {
  const auto n = static_cast<Index>(free_.size());
  VectorXd reach = VectorXd::Zero(xi1_.size());
  for (const Index l : free_) reach[l] = infinity;
  const Enclosure radius = sqrt(Enclosure(most) * 2.0);
  MatrixXd unexplained(n, n);  // |I - P A|
  VectorXd fixed(n);
  double contraction = 0.0;
  for (Index f = 0; f < n; ++f) {
    const double middle = xi1_[free_[static_cast<std::size_t>(f)]];
    Ranges row(static_cast<std::size_t>(n), Enclosure(0.0));
    Enclosure shift(-middle);
    Enclosure length(0.0);
    for (Index r = 0; r < P_.cols(); ++r) {
      const Index i = kept_[static_cast<std::size_t>(r)];
      const Enclosure weighted = Enclosure(P_(f, r)) * problem_.weight(i);
      for (std::size_t k = 0; k < row.size(); ++k) row[k] += weighted * *over.at(i, free_[k]);
      shift += weighted * without_held(over, i);
      length += square(Enclosure(P_(f, r)));
    }
    Enclosure known = Enclosure(shift.magnitude()) + sqrt(length) * radius;
    Enclosure sum(0.0);
    for (Index k = 0; k < n; ++k) {
      const auto at = static_cast<std::size_t>(k);
      unexplained(f, k) = (Enclosure(f == k ? 1.0 : 0.0) - row[at]).magnitude();
      sum += Enclosure(unexplained(f, k));
      known += Enclosure(unexplained(f, k)) * std::abs(xi1_[free_[at]]);
    }
    contraction = std::max(contraction, sum.upper());
    fixed[f] = known.upper();
  }
  if (n == 0 || !(contraction < 1.0) || !fixed.allFinite()) return reach;
  VectorXd proven = VectorXd::Constant(
      n, (Enclosure(fixed.maxCoeff()) / (Enclosure(1.0) - Enclosure(contraction))).upper());
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    VectorXd less(n);
    for (Index f = 0; f < n; ++f) {
      Enclosure sum(fixed[f]);
      for (Index k = 0; k < n; ++k) sum += Enclosure(unexplained(f, k)) * proven[k];
      less[f] = std::min(proven[f], sum.upper());
    }
    proven = less;
  }
  for (Index f = 0; f < n; ++f) reach[free_[static_cast<std::size_t>(f)]] = proven[f];
  return reach;
}

/// What is bounded: z - A xi1 - b = y - A dx - S w - T (w dx) - remainder, weighted, with
/// dx = xi1 - its guess and w = xi2 - the middle of the box.
struct Relaxation {
  Ranges y = {};
  Columns columns = {};
  double remainder = 0.0;  // its norm, at most
};

class Relaxer {
 public:
  Relaxer(const EnclosedProblem& problem, const EnclosedRows& at, const EnclosedRows& over,
          const std::vector<Index>& kept)
      : problem_(problem), at_(at), over_(over), kept_(kept) {}

  /// `steps` (n_1): what dx may be.
  Relaxation relax(const VectorXd& half, const Ranges& steps, BoxBound& result) const {
    Relaxation relaxed;
    const Index n_1 = problem_.n_1();
    for (Index l = 0; l < n_1; ++l) {
      relaxed.columns.add(weighted([&](Index i) { return *at_.at(i, l); }),
                          steps[static_cast<std::size_t>(l)]);
    }
    for (Index j = 0; j < problem_.n_2(); ++j) {
      if (half[j] == 0.0) continue;
      const Index slope = 1 + j;
      Ranges slopes = weighted([&](Index i) {
        Enclosure sum = at_.at(i, n_1)[slope];
        for (Index l = 0; l < n_1; ++l) sum += at_.at(i, l)[slope] * result.xi1[l];
        return sum;
      });
      double length = 0.0;
      for (const Enclosure& one : slopes) length = std::hypot(length, one.middle());
      result.swing[j] = half[j] * length;
      const Enclosure w(-half[j], half[j]);
      relaxed.columns.add(std::move(slopes), w);
      for (Index l = 0; l < n_1; ++l) {
        relaxed.columns.add(weighted([&](Index i) { return at_.at(i, l)[slope]; }),
                            w * steps[static_cast<std::size_t>(l)]);
      }
    }
    relaxed.y = weighted([&](Index i) {
      Enclosure left = Enclosure(problem_.z(i)) - *at_.at(i, n_1);
      for (Index l = 0; l < n_1; ++l) left = left - *at_.at(i, l) * result.xi1[l];
      return left;
    });
    Enclosure sum(0.0);
    for (const Enclosure& one :
         weighted([&](Index i) { return curvature(i, half, result.reach, result.xi1); })) {
      sum += square(one);
    }
    relaxed.remainder = sqrt(sum).upper();
    return relaxed;
  }

 private:
  template <class Row>
  Ranges weighted(const Row& row) const {
    Ranges column;
    column.reserve(kept_.size());
    for (const Index i : kept_) column.push_back(row(i) * problem_.weight(i));
    return column;
  }

  /// Half of the second derivatives over the box times what they are multiplied by.
  Enclosure curvature(Index i, const VectorXd& half, const VectorXd& reach,
                      const VectorXd& xi1) const {
    const Index n_1 = problem_.n_1();
    Enclosure sum(0.0);
    Index part = 1 + problem_.n_2();
    for (Index j = 0; j < problem_.n_2(); ++j) {
      for (Index k = 0; k <= j; ++k, ++part) {
        if (half[j] == 0.0 || half[k] == 0.0) continue;
        Enclosure curvature(over_.at(i, n_1)[part].magnitude());
        for (Index l = 0; l < n_1; ++l) {
          curvature += Enclosure(over_.at(i, l)[part].magnitude()) *
                       (Enclosure(std::abs(xi1[l])) + Enclosure(reach[l]));
        }
        sum += curvature * half[j] * half[k] * (j == k ? 0.5 : 1.0);
      }
    }
    return sum;
  }

  const EnclosedProblem& problem_;
  const EnclosedRows& at_;
  const EnclosedRows& over_;
  const std::vector<Index>& kept_;
};

}  // namespace

BoxBound bound_over(const EnclosedProblem& problem, const Ranges& box, const Ranges& limits,
                    double most) {
  const Index n_1 = problem.n_1();
  const Index n_2 = problem.n_2();
  BoxBound result{.middle = VectorXd(n_2),
                  .xi1 = VectorXd::Zero(n_1),
                  .swing = VectorXd::Zero(n_2),
                  .reach = VectorXd::Constant(n_1, infinity)};
  VectorXd half(n_2);
  for (Index j = 0; j < n_2; ++j) {
    const Enclosure& range = box[static_cast<std::size_t>(j)];
    result.middle[j] = range.middle();
    half[j] = (range - Enclosure(result.middle[j])).magnitude();
  }
  const EnclosedRows at = problem.over(points(result.middle));
  const EnclosedRows over = problem.over(box);
  const std::vector<Index> kept = finite_rows(problem, over);
  const Linear linear(problem, at, kept, limits);
  result.xi1 = linear.xi1();
  result.reach = linear.reach(over, most);
  Ranges steps;
  for (Index l = 0; l < n_1; ++l) {
    const Enclosure within = limits[static_cast<std::size_t>(l)] - Enclosure(result.xi1[l]);
    steps.emplace_back(std::max(within.lower(), -result.reach[l]),
                       std::min(within.upper(), result.reach[l]));
    result.reach[l] = steps.back().magnitude();
  }
  const Relaxation relaxed = Relaxer(problem, at, over, kept).relax(half, steps, result);
  const double bound = dual_bound(relaxed.columns, relaxed.y, leftover(relaxed.columns, relaxed.y));
  if (!(bound > 0.0)) return result;
  const Enclosure root = sqrt(Enclosure(bound) * 2.0) - Enclosure(relaxed.remainder);
  if (!(root.lower() > 0.0)) return result;
  result.lower = std::min((square(Enclosure(root.lower())) * 0.5).lower(), most);
  return result;
}

}  // namespace sepcal::certificate
