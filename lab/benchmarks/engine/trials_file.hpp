// SPDX-License-Identifier: BSD-3-Clause
// Trials of one design of scalar example 1, z = (1 + a) cos(eta + b) + c, as
// lab/benchmarks/small_fits.py writes them: how many, their rows, eta, then z trial by trial.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace benchmark {

/// A view of `numbers`, which must outlive it.
struct TrialsFile {
  explicit TrialsFile(const std::vector<double>& numbers)
      : trials(static_cast<std::size_t>(numbers[0])),
        rows(static_cast<std::size_t>(numbers[1])),
        eta(numbers.data() + 2, rows) {}

  std::span<const double> z(std::size_t trial) const {
    return {eta.data() + rows * (trial + 1), rows};
  }

  std::size_t trials;
  std::size_t rows;
  std::span<const double> eta;
};

}  // namespace benchmark
