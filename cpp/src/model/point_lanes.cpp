// SPDX-License-Identifier: BSD-3-Clause
#include "model/point_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/aligned_doubles.hpp"
#include "base/stop.hpp"
#include "numerics/plain_pivot.hpp"

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
    part.kept = Measurements::Range::nowhere;
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

/// In a block of every chunk and where a segment starts, at two points.
void PointLanes::find_zeros(const MatrixXd& points) {
  const Tables& tables = model_.tables();
  const Index n_1 = tables.n_1();
  const Index n_z = tables.n_z();
  zero_.assign(static_cast<std::size_t>(n_z * n_1), 1);
  std::vector<const double*> pointers;
  for (const auto& chunk : measurements_.chunks()) {
    for (const Measurements::Range& range : chunk) {
      if (!range.starts_segment && &range != &chunk.back()) continue;
      const auto rows = static_cast<Index>(range.rows);
      MatrixXd values(n_z * rows, n_1 + 1);
      for (const Index point : {Index{0}, points.cols() - 1}) {
        model_.evaluate(measurements_.block(range, pointers), points.col(point).data(), nullptr,
                        nullptr, values);
        for (Index j = 0; j < n_z; ++j) {
          const auto own = values.block(j * rows, 0, rows, n_1);
          for (Index c = 0; c < n_1; ++c) {
            if (!(own.col(c).array() == 0.0).all())
              zero_[static_cast<std::size_t>(j * n_1 + c)] = 0;
          }
        }
      }
    }
    measurements_.release(chunk);
  }
  for (Index j = 0; j < n_z; ++j) {
    std::vector<Index> kept;
    for (Index c = 0; c < n_1; ++c) {
      if (zero_[static_cast<std::size_t>(j * n_1 + c)] == 0) kept.push_back(c);
    }
    kept.push_back(n_1);
    kept_.push_back(std::move(kept));
  }
}

bool PointLanes::merge(const double* by_output, double* merged) const {
  const auto columns = static_cast<std::size_t>(model_.tables().n_1()) + 1;
  bool safe = true;
  AlignedDoubles rows;
  std::vector<TriangularFactor> wide(columns > lanes::most_columns ? width_ : 0,
                                     TriangularFactor(static_cast<int>(columns)));
  for (const auto& kept : kept_) {
    const std::size_t n = kept.size();
    rows.assign(columns * n * width_, 0.0);
    for (std::size_t c = 0; c < n; ++c) {
      double* const column = rows.data() + static_cast<std::size_t>(kept[c]) * n * width_;
      for (std::size_t i = 0; i <= c; ++i) {
        std::copy_n(by_output + (i * n + c) * width_, width_, column + i * width_);
      }
    }
    by_output += n * n * width_;
    if (wide.empty()) {
      const lanes::Panel panel = lanes::stack_panel(*kit_, columns, merged, rows.data(), n);
      safe = lanes::absorb_panels(*kit_, {&panel, 1}, n) && safe;
      continue;
    }
    using Strided = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
    const auto step = static_cast<Index>(width_);
    const auto m = static_cast<Index>(n);
    for (std::size_t lane = 0; lane < width_; ++lane) {
      MatrixXd own = Eigen::Map<const MatrixXd, 0, Strided>(
          rows.data() + lane, m, static_cast<Index>(columns), Strided(m * step, step));
      wide[lane].absorb(own);
    }
  }
  for (std::size_t lane = 0; lane < wide.size(); ++lane) {
    for (std::size_t i = 0; i < columns; ++i) {
      for (std::size_t c = 0; c < columns; ++c) {
        merged[(i * columns + c) * width_ + lane] =
            wide[lane].matrix()(static_cast<Index>(i), static_cast<Index>(c));
      }
    }
  }
  return safe;
}

PointFactors PointLanes::factor(const MatrixXd& points,
                                const std::function<void()>& after_chunk) const {
  const std::size_t outputs = kept_.size();
  const auto columns = static_cast<std::size_t>(model_.tables().n_1()) + 1;
  const auto count = static_cast<std::size_t>(points.cols());
  const std::size_t tiles = (count + width_ - 1) / width_;
  const AlignedDoubles packed = pack(points, tiles, width_);
  AlignedDoubles scratch(outputs * columns * most_lane_rows * width_);
  std::vector<std::size_t> begins{0};  // of each output's factor, within a tile's
  for (const auto& kept : kept_)
    begins.push_back(begins.back() + kept.size() * kept.size() * width_);
  AlignedDoubles factors(tiles * begins.back(), 0.0);
  std::vector<bool> clear(tiles, true);
  std::vector<lanes::Panel> panels(outputs);
  bool zeros_hold = true;
  for (const auto& chunk : measurements_.chunks()) {
    for (const Measurements::Range& range : chunk) {
      for_each_lane_block(measurements_, range, outputs, [&](LaneBlock block) {
        base::heed_stop();
        block.zero = zero_.data();
        const auto absorb = [&](std::size_t tile, double* rows) {
          for (std::size_t j = 0; j < outputs; ++j) {
            double* T = factors.data() + tile * begins.back() + begins[j];
            panels[j] = lanes::stack_panel(*kit_, kept_[j].size(), T, rows, block.rows);
            rows += kept_[j].size() * block.rows * width_;
          }
          if (!lanes::absorb_panels(*kit_, panels, block.rows)) clear[tile] = false;
        };
        if (!model_.evaluate_lanes(block, {packed.data(), tiles}, scratch.data(), absorb)) {
          zeros_hold = false;
        }
      });
    }
    measurements_.release(chunk);
    after_chunk();
  }
  AlignedDoubles merged(tiles * columns * columns * width_, 0.0);
  for (std::size_t t = 0; t < tiles; ++t) {
    double* const T = merged.data() + t * columns * columns * width_;
    if (!zeros_hold || !merge(factors.data() + t * begins.back(), T)) clear[t] = false;
  }
  return {std::move(merged), std::move(clear), static_cast<int>(columns), width_};
}

std::optional<TriangularFactor> PointFactors::factor(std::size_t point) const {
  if (!clear_[point / width_]) return {};
  MatrixXd rows = MatrixXd::Zero(n_, n_);
  for (int i = 0; i < n_; ++i) {
    for (int c = i; c < n_; ++c) rows(i, c) = entry(point, i, c);
  }
  TriangularFactor factor(n_);
  factor.absorb(rows);
  if (!factor.all_finite()) return {};
  return factor;
}

double PointFactors::remaining_square(std::size_t point) const {
  if (!clear_[point / width_]) return not_a_number;
  for (int c = 0; c + 1 < n_; ++c) {
    double square = 0.0;
    for (int i = 0; i <= c; ++i) square += entry(point, i, c) * entry(point, i, c);
    const double pivot = std::abs(entry(point, c, c));
    if (!(pivot > numerics::smallest_plain_pivot * std::sqrt(square))) return not_a_number;
  }
  const double last = entry(point, n_ - 1, n_ - 1);
  return last * last;
}

}  // namespace sepcal::model
