// SPDX-License-Identifier: BSD-3-Clause
// The narrow waist: a model as everything below sees it. It is asked for whole blocks of samples
// and answers with the rows [A | D | b]; how it came to be makes no difference from
// here on.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/lane_kernel.hpp"
#include "sepcal/detail/tables.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// Consecutive samples of one segment of a record. A block never crosses a segment's edge. An input
/// that is derived from others (a rate of change, a delayed channel) is a column like any other:
/// the record computes it, within a segment, before a model sees it.
struct Block {
  std::span<const double* const> inputs;  // n_u columns, each `rows` values long
  std::size_t rows = 0;
  std::size_t first = 0;       // the record's row at which the block begins
  bool starts_segment = true;  // no history before this block's first row
  const void* kept = nullptr;  // what keep_rows() made of just these inputs, or nullptr
};

/// What a trajectory model carries from block to block. Plain models have none.
class Carry {
 public:
  Carry() = default;
  Carry(const Carry&) = delete;
  Carry& operator=(const Carry&) = delete;
  virtual ~Carry() = default;
};

class Enclosure;        // enclosure.hpp
struct EnclosedRows;    // the same
class InnovationModel;  // innovation_model.hpp

/// Where the values of x begin, never nullptr: to evaluate(), a null xi1 means "no tangent asked
/// for", which an empty xi1 (n_1 = 0) is not.
inline const double* values_of(const Eigen::VectorXd& x) {
  static constexpr double none = 0.0;
  return x.size() > 0 ? x.data() : &none;
}

class BlockModel {
 public:
  explicit BlockModel(Tables tables);  // throws Error where names clash
  BlockModel(const BlockModel&) = delete;
  BlockModel& operator=(const BlockModel&) = delete;
  virtual ~BlockModel() = default;

  const Tables& tables() const { return tables_; }

  /// Fills `rows`, (n_z * block.rows) x (n_1 + 1) with [A | b], or, where xi1 is given,
  /// (n_z * block.rows) x (n_1 + n_2 + 1) with [A | D | b], D = d(A xi1 + b)/d xi2.
  /// Output j takes the rows from j * block.rows on.
  ///   xi2    n_2 values
  ///   xi1    n_1 values (values_of()), or nullptr for [A | b] alone
  ///   carry  what new_carry() gave for this pass, or nullptr where it gave none
  /// Pure but for `carry`: called from several threads at once.
  virtual void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                        Eigen::Ref<Eigen::MatrixXd> rows) const = 0;

  /// What evaluate() without xi1 gives at each of several points (n_2 x S), each with a carry of
  /// its own: `visit` sees one point's rows after the other's. Overridden where they come faster
  /// together. `scratch` may hold the rows.
  using VisitRows = std::function<void(Eigen::Index point, Eigen::MatrixXd& rows)>;
  virtual void evaluate_points(const Block& block, const Eigen::MatrixXd& points,
                               std::span<const std::unique_ptr<Carry>> carries,
                               Eigen::MatrixXd& scratch, const VisitRows& visit) const;

  /// Bytes that keep_rows() writes of a block of so many rows; 0 where nothing is worth keeping.
  virtual std::size_t kept_bytes(std::size_t rows) const;

  /// What of a block depends on u alone, to `to`, aligned to 64 bytes: evaluate() is faster where
  /// the block has it.
  virtual void keep_rows(const Block& block, void* to) const;

  /// Lanes of evaluate_lanes(); 0 where points can't be evaluated side by side.
  virtual std::size_t lane_width() const { return 0; }

  /// What evaluate() without xi1 gives at many points, z - b in the place of b: `visit` sees tile
  /// after tile as TileVisit does. Returns whether all that was left out is zero. `scratch`,
  /// aligned to 64 bytes, has room for a tile of [A | b] without anything left out.
  using VisitTile = std::function<void(std::size_t tile, double* rows)>;
  virtual bool evaluate_lanes(const LaneBlock& block, const PointTiles& points, double* scratch,
                              const VisitTile& visit) const;

  /// Bytes that prepare_rows() writes of a row; 0 where fill_trials() can't be asked. There its
  /// lanes are lane_width().
  virtual std::size_t prepared_bytes() const { return 0; }

  /// What of a block depends on u alone, to `to`, aligned to 64 bytes.
  virtual void prepare_rows(const Block& block, void* to) const;

  /// [A | D | z - A xi1 - b] of many trials side by side, as LaneKernel::fill_trials gives it.
  virtual void fill_trials(const TrialRows& trials, double* to) const;

  /// Fills `columns`, (n_z * block.rows) x inputs.size(), with d(A xi1 + b)/du_i of the chosen
  /// inputs, by their index in tables().inputs: what an effect that corrects an input needs. Unless
  /// overridden by fourth-order differences. Throws Error where the model can't be differentiated
  /// by its inputs, as one that carries a state.
  virtual void input_tangent(const Block& block, const double* xi2, const double* xi1,
                             std::span<const int> inputs,
                             Eigen::Ref<Eigen::MatrixXd> columns) const;

  /// Adds to `sum`, n_2 x n_2, the second derivatives by xi2 of A xi1 + b, summed over the block's
  /// rows and all outputs, what Eq. 18 asks for. False, and nothing added, where the model doesn't
  /// know them: they then come from differences of the tangent.
  virtual bool add_second_derivatives(const Block& block, const double* xi2, const double* xi1,
                                      Eigen::Ref<Eigen::MatrixXd> sum) const;

  /// Ranges of [A | b] and of its derivatives by xi2 (n_2) wherever that is within these ranges, to
  /// `rows`: rounded outwards, so that what is shown of them is proven. Of output j the rows from
  /// j * block.rows on. False where the model can't tell.
  virtual bool enclose(const Block& block, std::span<const Enclosure> xi2,
                       EnclosedRows& rows) const;

  /// Points of xi2 (n_2 x any number, none unless overridden) that a closed form makes of the
  /// measurements, u of shape (rows, n_u) and z of shape (rows, n_z): stage one descends from them
  /// too, where a narrow basin slips between its samples. They may lie beyond the bounds.
  virtual Eigen::MatrixXd guess(const Eigen::MatrixXd& u, const Eigen::MatrixXd& z) const;

  /// Where nonlinear parameters begin that the record itself tells, by name, as the initial states
  /// of a trajectory; none unless overridden. A fit starts them there, unless its options say
  /// otherwise, and stage one doesn't sample them.
  virtual std::map<std::string, double> starting_values(const Record& record) const;

  /// Parameters on which nothing in this record depends, as initial states of segments that are
  /// left out; none unless overridden.
  virtual std::vector<std::string> idle_parameters(const Record& record) const;

  /// The factor by which a small error of a state grows along the trajectory where it grows most,
  /// at parameters (n); 1 of a model without a state.
  virtual double growth(const Record& record, const Eigen::VectorXd& xi) const;

  /// The longest step of integration times the fastest rate of the dynamics there, at parameters
  /// (n); 0 of a model that integrates nothing.
  virtual double coarseness(const Record& record, const Eigen::VectorXd& xi) const;

  /// The noises that drive a state; none of a model without one.
  virtual std::span<const Variable> process_noises() const { return {}; }

  /// The covariance (n x n) of the score J' R^-1 e, at parameters (n), where e is what process
  /// noise makes of the outputs along trajectories that know nothing of it; zero of a model without
  /// a state. `noise`: the outputs' deviations (n_z). `density`: of each process noise the root of
  /// its spectral density (process_noises()).
  virtual Eigen::MatrixXd score_noise(const Record& record, const Eigen::VectorXd& xi,
                                      const Eigen::VectorXd& noise,
                                      const Eigen::VectorXd& density) const;

  /// The likelihood of a record where noise drives the states, which filter error maximises; model
  /// and record must outlive it. nullptr of a model without a state.
  virtual std::unique_ptr<InnovationModel> innovations(const Record& record) const;

  /// A trajectory model returns its state here; its blocks then come in order, one pass a carry,
  /// and the model forgets the state where block.starts_segment. nullptr: samples are independent.
  virtual std::unique_ptr<Carry> new_carry() const { return nullptr; }

 private:
  Tables tables_;
};

}  // namespace sepcal
