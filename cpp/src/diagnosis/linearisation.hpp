// SPDX-License-Identifier: BSD-3-Clause
// The neighbourhood of a fit, dense: residual and tangent of every row, output after output, each
// divided by the output's RMSE. What a factor forgets, the order of rows, is what noise models and
// held-out rows need.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/record.hpp"

namespace sepcal::diagnosis {

/// An output whose residual is not zero.
struct UsedOutput {
  int index = 0;  // among the model's
  std::string name;
  std::string unit;
  double scale = 1.0;     // RMSE of its residual, which all its rows are divided by
  double weight = 1.0;    // of a scaled row in errors over all outputs: the scale, or 1 where the
                          // outputs have different units
  double variance = 0.0;  // of what is measured about its mean, in the unit's square
};

/// Where rows stand: N of each output, segment after segment, one output below the other.
struct RowLayout {
  std::vector<Segment> segments = {};  // among the N rows
  std::vector<Segment> runs = {};      // the same rows, cut where there are gaps: as noise runs
  std::vector<UsedOutput> outputs = {};
  Eigen::Index rows = 0;  // N

  Eigen::Index count() const { return static_cast<Eigen::Index>(outputs.size()) * rows; }
  /// The rows of the j-th used output.
  Eigen::Index first(std::size_t j) const { return static_cast<Eigen::Index>(j) * rows; }
};

/// Of errors over all outputs; empty where these have different units.
inline std::string common_unit(const RowLayout& layout) {
  const auto& outputs = layout.outputs;
  for (const UsedOutput& output : outputs) {
    if (output.unit != outputs.front().unit) return {};
  }
  return outputs.empty() ? std::string() : outputs.front().unit;
}

struct LinearisedFit {
  RowLayout layout;
  std::vector<std::string> parameters;  // estimated and not at a bound: the columns of `tangent`
  Eigen::MatrixXd tangent;              // count() x parameters, or a basis in its place
  Eigen::VectorXd residual;             // count(), z - model
  Eigen::MatrixXd input_drift = {};     // count() x corrections that may wander, of unit size
  std::vector<double> times = {};       // of the N rows [s]; none where nothing wanders
  bool follows_path = false;            // rows follow from those before them
  // Of an orthonormal basis in the tangent's place, else empty:
  Eigen::MatrixXd weights = {};      // parameters x rank, it is the tangent times these
  Eigen::MatrixXd coordinates = {};  // rank x parameters, the tangent is it times these
};

}  // namespace sepcal::diagnosis
