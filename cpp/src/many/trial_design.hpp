// SPDX-License-Identifier: BSD-3-Clause
// What trials share, their rows, and what each has of its own, z.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "base/aligned_doubles.hpp"
#include "model/measurements.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/fit_trials.hpp"

namespace sepcal::many {

class TrialDesign {
 public:
  /// `rows`: the design's, for `model`, whose own outputs are not looked at. `outputs` has each of
  /// the model's outputs. All must outlive this.
  TrialDesign(const BlockModel& model, const model::Measurements& rows,
              const std::vector<TrialOutput>& outputs, std::size_t trials);

  const BlockModel& model() const { return model_; }
  std::size_t rows() const { return rows_.rows(); }        // N
  std::size_t outputs() const { return outputs_.size(); }  // n_z
  std::size_t trials() const { return trials_; }           // K

  /// What the model's lanes need of the rows from `row` on.
  const void* prepared(std::size_t row) const {
    return reinterpret_cast<const std::byte*>(prepared_.data()) +  // NOLINT: bytes of the model's
           row * model_.prepared_bytes();
  }

  /// A trial's z, output after output, `step` values from one to the next. Returns the sum of
  /// squares: not finite where z isn't.
  double gather(std::size_t trial, double* to, std::size_t step = 1) const;

  /// [A | b] at xi2, (n_z N) x (n_1 + 1), in the order of gather().
  Eigen::MatrixXd evaluate(const Eigen::VectorXd& xi2) const;

 private:
  template <class Visit>
  void for_each_range(const Visit& visit) const;

  const BlockModel& model_;
  const model::Measurements& rows_;
  std::size_t trials_;
  std::vector<const double*> outputs_;  // n_z, each K x length
  std::size_t length_;                  // of the record
  base::AlignedDoubles prepared_;
};

}  // namespace sepcal::many
