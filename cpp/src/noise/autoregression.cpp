// SPDX-License-Identifier: BSD-3-Clause
// Row t of a block is predicted from its min(t, p) predecessors, with variance
// sigma^2 / prod_{t<j<=p} (1 - r_j^2): the exact Gaussian likelihood of an AR(p).
#include "noise/autoregression.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "numerics/lanes.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::noise {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using numerics::add_lanes;
using numerics::lane_count;
using numerics::Lanes;
using numerics::load;
using numerics::store;

VectorXd phi_from_partial(const VectorXd& partial) {
  VectorXd phi = partial;
  for (Index k = 1; k < phi.size(); ++k) {
    const VectorXd before = phi.head(k);
    phi.head(k) -= partial[k] * before.reverse();
  }
  return phi;
}

VectorXd partial_from_phi(VectorXd phi) {
  for (Index k = phi.size() - 1; k > 0; --k) {
    const VectorXd now = phi.head(k);
    phi.head(k) = (now + phi[k] * now.reverse()) / (1.0 - phi[k] * phi[k]);
  }
  return phi;
}

bool is_stationary(const VectorXd& phi) {
  return (partial_from_phi(phi).array().abs() < 1.0).all();
}

namespace {

/// Of pairs of rows, a forward one and the backward one before it.
struct PairSums {
  double product = 0.0;
  double squares = 0.0;  // of both
  double forward = 0.0;  // the forward ones' squares
};

// NOLINTBEGIN(*-pointer-arithmetic,*-c-arrays,*-constant-array-index): lanes of a register.

SEPCAL_EVERY_WIDTH PairSums add_pairs(const double* forward, const double* backward, Index pairs) {
  Lanes product = {};
  Lanes forwards = {};
  Lanes backwards = {};
  Index t = 0;
  for (; t + lane_count <= pairs; t += lane_count) {
    Lanes f;
    Lanes b;
    load(forward + t, f);
    load(backward + t, b);
    product += f * b;
    forwards += f * f;
    backwards += b * b;
  }
  PairSums sums{add_lanes(product), add_lanes(backwards), add_lanes(forwards)};
  for (; t < pairs; ++t) {
    sums.product += forward[t] * backward[t];
    sums.forward += forward[t] * forward[t];
    sums.squares += backward[t] * backward[t];
  }
  sums.squares += sums.forward;
  return sums;
}

constexpr Index lags_at_once = 4;

/// Adds sum_t x_t x_{t-lag} of a block to `products`, for lags 0, ..., lags - 1, a multiple of
/// lags_at_once.
SEPCAL_EVERY_WIDTH void add_lagged(const double* x, Index rows, Index lags, double* products) {
  for (Index lag = 0; lag < lags; lag += lags_at_once) {
    Lanes sums[lags_at_once] = {};
    Index t = lag + lags_at_once - 1;
    for (; t + lane_count <= rows; t += lane_count) {
      Lanes now;
      load(x + t, now);
      for (Index k = 0; k < lags_at_once; ++k) {
        Lanes before;
        load(x + t - lag - k, before);
        sums[k] += now * before;
      }
    }
    for (Index k = 0; k < lags_at_once; ++k) {
      double sum = add_lanes(sums[k]);
      for (Index late = t; late < rows; ++late) sum += x[late] * x[late - lag - k];
      const Index first = lag + k;
      for (Index early = first; early < lag + lags_at_once - 1; ++early) {
        if (early < rows) sum += x[early] * x[early - lag - k];
      }
      products[lag + k] += sum;
    }
  }
}

/// x_t - sum_i phi_i x_{t-i} in the place of x_t, from the last row back to row p.
SEPCAL_EVERY_WIDTH void subtract_rows(const double* phi, Index order, double* x, Index rows) {
  constexpr Index groups = 4;
  constexpr Index chunk = groups * lane_count;
  Index last = rows;
  for (; last - chunk >= order; last -= chunk) {
    double* at = x + last - chunk;
    Lanes left[groups];
    for (Index g = 0; g < groups; ++g) load(at + g * lane_count, left[g]);
    for (Index i = 0; i < order; ++i) {
      for (Index g = 0; g < groups; ++g) {
        Lanes before;
        load(at + g * lane_count - i - 1, before);
        left[g] -= phi[i] * before;
      }
    }
    for (Index g = 0; g < groups; ++g) store(left[g], at + g * lane_count);
  }
  for (Index t = last - 1; t >= order; --t) {
    double left = x[t];
    for (Index i = 0; i < order; ++i) left -= phi[i] * x[t - i - 1];
    x[t] = left;
  }
}

/// Both become what the other of a pair does not predict.
SEPCAL_EVERY_WIDTH void reflect(double r, double* forward, double* backward, Index pairs) {
  Index t = 0;
  for (; t + lane_count <= pairs; t += lane_count) {
    Lanes f;
    Lanes b;
    load(forward + t, f);
    load(backward + t, b);
    const Lanes left = f - r * b;
    const Lanes right = b - r * f;
    store(left, forward + t);
    store(right, backward + t);
  }
  for (; t < pairs; ++t) {
    const double f = forward[t];
    forward[t] = f - r * backward[t];
    backward[t] = backward[t] - r * f;
  }
}

// NOLINTEND(*-pointer-arithmetic,*-c-arrays,*-constant-array-index)

/// Of one order of the lattice, over all blocks.
struct Stage {
  PairSums pairs;
  double starts = 0.0;  // squares of the first forward rows
};

/// The rows themselves, reflected from order to order.
class ReflectedRows {
 public:
  ReflectedRows(const VectorXd& y, const std::vector<Index>& lengths)
      : lengths_(lengths), forward_(y), backward_(y) {}

  Stage sum(int order) const {
    Stage stage;
    Index first = 0;
    for (const Index length : lengths_) {
      if (length > order) {
        const Index start = first + order;
        const PairSums sums =
            add_pairs(&forward_[start] + 1, &backward_[first], length - order - 1);
        stage.starts += forward_[start] * forward_[start];
        stage.pairs.product += sums.product;
        stage.pairs.squares += sums.squares;
        stage.pairs.forward += sums.forward;
      }
      first += length;
    }
    return stage;
  }

  void reflect_all(int order, double r) {
    Index first = 0;
    for (const Index length : lengths_) {
      const Index pairs = length - order - 1;
      if (pairs > 0) reflect(r, &forward_[first + order] + 1, &backward_[first], pairs);
      first += length;
    }
  }

 private:
  const std::vector<Index>& lengths_;
  VectorXd forward_;
  VectorXd backward_;  // a row stands `order` rows before its own, that of its pair
};

/// The same from products of rows up to an order's lags apart, less those at the blocks' ends. What
/// is predicted but for a millionth is lost in their rounding.
class LaggedProducts {
 public:
  LaggedProducts(const VectorXd& y, const std::vector<Index>& lengths, int max_order)
      : y_(y), lengths_(lengths), a_(VectorXd::Zero(max_order + 2)) {
    const Index lags = (max_order + 1 + lags_at_once) / lags_at_once * lags_at_once;
    lagged_ = VectorXd::Zero(lags);
    Index first = 0;
    for (const Index length : lengths) {
      add_lagged(&y[first], length, lags, lagged_.data());
      first += length;
    }
    a_[0] = 1.0;
  }

  static bool pays(const std::vector<Index>& lengths, int max_order) {
    constexpr Index rows_an_order = 60;
    return std::ranges::all_of(
        lengths, [&](Index length) { return length > rows_an_order * (max_order + 2); });
  }

  Stage sum(int order) const {
    const Index count = order + 2;
    MatrixXd S(count, count);  // of x_{t-i} x_{t-j} over the pairs
    for (Index i = 0; i < count; ++i) {
      for (Index j = i; j < count; ++j) S(j, i) = S(i, j) = of_pairs(i, j - i, order);
    }
    const VectorXd forward = a_.head(count);
    const VectorXd backward = forward.reverse();
    Stage stage;
    stage.pairs.forward = forward.dot(S * forward);
    stage.pairs.squares = stage.pairs.forward + backward.dot(S * backward);
    stage.pairs.product = forward.dot(S * backward);
    Index first = 0;
    for (const Index length : lengths_) {
      const double start = forward.head(count - 1).reverse().dot(y_.segment(first, count - 1));
      stage.starts += start * start;
      first += length;
    }
    return stage;
  }

  void reflect_all(int order, double r) {
    const VectorXd before = a_.head(order + 2);
    a_.head(order + 2) -= r * before.reverse();
  }

  double square() const { return lagged_[0]; }

 private:
  /// sum of x_s x_{s-lag} over the blocks without what has s below order + 1 - i or among a block's
  /// last i.
  double of_pairs(Index i, Index lag, Index order) const {
    double sum = lagged_[lag];
    Index first = 0;
    for (const Index length : lengths_) {
      for (Index s = lag; s < order + 1 - i; ++s) sum -= y_[first + s] * y_[first + s - lag];
      for (Index s = length - i; s < length; ++s) sum -= y_[first + s] * y_[first + s - lag];
      first += length;
    }
    return sum;
  }

  const VectorXd& y_;
  const std::vector<Index>& lengths_;
  VectorXd lagged_;
  VectorXd a_;  // of the forward rows: 1, -phi, and a zero
};

/// `least`: of a row's square that must be left.
template <class Lattice>
std::optional<BurgFit> fit_lattice(Lattice lattice, Index count, const std::vector<Index>& lengths,
                                   int max_order, double least) {
  BurgFit fit{VectorXd::Zero(max_order + 1), VectorXd::Zero(max_order + 1),
              VectorXd::Zero(max_order)};
  const auto rows = static_cast<double>(count);
  // The first rows of the blocks, each divided by its own variance ratio, and their log variances.
  double early = 0.0;
  double log_ratio = 0.0;
  for (int order = 0;; ++order) {
    const Stage stage = lattice.sum(order);
    const double square = stage.pairs.forward + stage.starts + early;
    if (!(square >= least)) return std::nullopt;
    fit.criterion[order] = rows * std::log(square / rows) + log_ratio;
    fit.log_ratio[order] = log_ratio;
    if (order == max_order) return fit;
    const double power = stage.pairs.squares;
    const double r = power > 0.0 ? 2.0 * stage.pairs.product / power : 0.0;
    const double left = 1.0 - r * r;
    if (!(left > 1e-10)) {  // predicted without error: no higher order has anything to add
      fit.criterion.tail(max_order - order).setConstant(fit.criterion[order]);
      fit.log_ratio.tail(max_order - order).setConstant(log_ratio);
      return fit;
    }
    fit.partial[order] = r;
    early = (early + stage.starts) * left;
    double early_rows = 0.0;
    for (const Index length : lengths) {
      early_rows += static_cast<double>(std::min<Index>(length, order + 1));
    }
    log_ratio -= early_rows * std::log(left);
    lattice.reflect_all(order, r);
  }
}

}  // namespace

void subtract_predictions(const VectorXd& phi, Eigen::Ref<VectorXd> x) {
  subtract_rows(phi.data(), phi.size(), x.data(), x.size());
}

BurgFit fit_burg(const VectorXd& y, const std::vector<Index>& lengths, int max_order) {
  constexpr double kept = 1e-5;  // of the square: all digits but a few
  if (LaggedProducts::pays(lengths, max_order)) {
    const LaggedProducts products(y, lengths, max_order);
    const double least = kept * products.square();
    if (auto fit = fit_lattice(products, y.size(), lengths, max_order, least)) return *fit;
  }
  return fit_lattice(ReflectedRows(y, lengths), y.size(), lengths, max_order, -infinity)
      .value_or(BurgFit{});
}

}  // namespace sepcal::noise
