// SPDX-License-Identifier: BSD-3-Clause
#include "many/trial_design.hpp"

#include <algorithm>

namespace sepcal::many {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TrialDesign::TrialDesign(const BlockModel& model, const model::Measurements& rows,
                         const std::vector<TrialOutput>& outputs, std::size_t trials)
    : model_(model),
      rows_(rows),
      trials_(trials),
      length_(outputs.front().values.size() / trials),
      prepared_(rows.rows() * model.prepared_bytes() / sizeof(double) + 1) {
  for (const Variable& output : model.tables().outputs) {
    outputs_.push_back(std::ranges::find(outputs, output.name, &TrialOutput::name)->values.data());
  }
  std::vector<const double*> pointers;
  for_each_range([&](const model::Measurements::Range& range) {
    auto* const to = reinterpret_cast<std::byte*>(prepared_.data());  // NOLINT: as prepared()
    model_.prepare_rows(rows_.block(range, pointers), to + range.offset * model_.prepared_bytes());
  });
}

template <class Visit>
void TrialDesign::for_each_range(const Visit& visit) const {
  for (const auto& chunk : rows_.chunks()) {
    for (const model::Measurements::Range& range : chunk) visit(range);
  }
}

double TrialDesign::gather(std::size_t trial, double* to, std::size_t step) const {
  double square = 0.0;
  for (std::size_t j = 0; j < outputs_.size(); ++j) {
    const double* const z = outputs_[j] + trial * length_;
    for_each_range([&](const model::Measurements::Range& range) {
      double* own = to + (j * rows() + range.offset) * step;
      for (std::size_t row = range.first; row < range.first + range.rows; ++row, own += step) {
        *own = z[row];
        square += z[row] * z[row];
      }
    });
  }
  return square;
}

MatrixXd TrialDesign::evaluate(const VectorXd& xi2) const {
  const auto n_z = static_cast<Index>(outputs());
  const auto N = static_cast<Index>(rows());
  MatrixXd whole(n_z * N, model_.tables().n_1() + 1);
  MatrixXd own;
  std::vector<const double*> pointers;
  for_each_range([&](const model::Measurements::Range& range) {
    const auto count = static_cast<Index>(range.rows);
    own.resize(n_z * count, whole.cols());
    model_.evaluate(rows_.block(range, pointers), values_of(xi2), nullptr, nullptr, own);
    for (Index j = 0; j < n_z; ++j) {
      whole.middleRows(j * N + static_cast<Index>(range.offset), count) =
          own.middleRows(j * count, count);
    }
  });
  return whole;
}

}  // namespace sepcal::many
