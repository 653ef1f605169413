// SPDX-License-Identifier: BSD-3-Clause
#include "noise/fractional_difference.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "numerics/gauss_rule.hpp"
#include "numerics/lanes.hpp"

namespace sepcal::noise {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using numerics::add_lanes;
using numerics::lane_count;
using numerics::Lanes;
using numerics::load;

static_assert(Exponentials::count == lane_count);
constexpr Index near_rows = Index{2} * Exponentials::count;
constexpr Index few_rows = 128;  // whose coefficients cost less than exponentials do
// Trapezoids in ln(lambda) converge like e^{-pi^2 / step}: 2e-11 here.
constexpr double step = 0.4;
constexpr Index many_rows =
    2048;  // over which fewer exponentials save more than finding them costs

// NOLINTBEGIN(*-pointer-arithmetic,*-c-arrays,*-constant-array-index): lanes of a register.

/// y_t from the last near_rows of x, by `near` (the oldest first), and from all before, by groups
/// of exponentials, which stay in registers where these are wide.
template <std::size_t groups>
[[gnu::always_inline]] inline void filter_by(const double* near, const Exponentials* distant,
                                             double* x, Index rows) {
  Lanes state[groups] = {};
  Lanes decay[groups];
  Lanes weight[groups];
#pragma GCC unroll 9
  for (std::size_t g = 0; g < groups; ++g) {
    load(distant[g].decay, decay[g]);
    load(distant[g].weight, weight[g]);
  }
  Lanes older;
  Lanes newer;
  load(near, older);
  load(near + Exponentials::count, newer);
  constexpr Index chunk = 512;
  double past[near_rows + chunk] = {};  // the rows as they were, behind those before them
  for (Index first = 0; first < rows; first += chunk) {
    const Index count = std::min(chunk, rows - first);
    std::copy_n(x + first, count, past + near_rows);
    for (Index t = 0; t < count; ++t) {
      const Lanes leaving = Lanes{} + past[t];
      Lanes old_rows;
      Lanes new_rows;
      load(past + t + 1, old_rows);
      load(past + t + 1 + Exponentials::count, new_rows);
      Lanes sum = older * old_rows + newer * new_rows;
#pragma GCC unroll 9
      for (std::size_t g = 0; g < groups; ++g) {
        state[g] = decay[g] * state[g] + leaving;
        sum += weight[g] * state[g];
      }
      x[first + t] = add_lanes(sum);
    }
    std::copy_n(past + count, near_rows, past);
  }
}

constexpr std::size_t fewest_groups = 3;
constexpr std::size_t most_groups = 9;  // those of 2048 rows; no more rows need as many

SEPCAL_EVERY_WIDTH void filter(const double* near, const Exponentials* distant, std::size_t groups,
                               double* x, Index rows) {
  switch (groups) {
    case fewest_groups:
      filter_by<fewest_groups>(near, distant, x, rows);
      break;
    case 5:
      filter_by<5>(near, distant, x, rows);
      break;
    case 7:
      filter_by<7>(near, distant, x, rows);
      break;
    default:
      filter_by<most_groups>(near, distant, x, rows);
  }
}

/// Groups for so many terms, of which filter() has an odd number.
std::size_t count_groups(Index terms) {
  const auto groups = static_cast<std::size_t>((terms - 1) / Exponentials::count + 1);
  return std::clamp(groups | 1U, fewest_groups, most_groups);
}

// NOLINTEND(*-pointer-arithmetic,*-c-arrays,*-constant-array-index)

struct Terms {
  VectorXd lambda;  // ascending
  VectorXd weight;
};

/// The exponentials that hardly fall over the rows, most of all, become a group of Gauss's: with
/// lambda k < 6 a polynomial of degree 15 in lambda stands for e^{-lambda k} to 1e-10.
Terms merge_slow(const Terms& all, Index rows) {
  constexpr double fall = 6.0;
  const Index slow = (all.lambda.array() * static_cast<double>(rows) < fall).count();
  const Index fast = all.lambda.size() - slow;
  if (slow <= Exponentials::count) return all;
  const numerics::GaussRule rule =
      numerics::gauss_rule(all.lambda.head(slow), all.weight.head(slow), Exponentials::count);
  Terms merged{VectorXd(rule.nodes.size() + fast), VectorXd(rule.nodes.size() + fast)};
  merged.lambda << rule.nodes, all.lambda.tail(fast);
  merged.weight << rule.weights, all.weight.tail(fast);
  return merged;
}

}  // namespace

FractionalDifference::FractionalDifference(double d, Index rows)
    : d_(d < 0.0 ? d + 1.0 : d), summed_(d < 0.0) {
  if (d_ <= 0.0) return;
  near_.resize(std::max<Index>(1, rows <= few_rows ? rows : near_rows));
  near_[0] = 1.0;
  for (Index k = 1; k < near_.size(); ++k) {
    near_[k] = near_[k - 1] * (static_cast<double>(k - 1) - d_) / static_cast<double>(k);
  }
  near_.reverseInPlace();
  if (rows <= few_rows) return;
  constexpr double pi = std::numbers::pi;
  const double scale = std::sin(pi * d_) / pi;
  // What lies below `lowest` adds less than 1e-10 over all rows; above `highest`, e^{-45}.
  const double lowest = std::log(1e-10 / static_cast<double>(rows) / scale) / (1.0 + d_);
  const double highest = std::log(45.0 / (static_cast<double>(near_rows) - d_));
  const auto nodes = static_cast<Index>(std::ceil((highest - lowest) / step)) + 1;
  Terms terms{VectorXd(nodes), VectorXd(nodes)};
  for (Index i = 0; i < nodes; ++i) {
    const double lambda = std::exp(lowest + step * static_cast<double>(i));
    terms.lambda[i] = lambda;
    terms.weight[i] = -scale * step * lambda * std::pow(-std::expm1(-lambda), d_) *
                      std::exp(-(static_cast<double>(near_rows) - d_) * lambda);
  }
  if (rows > many_rows) terms = merge_slow(terms, rows);
  const Index count = terms.lambda.size();
  distant_.resize(count_groups(count));
  for (Index i = 0; i < count; ++i) {
    Exponentials& group = distant_[static_cast<std::size_t>(i / Exponentials::count)];
    group.decay[i % Exponentials::count] = std::exp(-terms.lambda[i]);
    group.weight[i % Exponentials::count] = terms.weight[i];
  }
}

void FractionalDifference::apply(Eigen::Ref<VectorXd> x) const {
  if (d_ > 0.0) {
    if (distant_.empty()) {
      for (Index t = x.size() - 1; t >= 0; --t) {
        const Index span = std::min(t + 1, near_.size());
        x[t] = near_.tail(span).dot(x.segment(t + 1 - span, span));
      }
    } else {
      filter(near_.data(), distant_.data(), distant_.size(), x.data(), x.size());
    }
  }
  if (!summed_) return;
  double sum = 0.0;
  for (double& value : x) value = sum += value;
}

}  // namespace sepcal::noise
