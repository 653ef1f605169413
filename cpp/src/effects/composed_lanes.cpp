// SPDX-License-Identifier: BSD-3-Clause
#include "effects/composed_lanes.hpp"

#include <algorithm>
#include <utility>

namespace sepcal::effects {

using Eigen::Index;
using Eigen::MatrixXd;

ComposedLanes::ComposedLanes(const BlockModel& model, const Tables& tables,
                             const ComposedParts& parts, const LaneBlock& block)
    : model_(model), tables_(tables), parts_(parts), block_(block), width_(model.lane_width()) {
  for (const int input : parts.model_inputs) inputs_.push_back(block.inputs[input]);
  const auto rows = static_cast<Index>(block.rows);
  for (const VaryingPart& part : parts.varying) {
    MatrixXd& values = drives_.emplace_back(rows, part.driver->functions());
    part.driver->evaluate(part.driver_input < 0 ? nullptr : block.inputs[part.driver_input],
                          block.first, 0.0, values, nullptr);
  }
  const Index own_1 = model.tables().n_1();
  std::ptrdiff_t place = 0;
  for (Index j = 0; j < tables.n_z(); ++j) {
    std::vector<std::ptrdiff_t> places(static_cast<std::size_t>(own_1), -1);
    for (Index c = 0; c < own_1; ++c) {
      zero_.push_back(is_left_out(j, c) ? 1 : 0);
      if (zero_.back() != 0) continue;
      places[static_cast<std::size_t>(c)] = place;
      columns_.push_back({.base = place++});
    }
    add_varying(j, places);
    columns_.push_back({.base = place++});  // z - b
  }
}

bool ComposedLanes::is_left_out(Index output, Index column) const {
  return block_.zero != nullptr && block_.zero[output * tables_.n_1() + column] != 0;
}

/// What drivers make of an output's own columns, which stand at `places` of the model's tile.
void ComposedLanes::add_varying(Index output, const std::vector<std::ptrdiff_t>& places) {
  for (std::size_t p = 0; p < parts_.varying.size(); ++p) {
    const VaryingPart& part = parts_.varying[p];
    Index column = part.first;
    for (std::size_t c = 0; c < part.targets.size(); ++c) {
      for (Index f = 0; f < drives_[p].cols(); ++f, ++column) {
        if (is_left_out(output, column)) continue;
        const auto phi = drives_[p].col(f);
        Column made{.factor = std::vector<double>(phi.begin(), phi.end())};
        if (part.targets[c] >= 0) {
          made.base = places[static_cast<std::size_t>(part.targets[c])];
          if (made.base < 0) std::ranges::fill(made.factor, 0.0);
        } else {
          std::vector<double> share(block_.rows, 0.0);
          for (const auto& [shared, input] : part.shares[c]) {
            for (std::size_t i = 0; i < block_.rows && shared == output; ++i) {
              share[i] += block_.inputs[input][i];
            }
          }
          for (std::size_t i = 0; i < block_.rows; ++i) made.factor[i] *= share[i];
        }
        columns_.push_back(std::move(made));
      }
    }
  }
}

LaneBlock ComposedLanes::own_block() const {
  return {inputs_.data(), block_.outputs, block_.rows, block_.first, zero_.data()};
}

std::size_t ComposedLanes::own_size() const {
  const Tables& own = model_.tables();
  return static_cast<std::size_t>(own.n_z() * (own.n_1() + 1)) * block_.rows * width_;
}

void ComposedLanes::fill(const double* own, double* to) const {
  const std::size_t size = block_.rows * width_;
  for (const Column& column : columns_) {
    const double* const base =
        column.base < 0 ? nullptr : own + column.base * static_cast<std::ptrdiff_t>(size);
    if (column.factor.empty()) {
      std::copy_n(base, size, to);
    } else {
      for (std::size_t i = 0; i < block_.rows; ++i) {
        const double factor = column.factor[i];
        for (std::size_t lane = i * width_; lane < (i + 1) * width_; ++lane) {
          to[lane] = base == nullptr ? factor : factor * base[lane];
        }
      }
    }
    to += size;
  }
}

}  // namespace sepcal::effects
