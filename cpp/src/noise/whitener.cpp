// SPDX-License-Identifier: BSD-3-Clause
// Where the level is free the differences x_t = e_t - e_{t-1} of a segment are whitened: they are
// stationary with delta = d - 1, whatever d is in [0, 1).
#include <cmath>
#include <numbers>

#include "noise/arfima_factor.hpp"
#include "noise/noise_room.hpp"
#include "sepcal/error.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal {

using namespace noise;  // this room's own

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

void noise::check_noise_model(const NoiseModel& model) {
  if (!(model.d >= 0.0 && model.d < 1.0)) {
    throw Error("the noise model's d is " + std::to_string(model.d) + "; it must be in [0, 1)");
  }
  if (!is_stationary(model.phi)) {
    throw Error(
        "the noise model's phi is not stationary: every partial autocorrelation must be "
        "within (-1, 1)");
  }
  if (!(model.sigma >= 0.0 && std::isfinite(model.sigma))) {
    throw Error("the noise model's sigma is " + std::to_string(model.sigma) +
                "; it must be finite and not negative");
  }
}

std::vector<Index> noise::find_lengths(const std::vector<Segment>& segments) {
  std::vector<Index> lengths;
  for (const Segment& segment : segments) {
    if (segment.first >= segment.last) {
      throw Error("segment '" + segment.label + "' is empty: its last row must be past its first");
    }
    lengths.push_back(static_cast<Index>(segment.rows()));
  }
  return lengths;
}

std::vector<Index> noise::find_blocks(std::vector<Index> lengths, bool free_level) {
  if (free_level) {
    for (Index& length : lengths) --length;
  }
  return lengths;
}

noise::NoiseRows::NoiseRows(const VectorXd& e, const std::vector<Index>& lengths,
                            bool level_is_free)
    : free_level(level_is_free), blocks(find_blocks(lengths, level_is_free)), values(e) {
  if (!free_level) return;
  Index from = 0;
  Index to = 0;
  for (const Index length : lengths) {
    const Index block = length - 1;
    values.segment(to, block) = e.segment(from + 1, block) - e.segment(from, block);
    from += length;
    to += block;
  }
  values.conservativeResize(to);
}

VectorXd gather_rows(std::span<const double> e, const std::vector<Segment>& segments) {
  Index rows = 0;
  for (const Index length : find_lengths(segments)) rows += length;
  VectorXd gathered(rows);
  Index at = 0;
  for (const Segment& segment : segments) {
    if (segment.last > e.size()) {
      throw Error("segment '" + segment.label + "' ends at row " + std::to_string(segment.last) +
                  "; there are " + std::to_string(e.size()) + " values");
    }
    for (std::size_t row = segment.first; row < segment.last; ++row) gathered[at++] = e[row];
  }
  return gathered;
}

Whitener::Whitener(const NoiseModel& model, const std::vector<Segment>& segments)
    : lengths_(find_lengths(segments)), sigma_(model.sigma), free_level_(model.level_is_free()) {
  check_noise_model(model);
  if (!(sigma_ > 0.0)) {
    throw Error("the noise model's sigma is 0: leave out the output, it has nothing to whiten");
  }
  const std::vector<Index> blocks = find_blocks(lengths_, free_level_);
  factor_ =
      std::make_shared<const ArfimaFactor>(model.d - (free_level_ ? 1.0 : 0.0), model.phi, blocks);
  for (const Index length : lengths_) rows_ += length;
  for (const Index block : blocks) informative_rows_ += block;
  log_determinant_ = factor_->log_determinant(blocks);
  if (!std::isfinite(log_determinant_)) {
    throw Error(
        "the noise model's phi is so near to not stationary that its covariance is lost in "
        "rounding; choose a lower order");
  }
  log_determinant_ += 2.0 * static_cast<double>(informative_rows_) * std::log(sigma_);
}

void Whitener::apply(Ref<MatrixXd> columns) const {
  if (columns.rows() != rows_) {
    throw Error("there are " + std::to_string(columns.rows()) +
                " rows to whiten; the segments have " + std::to_string(rows_));
  }
  for (Index j = 0; j < columns.cols(); ++j) {
    Index first = 0;
    for (const Index length : lengths_) {
      auto part = columns.col(j).segment(first, length);
      first += length;
      if (!free_level_) {
        factor_->whiten(part);
        continue;
      }
      for (Index t = length - 1; t > 0; --t) part[t] -= part[t - 1];
      part[0] = 0.0;
      factor_->whiten(part.tail(length - 1));
    }
  }
  columns /= sigma_;
}

}  // namespace sepcal
