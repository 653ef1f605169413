// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/gauss_markov_filter.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/lanes.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using numerics::load;
using numerics::Quad;
using numerics::quad_count;
using numerics::store;

constexpr Index at_once = 2 * quad_count;  // columns at once

/// The filter's numbers, a row of `width` for each row of the record or output of it.
struct FilterRows {
  Index rows;
  Index outputs;
  Index states;
  Index width;  // the states, filled up to whole quads
  const double* decays;
  const double* slopes;
};

// NOLINTBEGIN(*-pointer-arithmetic): lanes of a register.

/// Fills gains and roots from the covariance P (width x width) before the first row.
SEPCAL_EVERY_WIDTH void find_gains(const FilterRows& filter, const double* stationary,
                                   const double* white, double* P, double* carried, double* gains,
                                   double* roots) {
  const Index width = filter.width;
  for (Index t = 0; t < filter.rows; ++t) {
    const double* decay = filter.decays + t * width;
    for (Index k = 0; t > 0 && k < filter.states; ++k) {
      for (Index l = 0; l < width; l += quad_count) {
        Quad covariance;
        Quad with;
        load(P + k * width + l, covariance);
        load(decay + l, with);
        store(decay[k] * with * covariance, P + k * width + l);
      }
      P[k * width + k] += stationary[k] * (1.0 - decay[k] * decay[k]);
    }
    for (Index j = 0; j < filter.outputs; ++j) {
      const Index at = t * filter.outputs + j;
      const double* slope = filter.slopes + at * width;
      double* gain = gains + at * width;
      Quad own = {};
      for (Index l = 0; l < width; l += quad_count) {
        Quad sum = {};
        for (Index k = 0; k < filter.states; ++k) {
          if (slope[k] == 0.0) continue;  // most states enter few outputs
          Quad covariance;
          load(P + k * width + l, covariance);
          sum += slope[k] * covariance;
        }
        store(sum, carried + l);
        Quad with;
        load(slope + l, with);
        own += with * sum;
      }
      const double innovation = white[j] + (own[0] + own[1]) + (own[2] + own[3]);
      roots[at] = 1.0 / std::sqrt(innovation);
      for (Index l = 0; l < width; l += quad_count) {
        Quad by;
        load(carried + l, by);
        by /= innovation;
        store(by, gain + l);
        for (Index k = 0; k < filter.states; ++k) {
          Quad covariance;
          load(P + k * width + l, covariance);
          store(covariance - carried[k] * by, P + k * width + l);
        }
      }
    }
  }
}

/// Columns side by side, `at_once` of them (m N x at_once), with zeros for the states.
SEPCAL_EVERY_WIDTH void whiten_side_by_side(const FilterRows& filter, const double* gains,
                                            const double* roots, double* values, double* states) {
  for (Index t = 0; t < filter.rows; ++t) {
    const double* decay = filter.decays + t * filter.width;
    for (Index k = 0; k < filter.states; ++k) {
      for (Index c = 0; c < at_once; c += quad_count) {
        Quad state;
        load(states + k * at_once + c, state);
        store(decay[k] * state, states + k * at_once + c);
      }
    }
    for (Index j = 0; j < filter.outputs; ++j) {
      const Index at = t * filter.outputs + j;
      const double* slope = filter.slopes + at * filter.width;
      const double* gain = gains + at * filter.width;
      Quad first;  // innovations
      Quad second;
      load(values + at * at_once, first);
      load(values + at * at_once + quad_count, second);
      for (Index k = 0; k < filter.states; ++k) {
        if (slope[k] == 0.0) continue;
        Quad state;
        load(states + k * at_once, state);
        first -= slope[k] * state;
        load(states + k * at_once + quad_count, state);
        second -= slope[k] * state;
      }
      for (Index k = 0; k < filter.states; ++k) {
        Quad state;
        load(states + k * at_once, state);
        store(state + gain[k] * first, states + k * at_once);
        load(states + k * at_once + quad_count, state);
        store(state + gain[k] * second, states + k * at_once + quad_count);
      }
      store(roots[at] * first, values + at * at_once);
      store(roots[at] * second, values + at * at_once + quad_count);
    }
  }
}

// NOLINTEND(*-pointer-arithmetic)

}  // namespace

GaussMarkovFilter::GaussMarkovFilter(const std::vector<GaussMarkovState>& states,
                                     const VectorXd& white, const std::vector<double>& times)
    : states_(std::ssize(states)) {
  const auto n = static_cast<Index>(times.size());
  const Index outputs = white.size();
  const Index width = (states_ + quad_count - 1) / quad_count * quad_count;
  decays_ = ByRow::Zero(n, width);
  slopes_ = ByRow::Zero(n * outputs, width);
  gains_ = ByRow::Zero(n * outputs, width);
  roots_ = VectorXd(n * outputs);
  VectorXd stationary = VectorXd::Zero(width);
  for (Index k = 0; k < states_; ++k) {
    const GaussMarkovState& state = states[static_cast<std::size_t>(k)];
    stationary[k] = state.variance;
    for (Index j = 0; j < outputs; ++j) {
      auto slopes = slopes_.col(k)(Eigen::seqN(j, n, outputs));
      if (state.slopes != nullptr) slopes = state.slopes->segment(j * n, n);
      if (state.slopes == nullptr && j == state.output) slopes.setOnes();
    }
    const GaussMarkovState* before = k > 0 ? &states[static_cast<std::size_t>(k - 1)] : nullptr;
    if (before != nullptr && state.time == before->time && state.rows == before->rows) {
      decays_.col(k) = decays_.col(k - 1);
      continue;
    }
    for (Index t = 1; t < n; ++t) {
      const auto row = static_cast<std::size_t>(t);
      const double elapsed = std::max(0.0, times[row] - times[row - 1]);
      decays_(t, k) = std::exp(state.rows > 0.0 ? -1.0 / state.rows : -elapsed / state.time);
    }
  }
  ByRow P = stationary.asDiagonal();
  VectorXd carried(width);
  const FilterRows filter{n, outputs, states_, width, decays_.data(), slopes_.data()};
  find_gains(filter, stationary.data(), white.data(), P.data(), carried.data(), gains_.data(),
             roots_.data());
}

MatrixXd GaussMarkovFilter::whiten(const MatrixXd& columns) const {
  const Index n = decays_.rows();
  const Index outputs = roots_.size() / n;
  MatrixXd white(columns.rows(), columns.cols());
  ByRow values(columns.rows(), at_once);
  const FilterRows filter{n, outputs, states_, slopes_.cols(), decays_.data(), slopes_.data()};
  for (Index first = 0; first < columns.cols(); first += at_once) {
    const Index count = std::min(at_once, columns.cols() - first);
    values.setZero();
    for (Index j = 0; j < outputs; ++j) {
      values(Eigen::seqN(j, n, outputs), Eigen::seqN(0, count)) =
          columns.block(j * n, first, n, count);
    }
    ByRow states = ByRow::Zero(states_, at_once);
    whiten_side_by_side(filter, gains_.data(), roots_.data(), values.data(), states.data());
    white.middleCols(first, count) = values.leftCols(count);
  }
  return white;
}

}  // namespace sepcal::diagnosis
