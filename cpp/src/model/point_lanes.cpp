// SPDX-License-Identifier: BSD-3-Clause
#include "model/point_lanes.hpp"

#include <algorithm>

#include "base/aligned_doubles.hpp"

namespace sepcal::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

using base::AlignedDoubles;

/// Of a record, a few rows at a time.
template <class Visit>
void for_each_lane_block(const Measurements& measurements, const Measurements::Range& range,
                         std::size_t outputs, const Visit& visit) {
  std::vector<const double*> pointers;
  for (std::size_t row = 0; row < range.rows; row += most_lane_rows) {
    Measurements::Range part = range;
    part.first += row;
    part.rows = std::min(most_lane_rows, range.rows - row);
    const Block block = measurements.block(part, pointers);
    std::vector<const double*> measured;
    for (std::size_t j = 0; j < outputs; ++j) {
      measured.push_back(measurements.output(static_cast<int>(j), part).data());
    }
    visit(LaneBlock{block.inputs.data(), measured.data(), part.rows, part.first});
  }
}

/// Points by tile, parameter and lane; the last tile is filled up with its first point.
AlignedDoubles pack(const MatrixXd& points, std::size_t tiles, std::size_t width) {
  AlignedDoubles packed;
  packed.reserve(tiles * width * static_cast<std::size_t>(points.rows()));
  for (std::size_t t = 0; t < tiles; ++t) {
    for (Index k = 0; k < points.rows(); ++k) {
      for (std::size_t lane = 0; lane < width; ++lane) {
        const auto point = static_cast<Index>(t * width + lane);
        packed.push_back(points(k, point < points.cols() ? point : static_cast<Index>(t * width)));
      }
    }
  }
  return packed;
}

}  // namespace

PointLanes::PointLanes(const BlockModel& model, const Measurements& measurements,
                       const MatrixXd& points)
    : model_(model), measurements_(measurements), width_(model.lane_width()) {
  if (width_ == 0 || points.cols() == 0) {
    width_ = 0;
    return;
  }
  kit_ = lanes::lane_kit_of(width_);
  find_zeros(points);
  const auto most = std::ranges::max(kept_, {}, [](const auto& columns) { return columns.size(); });
  if (kit_ == nullptr || most.size() > lanes::most_columns) width_ = 0;
}

/// In a block of every chunk, at two points.
void PointLanes::find_zeros(const MatrixXd& points) {
  const Tables& tables = model_.tables();
  const Index n_1 = tables.n_1();
  const Index n_z = tables.n_z();
  MatrixXd largest = MatrixXd::Zero(n_1, n_z);
  std::vector<const double*> pointers;
  for (const auto& chunk : measurements_.chunks()) {
    const Measurements::Range& range = chunk.back();
    const auto rows = static_cast<Index>(range.rows);
    MatrixXd values(n_z * rows, n_1 + 1);
    for (const Index point : {Index{0}, points.cols() - 1}) {
      model_.evaluate(measurements_.block(range, pointers), points.col(point).data(), nullptr,
                      nullptr, values);
      for (Index j = 0; j < n_z; ++j) {
        const auto own = values.block(j * rows, 0, rows, n_1);
        for (Index c = 0; c < n_1; ++c) {
          if (!(own.col(c).array() == 0.0).all()) largest(c, j) = 1.0;
        }
      }
    }
  }
  for (Index j = 0; j < n_z; ++j) {
    std::vector<Index> kept;
    for (Index c = 0; c < n_1; ++c) {
      zero_.push_back(largest(c, j) == 0.0 ? 1 : 0);
      if (zero_.back() == 0) kept.push_back(c);
    }
    kept.push_back(n_1);
    kept_.push_back(std::move(kept));
  }
}

std::vector<std::optional<TriangularFactor>> PointLanes::factor(
    const MatrixXd& points, const std::function<void()>& after_chunk) const {
  const std::size_t outputs = kept_.size();
  const Index columns = model_.tables().n_1() + 1;
  const auto count = static_cast<std::size_t>(points.cols());
  const std::size_t tiles = (count + width_ - 1) / width_;
  const AlignedDoubles packed = pack(points, tiles, width_);
  AlignedDoubles scratch(outputs * static_cast<std::size_t>(columns) * most_lane_rows * width_);
  std::vector<std::size_t> begins{0};  // of each output's factor, within a tile's
  for (const auto& kept : kept_)
    begins.push_back(begins.back() + kept.size() * kept.size() * width_);
  AlignedDoubles factors(tiles * begins.back(), 0.0);
  std::vector<bool> safe(tiles, true);
  bool zeros_hold = true;
  for (const auto& chunk : measurements_.chunks()) {
    for (const Measurements::Range& range : chunk) {
      for_each_lane_block(measurements_, range, outputs, [&](LaneBlock block) {
        block.zero = zero_.data();
        const auto absorb = [&](std::size_t tile, double* rows) {
          for (std::size_t j = 0; j < outputs; ++j) {
            double* T = factors.data() + tile * begins.back() + begins[j];
            if (!kit_->absorb[kept_[j].size()](T, rows, block.rows, block.rows * width_))
              safe[tile] = false;
            rows += kept_[j].size() * block.rows * width_;
          }
        };
        if (!model_.evaluate_lanes(block, {packed.data(), tiles}, scratch.data(), absorb)) {
          zeros_hold = false;
        }
      });
    }
    after_chunk();
  }
  std::vector<std::optional<TriangularFactor>> result(count);
  for (std::size_t point = 0; point < count; ++point) {
    const std::size_t tile = point / width_;
    if (!zeros_hold || !safe[tile]) continue;
    TriangularFactor whole(static_cast<int>(columns));
    for (std::size_t j = 0; j < outputs; ++j) {
      const auto n = static_cast<Index>(kept_[j].size());
      const double* T = factors.data() + tile * begins.back() + begins[j] + point % width_;
      MatrixXd rows = MatrixXd::Zero(n, columns);
      for (Index i = 0; i < n; ++i) {
        for (Index c = i; c < n; ++c) {
          rows(i, kept_[j][static_cast<std::size_t>(c)]) =
              T[static_cast<std::size_t>(i * n + c) * width_];
        }
      }
      whole.absorb(rows);
    }
    if (whole.all_finite()) result[point] = std::move(whole);
  }
  return result;
}

}  // namespace sepcal::model
