// SPDX-License-Identifier: BSD-3-Clause
// The pass that many points of xi2 share.
#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>

#include "base/stop.hpp"
#include "model/point_lanes.hpp"
#include "model/row_lanes.hpp"
#include "model/sweep.hpp"

namespace sepcal::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The fraction done, said from any thread.
class Progress {
 public:
  Progress(const std::function<void(double)>& on_progress, std::size_t steps)
      : on_progress_(on_progress), steps_(static_cast<double>(steps)) {}

  void step() {
    if (!on_progress_) return;
    const std::lock_guard lock(mutex_);
    on_progress_(++done_ / steps_);
  }

 private:
  const std::function<void(double)>& on_progress_;
  std::mutex mutex_;
  double done_ = 0.0;
  double steps_;
};

/// `count` samples among as many groups as threads, in whole tiles of `width`.
std::vector<std::pair<Index, Index>> split(Index count, Index threads, Index width) {
  const Index tiles = (count + width - 1) / width;
  const Index groups = std::clamp<Index>(tiles, 1, threads);
  std::vector<std::pair<Index, Index>> parts;  // the first sample and how many
  for (Index g = 0; g < groups; ++g) {
    const Index first = g * tiles / groups * width;
    const Index last = std::min(count, (g + 1) * tiles / groups * width);
    parts.emplace_back(first, last - first);
  }
  return parts;
}

}  // namespace

VectorXd Sweep::sample_squares(const MatrixXd& samples,
                               const std::function<void(double)>& on_progress) const {
  const PointLanes lanes(model_, measurements_, samples);
  VectorXd squares(samples.cols());
  if (lanes.width() == 0) {
    std::vector<Index> all(static_cast<std::size_t>(samples.cols()));
    std::iota(all.begin(), all.end(), Index{0});
    sample_one_by_one(samples, all, squares, on_progress);
    return squares;
  }
  const auto parts = split(samples.cols(), pool_.threads(), static_cast<Index>(lanes.width()));
  Progress progress(on_progress, parts.size() * measurements_.chunks().size());
  pool_.for_each(parts.size(), [&](std::size_t p) {
    const auto [first, count] = parts[p];
    const PointFactors found =
        lanes.factor(samples.middleCols(first, count), [&] { progress.step(); });
    for (Index s = 0; s < count; ++s) {
      squares[first + s] = found.remaining_square(static_cast<std::size_t>(s));
    }
  });
  std::vector<Index> unclear;
  for (Index s = 0; s < squares.size(); ++s) {
    if (!std::isfinite(squares[s])) unclear.push_back(s);
  }
  sample_one_by_one(samples, unclear, squares, {});
  return squares;
}

template <class Factor>
void Sweep::absorb_samples(const MatrixXd& points, std::vector<Factor>& factors,
                           const std::function<void()>& after_chunk) const {
  std::vector<std::unique_ptr<Carry>> carries;
  for (Index s = 0; s < points.cols(); ++s) carries.push_back(model_.new_carry());
  std::vector<const double*> pointers;
  MatrixXd given;
  RowScratch scratch;
  for (const auto& chunk : measurements_.chunks()) {
    for (const Measurements::Range& range : chunk) {
      base::heed_stop();
      const Block block = measurements_.block(range, pointers);
      model_.evaluate_points(block, points, carries, given, [&](Index s, const MatrixXd& values) {
        auto rows = scratch.shape(values.rows(), values.cols());
        rows = values;
        subtract_from_outputs(range, rows.rightCols<1>().col(0));
        factors[static_cast<std::size_t>(s)].absorb(rows);
      });
    }
    measurements_.release(chunk);
    after_chunk();
  }
}

VectorXd Sweep::squares_one_by_one(const MatrixXd& points,
                                   const std::function<void()>& after_chunk) const {
  const int columns = tables().n_1() + 1;
  std::vector<TriangularFactor> factors(static_cast<std::size_t>(points.cols()),
                                        TriangularFactor(columns));
  bool safe = RowLanes::take(columns);
  if (safe) {
    std::vector<RowLanes> lanes(factors.size(), RowLanes(columns));
    absorb_samples(points, lanes, after_chunk);
    for (std::size_t s = 0; s < factors.size(); ++s) {
      safe = safe && lanes[s].is_safe();
      factors[s] = lanes[s].merge();
    }
  }
  if (!safe) {
    factors.assign(factors.size(), TriangularFactor(columns));
    absorb_samples(points, factors,
                   RowLanes::take(columns) ? std::function<void()>([] {}) : after_chunk);
  }
  VectorXd squares(points.cols());
  for (Index s = 0; s < squares.size(); ++s) {
    const TriangularFactor& factor = factors[static_cast<std::size_t>(s)];
    squares[s] = factor.all_finite() ? remaining_square(factor) : infinity;
  }
  return squares;
}

void Sweep::sample_one_by_one(const MatrixXd& samples, const std::vector<Index>& chosen,
                              VectorXd& squares,
                              const std::function<void(double)>& on_progress) const {
  constexpr Index tile = 25;  // samples that share a block while it is in the cache
  const auto count = static_cast<Index>(chosen.size());
  const Index tiles = (count + tile - 1) / tile;
  Progress progress(on_progress, static_cast<std::size_t>(tiles) * measurements_.chunks().size());
  pool_.for_each(static_cast<std::size_t>(tiles), [&](std::size_t t) {
    const auto first = static_cast<Index>(t) * tile;
    const auto own = std::span(chosen).subspan(
        static_cast<std::size_t>(first), static_cast<std::size_t>(std::min(tile, count - first)));
    const MatrixXd points = samples(Eigen::all, std::vector<Index>(own.begin(), own.end()));
    const VectorXd found = squares_one_by_one(points, [&] { progress.step(); });
    for (std::size_t s = 0; s < own.size(); ++s) squares[own[s]] = found[static_cast<Index>(s)];
  });
}

}  // namespace sepcal::model
