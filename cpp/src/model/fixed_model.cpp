// SPDX-License-Identifier: BSD-3-Clause
#include "model/fixed_model.hpp"

#include <algorithm>

namespace sepcal::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Tables without(const Tables& tables, const std::map<std::string, double>& fixed) {
  Tables left = tables;
  const auto held = [&](const Variable& parameter) { return fixed.contains(parameter.name); };
  std::erase_if(left.linear, held);
  std::erase_if(left.nonlinear, held);
  return left;
}

void split(const std::vector<Variable>& parameters, const std::map<std::string, double>& fixed,
           VectorXd& values, std::vector<Index>& free) {
  values = VectorXd::Zero(static_cast<Index>(parameters.size()));
  for (Index k = 0; k < values.size(); ++k) {
    const auto at = fixed.find(parameters[static_cast<std::size_t>(k)].name);
    if (at == fixed.end()) {
      free.push_back(k);
    } else {
      values[k] = at->second;
    }
  }
}

VectorXd fill_in(VectorXd whole, const std::vector<Index>& free, const double* values) {
  for (std::size_t i = 0; i < free.size(); ++i) whole[free[i]] = values[i];
  return whole;
}

}  // namespace

FixedModel::FixedModel(const BlockModel& model, const std::map<std::string, double>& fixed)
    : BlockModel(without(model.tables(), fixed)), model_(model) {
  split(model.tables().linear, fixed, xi1_, free_1_);
  split(model.tables().nonlinear, fixed, xi2_, free_2_);
}

void FixedModel::evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                          Eigen::Ref<MatrixXd> rows) const {
  const VectorXd whole_2 = fill_in(xi2_, free_2_, xi2);
  const Index n_1 = xi1_.size();
  const Index n_2 = xi1 == nullptr ? 0 : xi2_.size();
  MatrixXd whole(rows.rows(), n_1 + n_2 + 1);
  if (xi1 == nullptr) {
    model_.evaluate(block, whole_2.data(), nullptr, carry, whole);
  } else {
    const VectorXd whole_1 = fill_in(xi1_, free_1_, xi1);
    model_.evaluate(block, values_of(whole_2), values_of(whole_1), carry, whole);
  }
  take_free(whole, xi1 != nullptr, rows);
}

void FixedModel::take_free(const MatrixXd& whole, bool tangent, Eigen::Ref<MatrixXd> rows) const {
  const Index n_1 = xi1_.size();
  Index column = 0;
  for (const Index k : free_1_) rows.col(column++) = whole.col(k);
  if (tangent) {
    for (const Index k : free_2_) rows.col(column++) = whole.col(n_1 + k);
  }
  rows.col(column).noalias() = whole.rightCols<1>() + whole.leftCols(n_1) * xi1_;
}

void FixedModel::evaluate_points(const Block& block, const MatrixXd& points,
                                 std::span<const std::unique_ptr<Carry>> carries, MatrixXd& scratch,
                                 const VisitRows& visit) const {
  MatrixXd whole(xi2_.size(), points.cols());
  for (Index s = 0; s < points.cols(); ++s) {
    whole.col(s) = fill_in(xi2_, free_2_, points.col(s).data());
  }
  MatrixXd free(static_cast<Index>(block.rows) * tables().n_z(), tables().n_1() + 1);
  model_.evaluate_points(block, whole, carries, scratch, [&](Index s, const MatrixXd& rows) {
    take_free(rows, false, free);
    visit(s, free);
  });
}

bool FixedModel::evaluate_lanes(const LaneBlock& block, const PointTiles& points, double* scratch,
                                const VisitTile& visit) const {
  const std::size_t width = lane_width();
  const auto n_2 = static_cast<std::size_t>(xi2_.size());
  base::AlignedDoubles whole;
  whole.reserve(points.tiles * n_2 * width);
  const double* free = points.xi2;
  for (std::size_t t = 0; t < points.tiles; ++t) {
    auto next = free_2_.begin();
    for (Index k = 0; k < xi2_.size(); ++k) {
      if (next != free_2_.end() && *next == k) {
        whole.insert(whole.end(), free, free + width);
        free += width;
        ++next;
      } else {
        whole.insert(whole.end(), width, xi2_[k]);
      }
    }
  }
  const Index n_1 = xi1_.size();
  std::vector<unsigned char> zero(static_cast<std::size_t>(n_1 * tables().n_z()), 0);
  const auto given = static_cast<Index>(free_1_.size());
  for (Index j = 0; j < tables().n_z() && block.zero != nullptr; ++j) {
    for (Index k = 0; k < given; ++k) {
      zero[static_cast<std::size_t>(j * n_1 + free_1_[static_cast<std::size_t>(k)])] =
          block.zero[j * given + k];
    }
  }
  LaneBlock of_whole = block;
  of_whole.zero = zero.data();
  base::AlignedDoubles rows(static_cast<std::size_t>((n_1 + 1) * tables().n_z()) * block.rows *
                            width);
  base::AlignedDoubles held(block.rows * width);
  return model_.evaluate_lanes(of_whole, {whole.data(), points.tiles}, rows.data(),
                               [&](std::size_t tile, double* values) {
                                 take_free(of_whole, values, scratch, held);
                                 visit(tile, scratch);
                               });
}

void FixedModel::take_free(const LaneBlock& whole, const double* rows, double* to,
                           base::AlignedDoubles& held) const {
  const std::size_t size = held.size();
  const Index n_1 = xi1_.size();
  for (Index j = 0; j < tables().n_z(); ++j) {
    std::ranges::fill(held, 0.0);
    auto next = free_1_.begin();
    for (Index k = 0; k < n_1; ++k) {
      const bool is_free = next != free_1_.end() && *next == k;
      if (is_free) ++next;
      if (whole.zero[j * n_1 + k] != 0) continue;
      if (is_free) {
        to = std::copy_n(rows, size, to);
      } else {
        for (std::size_t i = 0; i < size; ++i) held[i] += xi1_[k] * rows[i];
      }
      rows += size;
    }
    for (std::size_t i = 0; i < size; ++i) to[i] = rows[i] - held[i];
    rows += size;
    to += size;
  }
}

void FixedModel::fill_trials(const TrialRows& trials, double* to) const {
  const std::size_t width = lane_width();
  const auto n_z = static_cast<std::size_t>(tables().n_z());
  const Index n_1 = xi1_.size();
  const Index n = n_1 + xi2_.size();
  const auto size = static_cast<std::size_t>(trials.rows) * width;
  // Uninitialised, and aligned for registers of any width.
  Eigen::ArrayXd scratch(static_cast<Index>(width) * n + static_cast<Index>(n_z * size) * (n + 1));
  const auto lay_out = [&](const VectorXd& held, const std::vector<Index>& free,
                           const double* values, double* whole) {
    auto next = free.begin();
    for (Index k = 0; k < held.size(); ++k, whole += width) {
      if (next != free.end() && *next == k) {
        std::copy_n(values, width, whole);
        values += width;
        ++next;
      } else {
        std::fill_n(whole, width, held[k]);
      }
    }
    return whole;
  };
  TrialRows of_whole = trials;
  of_whole.xi1 = scratch.data();
  double* const xi2 = lay_out(xi1_, free_1_, trials.xi1, scratch.data());
  of_whole.xi2 = xi2;
  double* const rows = lay_out(xi2_, free_2_, trials.xi2, xi2);
  model_.fill_trials(of_whole, rows);
  const auto column = [&](std::size_t j, Index k) {
    return rows + (j * static_cast<std::size_t>(n + 1) + static_cast<std::size_t>(k)) * size;
  };
  for (std::size_t j = 0; j < n_z; ++j) {
    for (const Index k : free_1_) to = std::copy_n(column(j, k), size, to);
    for (const Index k : free_2_) to = std::copy_n(column(j, n_1 + k), size, to);
    to = std::copy_n(column(j, n), size, to);
  }
}

void FixedModel::input_tangent(const Block& block, const double* xi2, const double* xi1,
                               std::span<const int> inputs, Eigen::Ref<MatrixXd> columns) const {
  const VectorXd whole_1 = fill_in(xi1_, free_1_, xi1);
  const VectorXd whole_2 = fill_in(xi2_, free_2_, xi2);
  model_.input_tangent(block, values_of(whole_2), values_of(whole_1), inputs, columns);
}

bool FixedModel::add_second_derivatives(const Block& block, const double* xi2, const double* xi1,
                                        Eigen::Ref<MatrixXd> sum) const {
  const VectorXd whole_1 = fill_in(xi1_, free_1_, xi1);
  const VectorXd whole_2 = fill_in(xi2_, free_2_, xi2);
  MatrixXd whole = MatrixXd::Zero(xi2_.size(), xi2_.size());
  if (!model_.add_second_derivatives(block, values_of(whole_2), values_of(whole_1), whole)) {
    return false;
  }
  sum += whole(free_2_, free_2_);
  return true;
}

}  // namespace sepcal::model
