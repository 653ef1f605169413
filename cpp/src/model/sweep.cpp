// SPDX-License-Identifier: BSD-3-Clause
#include "model/sweep.hpp"

#include <algorithm>
#include <cmath>

#include "base/stop.hpp"
#include "model/row_lanes.hpp"

namespace sepcal::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;
using Factors = std::vector<TriangularFactor>;

Index rows_of(const Measurements::Range& range) { return static_cast<Index>(range.rows); }

/// One factor an output, from rows stacked output by output.
template <class Factor>
void absorb_by_output(Ref<MatrixXd> rows, Index block_rows, std::vector<Factor>& factors) {
  for (std::size_t j = 0; j < factors.size(); ++j) {
    factors[j].absorb(rows.middleRows(static_cast<Index>(j) * block_rows, block_rows));
  }
}

Factors merge_in_order(const std::vector<Factors>& chunks, int outputs, int columns) {
  Factors merged(static_cast<std::size_t>(outputs), TriangularFactor(columns));
  for (const Factors& chunk : chunks) {
    for (std::size_t j = 0; j < merged.size(); ++j) merged[j].merge(chunk[j]);
  }
  return merged;
}

std::vector<Factors> empty_factors(std::size_t chunks, int outputs, int columns) {
  return {chunks, Factors(static_cast<std::size_t>(outputs), TriangularFactor(columns))};
}

}  // namespace

void Sweep::subtract_from_outputs(const Measurements::Range& range, Ref<VectorXd> values) const {
  for (int j = 0; j < tables().n_z(); ++j) {
    const auto z = measurements_.output(j, range);
    auto part = values.segment(j * rows_of(range), rows_of(range));
    part = Eigen::Map<const VectorXd>(z.data(), rows_of(range)) - part;
  }
}

void Sweep::fill_linear(const Block& block, const Measurements::Range& range, const double* xi2,
                        Carry* carry, Ref<MatrixXd> rows) const {
  model_.evaluate(block, xi2, nullptr, carry, rows);
  subtract_from_outputs(range, rows.rightCols<1>().col(0));
}

void Sweep::fill_tangent(const Block& block, const Measurements::Range& range, const VectorXd& xi1,
                         const VectorXd& xi2, Carry* carry, Ref<MatrixXd> rows) const {
  model_.evaluate(block, values_of(xi2), values_of(xi1), carry, rows);
  subtract_from_outputs(range, rows.rightCols<1>().col(0));
  rows.rightCols<1>().noalias() -= rows.leftCols(tables().n_1()) * xi1;
}

void Sweep::for_each_block(const Visit& visit) const {
  const auto& chunks = measurements_.chunks();
  pool_.for_each(chunks.size(), [&](std::size_t c) {
    const auto carry = model_.new_carry();
    std::vector<const double*> pointers;
    RowScratch scratch;
    for (const Measurements::Range& range : chunks[c]) {
      base::heed_stop();
      visit(c, range, measurements_.block(range, pointers), carry.get(), scratch);
    }
  });
}

Factors Sweep::factor_blocks(int columns, const FillRows& fill) const {
  const int n_z = tables().n_z();
  const std::size_t chunks = measurements_.chunks().size();
  if (RowLanes::take(columns)) {
    std::vector<std::vector<RowLanes>> lanes(
        chunks, std::vector<RowLanes>(static_cast<std::size_t>(n_z), RowLanes(columns)));
    for_each_block([&](std::size_t c, const auto& range, const Block& block, Carry* carry,
                       RowScratch& scratch) {
      auto rows = scratch.shape(n_z * rows_of(range), columns);
      fill(block, range, carry, rows);
      absorb_by_output(rows, rows_of(range), lanes[c]);
    });
    std::vector<Factors> parts(chunks);
    bool safe = true;
    for (std::size_t c = 0; c < chunks; ++c) {
      for (const RowLanes& own : lanes[c]) {
        safe = safe && own.is_safe();
        parts[c].push_back(own.merge());
      }
    }
    if (safe) return merge_in_order(parts, n_z, columns);
  }
  std::vector<Factors> parts = empty_factors(chunks, n_z, columns);
  for_each_block(
      [&](std::size_t c, const auto& range, const Block& block, Carry* carry, RowScratch& scratch) {
        auto rows = scratch.shape(n_z * rows_of(range), columns);
        fill(block, range, carry, rows);
        absorb_by_output(rows, rows_of(range), parts[c]);
      });
  return merge_in_order(parts, n_z, columns);
}

std::vector<TriangularFactor> Sweep::linear_factors(const VectorXd& xi2) const {
  return linear_memory_.at(xi2, [&] {
    ++values_passes_;
    return factor_blocks(
        tables().n_1() + 1,
        [&](const Block& block, const Measurements::Range& range, Carry* carry,
            const Ref<MatrixXd>& rows) { fill_linear(block, range, xi2.data(), carry, rows); });
  });
}

std::vector<TriangularFactor> Sweep::tangent_factors(const VectorXd& xi1,
                                                     const VectorXd& xi2) const {
  VectorXd xi(xi1.size() + xi2.size());
  xi << xi1, xi2;
  return tangent_memory_.at(xi, [&] {
    ++tangent_passes_;
    return factor_blocks(
        tables().n_1() + tables().n_2() + 1,
        [&](const Block& block, const Measurements::Range& range, Carry* carry,
            const Ref<MatrixXd>& rows) { fill_tangent(block, range, xi1, xi2, carry, rows); });
  });
}

std::vector<TriangularFactor> Sweep::forgiving_factors(const VectorXd& xi1, const VectorXd& xi2,
                                                       const RobustLoss& loss,
                                                       const VectorXd& weights) const {
  ++tangent_passes_;
  const int columns = tables().n_1() + tables().n_2() + 1;
  const int n_z = tables().n_z();
  std::vector<Factors> parts = empty_factors(measurements_.chunks().size(), n_z, columns);
  MatrixXd excesses = MatrixXd::Zero(n_z, static_cast<Index>(parts.size()));
  for_each_block(
      [&](std::size_t c, const auto& range, const Block& block, Carry* carry, RowScratch& scratch) {
        const Index N = rows_of(range);
        auto rows = scratch.shape(n_z * N, columns);
        fill_tangent(block, range, xi1, xi2, carry, rows);
        for (Index row = 0; row < rows.rows(); ++row) {
          const Index j = row / N;
          const double s = weights[j] * rows(row, columns - 1);
          const double w = loss.weight(s);
          excesses(j, static_cast<Index>(c)) += std::max(0.0, loss.cost(s) - w * s * s);
          rows.row(row) *= std::sqrt(w);
        }
        absorb_by_output(rows, N, parts[c]);
      });
  Factors factors = merge_in_order(parts, n_z, columns);
  for (int j = 0; j < n_z; ++j) {
    MatrixXd excess = MatrixXd::Zero(1, columns);
    excess(0, columns - 1) = std::sqrt(excesses.row(j).sum()) / weights[j];
    factors[static_cast<std::size_t>(j)].absorb(excess);
  }
  return factors;
}

std::vector<MatrixXd> Sweep::slope_products(const VectorXd& xi1, const VectorXd& xi2) const {
  const Index n_1 = tables().n_1();
  const Index n_2 = tables().n_2();
  const Index n_z = tables().n_z();
  std::vector<VectorXd> points{xi1, VectorXd::Zero(n_1)};
  for (Index p = 0; p < n_1; ++p) points.emplace_back(VectorXd::Unit(n_1, p));
  tangent_passes_ += static_cast<int>(points.size());
  const auto& chunks = measurements_.chunks();
  std::vector<MatrixXd> parts(chunks.size(), MatrixXd::Zero(n_1, n_z * n_2));
  pool_.for_each(chunks.size(), [&](std::size_t c) {
    std::vector<std::unique_ptr<Carry>> carries;  // each tangent is a pass of its own
    for (std::size_t k = 0; k < points.size(); ++k) carries.push_back(model_.new_carry());
    std::vector<const double*> pointers;
    for (const Measurements::Range& range : chunks[c]) {
      base::heed_stop();
      const Index N = rows_of(range);
      const Block block = measurements_.block(range, pointers);
      std::vector<MatrixXd> tangents;
      for (std::size_t k = 0; k < points.size(); ++k) {
        MatrixXd rows(n_z * N, n_1 + n_2 + 1);
        fill_tangent(block, range, points[k], xi2, carries[k].get(), rows);
        tangents.emplace_back(rows.rightCols(n_2 + 1));
      }
      const VectorXd r = tangents[0].col(n_2);
      for (Index p = 0; p < n_1; ++p) {
        const MatrixXd slope =
            (tangents[static_cast<std::size_t>(p) + 2] - tangents[1]).leftCols(n_2);
        for (Index j = 0; j < n_z; ++j) {
          parts[c].row(p).segment(j * n_2, n_2) +=
              r.segment(j * N, N).transpose() * slope.middleRows(j * N, N);
        }
      }
    }
  });
  std::vector<MatrixXd> products(static_cast<std::size_t>(n_z), MatrixXd::Zero(n_1, n_2));
  for (const MatrixXd& part : parts) {
    for (Index j = 0; j < n_z; ++j) {
      products[static_cast<std::size_t>(j)] += part.middleCols(j * n_2, n_2);
    }
  }
  return products;
}

template <class VisitRows>
void Sweep::for_each_tangent(const VectorXd& xi1, const VectorXd& xi2,
                             const VisitRows& visit) const {
  ++tangent_passes_;
  const int n_z = tables().n_z();
  for_each_block(
      [&](std::size_t, const auto& range, const Block& block, Carry* carry, RowScratch& scratch) {
        auto rows = scratch.shape(n_z * rows_of(range), tables().n_1() + tables().n_2() + 1);
        fill_tangent(block, range, xi1, xi2, carry, rows);
        for (int j = 0; j < n_z; ++j) {
          visit(j, static_cast<Index>(range.offset),
                rows.middleRows(j * rows_of(range), rows_of(range)));
        }
      });
}

std::vector<MatrixXd> Sweep::tangent_rows(const VectorXd& xi1, const VectorXd& xi2) const {
  std::vector<MatrixXd> outputs(
      static_cast<std::size_t>(tables().n_z()),
      MatrixXd(static_cast<Index>(measurements_.rows()), tables().n_1() + tables().n_2() + 1));
  for_each_tangent(xi1, xi2, [&](int j, Index offset, const auto& rows) {
    outputs[static_cast<std::size_t>(j)].middleRows(offset, rows.rows()) = rows;
  });
  return outputs;
}

MatrixXd Sweep::tangent_columns(const VectorXd& xi1, const VectorXd& xi2,
                                const std::vector<Index>& columns) const {
  const auto count = static_cast<Index>(measurements_.rows());
  MatrixXd stacked(tables().n_z() * count, static_cast<Index>(columns.size()));
  for_each_tangent(xi1, xi2, [&](int j, Index offset, const auto& rows) {
    stacked.middleRows(j * count + offset, rows.rows()) = rows(Eigen::all, columns);
  });
  return stacked;
}

MatrixXd Sweep::block_residuals(const Block& block, const Measurements::Range& range,
                                const VectorXd& xi1, const VectorXd& xi2, Carry* carry,
                                RowScratch& scratch) const {
  const int n_1 = tables().n_1();
  auto rows = scratch.shape(tables().n_z() * rows_of(range), n_1 + 1);
  fill_linear(block, range, xi2.data(), carry, rows);
  VectorXd r = rows.col(n_1);
  r.noalias() -= rows.leftCols(n_1) * xi1;
  return r.reshaped(rows_of(range), tables().n_z());
}

VectorXd Sweep::sum_residuals(const VectorXd& xi1, const VectorXd& xi2,
                              const std::function<VectorXd(const MatrixXd&)>& of_block) const {
  ++values_passes_;
  const auto chunks = static_cast<Index>(measurements_.chunks().size());
  MatrixXd parts = MatrixXd::Zero(tables().n_z(), chunks);
  for_each_block(
      [&](std::size_t c, const auto& range, const Block& block, Carry* carry, RowScratch& scratch) {
        parts.col(static_cast<Index>(c)) +=
            of_block(block_residuals(block, range, xi1, xi2, carry, scratch));
      });
  return parts.rowwise().sum();
}

VectorXd Sweep::squared_residuals(const VectorXd& xi1, const VectorXd& xi2) const {
  return sum_residuals(xi1, xi2, [](const MatrixXd& r) -> VectorXd {
    return r.colwise().squaredNorm().transpose();
  });
}

VectorXd Sweep::losses(const VectorXd& xi1, const VectorXd& xi2, const RobustLoss& loss,
                       const VectorXd& weights) const {
  return sum_residuals(xi1, xi2, [&](const MatrixXd& r) -> VectorXd {
    const MatrixXd s = r * weights.asDiagonal();
    return s.unaryExpr([&](double each) { return loss.cost(each); }).colwise().sum().transpose();
  });
}

MatrixXd Sweep::residuals(const VectorXd& xi1, const VectorXd& xi2) const {
  ++values_passes_;
  MatrixXd all(static_cast<Index>(measurements_.rows()), tables().n_z());
  for_each_block(
      [&](std::size_t, const auto& range, const Block& block, Carry* carry, RowScratch& scratch) {
        all.middleRows(static_cast<Index>(range.offset), rows_of(range)) =
            block_residuals(block, range, xi1, xi2, carry, scratch);
      });
  return all;
}

}  // namespace sepcal::model
