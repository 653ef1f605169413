// SPDX-License-Identifier: BSD-3-Clause
#include "model/sweep.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <utility>

#include "base/stop.hpp"
#include "model/in_order.hpp"
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
void absorb_by_output(Ref<MatrixXd> rows, Index block_rows, Factors& factors) {
  for (std::size_t j = 0; j < factors.size(); ++j) {
    factors[j].absorb(rows.middleRows(static_cast<Index>(j) * block_rows, block_rows));
  }
}

Factors empty_factors(int outputs, int columns) {
  return Factors(static_cast<std::size_t>(outputs), TriangularFactor(columns));
}

void merge_by_output(const Factors& part, Factors& merged) {
  for (std::size_t j = 0; j < merged.size(); ++j) merged[j].merge(part[j]);
}

/// Merges the factors of chunks as they come.
class Merge : public InOrder<Factors> {
 public:
  Merge(int outputs, int columns)
      : InOrder([this](const Factors& part) { merge_by_output(part, merged_); }),
        merged_(empty_factors(outputs, columns)) {}

  /// Once every chunk was given.
  Factors result() { return std::move(merged_); }

 private:
  Factors merged_;
};

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

void Sweep::for_each_block(const Visit& visit, const AfterChunk& after_chunk) const {
  const auto& chunks = measurements_.chunks();
  pool_.for_each(chunks.size(), [&](std::size_t c) {
    const auto carry = model_.new_carry();
    std::vector<const double*> pointers;
    RowScratch scratch;
    for (const Measurements::Range& range : chunks[c]) {
      base::heed_stop();
      visit(c, range, measurements_.block(range, pointers), carry.get(), scratch);
    }
    if (after_chunk) after_chunk(c);
    measurements_.release(chunks[c]);
  });
}

Factors Sweep::factor_blocks(int columns, const FillRows& fill) const {
  const int n_z = tables().n_z();
  const std::size_t chunks = measurements_.chunks().size();
  const auto outputs = static_cast<std::size_t>(n_z);
  if (RowLanes::take(columns)) {
    Merge merge(n_z, columns);
    std::vector<std::vector<RowLanes>> lanes(chunks);
    std::atomic<bool> safe = true;
    for_each_block(
        [&](std::size_t c, const auto& range, const Block& block, Carry* carry,
            RowScratch& scratch) {
          if (lanes[c].empty()) lanes[c] = std::vector<RowLanes>(outputs, RowLanes(columns));
          auto rows = scratch.shape(n_z * rows_of(range), columns);
          fill(block, range, carry, rows);
          RowLanes::absorb_outputs(lanes[c], rows);
        },
        [&](std::size_t c) {
          Factors factors;
          for (const RowLanes& own : lanes[c]) {
            if (!own.is_safe()) safe = false;
            factors.push_back(own.merge());
          }
          std::vector<RowLanes>().swap(lanes[c]);
          merge.give(c, std::move(factors));
        });
    if (safe) return merge.result();
  }
  Merge merge(n_z, columns);
  std::vector<Factors> parts(chunks);
  for_each_block(
      [&](std::size_t c, const auto& range, const Block& block, Carry* carry, RowScratch& scratch) {
        if (parts[c].empty()) parts[c] = empty_factors(n_z, columns);
        auto rows = scratch.shape(n_z * rows_of(range), columns);
        fill(block, range, carry, rows);
        absorb_by_output(rows, rows_of(range), parts[c]);
      },
      [&](std::size_t c) { merge.give(c, std::move(parts[c])); });
  return merge.result();
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
  Merge merge(n_z, columns);
  std::vector<Factors> parts(measurements_.chunks().size());
  MatrixXd excesses = MatrixXd::Zero(n_z, static_cast<Index>(parts.size()));
  for_each_block(
      [&](std::size_t c, const auto& range, const Block& block, Carry* carry, RowScratch& scratch) {
        const Index N = rows_of(range);
        if (parts[c].empty()) parts[c] = empty_factors(n_z, columns);
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
      },
      [&](std::size_t c) { merge.give(c, std::move(parts[c])); });
  Factors factors = merge.result();
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
    measurements_.release(chunks[c]);
  });
  std::vector<MatrixXd> products(static_cast<std::size_t>(n_z), MatrixXd::Zero(n_1, n_2));
  for (const MatrixXd& part : parts) {
    for (Index j = 0; j < n_z; ++j) {
      products[static_cast<std::size_t>(j)] += part.middleCols(j * n_2, n_2);
    }
  }
  return products;
}

std::vector<Factors> Sweep::stretch_factors(const VectorXd& xi1, const VectorXd& xi2,
                                            const std::vector<Index>& cuts,
                                            const RowWeight& weight) const {
  ++tangent_passes_;
  const int columns = tables().n_1() + tables().n_2() + 1;
  const int n_z = tables().n_z();
  std::vector<Factors> stretches(cuts.size() - 1, empty_factors(n_z, columns));
  using Part = std::map<std::size_t, Factors>;  // by stretch
  InOrder<Part> merge([&](const Part& part) {
    for (const auto& [stretch, factors] : part) merge_by_output(factors, stretches[stretch]);
  });
  std::vector<Part> parts(measurements_.chunks().size());
  for_each_block(
      [&](std::size_t c, const auto& range, const Block& block, Carry* carry, RowScratch& scratch) {
        const Index N = rows_of(range);
        const auto first = static_cast<Index>(range.offset);
        auto rows = scratch.shape(n_z * N, columns);
        fill_tangent(block, range, xi1, xi2, carry, rows);
        if (weight) {
          for (Index row = 0; row < rows.rows(); ++row) {
            rows.row(row) *= weight(row / N, rows(row, columns - 1));
          }
        }
        for (Index from = 0; from < N;) {
          const auto stretch = static_cast<std::size_t>(
              std::ranges::upper_bound(cuts, first + from) - cuts.begin() - 1);
          const Index to = std::min(N, cuts[stretch + 1] - first);
          Factors& own = parts[c].try_emplace(stretch, empty_factors(n_z, columns)).first->second;
          for (int j = 0; j < n_z; ++j) {
            own[static_cast<std::size_t>(j)].absorb(rows.middleRows(j * N + from, to - from));
          }
          from = to;
        }
      },
      [&](std::size_t c) { merge.give(c, std::move(parts[c])); });
  return stretches;
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

void Sweep::for_each_residual(const VectorXd& xi1, const VectorXd& xi2,
                              const std::function<void(const MatrixXd& r)>& visit) const {
  ++values_passes_;
  using Blocks = std::vector<MatrixXd>;
  InOrder<Blocks> in_order([&](const Blocks& blocks) { std::ranges::for_each(blocks, visit); });
  std::vector<Blocks> parts(measurements_.chunks().size());
  for_each_block(
      [&](std::size_t c, const auto& range, const Block& block, Carry* carry, RowScratch& scratch) {
        parts[c].push_back(block_residuals(block, range, xi1, xi2, carry, scratch));
      },
      [&](std::size_t c) { in_order.give(c, std::move(parts[c])); });
}

MatrixXd Sweep::residuals(const VectorXd& xi1, const VectorXd& xi2) const {
  MatrixXd all(static_cast<Index>(measurements_.rows()), tables().n_z());
  Index first = 0;
  for_each_residual(xi1, xi2, [&](const MatrixXd& r) {
    all.middleRows(first, r.rows()) = r;
    first += r.rows();
  });
  return all;
}

}  // namespace sepcal::model
