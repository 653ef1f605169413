// SPDX-License-Identifier: BSD-3-Clause
// What follows from a noise model: draws of it, and X' Sigma X.
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "noise/arfima_factor.hpp"
#include "noise/noise_room.hpp"
#include "noise/stationary_lags.hpp"
#include "numerics/symmetric.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace noise;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

/// Box & Muller on 53 bits: std::normal_distribution differs between libraries.
void draw_normals(std::mt19937_64& generator, Ref<VectorXd> out) {
  const auto uniform = [&] { return (static_cast<double>(generator() >> 11U) + 0.5) * 0x1p-53; };
  for (Index i = 0; i < out.size(); i += 2) {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    out[i] = radius * std::cos(angle);
    if (i + 1 < out.size()) out[i + 1] = radius * std::sin(angle);
  }
}

/// The sizes of `innovations` with the signs of `x`; x where they are zero.
void keep_sizes(const Ref<const VectorXd>& innovations, Ref<VectorXd> x) {
  for (Index t = 0; t < x.size(); ++t) {
    if (innovations[t] != 0.0) x[t] = std::copysign(innovations[t], x[t]);
  }
}

}  // namespace

MatrixXd simulate_noise(const NoiseModel& model, const std::vector<Segment>& segments, Index draws,
                        std::mt19937_64& generator, const VectorXd& innovations) {
  check_noise_model(model);
  const std::vector<Index> lengths = find_lengths(segments);
  const bool free = model.level_is_free();
  // A free level takes the changes over the n rows before the segment too: as many as 2n - 1.
  std::vector<Index> blocks = lengths;
  Index rows = 0;
  for (Index& block : blocks) {
    rows += block;
    if (free) block = 2 * block - 1;
  }
  if (innovations.size() > 0 && innovations.size() != rows) {
    throw Error("there are " + std::to_string(innovations.size()) +
                " innovations; the segments have " + std::to_string(rows) + " rows");
  }
  const ArfimaFactor factor(model.d - (free ? 1.0 : 0.0), model.phi, blocks);
  MatrixXd noise(rows, draws);
  VectorXd x;
  for (Index j = 0; j < draws; ++j) {
    Index first = 0;
    for (std::size_t k = 0; k < lengths.size(); ++k) {
      x.resize(blocks[k]);
      draw_normals(generator, x);
      if (innovations.size() > 0) {
        keep_sizes(innovations.segment(first, lengths[k]), x.tail(lengths[k]));
      }
      factor.colour(x);
      if (free) {
        for (Index t = 1; t < x.size(); ++t) x[t] += x[t - 1];
      }
      noise.col(j).segment(first, lengths[k]) = model.sigma * x.tail(lengths[k]);
      first += lengths[k];
    }
  }
  return noise;
}

MatrixXd covariance_product(const NoiseModel& model, const std::vector<Segment>& segments,
                            const Ref<const MatrixXd>& X) {
  check_noise_model(model);
  const std::vector<Index> lengths = find_lengths(segments);
  const Index rows = std::accumulate(lengths.begin(), lengths.end(), Index{0});
  if (X.rows() != rows) {
    throw Error("X has " + std::to_string(X.rows()) + " rows; the segments have " +
                std::to_string(rows));
  }
  const StationaryLags lags(model, lengths);
  MatrixXd product = MatrixXd::Zero(X.cols(), X.cols());
  Index first = 0;
  for (const Index n : lengths) {
    const auto part = X.middleRows(first, n);
    first += n;
    product += part.transpose() * lags.multiply(part, n, 0);
  }
  return numerics::symmetric_part(product);
}

}  // namespace sepcal
