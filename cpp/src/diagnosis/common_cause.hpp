// SPDX-License-Identifier: BSD-3-Clause
// Do outputs that should be independent move together, all along or for a while? In every window
// the sum of two outputs' products over the root of their squares, a correlation that is a standard
// normal number where the signs of rows are chance, however the sizes come and go.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "diagnosis/nested_windows.hpp"

namespace sepcal::diagnosis {

struct CommonCause {
  double p_value = 1.0;              // corrected for pairs and windows; at least 0.001
  std::vector<std::size_t> outputs;  // that move together: at least two, else there is no test
  Window strongest = {};             // where they do so most
  double share = 0.0;  // of the two's squares there that goes together: their correlation
  Eigen::VectorXd together = {};  // the sum of the two that do so most, the signs made equal
};

/// `white`: whitened residuals, rows x outputs. The largest correlation is held against sets
/// of signs that are drawn output by output: 999, or until twenty are as strong (Besag & Clifford,
/// Sequential Monte Carlo p-values, Biometrika 78, 1991).
CommonCause find_common_cause(const Eigen::MatrixXd& white, std::uint64_t seed);

}  // namespace sepcal::diagnosis
