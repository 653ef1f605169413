// SPDX-License-Identifier: BSD-3-Clause
// Passes over a record: the rows that a model gives for every block, reduced to one triangular
// factor an output or to sums. Chunks are reduced apart and merged in the record's order, so that
// the result is the same, bit for bit, on any number of threads.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <functional>
#include <vector>

#include "base/aligned_doubles.hpp"
#include "base/thread_pool.hpp"
#include "model/loss.hpp"
#include "model/measurements.hpp"
#include "model/pass_memory.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/passes.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::model {

/// Rows of a block, where registers of any width load them.
class RowScratch {
 public:
  Eigen::Map<Eigen::MatrixXd> shape(Eigen::Index rows, Eigen::Index columns) {
    values_.resize(static_cast<std::size_t>(rows * columns));
    return {values_.data(), rows, columns};
  }

 private:
  base::AlignedDoubles values_;
};

class Sweep {
 public:
  /// All three must outlive the sweep.
  Sweep(const BlockModel& model, const Measurements& measurements, base::ThreadPool& pool)
      : model_(model), measurements_(measurements), pool_(pool) {}

  const Tables& tables() const { return model_.tables(); }
  const Measurements& measurements() const { return measurements_; }
  base::ThreadPool& pool() const { return pool_; }

  /// Those that were made so far.
  Passes passes() const { return {values_passes_, tangent_passes_}; }

  /// [A | z - b] at xi2: n_z factors of n_1 + 1 columns.
  std::vector<TriangularFactor> linear_factors(const Eigen::VectorXd& xi2) const;

  /// [A | D | r] at (xi1, xi2), r = z - A xi1 - b: n_z factors of n_1 + n_2 + 1 columns.
  std::vector<TriangularFactor> tangent_factors(const Eigen::VectorXd& xi1,
                                                const Eigen::VectorXd& xi2) const;

  /// The same of rows multiplied by sqrt(w(s)), s = weights_j r, and of one row more, whose
  /// residual makes the square of the last column sum rho(s) / weights_j^2: still not whitened.
  std::vector<TriangularFactor> forgiving_factors(const Eigen::VectorXd& xi1,
                                                  const Eigen::VectorXd& xi2,
                                                  const RobustLoss& loss,
                                                  const Eigen::VectorXd& weights) const;

  /// G by output (n_z, each n_1 x n_2), not whitened: G_pi = sum of r dA_p/dxi2_i over the rows, r
  /// at (xi1, xi2). D is affine in xi1, so that n_1 + 1 more tangents give it, of any model.
  std::vector<Eigen::MatrixXd> slope_products(const Eigen::VectorXd& xi1,
                                              const Eigen::VectorXd& xi2) const;

  /// [A | D | r] at (xi1, xi2) of every selected row, output by output (n_z matrices of rows() rows
  /// in the record's order): what depends on the order of rows, which a factor forgets.
  std::vector<Eigen::MatrixXd> tangent_rows(const Eigen::VectorXd& xi1,
                                            const Eigen::VectorXd& xi2) const;

  /// Some of those columns, one output below the other: n_z rows() x columns.
  Eigen::MatrixXd tangent_columns(const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2,
                                  const std::vector<Eigen::Index>& columns) const;

  /// Sum of r^2 by output (n_z).
  Eigen::VectorXd squared_residuals(const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2) const;

  /// Sum of rho(weights_j r) by output (n_z).
  Eigen::VectorXd losses(const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2,
                         const RobustLoss& loss, const Eigen::VectorXd& weights) const;

  /// What a row of output j is multiplied by, of its residual.
  using RowWeight = std::function<double(Eigen::Index j, double r)>;

  /// [A | D | r] at (xi1, xi2) of the rows cuts[b] <= row < cuts[b + 1], b = 0, 1, ...: n_z factors
  /// for each, all rows among them; multiplied by `weight`, where there is one.
  std::vector<std::vector<TriangularFactor>> stretch_factors(const Eigen::VectorXd& xi1,
                                                             const Eigen::VectorXd& xi2,
                                                             const std::vector<Eigen::Index>& cuts,
                                                             const RowWeight& weight = {}) const;

  /// r of some rows at a time (rows x n_z), in the record's order.
  void for_each_residual(const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2,
                         const std::function<void(const Eigen::MatrixXd& r)>& visit) const;

  /// r of every selected row, in the record's order: rows() x n_z.
  Eigen::MatrixXd residuals(const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2) const;

  /// The sum of squares that the best xi1 leaves, all outputs unweighted, at every column of
  /// `samples` (n_2 x S); infinite where the model is not finite. A block of data stays in the
  /// cache while all samples pass over it. `on_progress` hears the fraction done, from any thread,
  /// one call at a time.
  Eigen::VectorXd sample_squares(const Eigen::MatrixXd& samples,
                                 const std::function<void(double)>& on_progress) const;

 private:
  using Visit = std::function<void(std::size_t chunk, const Measurements::Range& range,
                                   const Block& block, Carry* carry, RowScratch& scratch)>;

  using AfterChunk = std::function<void(std::size_t chunk)>;

  /// Visits every block, a chunk's blocks in order; `scratch` is the chunk's own. At a chunk's end,
  /// in the same thread, `after_chunk`.
  void for_each_block(const Visit& visit, const AfterChunk& after_chunk = {}) const;

  /// visit(j, offset, rows): [A | D | r] of output j in the rows of a block, `offset` rows before.
  template <class VisitRows>
  void for_each_tangent(const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2,
                        const VisitRows& visit) const;

  /// Sums over the rows by output (n_z) of what `of_block` makes of a block's r (rows x n_z).
  Eigen::VectorXd sum_residuals(
      const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2,
      const std::function<Eigen::VectorXd(const Eigen::MatrixXd&)>& of_block) const;

  /// One factor an output of the rows that `fill` makes of every block.
  using FillRows = std::function<void(const Block& block, const Measurements::Range& range,
                                      Carry* carry, Eigen::Ref<Eigen::MatrixXd> rows)>;
  std::vector<TriangularFactor> factor_blocks(int columns, const FillRows& fill) const;

  /// What sample_squares() gives of the chosen samples, each evaluated by itself.
  void sample_one_by_one(const Eigen::MatrixXd& samples, const std::vector<Eigen::Index>& chosen,
                         Eigen::VectorXd& squares,
                         const std::function<void(double)>& on_progress) const;

  /// The same of a few points, behind one another over each block.
  Eigen::VectorXd squares_one_by_one(const Eigen::MatrixXd& points,
                                     const std::function<void()>& after_chunk) const;
  template <class Factor>
  void absorb_samples(const Eigen::MatrixXd& points, std::vector<Factor>& factors,
                      const std::function<void()>& after_chunk) const;

  /// A block's rows, (n_z * rows) x (n_1 + 1): [A | z - b].
  void fill_linear(const Block& block, const Measurements::Range& range, const double* xi2,
                   Carry* carry, Eigen::Ref<Eigen::MatrixXd> rows) const;
  /// r of a block, its rows x n_z.
  Eigen::MatrixXd block_residuals(const Block& block, const Measurements::Range& range,
                                  const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2,
                                  Carry* carry, RowScratch& scratch) const;
  /// A block's rows, (n_z * rows) x (n_1 + n_2 + 1): [A | D | r].
  void fill_tangent(const Block& block, const Measurements::Range& range,
                    const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2, Carry* carry,
                    Eigen::Ref<Eigen::MatrixXd> rows) const;
  void subtract_from_outputs(const Measurements::Range& range,
                             Eigen::Ref<Eigen::VectorXd> values) const;

  const BlockModel& model_;
  const Measurements& measurements_;
  base::ThreadPool& pool_;
  mutable PassMemory linear_memory_;
  mutable PassMemory tangent_memory_;
  mutable std::atomic<int> values_passes_ = 0;
  mutable std::atomic<int> tangent_passes_ = 0;
};

}  // namespace sepcal::model
