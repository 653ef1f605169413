// SPDX-License-Identifier: BSD-3-Clause
// Neighbourhoods of fits that never took place: a tangent and a residual on rows in segments.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/linearisation.hpp"
#include "numerics/decompositions.hpp"

namespace sepcal::test {

/// Segments one after another, by label and length, and outputs by their scales.
inline diagnosis::RowLayout make_layout(
    const std::vector<std::pair<std::string, std::size_t>>& segments,
    const std::vector<double>& scales) {
  std::vector<Segment> cut;
  std::size_t row = 0;
  for (const auto& [label, length] : segments) {
    cut.push_back({label, row, row + length});
    row += length;
  }
  diagnosis::RowLayout layout{cut, cut, {}, static_cast<Eigen::Index>(row)};
  for (std::size_t j = 0; j < scales.size(); ++j) {
    layout.outputs.push_back({.index = static_cast<int>(j),
                              .name = "z" + std::to_string(j),
                              .unit = "m/s",
                              .scale = scales[j],
                              .weight = scales[j]});
  }
  return layout;
}

/// The least-squares estimate, by a decomposition of its own.
inline Eigen::VectorXd least_squares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& z) {
  return columns.colPivHouseholderQr().solve(z);
}

/// The fit of z = tangent x + noise: what least squares leaves, output by output below each other.
inline diagnosis::LinearisedFit fit_to(const diagnosis::RowLayout& layout,
                                       const Eigen::MatrixXd& tangent, const Eigen::VectorXd& z) {
  diagnosis::LinearisedFit fit{layout, {}, tangent, z - tangent * least_squares(tangent, z)};
  for (Eigen::Index k = 0; k < tangent.cols(); ++k) {
    fit.parameters.push_back("x" + std::to_string(k));
  }
  return fit;
}

}  // namespace sepcal::test
