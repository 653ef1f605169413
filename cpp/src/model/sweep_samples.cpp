// SPDX-License-Identifier: BSD-3-Clause
// The pass that many points of xi2 share.
#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "base/stop.hpp"
#include "model/point_lanes.hpp"
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

void Sweep::sample_one_by_one(const MatrixXd& samples, const std::vector<Index>& chosen,
                              VectorXd& squares,
                              const std::function<void(double)>& on_progress) const {
  constexpr std::size_t tile = 25;  // samples that share a block while it is in the cache
  const std::size_t tiles = (chosen.size() + tile - 1) / tile;
  const auto& chunks = measurements_.chunks();
  Progress progress(on_progress, tiles * chunks.size());
  pool_.for_each(tiles, [&](std::size_t t) {
    const std::size_t first = t * tile;
    const std::size_t count = std::min(tile, chosen.size() - first);
    std::vector<std::unique_ptr<Carry>> carries;
    std::vector<TriangularFactor> factors(count, TriangularFactor(tables().n_1() + 1));
    MatrixXd points(samples.rows(), static_cast<Index>(count));
    for (std::size_t s = 0; s < count; ++s) {
      carries.push_back(model_.new_carry());
      points.col(static_cast<Index>(s)) = samples.col(chosen[first + s]);
    }
    std::vector<const double*> pointers;
    MatrixXd scratch;
    for (const auto& chunk : chunks) {
      for (const Measurements::Range& range : chunk) {
        base::heed_stop();
        const Block block = measurements_.block(range, pointers);
        model_.evaluate_points(block, points, carries, scratch, [&](Index s, MatrixXd& rows) {
          subtract_from_outputs(range, rows.rightCols<1>().col(0));
          factors[static_cast<std::size_t>(s)].absorb(rows);
        });
      }
      progress.step();
    }
    for (std::size_t s = 0; s < count; ++s) {
      squares[chosen[first + s]] =
          factors[s].all_finite() ? remaining_square(factors[s]) : infinity;
    }
  });
}

}  // namespace sepcal::model
